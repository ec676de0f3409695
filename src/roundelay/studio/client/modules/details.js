// The panel of the part that is chosen: its verdict, what else it could be, how it is written.

import { byId, element } from "../page/elements.js";
import { verdictOf } from "./cards.js";
import { chosen, rendered, renamed } from "./edits.js";

const CHECKS = { in_place: false, mirror: false, foot_lock: true, repair: true };

export function createDetails(page, store, session) {
  let offered = { key: "", periods: [], classes: [] };
  const place = () => store.state.part;
  const part = () => session().work.parts[place()];
  const choose = (what) => session().change(chosen(session().work, place(), what));

  byId("name").addEventListener("change", (event) => session().change(renamed(session().work, place(), event.target.value)));
  byId("name").addEventListener("keydown", (event) => {
    if (event.key === "Escape") event.target.value = part().name;
    if (event.key === "Enter" || event.key === "Escape") event.target.blur();
  });
  const number = (text) => (text === "" ? null : Number(text));
  byId("period").addEventListener("change", ({ target }) => choose({ period: number(target.value) }));
  byId("limbs").addEventListener("change", ({ target }) => choose({ limbs: target.value || null }));
  byId("class").addEventListener("change", ({ target }) => choose({ class_index: number(target.value) }));
  byId("method").addEventListener("change", ({ target }) => choose({ method: target.value === "auto" ? null : target.value }));
  byId("start").addEventListener("change", ({ target }) => choose({ start: begun(target.value) }));
  byId("fps").addEventListener("change", ({ target }) => session().change(rendered(session().work, { fps: number(target.value) })));
  for (const [name, usual] of Object.entries(CHECKS)) {
    byId(name).addEventListener("change", ({ target }) => {
      session().change(rendered(session().work, { [name]: target.checked === usual ? null : target.checked }));
    });
  }

  function begun(value) {
    if (value === "0") return null;
    if (value === "here") return `frame:${Math.round(store.state.time * page.capture.fps)}`;
    return value === "right" ? value : Number(value);
  }

  function nextClass() {
    const classes = offered.classes.filter((one) => one.turns !== null);
    if (classes.length < 2) return;
    const now = classes.findIndex((one) => one.chosen);
    choose({ class_index: classes[(now + 1) % classes.length].index });
  }

  function fill() {
    const one = part();
    for (const id of ["part-card", "choices-card", "export-card"]) byId(id).hidden = !one;
    fillRender();
    if (!one) return;
    if (document.activeElement !== byId("name")) byId("name").value = one.name;
    fillVerdict(session().loop(place()));
    byId("method").value = one.method ?? "auto";
    fillStart(one.start ?? 0);
    select("limbs", [["", "automatic"], ...page.limbs.map((name) => [name, name === "body" ? "whole body" : name])], one.limbs ?? "");
    fillOffered(one);
  }

  function fillVerdict(known) {
    const [kind, word] = verdictOf(known);
    byId("verdict").replaceChildren(element("span", { className: `word ${kind}` }, word));
    const reasons = known?.fault ? [known.fault] : (known?.verdict?.reasons ?? []);
    byId("reasons").replaceChildren(...reasons.map((reason) => element("li", {}, reason)));
    byId("figures").replaceChildren(...(known?.verdict?.rows ?? []).map(([name, value, beside]) => {
      const cell = element("td", {}, value, ...(beside ? [element("small", {}, beside)] : []));
      return element("tr", {}, element("th", { scope: "row" }, name), cell);
    }));
  }

  function fillStart(start) {
    const known = [...byId("start").options].some((option) => option.value === String(start));
    const list = byId("start");
    list.querySelector("[data-own]")?.remove();
    if (!known) {
      const own = element("option", { value: String(start) }, String(start).replace("frame:", "frame "));
      own.dataset.own = "";
      list.append(own);
    }
    list.value = String(start);
  }

  function fillOffered(one) {
    const period = one.period ?? "";
    const periods = offered.periods.map(({ seconds, words }) => [String(seconds), `${seconds.toFixed(2)} s, ${words}`]);
    if (period !== "" && !periods.some(([value]) => value === String(period))) periods.push([String(period), `${period} s`]);
    select("period", [["", "automatic"], ...periods], String(period));
    const classes = offered.classes.map(({ index, turns, chosen: own }) => [
      String(index), `${index + 1}: ${turns === null ? "does not turn" : `turns ${turns.toFixed(1)}×`}${own ? ", in use" : ""}`,
    ]);
    const wanted = one.class_index ?? "";
    if (wanted !== "" && !classes.some(([value]) => value === String(wanted))) classes.push([String(wanted), `${wanted + 1}`]);
    select("class", [["", "automatic"], ...classes], String(wanted));
  }

  function select(id, options, value) {
    const list = byId(id);
    const told = JSON.stringify(options);
    if (list.dataset.told !== told) {
      list.dataset.told = told;
      list.replaceChildren(...options.map(([key, words]) => element("option", { value: key }, words)));
    }
    list.value = value;
  }

  function fillRender() {
    const { render } = session().work;
    byId("fps").value = render.fps ? String(render.fps) : "";
    for (const [name, usual] of Object.entries(CHECKS)) byId(name).checked = render[name] ?? usual;
  }

  return {
    fill,
    nextClass,
    offer(key, choices) {
      offered = { key, ...choices };
      fill();
    },
    offeredFor: () => offered.key,
  };
}
