// One take that is open: its work with what came before it, its loops, what is computed.

import { ask, follow } from "./api.js";

// What decides a loop: everything but the name.
export function keyOf(work, place) {
  const { name, ...rest } = work.parts[place];
  return JSON.stringify([Object.entries(rest).sort(), Object.entries(work.render).sort()]);
}

export class Session {
  #history = [];
  #place = -1;
  #saving = Promise.resolve();
  #stop = null;
  loops = new Map();
  words = { command: "", python: "" };

  constructor({ name, revision }, listeners) {
    Object.assign(this, { name, revision, listeners });
  }

  get work() {
    return this.#history[this.#place];
  }

  get path() {
    return `api/takes/${encodeURIComponent(this.name)}`;
  }

  begin(work) {
    this.#history = [work];
    this.#place = 0;
  }

  loop(place) {
    return this.work.parts[place] ? this.loops.get(keyOf(this.work, place)) : undefined;
  }

  canUndo() {
    return this.#place > 0;
  }

  canRedo() {
    return this.#place < this.#history.length - 1;
  }

  change(work) {
    if (work === this.work) return;
    this.#history = [...this.#history.slice(0, this.#place + 1), work];
    this.#go(this.#place + 1);
  }

  undo() {
    if (this.canUndo()) this.#go(this.#place - 1);
  }

  redo() {
    if (this.canRedo()) this.#go(this.#place + 1);
  }

  #go(place) {
    this.#place = place;
    this.listeners.changed();
    this.save();
    this.remake();
  }

  // Keep the work; one after the other, so that no older one comes last.
  save() {
    const { work } = this;
    this.#saving = this.#saving.then(async () => {
      try {
        const { revision } = await ask(`${this.path}/work`, "PUT", { work, revision: this.revision });
        this.revision = revision;
      } catch (error) {
        this.listeners.failed(error);
      }
    });
    return this.#saving;
  }

  // Hear of an event about loops; the work is the one that was asked about.
  heard(event, work, record) {
    const key = keyOf(work, event.place);
    const known = this.loops.get(key) ?? {};
    if (event.loop) known.record = record;
    if (event.verdict) known.verdict = event.verdict;
    if (event.fault) known.fault = event.fault;
    this.loops.set(key, known);
  }

  // Make the loops that are not there yet.
  async remake() {
    this.stop();
    const { work } = this;
    const wanted = (place) => {
      const known = this.loop(place);
      return !known || (!known.fault && !known.verdict);
    };
    const places = work.parts.map((_, place) => place).filter(wanted);
    const stop = new AbortController();
    this.#stop = stop;
    try {
      const answer = (event) => this.listeners.heard(event, work);
      await follow(`${this.path}/loops`, { work, places }, answer, stop.signal);
    } catch (error) {
      if (error.name !== "AbortError") this.listeners.failed(error);
    }
    if (this.#stop === stop) {
      this.#stop = null;
      this.listeners.idle();
    }
  }

  stop() {
    this.#stop?.abort();
    this.#stop = null;
  }
}
