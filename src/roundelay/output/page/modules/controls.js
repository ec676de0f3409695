// Buttons, switches and keys: what they do, and how they show the state.

import { byId } from "./elements.js";
import { listenToKeys } from "./keyboard.js";

const PLAY = "M4 2.5v11l9-5.5z";
const PAUSE = "M3.5 2.5h3v11h-3zM9.5 2.5h3v11h-3z";

export function listenToControls(store, page, { reset, theme }) {
  const { state } = store;
  const { capture } = page;
  const speed = byId("speed");
  const hasLoop = () => Boolean(page.motion()?.loop);
  const actions = {
    reset,
    theme,
    playOrPause: () => store.change({ playing: !state.playing }),
    seek: (time) => store.change({ time: Math.min(Math.max(time, 0), capture.seconds) }),
    step: (direction, far) => actions.seek(state.time + direction * (far ? 1 : capture.step / capture.fps)),
    toggle: (what) => store.change({ [what]: !state[what] }),
    view: (view) => store.change({ view: hasLoop() ? view : "capture" }),
    compare: () => actions.view(state.view === "capture" ? "loop" : "capture"),
    help: () => byId("help").showModal(),
    speed(direction) {
      speed.selectedIndex = Math.min(Math.max(speed.selectedIndex + direction, 0), speed.length - 1);
      store.change({ speed: Number(speed.value) });
    },
    part(direction) {
      const starts = (page.motion()?.parts ?? []).map(([start]) => start / capture.fps);
      const next = direction > 0
        ? starts.find((time) => time > state.time + 0.01)
        : starts.findLast((time) => time < state.time - 0.01);
      if (next !== undefined) actions.seek(next);
    },
    nextClass() {
      const bars = (page.motion()?.classes ?? []).map(({ bar }) => bar);
      if (bars.length > 0) store.change({ bar: bars[(bars.indexOf(state.bar) + 1) % bars.length] });
    },
  };
  byId("play").addEventListener("click", actions.playOrPause);
  byId("help-button").addEventListener("click", actions.help);
  speed.addEventListener("change", () => store.change({ speed: Number(speed.value) }));
  for (const what of ["onion", "follow"]) {
    byId(what).addEventListener("change", (event) => store.change({ [what]: event.target.checked }));
  }
  byId("views").addEventListener("change", (event) => actions.view(event.target.value));
  listenToKeys(actions);
}

export function showControls(state, { capture }) {
  byId("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
  byId("play-icon").setAttribute("d", state.playing ? PAUSE : PLAY);
  const frame = Math.round(state.time * capture.fps);
  byId("now").textContent = `${state.time.toFixed(2)} s`;
  byId("frame").textContent = `, frame ${frame}`;
  byId("onion").checked = state.onion;
  byId("follow").checked = state.follow;
  for (const choice of byId("views").querySelectorAll("input")) choice.checked = choice.value === state.view;
  const timeline = byId("timeline");
  timeline.setAttribute("aria-valuemax", capture.seconds.toFixed(2));
  timeline.setAttribute("aria-valuenow", state.time.toFixed(2));
  timeline.setAttribute("aria-valuetext", `${state.time.toFixed(2)} seconds`);
}
