// The phase as a clock: a ring of the phase's colours with a hand.

import { font, ink, layered } from "./canvas.js";

export function createDial(canvas, page, store) {
  const { colours } = page;

  function drawRing(context, width, height) {
    const [x, y, radius] = [width / 2, height / 2, width / 2 - 8];
    const angle = (part) => 2 * Math.PI * part - Math.PI / 2;
    context.lineWidth = 9;
    colours.forEach((colour, number) => {
      context.strokeStyle = colour;
      context.beginPath();
      context.arc(x, y, radius, angle(number / colours.length), angle((number + 1.1) / colours.length));
      context.stroke();
    });
  }

  // The capture's coordinate, or the phase of the loop when that is what is seen.
  function shown() {
    const motion = page.motion();
    const { view, bar, time } = store.state;
    if (motion?.loop && view === "loop") return [motion.steadyPhase(time), "periods"];
    return [motion?.turns(bar, time) ?? null, "turns"];
  }

  function drawHand(context, width, height) {
    const [turns, unit] = shown();
    const [x, y, radius] = [width / 2, height / 2, width / 2 - 8];
    context.textAlign = "center";
    context.fillStyle = ink(turns === null ? "muted" : "ink");
    context.font = font(turns === null ? 12 : 19);
    context.fillText(turns === null ? "pause" : turns.toFixed(2), x, y + (turns === null ? 4 : 5));
    if (turns === null) return;
    context.font = font(10.5);
    context.fillStyle = ink("muted");
    context.fillText(unit, x, y + 19);
    const angle = 2 * Math.PI * turns - Math.PI / 2;
    context.fillStyle = ink("ink");
    context.strokeStyle = ink("card");
    context.lineWidth = 2.5;
    context.beginPath();
    context.arc(x + radius * Math.cos(angle), y + radius * Math.sin(angle), 7, 0, 7);
    context.fill();
    context.stroke();
  }

  return layered(canvas, drawRing, drawHand);
}
