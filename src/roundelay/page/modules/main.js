// The page: unpack the data, make the parts, let time run.

import { unpack } from "./unpack.js";
import { createStore } from "./store.js";
import { Capture, Motion } from "./motion.js";
import { Camera } from "./camera.js";
import { createStage, homeYaw } from "./stage.js";
import { listenToGestures } from "./gestures.js";
import { createTimeline } from "./timeline.js";
import { createPlane } from "./plane.js";
import { createDial } from "./dial.js";
import { createBarcode } from "./barcode.js";
import { fillMotions, fillNotice, fillPanel } from "./panel.js";
import { listenToControls, showControls } from "./controls.js";
import { createTheme } from "./theme.js";
import { byId } from "./elements.js";

async function start() {
  const data = await unpack(byId("payload").textContent);
  const capture = new Capture(data.capture);
  const motions = data.motions.map((record) => new Motion(record, capture));
  const store = createStore({
    time: 0, playing: false, speed: 1, view: "capture", onion: false, follow: true,
    motion: 0, bar: -1,
  });
  const page = {
    ...data, capture, motions,
    motion: () => motions[store.state.motion],
  };
  const camera = new Camera();
  camera.reset(homeYaw(capture.track));
  const stage = createStage(byId("stage"), camera, page);
  const timeline = createTimeline(byId("timeline"), page, store);
  const plane = createPlane(byId("plane"), page, store);
  const dial = createDial(byId("dial"), page, store);
  const barcode = createBarcode(byId("bars"), byId("bars-note"), page, store);

  let stale = true;
  const redraw = () => { stale = true; };
  function renew() {
    for (const layer of [timeline, plane, dial]) layer.invalidate();
    redraw();
  }
  function refill() {
    fillPanel(page);
    barcode.fill();
    renew();
  }

  store.onChange((changed) => {
    if (changed.has("motion")) store.change(opening(page.motion(), store.state, capture));
    if (changed.has("motion")) refill();
    if (changed.has("bar")) {
      barcode.show();
      renew();
    }
    showControls(store.state, page);
    redraw();
  });

  if (motions.length > 0) store.change(opening(motions[0], store.state, capture));
  describe(page);
  fillNotice(data.reason);
  fillMotions(page, store);
  const toggleTheme = createTheme(renew);
  listenToControls(store, page, { reset: () => { camera.reset(); redraw(); }, theme: toggleTheme });
  listenToGestures(byId("stage"), camera, redraw);
  new ResizeObserver(renew).observe(document.body);
  refill();
  showControls(store.state, page);

  let before = performance.now();
  let chartsDue = false;
  let odd = false;
  function tick(now) {
    const passed = Math.min((now - before) / 1000, 0.25);
    before = now;
    if (store.state.playing) store.change({ time: wrapped(store.state, passed, capture.seconds) });
    if (stale) {
      stale = false;
      const views = stage.draw(store.state);
      caption(views, store.state);
      chartsDue = true;
    }
    // While the skeleton plays, the charts follow at half its rate.
    odd = !odd;
    if (chartsDue && (odd || !store.state.playing)) {
      chartsDue = false;
      for (const layer of [timeline, plane, dial]) layer.draw();
    }
    requestAnimationFrame(tick);
  }
  requestAnimationFrame(tick);
  document.body.dataset.ready = performance.now().toFixed(1);
}

// What to show first of a motion: its own class, and a time at which it goes on.
function opening(motion, { time }, capture) {
  const inside = motion.part(time) || motion.parts.length === 0;
  return { bar: motion.chosen, time: inside ? time : motion.parts[0][0] / capture.fps };
}

function wrapped({ time, speed }, passed, seconds) {
  const next = time + passed * speed;
  return next > seconds ? 0 : next;
}

function caption(views, state) {
  const names = views.map((group) => group.map((actor) => actor.label).join(" and ")).join(" | ");
  const missing = state.view === "overlay" && views[0].length === 1;
  const text = missing ? "Capture (no periodic part here)" : names;
  if (byId("caption").textContent !== text) byId("caption").textContent = text;
}

function describe({ name, version, capture, motions, segments, reason }) {
  const found = reason ? "no periodic motion" : motions.length === 1 ? "1 periodic motion" : `${motions.length} periodic motions`;
  byId("name").textContent = name;
  byId("segments-legend").hidden = segments.length === 0;
  byId("length").textContent = `of ${capture.seconds.toFixed(2)} s`;
  const length = ((capture.frames - 1) / capture.fps).toFixed(1);
  byId("summary").textContent = `${capture.frames} frames at ${+capture.fps.toFixed(2)} fps, ${length} s, ${capture.joints} joints; ${found}`;
  byId("footer").textContent = `Made by roundelay ${version}. Lengths are in body sizes: the skeleton's longest path along bones.`;
}

start().catch((error) => {
  byId("summary").textContent = `This page could not start: ${error.message}. It needs a browser of 2023 or later.`;
  console.error(error);
});
