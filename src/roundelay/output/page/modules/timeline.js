// The timeline: periodic parts, segments, the circular coordinate, and where we are.

import { font, ink, layered } from "./canvas.js";

const LEFT = 10;
const RIGHT = 10;
const STRIP = 14;

// A, B, ..., Z, AA, AB, ...
function letters(number) {
  const first = Math.floor(number / 26);
  return (first > 0 ? letters(first - 1) : "") + String.fromCharCode(65 + (number % 26));
}

export function createTimeline(canvas, page, store) {
  const { capture, colours, segments } = page;
  const top = STRIP + 14 + (segments.length > 0 ? STRIP + 4 : 0);

  const x = (seconds, width) => LEFT + (seconds / capture.seconds) * (width - LEFT - RIGHT);
  const y = (phase, height) => top + (1 - phase) * (height - top - 24);

  function drawParts(context, width, height) {
    page.motions.forEach((motion, number) => {
      const current = number === store.state.motion;
      for (const [start, stop] of motion.parts) {
        const [from, to] = [x(start / capture.fps, width), x((stop - 1) / capture.fps, width)];
        context.fillStyle = ink(current ? "accent" : "pale");
        context.beginPath();
        context.roundRect(from, 8, Math.max(to - from, 2), STRIP - 6, 3);
        context.fill();
        if (!current) continue;
        context.fillStyle = ink("band");
        context.fillRect(from, top, Math.max(to - from, 1), height - top - 24);
      }
    });
  }

  function drawSegments(context, width) {
    context.font = font(10.5);
    for (const [start, stop, label] of segments) {
      const [from, to] = [x(start / capture.fps, width), x((stop - 1) / capture.fps, width)];
      context.fillStyle = `oklch(${ink("segment")} ${(label * 83) % 360})`;
      context.fillRect(from + 0.5, STRIP + 9, Math.max(to - from - 1, 1), STRIP);
      context.fillStyle = ink("ink");
      if (to - from > 16) context.fillText(letters(label), from + 5, STRIP + 20);
    }
  }

  function drawCoordinate(context, width, height) {
    const motion = page.motion();
    const found = motion?.class(store.state.bar);
    if (!found) return;
    for (const [start, stop] of motion.parts) {
      for (let row = Math.ceil(start / capture.step); row * capture.step < stop; row++) {
        const turns = found.turns.values[row];
        const phase = turns - Math.floor(turns);
        context.fillStyle = colours[Math.floor(phase * colours.length) % colours.length];
        const at = x((row * capture.step) / capture.fps, width);
        context.fillRect(at - 1.25, y(phase, height) - 1.25, 2.5, 2.5);
      }
    }
  }

  function drawAxis(context, width, height) {
    const wanted = capture.seconds / Math.max(width / 80, 2);
    const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600].find((s) => s >= wanted) ?? 1800;
    context.font = font(11);
    context.textAlign = "center";
    context.strokeStyle = ink("line");
    context.strokeRect(LEFT, top, width - LEFT - RIGHT, height - top - 24);
    context.fillStyle = ink("muted");
    for (let seconds = 0; seconds <= capture.seconds; seconds += step) {
      const at = x(seconds, width);
      context.fillRect(at, height - 24, 1, 4);
      context.fillText(step < 1 ? seconds.toFixed(1) : seconds, Math.max(at, 14), height - 7);
    }
    context.textAlign = "left";
  }

  function drawGround(context, width, height) {
    drawAxis(context, width, height);
    drawParts(context, width, height);
    drawSegments(context, width);
    drawCoordinate(context, width, height);
  }

  function drawCursor(context, width, height) {
    const at = x(store.state.time, width);
    context.fillStyle = ink("ink");
    context.fillRect(at - 0.75, 2, 1.5, height - 22);
    context.beginPath();
    context.arc(at, 5, 4, 0, 7);
    context.fill();
  }

  function scrub(event) {
    const box = canvas.getBoundingClientRect();
    const part = (event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
    store.change({ time: Math.min(Math.max(part, 0), 1) * capture.seconds });
  }

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    scrub(event);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (canvas.hasPointerCapture(event.pointerId)) scrub(event);
  });
  return layered(canvas, drawGround, drawCursor);
}
