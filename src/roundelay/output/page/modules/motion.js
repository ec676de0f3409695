// The capture and what was found in it, asked by frame or by time.

import { Loop, Track, standing } from "./track.js";

export class Capture {
  constructor({ frames, fps, step, joints, bones, feet, points }) {
    Object.assign(this, { frames, fps, step, joints, bones, feet });
    this.track = new Track(points);
    this.seconds = (frames - 1) / fps;
  }

  place(seconds) {
    return (seconds * this.fps) / this.step;
  }

  at(seconds) {
    return this.track.at(this.place(seconds));
  }

  // The joints of the feet that stand.
  standing(seconds) {
    return standing(this.feet, seconds * this.fps);
  }
}

export class Motion {
  constructor(record, capture) {
    Object.assign(this, record);
    this.capture = capture;
    this.classes = (record.classes ?? []).map((found) => ({ ...found, turns: new Track(found.turns) }));
    this.loop = record.loop ? this.#placed(new Loop(record.loop)) : null;
  }

  // Let the loop begin with the first periodic part, where the capture is.
  #placed(loop) {
    this.start = this.parts[0][0] / this.capture.fps;
    this.startPhase = this.#within(loop.phase, this.start);
    loop.placeOn(this.capture.at(this.start), this.startPhase, this.capture.joints);
    return loop;
  }

  // The half-open range of frames around this time in which the motion goes on, or undefined.
  part(seconds) {
    const frame = seconds * this.capture.fps;
    return this.parts.find(([start, stop]) => start <= frame && frame <= stop - 1);
  }

  class(bar) {
    return this.classes.find((found) => found.bar === bar);
  }

  // The coordinate of a class at a time, in turns; null outside the periodic parts.
  turns(bar, seconds) {
    const found = this.class(bar);
    if (!found || !this.part(seconds)) return null;
    return this.#within(found.turns, seconds);
  }

  // The phase of the loop left to itself, at its steady tempo.
  steadyPhase(seconds) {
    return this.startPhase + (seconds - this.start) / this.period;
  }

  // The loop's phase that shows the same pose; outside the parts it just runs on.
  loopPhase(seconds) {
    if (!this.part(seconds)) return this.steadyPhase(seconds);
    return this.#within(this.loop.phase, seconds);
  }

  // Samples outside the part say nothing: stay between those inside.
  #within(track, seconds) {
    const [start, stop] = this.part(seconds);
    const { step } = this.capture;
    const [first, last] = [Math.ceil(start / step), Math.floor((stop - 1) / step)];
    return track.at(Math.min(Math.max(this.capture.place(seconds), first), last))[0];
  }
}
