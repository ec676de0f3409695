// Who is on the stage: what shows the pose at a time, which feet stand, in what colours.

import { ink } from "./canvas.js";
import { alignment, moveRigidly } from "./track.js";

// A function from the state to groups of actors, one group for each part of the stage.
export function createActors(page) {
  const { capture } = page;

  function coordinate(time, state) {
    return page.motion()?.turns(state.bar, time) ?? null;
  }

  const real = {
    label: "Capture",
    ends: true,
    pose: (time) => capture.at(time),
    feet: (time) => capture.standing(time),
    phase: coordinate,
    colours: sided,
  };

  // The loop left to itself.
  function free(motion) {
    return {
      label: "Loop",
      pose: (time) => motion.loop.at(motion.steadyPhase(time)),
      feet: (time) => motion.loop.standing(motion.steadyPhase(time)),
      phase: (time) => motion.steadyPhase(time),
      colours: sided,
    };
  }

  // The loop at the capture's phase, turned and moved to where the capture is.
  function inStep(motion) {
    return {
      label: "Loop",
      inStep: true,
      pose: (time) => laidOnCapture(motion, time),
      feet: (time) => motion.loop.standing(motion.loopPhase(time)),
      phase: coordinate,
      colours: sided,
    };
  }

  function laidOnCapture(motion, time) {
    const pose = motion.loop.inPlace(motion.loopPhase(time));
    const { angle, shift } = alignment(pose, capture.at(time), capture.joints);
    return moveRigidly(pose, angle, shift);
  }

  return ({ view, time }) => {
    const motion = page.motion();
    if (!motion?.loop || view === "capture") return [[real]];
    if (view === "loop") return [[free(motion)]];
    if (view === "beside") return [[real], [inStep(motion)]];
    const plain = { ...real, colours: () => ink("bone") };
    if (!motion.part(time)) return [[plain]];
    return [[plain, { ...inStep(motion), colours: () => ink("accent"), thin: 0.55 }]];
  };
}

function sided(side) {
  return ink(side < 0 ? "left" : side > 0 ? "right" : "bone");
}
