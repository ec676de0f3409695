// A camera that orbits a point, Y up.

export class Camera {
  constructor() {
    this.target = [0, 0.45, 0];
    // Farther away than the reader chose, to see the whole path.
    this.back = 0;
    this.reset();
  }

  reset(yaw = this.home ?? 0.6, distance = this.farness ?? 1.62) {
    this.home = yaw;
    this.farness = distance;
    Object.assign(this, { yaw, distance, pitch: 0.16 });
  }

  orbit(right, up) {
    this.yaw -= right;
    this.pitch = Math.min(Math.max(this.pitch + up, -0.1), 1.5);
  }

  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 0.5), 60);
  }

  // Return a function from a place in space to [x, y, pixels per unit], or null behind the eye.
  projector(width, height, left = 0) {
    const focal = 1.55 * Math.min(height, width * 1.25);
    const [cosY, sinY] = [Math.cos(this.yaw), Math.sin(this.yaw)];
    const [cosP, sinP] = [Math.cos(this.pitch), Math.sin(this.pitch)];
    const [tx, ty, tz] = this.target;
    const [cx, cy] = [left + width / 2, height * 0.51];
    return (x, y, z) => {
      const across = cosY * (x - tx) - sinY * (z - tz);
      const deep = sinY * (x - tx) + cosY * (z - tz);
      const away = this.distance + this.back - (cosP * deep + sinP * (y - ty));
      if (away < 0.05) return null;
      const scale = focal / away;
      return [cx + scale * across, cy - scale * (cosP * (y - ty) - sinP * deep), scale];
    };
  }
}
