// Time: moves on while the page plays, and has drawn what is stale, once a frame.

// Bounds: a function to the first and last second of what is played again and again.
export function runClock(store, bounds, drawStage, drawCharts) {
  const { state } = store;
  let stageDue = true;
  let chartsDue = true;
  let odd = false;
  let before = performance.now();

  function tick(now) {
    const passed = Math.min((now - before) / 1000, 0.25);
    before = now;
    if (state.playing) store.change({ time: next(state, passed, bounds()) });
    if (stageDue) drawStage();
    stageDue = false;
    // While the skeleton plays, the charts follow at half its rate.
    odd = !odd;
    if (chartsDue && (odd || !state.playing)) {
      chartsDue = false;
      drawCharts();
    }
    requestAnimationFrame(tick);
  }

  requestAnimationFrame(tick);
  return () => {
    stageDue = chartsDue = true;
  };
}

function next({ time, speed }, passed, [start, stop]) {
  const later = time + passed * speed;
  return later > stop || later < start ? start : later;
}
