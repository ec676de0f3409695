// The cards beside the player: the choice of motion, its facts, its quality, its file.

import { byId, element } from "./elements.js";

export function fillMotions(page, store) {
  byId("motions-card").hidden = page.motions.length < 2;
  if (page.motions.length < 2) return;
  byId("motions").replaceChildren(...page.motions.map((motion, number) => {
    const input = element("input", { type: "radio", name: "motion", value: number });
    input.checked = number === store.state.motion;
    input.addEventListener("change", () => store.change({ motion: number }));
    return element("label", {}, input, element("span", {}, `${number + 1} · ${motion.period.toFixed(2)} s`));
  }));
}

export function fillPanel(page) {
  const motion = page.motion();
  document.body.classList.toggle("no-loop", !motion?.loop);
  byId("facts-card").hidden = !motion?.classes?.length;
  byId("bars-card").hidden = !motion?.bars?.length;
  byId("plane-card").hidden = !motion?.plane;
  byId("quality-card").hidden = !motion?.quality;
  if (!motion) return;
  byId("facts").replaceChildren(...facts(motion).flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
  if (motion.plane) {
    const share = Math.round(100 * (motion.plane.shares[0] + motion.plane.shares[1]));
    byId("plane-note").textContent = `two principal components, ${share} %`;
  }
  if (motion.quality) fillQuality(motion);
}

function facts(motion) {
  const lead = ["Bar to next", motion.lead > 99 ? "over 99 to 1" : `${motion.lead.toFixed(1)} to 1`];
  const listed = motion.parts.map(([start, stop]) => `${start}–${stop}`).join(", ");
  if (!motion.loop) return [["Candidate", `frames ${listed}`], lead];
  const rows = [
    ["Verdict", motion.verdict],
    ["Period", `${motion.period.toFixed(2)} s`],
    ["Seen", `${motion.repetitions.toFixed(2)} times`],
    ["Certainty", certainty(motion)],
    ...(motion.limbs.length ? [["Limbs", motion.limbs.join(", ")]] : []),
    lead,
    ["Travel", `${motion.travel.toFixed(2)} sizes`],
  ];
  if (Math.abs(motion.turning) >= 1) rows.push(["Turning", `${motion.turning.toFixed(0)}°`]);
  return rows;
}

function certainty({ confidence }) {
  return confidence === null ? "one pass whose ends meet" : `${Math.round(100 * confidence)} %`;
}

function fillQuality(motion) {
  byId("quality").replaceChildren(...motion.quality.map(([what, value, other, note]) => {
    const beside = element("td", {}, other, element("small", {}, note));
    return element("tr", {}, element("th", { scope: "row" }, what), element("td", {}, value), beside);
  }));
  const link = byId("save");
  URL.revokeObjectURL(link.href);
  link.href = URL.createObjectURL(new Blob([bvhText(motion.bvh)], { type: "text/plain" }));
  link.download = motion.file;
}

function bvhText({ head, decimals, rows: { values, rows, columns } }) {
  const lines = [head];
  for (let row = 0; row < rows; row++) {
    const numbers = values.subarray(row * columns, (row + 1) * columns);
    lines.push(Array.from(numbers, (value) => value.toFixed(decimals)).join(" "));
  }
  return `${lines.join("\n")}\n`;
}

export function fillNotice(reason) {
  byId("notice").hidden = !reason;
  const said = reason.replace(/^no periodic motion found: /, "").split("; ");
  byId("reasons").replaceChildren(...said.map((part) => element("li", {}, part)));
}

export function fillHead({ name, version, capture, motions, segments, reason }) {
  const count = motions.length === 1 ? "1 periodic motion" : `${motions.length} periodic motions`;
  const rate = +capture.fps.toFixed(2);
  const said = `${capture.frames} frames at ${rate} fps, ${capture.seconds.toFixed(1)} s, ${capture.joints} joints`;
  byId("name").textContent = name;
  byId("summary").textContent = `${said}; ${reason ? "no periodic motion" : count}`;
  byId("length").textContent = `of ${capture.seconds.toFixed(2)} s`;
  byId("segments-legend").hidden = segments.length === 0;
  byId("footer").textContent = `Made by roundelay ${version}. Lengths are in body sizes: the skeleton's longest path along bones.`;
}

// Say who is on the stage.
export function fillCaption(views, { view }) {
  const names = views.map((group) => group.map((actor) => actor.label).join(" and ")).join(" | ");
  const missing = view === "overlay" && views[0].length === 1;
  const text = missing ? "Capture (no periodic part here)" : names;
  if (byId("caption").textContent !== text) byId("caption").textContent = text;
}
