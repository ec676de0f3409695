// The stage: capture, loop, both side by side, or one over the other.

import { fitted, ink } from "./canvas.js";
import { drawContacts, drawGround, drawShadow, drawSkeleton } from "./skeleton.js";
import { createActors } from "./actors.js";

const GHOSTS = [-4, 4, -3, 3, -2, 2, -1, 1];

export function createStage(canvas, camera, page) {
  const { capture, colours } = page;
  const { middle, reach } = boundsOf(capture.track);
  const actors = createActors(page);

  function phaseColour(turns) {
    return colours[Math.floor((turns - Math.floor(turns)) * colours.length) % colours.length];
  }

  function drawGhosts(context, project, actor, state) {
    const spacing = (page.motion()?.period ?? 1.5) / 12;
    for (const place of GHOSTS) {
      const time = state.time + place * spacing;
      if (actor.ends && (time < 0 || time > capture.seconds)) continue;
      const turns = actor.phase(time, state);
      if (actor.inStep && turns === null) continue;
      const colour = turns === null ? ink("pale") : phaseColour(turns);
      const look = { alpha: 0.6 - 0.11 * Math.abs(place), thin: 0.55 };
      drawSkeleton(context, project, actor.pose(time), capture.bones, () => colour, look);
    }
  }

  function draw(state) {
    const { context, width, height } = fitted(canvas);
    const views = actors(state);
    const share = width / views.length;
    views.forEach((group, number) => {
      const poses = group.map((actor) => actor.pose(state.time));
      const still = !state.follow && views.length === 1 && state.view !== "loop";
      const [x, , z] = still ? middle : poses[0];
      camera.target = [x, 0.45, z];
      camera.back = still ? 1.3 * reach : 0;
      context.save();
      context.beginPath();
      context.rect(number * share, 0, share, height);
      context.clip();
      const project = camera.projector(share, height, number * share);
      drawGround(context, project, camera.target, ink("grid"));
      drawShadow(context, project, poses[0], capture.bones, ink("shadow"));
      drawContacts(context, project, poses[0], group[0].feet(state.time), ink("accent"));
      if (state.onion) group.forEach((actor) => drawGhosts(context, project, actor, state));
      group.forEach((actor, i) => {
        const look = { thin: actor.thin ?? 1 };
        drawSkeleton(context, project, poses[i], capture.bones, actor.colours, look);
      });
      context.restore();
      if (number > 0) divide(context, number * share, height);
    });
    return views;
  }

  function divide(context, x, height) {
    context.fillStyle = ink("line");
    context.fillRect(Math.round(x), 0, 1, height);
  }

  return { draw };
}

// The middle of the root's path, and how far it reaches from there.
function boundsOf({ values, columns }) {
  const low = [Infinity, 0, Infinity];
  const high = [-Infinity, 0, -Infinity];
  for (let i = 0; i < values.length; i += columns) {
    for (const axis of [0, 2]) {
      low[axis] = Math.min(low[axis], values[i + axis]);
      high[axis] = Math.max(high[axis], values[i + axis]);
    }
  }
  const middle = low.map((value, axis) => (value + high[axis]) / 2);
  return { middle, reach: Math.hypot(high[0] - low[0], high[2] - low[2]) / 2 };
}

// A first view: across the way the body travels, and near enough to see it whole.
export function homeYaw({ values, rows, columns }) {
  let [xx, xz, zz] = [0, 0, 0];
  const [x0, z0] = [values[0], values[2]];
  for (let row = 0; row < rows; row++) {
    const [x, z] = [values[row * columns] - x0, values[row * columns + 2] - z0];
    [xx, xz, zz] = [xx + x * x, xz + x * z, zz + z * z];
  }
  const travelled = Math.sqrt((xx + zz) / rows);
  return travelled < 0.3 ? 0.5 : -0.5 * Math.atan2(2 * xz, xx - zz) + 0.35;
}
