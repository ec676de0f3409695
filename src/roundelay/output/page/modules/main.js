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
import { fillCaption, fillHead, fillMotions, fillNotice, fillPanel } from "./panel.js";
import { listenToControls, showControls } from "./controls.js";
import { createTheme } from "./theme.js";
import { runClock } from "./clock.js";
import { byId } from "./elements.js";

async function start() {
  const data = await unpack(byId("payload").textContent);
  const capture = new Capture(data.capture);
  const motions = data.motions.map((record) => new Motion(record, capture));
  const store = createStore({
    time: 0, playing: false, speed: 1, view: "capture", onion: false, follow: true,
    motion: 0, bar: -1,
  });
  const page = { ...data, capture, motions, motion: () => motions[store.state.motion] };
  if (motions.length > 0) store.change(opening(motions[0], store.state, capture));
  fillHead(page);
  fillNotice(data.reason);
  fillMotions(page, store);
  show(page, store);
  document.body.dataset.ready = performance.now().toFixed(1);
}

// Make the parts that draw, and let them hear of every change.
function show(page, store) {
  const { state } = store;
  const camera = new Camera();
  camera.reset(homeYaw(page.capture.track));
  const stage = createStage(byId("stage"), camera, page);
  const charts = [
    createTimeline(byId("timeline"), page, store),
    createPlane(byId("plane"), page, store),
    createDial(byId("dial"), page, store),
  ];
  const barcode = createBarcode(byId("bars"), byId("bars-note"), page, store);
  const redraw = runClock(
    store,
    () => [0, page.capture.seconds],
    () => fillCaption(stage.draw(state), state),
    () => charts.forEach((chart) => chart.draw()),
  );

  function renew() {
    charts.forEach((chart) => chart.invalidate());
    redraw();
  }
  function refill() {
    fillPanel(page);
    barcode.fill();
    renew();
  }

  store.onChange((changed) => {
    if (changed.has("motion")) {
      store.change(opening(page.motion(), state, page.capture));
      refill();
    }
    if (changed.has("bar")) {
      barcode.show();
      renew();
    }
    showControls(state, page);
    redraw();
  });
  const reset = () => {
    camera.reset();
    redraw();
  };
  listenToControls(store, page, { reset, theme: createTheme(renew) });
  listenToGestures(byId("stage"), camera, redraw);
  new ResizeObserver(renew).observe(document.body);
  refill();
  showControls(state, page);
}

// What to show first of a motion: its own class, and a time at which it goes on.
function opening(motion, { time }, capture) {
  const inside = motion.part(time) || motion.parts.length === 0;
  return { bar: motion.chosen, time: inside ? time : motion.parts[0][0] / capture.fps };
}

start().catch((error) => {
  byId("summary").textContent = `This page could not start: ${error.message}. It needs a browser of 2023 or later.`;
  console.error(error);
});
