// Values over time, between which the page goes smoothly.

export class Track {
  constructor({ values, rows, columns }) {
    this.values = values;
    this.rows = rows;
    this.columns = columns;
  }

  // The row at a fractional place, into a new or given array.
  at(place, into = new Float32Array(this.columns)) {
    const inside = Math.min(Math.max(place, 0), this.rows - 1);
    const first = Math.min(Math.floor(inside), Math.max(this.rows - 2, 0));
    const part = inside - first;
    const from = first * this.columns;
    const to = Math.min(first + 1, this.rows - 1) * this.columns;
    for (let column = 0; column < this.columns; column++) {
      const start = this.values[from + column];
      into[column] = start + part * (this.values[to + column] - start);
    }
    return into;
  }
}

// The joints of feet of which a span holds this moment.
export function standing(feet, moment) {
  const down = ({ spans }) => spans.some(([start, stop]) => start <= moment && moment < stop);
  return feet.filter(down).map(({ joint }) => joint);
}

// Turn and move points (x, y, z, x, ...) about the vertical, in place.
export function moveRigidly(points, angle, shift) {
  const cosine = Math.cos(angle);
  const sine = Math.sin(angle);
  for (let i = 0; i < points.length; i += 3) {
    const x = points[i];
    const z = points[i + 2];
    points[i] = cosine * x + sine * z + shift[0];
    points[i + 1] += shift[1];
    points[i + 2] = cosine * z - sine * x + shift[2];
  }
  return points;
}

// The loop as an endless motion: its one period, carried on by its travel and turning.
export class Loop {
  constructor({ points, turning, feet, phase }) {
    this.track = new Track(points);
    this.turning = turning;
    this.feet = feet;
    this.phase = new Track(phase);
    this.#measureStep();
  }

  #measureStep() {
    const { turning } = this;
    const first = this.track.at(0);
    const last = this.track.at(this.track.rows - 1);
    const turned = moveRigidly(first.slice(0, 3), turning, [0, 0, 0]);
    this.step = [0, 1, 2].map((axis) => last[axis] - turned[axis]);
  }

  // The pose at an unwrapped phase, where the travel has brought it.
  at(phase) {
    const whole = Math.floor(phase);
    const points = this.inPlace(phase);
    const shift = this.#reached(whole);
    return moveRigidly(points, this.turning * whole, shift);
  }

  // The pose at a phase in its first period.
  inPlace(phase) {
    const part = phase - Math.floor(phase);
    return this.track.at(part * (this.track.rows - 1));
  }

  // The joints of the feet that stand.
  standing(phase) {
    return standing(this.feet, phase - Math.floor(phase));
  }

  // Turn and move the loop so that at this phase it stands where this pose does.
  placeOn(pose, phase, joints) {
    const { angle, shift } = alignment(this.inPlace(phase), pose, joints);
    moveRigidly(this.track.values, angle, shift);
    this.#measureStep();
  }

  // What n applications of "turn, then step" move the origin by.
  #reached(n) {
    const [dx, dy, dz] = this.step;
    const half = this.turning / 2;
    const many = Math.abs(Math.sin(half)) < 1e-9 ? n : Math.sin(n * half) / Math.sin(half);
    const angle = (n - 1) * half;
    const cosine = Math.cos(angle) * many;
    const sine = Math.sin(angle) * many;
    return [cosine * dx + sine * dz, n * dy, cosine * dz - sine * dx];
  }
}

// The turn about the vertical and the level move that lay points on others best.
export function alignment(points, others, count) {
  const mean = (values, axis) => {
    let sum = 0;
    for (let i = 0; i < count; i++) sum += values[3 * i + axis];
    return sum / count;
  };
  const [ax, az, bx, bz] = [mean(points, 0), mean(points, 2), mean(others, 0), mean(others, 2)];
  let along = 0;
  let across = 0;
  for (let i = 0; i < 3 * count; i += 3) {
    const [px, pz, qx, qz] = [points[i] - ax, points[i + 2] - az, others[i] - bx, others[i + 2] - bz];
    along += px * qx + pz * qz;
    across += pz * qx - px * qz;
  }
  const angle = Math.atan2(across, along);
  const [x, , z] = moveRigidly([ax, 0, az], angle, [0, 0, 0]);
  return { angle, shift: [bx - x, 0, bz - z] };
}
