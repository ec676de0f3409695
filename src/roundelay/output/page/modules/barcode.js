// The barcode as a list of choices: every bar with a coordinate can be selected.

import { element } from "./elements.js";

export function createBarcode(list, note, page, store) {
  function row(motion, [birth, death], number, longest) {
    const found = motion.class(number);
    const bar = element("i");
    bar.style.left = `${(100 * birth) / longest}%`;
    bar.style.width = `${(100 * (death - birth)) / longest}%`;
    const cells = [
      element("span", { className: "muted" }, found ? `${number}` : ""),
      element("span", { className: "track" }, bar),
      element("span", { className: "turns" }, found ? `${found.net.toFixed(2)} turns` : ""),
    ];
    if (!found) return element("div", { className: "bar minor" }, ...cells);
    const input = element("input", { type: "radio", name: "bar", value: number });
    input.addEventListener("change", () => store.change({ bar: number }));
    const spoken = `Class ${number}: born at ${birth}, dies at ${death}, ${found.net.toFixed(2)} turns`;
    input.setAttribute("aria-label", spoken);
    return element("label", { className: "bar" }, input, ...cells);
  }

  function fill() {
    const motion = page.motion();
    list.replaceChildren();
    if (!motion?.bars?.length) return;
    const longest = Math.max(...motion.bars.map(([, death]) => death));
    list.append(...motion.bars.map((bar, number) => row(motion, bar, number, longest)));
    list.append(axis(longest));
    show();
  }

  function show() {
    const { bar } = store.state;
    for (const input of list.querySelectorAll("input")) {
      input.checked = Number(input.value) === bar;
      input.parentElement.classList.toggle("selected", input.checked);
    }
    if (page.motion()) note.textContent = remark(page.motion(), bar);
  }

  return { fill, show };
}

function axis(longest) {
  const ticks = [0, longest / 2, longest].map((value) => element("span", {}, value.toFixed(2)));
  return element("div", { className: "axis" }, ...ticks);
}

function remark(motion, bar) {
  const hidden = motion.hidden ? `${motion.hidden} short bars are not shown. ` : "";
  const found = motion.class(bar);
  if (!found) return hidden;
  const steady = Math.round((100 * found.net) / Math.max(found.total, 1e-9));
  const about = `${hidden}Of the turning of class ${bar}, ${steady} % is forwards.`;
  return motion.loop ? `${about} The loop is made with class ${motion.chosen}.` : about;
}
