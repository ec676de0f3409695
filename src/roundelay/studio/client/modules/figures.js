// Small moving figures, one a behaviour: its loop, in place, again and again.

import { fitted, ink } from "../page/canvas.js";
import { Camera } from "../page/camera.js";
import { drawGround, drawShadow, drawSkeleton } from "../page/skeleton.js";

export class Figure {
  constructor(canvas, bones, yaw) {
    Object.assign(this, { canvas, bones });
    this.camera = new Camera();
    this.camera.reset(yaw, 1.62);
  }

  show(motion) {
    this.motion = motion;
  }

  draw(seconds) {
    const { context, width, height } = fitted(this.canvas);
    if (!this.motion || width === 0) return;
    const phase = seconds / this.motion.period;
    const pose = this.motion.loop.inPlace(phase);
    this.camera.target = [pose[0], 0.44, pose[2]];
    const project = this.camera.projector(width, height);
    drawGround(context, project, this.camera.target, ink("grid"));
    drawShadow(context, project, pose, this.bones, ink("shadow"));
    const colours = (side) => ink(side < 0 ? "left" : side > 0 ? "right" : "bone");
    drawSkeleton(context, project, pose, this.bones, colours);
  }
}

// Draw all figures some twenty times a second; once where the reader wants no motion.
export function runFigures(figures) {
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  let before = -1000;
  function tick(now) {
    if (now - before > (still.matches ? 1000 : 45)) {
      before = now;
      for (const figure of figures()) figure.draw(still.matches ? 0 : now / 1000);
    }
    requestAnimationFrame(tick);
  }
  requestAnimationFrame(tick);
}
