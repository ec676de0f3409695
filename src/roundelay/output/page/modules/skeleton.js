// Drawing: the ground with its grid, shadows, and skeletons as limbs of round ends.

const CELL = 0.5;
const REACH = 6;

export function drawGround(context, project, centre, colour) {
  const [cx, cz] = [Math.round(centre[0] / CELL), Math.round(centre[2] / CELL)];
  context.strokeStyle = colour;
  context.lineWidth = 1;
  const bands = [[], [], []];
  for (let i = -REACH; i <= REACH; i++) {
    for (let j = -REACH; j < REACH; j++) {
      for (const across of [true, false]) {
        const from = across ? [cx + j, cz + i] : [cx + i, cz + j];
        const to = across ? [cx + j + 1, cz + i] : [cx + i, cz + j + 1];
        const away = Math.hypot((from[0] + to[0]) / 2 - cx, (from[1] + to[1]) / 2 - cz) / REACH;
        if (away < 1) bands[Math.floor(away * 3)].push([from, to]);
      }
    }
  }
  bands.forEach((lines, band) => {
    context.globalAlpha = 0.95 - 0.35 * band;
    context.beginPath();
    for (const [from, to] of lines) {
      const a = project(from[0] * CELL, 0, from[1] * CELL);
      const b = project(to[0] * CELL, 0, to[1] * CELL);
      if (!a || !b) continue;
      context.moveTo(a[0], a[1]);
      context.lineTo(b[0], b[1]);
    }
    context.stroke();
  });
  context.globalAlpha = 1;
}

export function drawShadow(context, project, points, bones, colour) {
  context.strokeStyle = colour;
  context.lineCap = "round";
  context.beginPath();
  let width = 4;
  for (const [from, to] of bones) {
    const a = project(points[3 * from], 0, points[3 * from + 2]);
    const b = project(points[3 * to], 0, points[3 * to + 2]);
    if (!a || !b) continue;
    width = a[2] * 0.022;
    context.moveTo(a[0], a[1]);
    context.lineTo(b[0], b[1]);
  }
  context.lineWidth = width;
  context.stroke();
}

// A ring on the ground under each of these joints.
export function drawContacts(context, project, points, joints, colour) {
  context.strokeStyle = colour;
  context.lineWidth = 2.5;
  for (const joint of joints) {
    context.beginPath();
    for (let step = 0; step <= 20; step++) {
      const angle = (Math.PI * step) / 10;
      const [x, z] = [Math.cos(angle), Math.sin(angle)].map((value) => 0.05 * value);
      const place = project(points[3 * joint] + x, 0, points[3 * joint + 2] + z);
      if (place) context.lineTo(place[0], place[1]);
    }
    context.stroke();
  }
}

// Colours: a function from a bone's side (-1, 0, 1) to a colour.
export function drawSkeleton(context, project, points, bones, colours, { alpha = 1, thin = 1 } = {}) {
  const limbs = [];
  for (const [from, to, side, head] of bones) {
    const a = project(points[3 * from], points[3 * from + 1], points[3 * from + 2]);
    const b = project(points[3 * to], points[3 * to + 1], points[3 * to + 2]);
    if (a && b) limbs.push({ a, b, side, head });
  }
  limbs.sort((one, other) => one.a[2] + one.b[2] - other.a[2] - other.b[2]);
  context.globalAlpha = alpha;
  context.lineCap = "round";
  for (const { a, b, side, head } of limbs) {
    context.strokeStyle = colours(side);
    context.lineWidth = Math.max(0.011 * (a[2] + b[2]) * thin, 1);
    context.beginPath();
    context.moveTo(a[0], a[1]);
    context.lineTo(b[0], b[1]);
    context.stroke();
    if (!head) continue;
    context.fillStyle = colours(side);
    context.beginPath();
    context.arc((a[0] + b[0]) / 2, (a[1] + b[1]) / 2, 0.037 * a[2] * (0.6 + 0.4 * thin), 0, 7);
    context.fill();
  }
  context.globalAlpha = 1;
}
