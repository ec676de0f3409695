// What the studio says: how far it is, what went wrong, what is done.

import { byId } from "../page/elements.js";

export function tell(text, done = false) {
  const message = byId("message");
  message.hidden = !text;
  message.textContent = text;
  message.classList.toggle("done", done);
}

// The bar appears when work takes longer than a glance.
export function createBar() {
  let due = null;
  return {
    show(share, stage) {
      byId("progress").value = share;
      if (stage) byId("stage-name").textContent = stage;
      due ??= setTimeout(() => { byId("bar").hidden = false; }, 250);
    },
    hide() {
      clearTimeout(due);
      due = null;
      byId("bar").hidden = true;
    },
  };
}
