// Changes of the work: each takes a work and returns another, or the same where nothing changes.

// Fewest frames of a part.
const FEWEST = 8;

const byHand = (part, spans) => {
  const { motion, ...rest } = part;
  return { ...rest, spans };
};
const withParts = (work, parts) => ({ ...work, parts });
const withPart = (work, place, part) => withParts(work, work.parts.map((old, i) => (i === place ? part : old)));

// Let a part start, or end, at another frame, as far as its neighbours in the part allow.
export function moved(work, place, number, edge, frame) {
  const { spans } = work.parts[place];
  const [start, stop] = spans[number];
  const low = edge === 0 ? (spans[number - 1]?.[1] ?? 0) : start + FEWEST;
  const high = edge === 0 ? stop - FEWEST : (spans[number + 1]?.[0] ?? work.capture.frames);
  const to = Math.min(Math.max(Math.round(frame), low), high);
  if (to === spans[number][edge] || low > high) return work;
  const span = edge === 0 ? [to, stop] : [start, to];
  return withPart(work, place, byHand(work.parts[place], spans.map((old, i) => (i === number ? span : old))));
}

// Rename a part; a name that another part has makes both one.
export function renamed(work, place, name) {
  const wanted = name.trim();
  if (!wanted || wanted === work.parts[place].name) return work;
  const other = work.parts.findIndex((part, i) => i !== place && part.name === wanted);
  if (other < 0) return withPart(work, place, { ...work.parts[place], name: wanted });
  const one = byHand(work.parts[other], united([...work.parts[other].spans, ...work.parts[place].spans]));
  return withParts(withPart(work, other, one), withPart(work, other, one).parts.filter((_, i) => i !== place));
}

export function split(work, place, frame) {
  const part = work.parts[place];
  const at = Math.round(frame);
  const number = part.spans.findIndex(([start, stop]) => start + FEWEST <= at && at <= stop - FEWEST);
  if (number < 0) return work;
  const [start, stop] = part.spans[number];
  const first = byHand(part, [...part.spans.slice(0, number), [start, at]]);
  const second = { ...byHand(part, [[at, stop], ...part.spans.slice(number + 1)]), name: freeName(work, part.name) };
  return withParts(work, [...work.parts.slice(0, place), first, second, ...work.parts.slice(place + 1)]);
}

// Merge the part's last range with what comes next in time, whosever that is.
export function merged(work, place, number) {
  const mine = work.parts[place].spans[number];
  let next = null;
  work.parts.forEach((part, p) => part.spans.forEach((span, n) => {
    const after = span[0] >= mine[1] && (p !== place || n !== number);
    if (after && (!next || span[0] < next.span[0])) next = { p, n, span };
  }));
  if (!next) return work;
  const others = work.parts.map((part, p) => {
    if (p === place) {
      const kept = part.spans.filter((_, n) => n !== number && !(next.p === place && n === next.n));
      return byHand(part, united([...kept, [mine[0], next.span[1]]]));
    }
    return p === next.p ? byHand(part, part.spans.filter((_, n) => n !== next.n)) : part;
  });
  return withParts(work, others.filter((part) => part.spans.length > 0));
}

export function added(work, start, stop) {
  const inside = [Math.max(0, Math.round(start)), Math.min(work.capture.frames, Math.round(stop))];
  if (inside[1] - inside[0] < FEWEST) return work;
  return withParts(work, [...work.parts, { name: freeName(work, "New part"), spans: [inside] }]);
}

export function removed(work, place) {
  return withParts(work, work.parts.filter((_, i) => i !== place));
}

// Choose a period, limbs, a class, ...; what is null is chosen by itself again.
export function chosen(work, place, what) {
  const part = { ...work.parts[place], ...what };
  for (const key of Object.keys(what)) if (what[key] === null) delete part[key];
  return withPart(work, place, part);
}

export function rendered(work, what) {
  const render = { ...work.render, ...what };
  for (const key of Object.keys(what)) if (what[key] === null) delete render[key];
  return { ...work, render };
}

function united(spans) {
  const sorted = spans.map((span) => [...span]).sort(([a], [b]) => a - b);
  return sorted.reduce((kept, span) => {
    const last = kept.at(-1);
    if (last && span[0] <= last[1]) last[1] = Math.max(last[1], span[1]);
    else kept.push(span);
    return kept;
  }, []);
}

function freeName(work, name) {
  const stem = name.replace(/ \d+$/, "");
  for (let number = 2; ; number++) {
    const tried = `${stem} ${number}`;
    if (!work.parts.some((part) => part.name === tried)) return tried;
  }
}
