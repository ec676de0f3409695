// The poses in their first two principal components, coloured by phase.

import { ink, layered } from "./canvas.js";

export function createPlane(canvas, page, store) {
  const { capture, colours } = page;
  let place = null;

  // A function from a point of the plane to the canvas; the axes keep their ratio.
  function placer(width, height) {
    const { values } = page.motion().plane.capture;
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    for (let i = 0; i < values.length; i += 2) {
      [left, right] = [Math.min(left, values[i]), Math.max(right, values[i])];
      [low, high] = [Math.min(low, values[i + 1]), Math.max(high, values[i + 1])];
    }
    const scale = Math.min((width - 16) / (right - left || 1), (height - 16) / (high - low || 1));
    const [x0, y0] = [(left + right) / 2, (low + high) / 2];
    return (x, y) => [width / 2 + scale * (x - x0), height / 2 - scale * (y - y0)];
  }

  function drawCurve(context, { values }, place, colour, thickness) {
    context.strokeStyle = colour;
    context.lineWidth = thickness;
    context.lineJoin = "round";
    context.beginPath();
    for (let i = 0; i < values.length; i += 2) context.lineTo(...place(values[i], values[i + 1]));
    context.stroke();
  }

  function drawPoints(context, motion, place) {
    const turns = motion.class(store.state.bar)?.turns.values;
    if (!turns) return;
    const { values } = motion.plane.capture;
    for (const [start, stop] of motion.parts) {
      for (let row = Math.ceil(start / capture.step); row * capture.step < stop; row++) {
        const phase = turns[row] - Math.floor(turns[row]);
        const [x, y] = place(values[2 * row], values[2 * row + 1]);
        context.fillStyle = colours[Math.floor(phase * colours.length) % colours.length];
        context.beginPath();
        context.arc(x, y, 2.4, 0, 7);
        context.fill();
      }
    }
  }

  function drawGround(context, width, height) {
    const motion = page.motion();
    if (!motion?.plane) return;
    place = placer(width, height);
    context.globalAlpha = 0.45;
    drawCurve(context, motion.plane.capture, place, ink("pale"), 0.75);
    context.globalAlpha = 1;
    drawPoints(context, motion, place);
    if (motion.plane.loop) drawCurve(context, motion.plane.loop, place, ink("ink"), 1.6);
  }

  function drawHere(context) {
    const motion = page.motion();
    if (!motion?.plane) return;
    const { values, rows } = motion.plane.capture;
    const row = Math.min(Math.round(capture.place(store.state.time)), rows - 1);
    const [x, y] = place(values[2 * row], values[2 * row + 1]);
    context.fillStyle = ink("accent");
    context.strokeStyle = ink("card");
    context.lineWidth = 2;
    context.beginPath();
    context.arc(x, y, 6, 0, 7);
    context.fill();
    context.stroke();
  }

  return layered(canvas, drawGround, drawHere);
}
