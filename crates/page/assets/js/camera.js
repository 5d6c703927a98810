// ---- camera.js: where the viewer stands, and the hands that move him.

/** Views: azimuth (0 = looking at the face, positive to the subject's left) and elevation, degrees. */
const VIEWS = { quarter: [40, 8], front: [0, 3], left: [90, 3], back: [180, 6], top: [0, 84] };

const FOV_Y = 0.5; // rad
const FIRST_DISTANCE = 1.2; // m
const WIDE_PX = 900; // where the style sheet puts the text beside the picture instead of above it

class Camera {
  /** `leeward`: +1 if hair is blown to the subject's left, -1 if to the right; the first view is from there. */
  constructor(canvas, up, middle, leeward) {
    Object.assign(this, { canvas, frame: upright(up), leeward });
    this.target = add(middle, scale(up, -0.04));
    VIEWS.quarter[0] *= leeward;
    this.now = { azimuth: VIEWS.quarter[0], elevation: VIEWS.quarter[1], distance: FIRST_DISTANCE };
    this.goal = { ...this.now };
  }

  setView(name) {
    const [azimuth, elevation] = VIEWS[name];
    // The short way round.
    this.now.azimuth -= 360 * Math.round((this.now.azimuth - azimuth) / 360);
    Object.assign(this.goal, { azimuth, elevation });
  }

  isAt(name) {
    const [azimuth, elevation] = VIEWS[name];
    return Math.abs(this.goal.azimuth - azimuth) < 1 && Math.abs(this.goal.elevation - elevation) < 1;
  }

  zoom(factor) {
    this.goal.distance = clamp(this.goal.distance * factor, 0.35, 3);
  }

  orbit(dx, dy) {
    this.goal.azimuth -= dx * 0.4;
    this.goal.elevation = clamp(this.goal.elevation + dy * 0.35, -80, 88);
  }

  /** Moves a little nearer to the goal; whether there is still some way to go. */
  settle(wallSecs) {
    const share = 1 - Math.exp(-wallSecs * 9);
    let left = 0;
    for (const key of Object.keys(this.now)) {
      const gap = this.goal[key] - this.now[key];
      this.now[key] += gap * share;
      left = Math.max(left, Math.abs(gap) / (key === "distance" ? 0.01 : 1));
    }
    return left > 0.02;
  }

  /** Eye and matrix for the picture's present size. */
  look() {
    const { frame, canvas, target, now } = this;
    const [az, el] = [now.azimuth, now.elevation].map((deg) => (deg * Math.PI) / 180);
    const level = add(scale(frame.forward, Math.cos(az)), scale(frame.left, Math.sin(az)));
    const from = add(scale(level, Math.cos(el)), scale(frame.up, Math.sin(el)));
    const aspect = canvas.width / canvas.height;
    const wide = canvas.clientWidth > WIDE_PX;
    // A narrow picture needs more distance for the same width of hair.
    const eye = add(target, scale(from, now.distance * Math.max(1, 0.92 / aspect)));
    const up = el > 1.35 ? scale(level, -1) : frame.up;
    // Text stands to the left of a wide picture and above a narrow one; the side the hair blows to gets more room.
    const shift = wide ? [this.leeward < 0 ? 0.34 : 0.2, 0.07] : [-0.16 * this.leeward, -0.2];
    const projection = perspective(FOV_Y, aspect, 0.05, 6, ...shift);
    return { eye, matrix: multiply(projection, lookAt(eye, target, up)) };
  }

  /** Light that goes with the viewer: the key over his left shoulder, so that every view is lit well, one from behind. */
  light(eye) {
    const { frame, target } = this;
    const toEye = unit(sub(eye, target));
    const right = unit(cross(frame.up, toEye));
    const level = unit(cross(right, frame.up));
    const key = unit(add(add(scale(level, 0.62), scale(right, -0.62)), scale(frame.up, 0.72)));
    const back = unit(add(add(scale(level, -0.85), scale(right, 0.5)), scale(frame.up, 0.45)));
    return { key, back, matrix: multiply(parallel(0.46, 2), lookAt(add(target, key), target, frame.up)) };
  }

  /** Mouse and fingers: one turns, two zoom. `changed` is called after each move. */
  wire(changed) {
    const { canvas } = this;
    const fingers = new Map();
    canvas.addEventListener("pointerdown", (e) => {
      fingers.set(e.pointerId, [e.clientX, e.clientY]);
      canvas.setPointerCapture(e.pointerId);
    });
    canvas.addEventListener("pointermove", (e) => {
      const before = fingers.get(e.pointerId);
      if (!before) return;
      const now = [e.clientX, e.clientY];
      const others = [...fingers].filter(([id]) => id !== e.pointerId).map(([, at]) => at);
      if (others.length === 0) this.orbit(now[0] - before[0], now[1] - before[1]);
      else {
        const apart = (at) => Math.hypot(at[0] - others[0][0], at[1] - others[0][1]);
        this.zoom(apart(before) / Math.max(apart(now), 1));
      }
      fingers.set(e.pointerId, now);
      changed();
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (e) => fingers.delete(e.pointerId));
    // A wheel scrolls the page; with Ctrl (which is also what a trackpad's pinch sends) it zooms.
    const wheel = (e) => {
      if (!e.ctrlKey && !e.metaKey) return;
      e.preventDefault();
      this.zoom(Math.exp(clamp(e.deltaY, -60, 60) * 0.006));
      changed();
    };
    canvas.addEventListener("wheel", wheel, { passive: false });
    canvas.addEventListener("dblclick", () => {
      this.goal.distance = FIRST_DISTANCE;
      this.setView("quarter");
      changed();
    });
  }
}

/** Forward, left and up for a viewer who stands on the ground, when the head may be tilted. */
function upright(up) {
  const forward = unit(sub([1, 0, 0], scale(up, up[0])));
  return { forward, left: cross(up, forward), up };
}
