// Canvases that are sharp on every screen, and colours that follow the theme.

const inks = new Map();

// A colour of the style sheet, as the theme has it.
export function ink(name) {
  if (!inks.has(name)) {
    const style = getComputedStyle(document.documentElement);
    inks.set(name, style.getPropertyValue(`--${name}`).trim());
  }
  return inks.get(name);
}

export function forgetInks() {
  inks.clear();
}

// Fit the canvas to its box; return its context in CSS pixels, cleared, with its size.
export function fitted(canvas) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  const context = canvas.getContext("2d");
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

// A canvas whose ground is drawn only when asked for, with something moving on top.
export function layered(canvas, drawGround, drawTop) {
  const ground = document.createElement("canvas");
  let stale = true;
  return {
    invalidate() {
      stale = true;
    },
    draw() {
      const { context, width, height } = fitted(canvas);
      if (width === 0) return;
      if (stale || ground.width !== canvas.width || ground.height !== canvas.height) {
        const ratio = canvas.width / width;
        ground.width = canvas.width;
        ground.height = canvas.height;
        const below = ground.getContext("2d");
        below.setTransform(ratio, 0, 0, ratio, 0, 0);
        drawGround(below, width, height);
        stale = false;
      }
      context.drawImage(ground, 0, 0, width, height);
      drawTop(context, width, height);
    },
  };
}

export function font(size) {
  return `${size}px system-ui, -apple-system, "Segoe UI", "Noto Sans", "Liberation Sans", sans-serif`;
}
