// The studio: a take is dropped, its loops appear, a person mends them.

import { unpack } from "../page/unpack.js";
import { createStore } from "../page/store.js";
import { Capture, Motion } from "../page/motion.js";
import { Camera } from "../page/camera.js";
import { createStage, homeYaw } from "../page/stage.js";
import { listenToGestures } from "../page/gestures.js";
import { createTheme } from "../page/theme.js";
import { runClock } from "../page/clock.js";
import { listenTo } from "../page/keyboard.js";
import { byId, element } from "../page/elements.js";
import { ask, follow, sendFile } from "./api.js";
import { createCards } from "./cards.js";
import { createDetails } from "./details.js";
import { added, merged, moved, removed, split } from "./edits.js";
import { createLanes } from "./lanes.js";
import { runFigures } from "./figures.js";
import { Session, keyOf } from "./session.js";
import { createBar, tell } from "./telling.js";
import { listenToFiles } from "./files.js";

const PLAY = "M4 2.5v11l9-5.5z";
const PAUSE = "M3.5 2.5h3v11h-3zM9.5 2.5h3v11h-3z";
let desk = null;
let largest = Infinity;
let opening = null;
const bar = createBar();
const theme = createTheme(() => desk?.redraw());

async function listTakes() {
  const told = await ask("api/takes");
  largest = told.largest;
  byId("largest").textContent = told.largest;
  byId("folder").textContent = told.folder;
  byId("takes-card").hidden = told.takes.length === 0;
  byId("takes").replaceChildren(...told.takes.map(({ name, bytes, work }) => {
    const size = `${(bytes / 1e6).toFixed(1)} MB${work ? ", with work" : ""}`;
    const button = element("button", { type: "button" }, name, element("span", { className: "muted" }, size));
    button.addEventListener("click", () => open(name));
    return element("li", {}, button);
  }));
}

// Take files in; open the first that is a take.
async function take(files) {
  const large = files.find((file) => file.size > largest * 1e6);
  if (large) {
    tell(`${large.name}: expected a file of at most ${largest} MB, found ${(large.size / 1e6).toFixed(0)} MB; allow more by roundelay studio --largest, or cut it`);
    return;
  }
  const stop = begin();
  try {
    for (const file of files) {
      await sendFile(file, (share) => bar.show(0.1 * share, `taking in ${file.name}`), stop.signal);
    }
    const main = files.find(({ name }) => !/\.(asf|bin|json)$/i.test(name)) ?? files[0];
    await opened(main.name, stop);
  } catch (error) {
    failed(error);
  } finally {
    end(stop);
  }
}

async function open(name) {
  const stop = begin();
  try {
    await opened(name, stop);
  } catch (error) {
    failed(error);
  } finally {
    end(stop);
  }
}

function begin() {
  opening?.abort();
  desk?.session.stop();
  opening = new AbortController();
  tell("");
  bar.show(0, "");
  return opening;
}

function end(stop) {
  if (opening !== stop) return;
  opening = null;
  bar.hide();
  desk?.offerChoices();
  listTakes().catch(failed);
}

function failed(error) {
  if (error.name === "AbortError") return;
  tell(error.message);
  bar.hide();
}

async function opened(name, stop) {
  let first = null;
  await follow(`api/takes/${encodeURIComponent(name)}/open`, {}, async (event) => {
    if (event.revision !== undefined) first = event;
    if (event.progress !== undefined) bar.show(0.1 + 0.9 * event.progress, event.stage);
    if (event.take) desk = createDesk(first, await unpack(event.take));
    if (event.work) desk.begin(event);
    else await desk?.heard(event, desk.session.work);
  }, stop.signal);
}

// All that shows one take.
function createDesk(first, data) {
  desk?.close();
  const capture = new Capture(data.capture);
  const store = createStore({
    time: 0, playing: true, speed: 1, view: "capture", onion: false, follow: true, whole: false, part: 0, span: 0, bar: -1,
  });
  const { state } = store;
  const page = { ...data, capture, motions: [], limbs: [], motion: () => page.motions[state.part] };
  const session = new Session(first, { changed, heard, failed, idle: () => { bar.hide(); offerChoices(); } });
  let begun = false;
  let closed = false;
  const camera = new Camera();
  camera.reset(homeYaw(capture.track));
  const current = () => session;
  const fresh = freshElements();
  const stage = createStage(fresh.stage, camera, page);
  const cards = createCards(byId("cards"), page, store, current);
  const details = createDetails(page, store, current);
  const lanes = createLanes(fresh, page, store, current);
  const redraw = runClock(store, bounds, () => !closed && showStage(), () => !closed && lanes.showTime(state.time));
  listenToGestures(fresh.stage, camera, redraw);

  function showStage() {
    const shown = stage.draw(state);
    const text = shown.map((group) => group.map(({ label }) => (label === "Capture" ? "Take" : label)).join(" and ")).join(" | ");
    if (byId("caption").textContent !== text) byId("caption").textContent = text;
    byId("now").textContent = `${state.time.toFixed(2)} s`;
    byId("frame").textContent = `frame ${Math.round(state.time * capture.fps)}`;
  }

  // What is played again and again: the range of the part that is chosen.
  function bounds() {
    const span = begun && !state.whole && spanNow();
    if (!span) return [0, capture.seconds];
    return [span[0] / capture.fps, (span[1] - 1) / capture.fps];
  }

  function spanNow() {
    const spans = session.work.parts[state.part]?.spans;
    return spans && (spans[state.span] ?? spans[0]);
  }

  function begin({ work, limbs, reason, words }) {
    begun = true;
    page.limbs = limbs;
    session.words = words;
    session.begin(work);
    byId("reason").hidden = work.parts.length > 0;
    byId("reason").textContent = `Nothing that repeats was found: ${reason}. Make a part by hand with N.`;
    store.change({ view: work.parts.length ? "beside" : "capture" });
    select(0);
    changed();
  }

  function select(part, span = 0) {
    const count = session.work.parts.length;
    if (count === 0) return;
    store.change({ part: (part + count) % count, span, whole: false });
    const [start, stop] = bounds();
    if (state.time < start || state.time > stop) store.change({ time: start });
  }

  async function heard(event, work) {
    if (event.progress !== undefined && !opening) bar.show(event.progress, event.stage);
    if (event.words) session.words = event.words;
    if (event.place === undefined) return;
    const record = event.loop && (await unpack(event.loop));
    session.heard(event, work, record && new Motion(record, capture));
    if (record) document.body.dataset.remade = event.place;
    changed();
  }

  // The work, or what is known of its loops, is another one.
  function changed() {
    const { parts } = session.work;
    if (state.part >= parts.length) store.change({ part: Math.max(0, parts.length - 1), span: 0 });
    // The loop before plays on until the new one is there.
    const before = page.motions.length === parts.length ? page.motions : [];
    page.motions = parts.map((_, place) => session.loop(place)?.record ?? before[place]);
    store.change({ bar: page.motion()?.chosen ?? -1 });
    byId("undo").disabled = !session.canUndo();
    byId("redo").disabled = !session.canRedo();
    linkWork();
    cards.fill();
    lanes.fill();
    details.fill();
    redraw();
  }

  function linkWork() {
    const link = byId("work-link");
    URL.revokeObjectURL(link.href);
    link.href = URL.createObjectURL(new Blob([JSON.stringify(session.work, null, 1)], { type: "application/json" }));
    link.download = `${session.name.replace(/\.[^.]*(\.gz)?$/, "")}.work.json`;
  }

  async function offerChoices() {
    const { work } = session;
    const place = state.part;
    const key = work?.parts[place] && keyOf(work, place);
    if (!key || opening || details.offeredFor() === key || !session.loop(place)?.verdict) return;
    try {
      await follow(`${session.path}/choices`, { work, place }, ({ choices }) => {
        if (choices && work === session.work) details.offer(key, choices);
      });
    } catch (error) {
      failed(error);
    }
  }

  store.onChange((change) => {
    if (closed) return;
    if (change.has("part") && begun) {
      store.change({ bar: page.motion()?.chosen ?? -1 });
      cards.fill();
      details.fill();
      lanes.fill();
      offerChoices();
    }
    if (change.has("span") && begun) lanes.fill();
    showControls(state);
    redraw();
  });
  byId("welcome").hidden = true;
  byId("desk").hidden = false;
  byId("summary").textContent = `${data.name}: ${capture.frames} frames at ${+capture.fps.toFixed(2)} fps, ${capture.seconds.toFixed(1)} s, ${capture.joints} joints`;
  document.title = `${data.name} · roundelay studio`;
  showControls(state);
  lanes.fillRuler();
  const watched = new ResizeObserver(() => { lanes.fillRuler(); redraw(); });
  watched.observe(document.body);
  return {
    page, session, store, begin, heard, select, redraw, offerChoices, details, bounds, cards,
    frame: () => Math.round(state.time * capture.fps),
    // The range of the part that is chosen nearest to the time shown.
    range() {
      const spans = session.work.parts[state.part]?.spans ?? [];
      const away = ([start, stop]) => Math.max(start - state.time * capture.fps, state.time * capture.fps - stop, 0);
      return spans.indexOf([...spans].sort((a, b) => away(a) - away(b))[0]);
    },
    close() {
      closed = true;
      state.playing = false;
      session.stop();
      watched.disconnect();
    },
  };
}

// Elements without the listeners of the take before.
function freshElements() {
  const made = ["stage", "ruler", "lanes", "name", "period", "limbs", "class", "method", "start", "fps", "in_place", "mirror", "foot_lock", "repair"].map((id) => {
    const old = byId(id);
    const copy = old.cloneNode(true);
    old.replaceWith(copy);
    return [id, copy];
  });
  return { ...Object.fromEntries(made), cursor: byId("cursor") };
}

function showControls(state) {
  byId("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
  byId("play-icon").setAttribute("d", state.playing ? PAUSE : PLAY);
  byId("onion").checked = state.onion;
  byId("whole").checked = state.whole;
  byId("speed").value = String(state.speed);
  for (const choice of byId("views").querySelectorAll("input")) choice.checked = choice.value === state.view;
}

const edit = (change) => desk?.session.work && desk.session.change(change(desk.session.work, desk.store.state.part));
const set = (what) => desk?.store.change(what);
const toggle = (what) => desk && set({ [what]: !desk.store.state[what] });
const actions = {
  upload: () => byId("files").click(),
  playOrPause: () => toggle("playing"),
  step(way, far) {
    if (!desk) return;
    const { capture } = desk.page;
    const time = desk.store.state.time + way * (far ? 1 : 1 / capture.fps);
    set({ playing: false, time: Math.min(Math.max(time, 0), capture.seconds) });
  },
  part: (way) => desk?.select(desk.store.state.part + way),
  startHere: () => edit((work, place) => moved(work, place, desk.range(), 0, desk.frame())),
  endHere: () => edit((work, place) => moved(work, place, desk.range(), 1, desk.frame())),
  split: () => edit((work, place) => split(work, place, desk.frame())),
  merge: () => edit((work, place) => merged(work, place, desk.range())),
  remove: () => edit((work, place) => (work.parts[place] ? removed(work, place) : work)),
  add() {
    if (!desk?.session.work) return;
    const { fps } = desk.page.capture;
    edit((work) => added(work, desk.frame(), desk.frame() + 4 * fps));
    desk.select(desk.session.work.parts.length - 1);
  },
  rename() {
    byId("name").focus();
    byId("name").select();
  },
  undo: () => desk?.session.undo(),
  redo: () => desk?.session.redo(),
  // Half a second before and after the first frame, slowly.
  join() {
    const motion = desk?.page.motion();
    if (!motion) return;
    const phase = Math.ceil(motion.steadyPhase(desk.bounds()[0]) + 0.25);
    const time = motion.start + (phase - motion.startPhase) * motion.period - 0.3;
    set({ view: "loop", speed: 0.25, playing: true, whole: true, time: Math.max(0, time) });
  },
  list() {
    byId("desk").hidden = true;
    byId("welcome").hidden = false;
    byId("takes").querySelector("button")?.focus();
  },
  exports: () => document.querySelector("#export-card .button").focus(),
  help: () => byId("help").showModal(),
  stop() {
    opening?.abort();
    desk?.session.stop();
    bar.hide();
  },
};

async function exported(target) {
  if (!desk?.session.work) return;
  const { session } = desk;
  const stop = begin();
  let link = null;
  try {
    await session.save();
    await follow(`${session.path}/export`, { work: session.work, target }, (event) => {
      if (event.link) link = event;
      if (event.progress !== undefined) bar.show(event.progress, event.stage);
      if (event.exported) {
        element("a", { href: link.link, download: link.file }).click();
        tell(`${link.file} holds ${event.exported.filter((name) => !/README|json$/.test(name)).join(", ")}`, true);
      }
    }, stop.signal);
  } catch (error) {
    failed(error);
  } finally {
    end(stop);
  }
}

async function copy(which) {
  if (!desk) return;
  const text = desk.session.words[which];
  byId("words").hidden = false;
  byId("words").textContent = text;
  try {
    await navigator.clipboard.writeText(text);
    tell("Copied.", true);
  } catch {
    getSelection().selectAllChildren(byId("words"));
    tell("The browser does not let the studio copy: the text is selected below, press Ctrl C.", true);
  }
}

const clicks = {
  open: actions.upload, choose: actions.upload, undo: actions.undo, redo: actions.redo, play: actions.playOrPause,
  "help-button": actions.help, "start-here": actions.startHere, "end-here": actions.endHere, split: actions.split,
  merge: actions.merge, add: actions.add, remove: actions.remove, stop: actions.stop, "join-slowly": actions.join,
  "copy-command": () => copy("command"), "copy-python": () => copy("python"),
};
for (const [id, action] of Object.entries(clicks)) byId(id).addEventListener("click", action);
for (const button of document.querySelectorAll("[data-target]")) {
  button.addEventListener("click", () => exported(button.dataset.target));
}
byId("views").addEventListener("change", ({ target }) => set({ view: target.value }));
byId("onion").addEventListener("change", () => toggle("onion"));
byId("whole").addEventListener("change", () => toggle("whole"));
byId("speed").addEventListener("change", ({ target }) => set({ speed: Number(target.value) }));
listenToFiles(byId("files"), take);
listenTo({
  " ": actions.playOrPause, u: actions.upload, l: actions.list, e: actions.exports, r: actions.rename,
  ArrowLeft: ({ shiftKey }) => actions.step(-1, shiftKey), ArrowRight: ({ shiftKey }) => actions.step(1, shiftKey),
  ArrowUp: () => actions.part(-1), ArrowDown: () => actions.part(1),
  i: actions.startHere, o: actions.endHere, s: actions.split, m: actions.merge, n: actions.add, Delete: actions.remove,
  c: () => desk?.details.nextClass(), j: actions.join, g: () => toggle("onion"), w: () => toggle("whole"), t: theme,
  1: () => set({ view: "capture" }), 2: () => set({ view: "loop" }), 3: () => set({ view: "beside" }), 4: () => set({ view: "overlay" }),
  Escape: actions.stop, "?": actions.help,
});
document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.target.matches("input[type=text]")) return;
  const action = { z: event.shiftKey ? actions.redo : actions.undo, y: actions.redo }[event.key.toLowerCase()];
  if (!action) return;
  event.preventDefault();
  action();
});
runFigures(() => desk?.cards.figures() ?? []);
listTakes().then(() => { document.body.dataset.ready = "yes"; }, failed);
