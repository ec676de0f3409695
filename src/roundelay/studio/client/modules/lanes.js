// The timeline: a ruler with the time, and every part as a range whose ends can be moved.

import { element } from "../page/elements.js";
import { hue } from "./cards.js";
import { moved } from "./edits.js";

const STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600];
const HEIGHT = 37;

export function createLanes({ ruler, lanes, cursor }, page, store, session) {
  const { frames, fps } = page.capture;
  const percent = (frame) => `${(100 * frame) / frames}%`;

  function frameAt(event) {
    const box = lanes.getBoundingClientRect();
    return Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1) * frames;
  }

  function fillRuler() {
    const seconds = frames / fps;
    const wanted = seconds / Math.max(lanes.clientWidth / 76, 2);
    const step = STEPS.find((one) => one >= wanted) ?? 1800;
    const ticks = [];
    for (let at = 0; at < seconds - 0.3 * step; at += step) {
      const tick = element("span", {}, step < 1 ? at.toFixed(1) : `${Math.round(at)}`);
      tick.style.left = percent(at * fps);
      ticks.push(tick);
    }
    ruler.replaceChildren(...ticks);
    ruler.setAttribute("aria-valuemax", seconds.toFixed(2));
  }

  // Parts that overlap, of different limbs, lie below each other.
  function rows(parts) {
    const ends = [];
    return parts.map(({ spans }) => {
      const row = ends.findIndex((taken) => taken.every(([a, b]) => spans.every(([c, d]) => d <= a || b <= c)));
      if (row >= 0) ends[row].push(...spans);
      else ends.push([...spans]);
      return row >= 0 ? row : ends.length - 1;
    });
  }

  function fill() {
    const { work } = session();
    const placed = rows(work.parts);
    const kept = document.activeElement?.dataset?.handle;
    lanes.style.height = `${HEIGHT * (Math.max(0, ...placed) + 1)}px`;
    lanes.replaceChildren(...work.parts.flatMap((part, place) =>
      part.spans.map((span, number) => range(part, place, number, span, placed[place]))));
    if (kept) lanes.querySelector(`[data-handle="${kept}"]`)?.focus();
  }

  function range(part, place, number, [start, stop], row) {
    const mine = place === store.state.part;
    const box = element("div", { className: mine ? "span mine" : "span" });
    box.style.setProperty("--hue", hue(place));
    box.style.left = percent(start);
    box.style.width = percent(stop - start);
    box.style.top = `${row * HEIGHT + 2}px`;
    const body = element("button", { className: "body", type: "button", title: `${part.name}, frames ${start} to ${stop}` }, part.name);
    body.setAttribute("aria-label", `${part.name}, frames ${start} to ${stop}`);
    body.addEventListener("click", (event) => {
      // By the keyboard: where the part begins.
      const frame = event.detail === 0 ? start : frameAt(event);
      store.change({ part: place, span: number, time: Math.min(frame, frames - 1) / fps });
    });
    box.append(body, handle(part, place, number, 0, start, box), handle(part, place, number, 1, stop, box));
    return box;
  }

  function handle(part, place, number, edge, frame, box) {
    const made = element("span", { className: `handle ${edge ? "last" : "first"}`, tabIndex: 0 });
    made.dataset.handle = `${place}.${number}.${edge}`;
    for (const [name, value] of Object.entries({
      role: "slider", "aria-label": `${edge ? "End" : "Start"} of ${part.name}`,
      "aria-valuemin": 0, "aria-valuemax": frames, "aria-valuenow": frame,
      "aria-valuetext": `frame ${frame}`,
    })) made.setAttribute(name, value);
    let to = null;
    const tried = (wanted) => moved(session().work, place, number, edge, wanted).parts[place].spans[number];
    made.addEventListener("pointerdown", (event) => {
      made.setPointerCapture(event.pointerId);
      event.preventDefault();
    });
    made.addEventListener("pointermove", (event) => {
      if (!made.hasPointerCapture(event.pointerId)) return;
      const [start, stop] = tried(frameAt(event));
      box.style.left = percent(start);
      box.style.width = percent(stop - start);
      to = edge ? stop : start;
      store.change({ part: place, span: number, time: Math.min(to, frames - 1) / fps });
    });
    made.addEventListener("pointerup", () => {
      if (to !== null) session().change(moved(session().work, place, number, edge, to));
    });
    made.addEventListener("keydown", (event) => {
      const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!way) return;
      event.preventDefault();
      store.change({ part: place, span: number });
      session().change(moved(session().work, place, number, edge, frame + way * (event.shiftKey ? 10 : 1)));
    });
    return made;
  }

  function showTime(time) {
    const at = Math.min((time * fps) / frames, 1);
    cursor.style.left = `calc(10px + ${at} * (100% - 20px))`;
    ruler.setAttribute("aria-valuenow", time.toFixed(2));
    ruler.setAttribute("aria-valuetext", `${time.toFixed(2)} seconds`);
  }

  const seek = (event) => store.change({ time: Math.min(frameAt(event), frames - 1) / fps, whole: true });
  ruler.addEventListener("pointerdown", (event) => {
    ruler.setPointerCapture(event.pointerId);
    seek(event);
  });
  ruler.addEventListener("pointermove", (event) => {
    if (ruler.hasPointerCapture(event.pointerId)) seek(event);
  });
  return { fill, fillRuler, showTime };
}
