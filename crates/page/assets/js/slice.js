// ---- slice.js: a slice through the field: color for speed, arrows for direction, and where it was measured.

/** For each slicing axis, which head axis runs to the right and which upward, and their signs. */
const SLICE_VIEWS = [
  { right: [1, 1], above: [2, 1], names: ["subject's right", "left", "down", "up"] },
  { right: [0, -1], above: [2, 1], names: ["front", "back", "down", "up"] },
  { right: [1, -1], above: [0, 1], names: ["subject's left", "right", "back", "front"] },
];
const AXIS_NAMES = ["x", "y", "z"];

class Slice {
  constructor(wind, bust, sources) {
    Object.assign(this, { wind, bust, sources });
    this.canvas = document.getElementById("slice");
    this.visible = true;
    this.counted = "";
    this.wire();
    this.recolor();
    this.setAxis(this.alongWind());
  }

  /** The axis that has least of the outside wind: the slice across it shows most of it. */
  alongWind() {
    const sums = [0, 1, 2].map((axis) => this.wind.data.outside.reduce((sum, v) => sum + Math.abs(v[axis]), 0));
    return sums.indexOf(Math.min(...sums));
  }

  wire() {
    this.controls = Object.fromEntries(
      ["slice-place", "slice-at", "slice-arrows", "slice-hair", "slice-here", "slice-scale", "slice-top"].map((id) => [
        id.replace("slice-", ""),
        document.getElementById(id),
      ]),
    );
    for (const button of document.querySelectorAll("[data-axis]")) {
      button.addEventListener("click", () => this.setAxis(Number(button.dataset.axis)));
    }
    const { controls, canvas } = this;
    controls.place.addEventListener("input", () => this.setPlace(Number(controls.place.value)));
    for (const box of [controls.arrows, controls.hair]) box.addEventListener("change", () => (this.dirty = true));
    canvas.addEventListener("pointermove", (e) => this.hover(e));
    canvas.addEventListener("pointerleave", () => { this.pointed = null; this.dirty = true; });
    new IntersectionObserver(([entry]) => { this.visible = entry.isIntersecting; this.dirty = true; }).observe(canvas);
    new ResizeObserver(() => (this.dirty = true)).observe(canvas);
  }

  recolor() {
    this.scale = speedScale();
    const card = theme.css("card").match(/[0-9a-f]{2}/gi).map((hex) => parseInt(hex, 16));
    this.faint = this.scale.map((color) => color.map((c, k) => Math.round(mix(card[k], c, 0.5))));
    this.dirty = true;
    const { context, width, height } = fitted(this.controls.scale);
    for (let x = 0; x < width; x++) {
      context.fillStyle = `rgb(${this.scale[Math.round((255 * x) / width)]})`;
      context.fillRect(x, 0, 1.5, height);
    }
    const { top, unit: name } = this.wind.data;
    this.controls.top.textContent = `${top < 100 ? top.toPrecision(2) : top.toFixed(0)} ${name} and more`;
  }

  setAxis(axis) {
    this.axis = axis;
    for (const button of document.querySelectorAll("[data-axis]")) {
      button.setAttribute("aria-pressed", String(Number(button.dataset.axis) === axis));
    }
    const n = this.wind.data.dims[axis];
    this.controls.place.max = n - 1;
    this.setPlace(Math.floor(n / 2));
  }

  setPlace(place) {
    this.place = place;
    this.controls.place.value = place;
    const at = this.wind.data.first_m[this.axis] + place * this.wind.data.edge_m;
    this.at = at;
    this.controls.at.textContent = `${AXIS_NAMES[this.axis]} = ${(at * 100).toFixed(1).replace("-", "−")} cm`;
    this.bodyImage = null;
    this.dirty = true;
    this.onPlace?.({ axis: this.axis, place: at, corners: this.wind.data.corners_m });
  }

  /** The flat index of the voxel in column i (to the right) and row j (upward) of the picture. */
  voxel(i, j) {
    const { right, above } = SLICE_VIEWS[this.axis];
    const index = [0, 0, 0];
    index[this.axis] = this.place;
    index[right[0]] = right[1] > 0 ? i : this.columns - 1 - i;
    index[above[0]] = above[1] > 0 ? j : this.rows - 1 - j;
    return this.wind.flat(...index);
  }

  draw(time) {
    if (!this.visible || (!this.dirty && time === this.lastTime)) return;
    this.dirty = false;
    this.lastTime = time;
    const { dims } = this.wind.data;
    const { right, above } = SLICE_VIEWS[this.axis];
    this.columns = dims[right[0]];
    this.rows = dims[above[0]];
    const { context, width, height } = fitted(this.canvas);
    this.margin = clamp(0.08 * width, 26, 42);
    this.cell = Math.min((width - 2 * this.margin) / this.columns, (height - 2 * this.margin) / this.rows);
    this.left = (width - this.cell * this.columns) / 2;
    this.bottom = (height + this.cell * this.rows) / 2;
    const moment = this.wind.at(time);
    this.drawCells(context, moment);
    this.drawBody(context, time);
    if (this.controls.hair.checked) this.drawHair(context, time);
    if (this.controls.arrows.checked) this.drawArrows(context, moment);
    this.drawOutside(context, moment);
    this.drawNames(context, width, height);
    this.say(moment);
  }

  /** Runs over the voxels of the slice with their vector and where it comes from. */
  each(moment, visit) {
    const vector = [0, 0, 0];
    for (let i = 0; i < this.columns; i++) {
      for (let j = 0; j < this.rows; j++) {
        const flat = this.voxel(i, j);
        this.wind.vector(flat, moment, vector);
        visit(i, j, vector, this.wind.flags[moment.nearer * this.wind.n + flat]);
      }
    }
  }

  drawCells(context, moment) {
    const { cell, left, bottom, scale: colors } = this;
    const { top } = this.wind.data;
    const counts = [0, 0, 0];
    const measured = [];
    const faint = this.faint;
    this.each(moment, (i, j, vector, flag) => {
      counts[flag]++;
      const share = clamp(norm(vector) / (top || 1), 0, 1);
      const [x, y] = [left + i * cell, bottom - (j + 1) * cell];
      context.fillStyle = `rgb(${(flag === 0 ? faint : colors)[Math.round(255 * share)]})`;
      context.fillRect(Math.floor(x), Math.floor(y), Math.ceil(cell) + 1, Math.ceil(cell) + 1);
      if (flag === 2) measured.push([x, y]);
    });
    this.drawOutsideEdge(context, moment);
    context.strokeStyle = theme.css("measured");
    context.lineWidth = 1.75;
    for (const [x, y] of measured) context.strokeRect(x + 1, y + 1, cell - 2, cell - 2);
    this.counts = counts;
  }

  /** A thin line between what hair told and what comes from outside. */
  drawOutsideEdge(context, moment) {
    const { cell, left, bottom, columns, rows } = this;
    const flag = (i, j) => this.wind.flags[moment.nearer * this.wind.n + this.voxel(i, j)];
    context.beginPath();
    for (let i = 0; i < columns; i++) {
      for (let j = 0; j < rows; j++) {
        const here = flag(i, j) === 0;
        const [x, y] = [left + i * cell, bottom - j * cell];
        if (i + 1 < columns && here !== (flag(i + 1, j) === 0)) {
          context.moveTo(x + cell, y);
          context.lineTo(x + cell, y - cell);
        }
        if (j + 1 < rows && here !== (flag(i, j + 1) === 0)) {
          context.moveTo(x, y - cell);
          context.lineTo(x + cell, y - cell);
        }
      }
    }
    context.strokeStyle = theme.css("interpolated");
    context.lineWidth = 1;
    context.stroke();
  }

  /** From a place in the picture (shares of the frame) to head space. */
  point(u, v) {
    const { corners_m } = this.wind.data;
    const { right, above } = SLICE_VIEWS[this.axis];
    const p = [0, 0, 0];
    p[this.axis] = this.at;
    for (const [share, [axis, sign]] of [[u, right], [v, above]]) {
      p[axis] = mix(corners_m[0][axis], corners_m[1][axis], sign > 0 ? share : 1 - share);
    }
    return p;
  }

  /** From head space to pixels. */
  pixel(p) {
    const { corners_m } = this.wind.data;
    const { right, above } = SLICE_VIEWS[this.axis];
    const share = ([axis, sign]) => {
      const s = (p[axis] - corners_m[0][axis]) / (corners_m[1][axis] - corners_m[0][axis]);
      return sign > 0 ? s : 1 - s;
    };
    return [this.left + share(right) * this.cell * this.columns, this.bottom - share(above) * this.cell * this.rows];
  }

  drawBody(context, time) {
    const turning = Boolean(this.sources.turn.data);
    if (!this.bodyImage || (turning && this.bodyTime !== time)) {
      this.bodyImage = this.cutBody(time, turning ? 90 : 220);
      this.bodyTime = time;
    }
    context.imageSmoothingEnabled = true;
    const [w, h] = [this.cell * this.columns, this.cell * this.rows];
    context.drawImage(this.bodyImage, this.left, this.bottom - h, w, h);
  }

  /** Where the slice cuts the body, as a picture with a soft edge. */
  cutBody(time, n) {
    const image = new ImageData(n, n);
    const ink = theme.css("body-cut").match(/[0-9a-f]{2}/gi).map((hex) => parseInt(hex, 16));
    const torsoFromHead = this.sources.turn.at(time);
    const pixel = 0.6 / n;
    for (let j = 0; j < n; j++) {
      for (let i = 0; i < n; i++) {
        const p = this.point((i + 0.5) / n, 1 - (j + 0.5) / n);
        const d = Math.min(this.bust.headDistance(p), this.bust.torsoDistance(transform(torsoFromHead, p)));
        image.data.set([...ink, 255 * clamp(0.5 - d / pixel, 0, 1)], 4 * (j * n + i));
      }
    }
    const canvas = document.createElement("canvas");
    Object.assign(canvas, { width: n, height: n });
    canvas.getContext("2d").putImageData(image, 0, 0);
    return canvas;
  }

  /** Hair that passes within a voxel of the slice; fainter the farther it is. */
  drawHair(context, time) {
    const { motion, counts } = this.sources.hair();
    if (!motion) return;
    const now = motion.at(time);
    const reach = this.wind.data.edge_m;
    context.strokeStyle = theme.css("hair-line");
    context.lineWidth = 1.6;
    context.lineCap = "round";
    let first = 0;
    for (const count of counts) {
      for (let k = first; k < first + count - 1; k++) {
        const [a, b] = [now.subarray(3 * k, 3 * k + 3), now.subarray(3 * k + 3, 3 * k + 6)];
        const far = (Math.abs(a[this.axis] - this.at) + Math.abs(b[this.axis] - this.at)) / 2;
        if (far > reach) continue;
        context.globalAlpha = 1 - 0.85 * (far / reach);
        context.beginPath();
        context.moveTo(...this.pixel(a));
        context.lineTo(...this.pixel(b));
        context.stroke();
      }
      first += count;
    }
    context.globalAlpha = 1;
  }

  drawArrows(context, moment) {
    const { cell, left, bottom } = this;
    const { right, above } = SLICE_VIEWS[this.axis];
    const { top } = this.wind.data;
    const every = cell < 11 ? 2 : 1;
    const longest = 0.95 * cell * every;
    const styles = [theme.css("arrow-outside"), theme.css("arrow"), theme.css("arrow")];
    const paths = styles.map(() => new Path2D());
    const strong = new Path2D();
    this.each(moment, (i, j, vector, flag) => {
      if (every > 1 && flag !== 2 && (i % every || j % every)) return;
      const [u, v] = [vector[right[0]] * right[1], vector[above[0]] * above[1]];
      const share = norm(vector) / (top || 1);
      if (share < 0.03) return;
      const path = flag > 0 && share > 0.55 ? strong : paths[flag];
      arrowPath(path, left + (i + 0.5) * cell, bottom - (j + 0.5) * cell, (u / top) * longest, (-v / top) * longest);
    });
    context.lineWidth = 1.1;
    context.lineCap = context.lineJoin = "round";
    paths.forEach((path, flag) => {
      context.strokeStyle = styles[flag];
      context.stroke(path);
    });
    context.strokeStyle = theme.css("arrow-strong");
    context.stroke(strong);
  }

  /** The wind outside the grid, as an arrow that arrives at the frame. */
  drawOutside(context, moment) {
    const { right, above } = SLICE_VIEWS[this.axis];
    const outside = this.wind.outside(moment);
    const [u, v] = [outside[right[0]] * right[1], -outside[above[0]] * above[1]];
    const size = Math.hypot(u, v);
    if (size < 0.05 * this.wind.data.top) return;
    const [halfW, halfH] = [(this.cell * this.columns) / 2, (this.cell * this.rows) / 2];
    const [cx, cy] = [this.left + halfW, this.bottom - halfH];
    const [dx, dy] = [u / size, v / size];
    const toFrame = Math.min(halfW / Math.max(Math.abs(dx), 1e-6), halfH / Math.max(Math.abs(dy), 1e-6));
    const length = clamp(size / this.wind.data.top, 0.25, 1.25) * (this.margin - 10);
    const path = new Path2D();
    const by = toFrame + 4 + length / 2;
    arrowPath(path, cx - dx * by, cy - dy * by, dx * length, dy * length, 8);
    context.strokeStyle = theme.css("outside");
    context.lineWidth = 2.4;
    context.stroke(path);
  }

  drawNames(context, width, height) {
    const [west, east, south, north] = SLICE_VIEWS[this.axis].names;
    const [w, h] = [this.cell * this.columns, this.cell * this.rows];
    context.fillStyle = theme.css("muted");
    context.font = "12px system-ui, sans-serif";
    context.textBaseline = "middle";
    context.textAlign = "left";
    context.fillText(west, this.left, this.bottom + 16);
    context.textAlign = "right";
    context.fillText(east, this.left + w, this.bottom + 16);
    context.textAlign = "center";
    context.fillText(north, this.left + w / 2, this.bottom - h - 14);
    context.fillText(south, this.left + w / 2, this.bottom + 16);
    context.strokeStyle = theme.css("line");
    context.lineWidth = 1;
    context.strokeRect(this.left - 0.5, this.bottom - h - 0.5, w + 1, h + 1);
  }

  hover(event) {
    const box = this.canvas.getBoundingClientRect();
    const i = Math.floor((event.clientX - box.left - this.left) / this.cell);
    const j = Math.floor((this.bottom - (event.clientY - box.top)) / this.cell);
    this.pointed = i >= 0 && j >= 0 && i < this.columns && j < this.rows ? [i, j] : null;
    this.dirty = true;
  }

  /** Shares in this slice, and the voxel under the pointer, in words. */
  say(moment) {
    const all = this.columns * this.rows;
    this.counts.forEach((count, flag) => {
      document.getElementById(`share-${flag}`).textContent = `${((100 * count) / all).toFixed(1)} %`;
    });
    let text = "Point at a voxel to read it.";
    if (this.pointed) {
      const flat = this.voxel(...this.pointed);
      const vector = this.wind.vector(flat, moment, [0, 0, 0]);
      const flag = this.wind.flags[moment.nearer * this.wind.n + flat];
      const parts = vector.map((c) => c.toFixed(2).replace("-", "−")).join(", ");
      const origin = ["from outside", "interpolated", "measured"][flag];
      text = `${norm(vector).toFixed(2)} ${this.wind.data.unit} (${parts}), ${origin}`;
    }
    this.controls.here.textContent = text;
  }
}

/** An arrow about its middle. */
function arrowPath(path, x, y, dx, dy, head = 0) {
  const [x0, y0, x1, y1] = [x - dx / 2, y - dy / 2, x + dx / 2, y + dy / 2];
  path.moveTo(x0, y0);
  path.lineTo(x1, y1);
  const barb = head || Math.min(0.36 * Math.hypot(dx, dy), 4.2);
  const angle = Math.atan2(dy, dx);
  for (const side of [2.6, -2.6]) {
    path.moveTo(x1, y1);
    path.lineTo(x1 + barb * Math.cos(angle + side), y1 + barb * Math.sin(angle + side));
  }
}
