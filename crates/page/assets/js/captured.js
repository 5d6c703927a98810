// ---- captured.js: what the cameras saw, over time.

const ROW_GAP = 1;
const LABEL_PX = 42;
const AXIS_PX = 20;

class Timeline {
  constructor(data, shares, head, player) {
    Object.assign(this, { data, shares, head, player });
    this.canvas = document.getElementById("timeline");
    this.tip = document.getElementById("timeline-tip");
    this.rows = data.names.length + 1; // the head, then the locks
    this.seconds = data.visible.n_columns * data.visible.secs_per_column;
    this.dirty = true;
    this.visible = true;
    this.canvas.style.height = `${clamp(this.rows * 11, 120, 420) + AXIS_PX}px`;
    this.wire();
  }

  wire() {
    const { canvas } = this;
    canvas.addEventListener("pointermove", (e) => this.hover(e));
    canvas.addEventListener("pointerleave", () => (this.tip.hidden = true));
    canvas.addEventListener("click", (e) => this.player.seek(this.timeAt(e)));
    new ResizeObserver(() => (this.dirty = true)).observe(canvas);
    new IntersectionObserver(([entry]) => { this.visible = entry.isIntersecting; this.dirty = true; }).observe(canvas);
  }

  timeAt(event) {
    const box = this.canvas.getBoundingClientRect();
    return clamp((event.clientX - box.left - LABEL_PX) / (box.width - LABEL_PX), 0, 1) * this.seconds;
  }

  share(row, column) {
    const n = this.data.visible.n_columns;
    return (row === 0 ? this.head[column] : this.shares[(row - 1) * n + column]) / 255;
  }

  name(row) {
    return row === 0 ? "head" : this.data.names[row - 1];
  }

  draw(time) {
    if (!this.visible || (!this.dirty && time === this.lastTime)) return;
    const { canvas } = this;
    if (this.dirty || !this.base) this.base = this.paintBase();
    this.dirty = false;
    this.lastTime = time;
    const { context, width, height } = fitted(canvas);
    context.drawImage(this.base, 0, 0, width, height);
    const x = LABEL_PX + clamp(time / this.seconds, 0, 1) * (width - LABEL_PX);
    context.fillStyle = theme.css("ink");
    context.fillRect(x - 0.75, 0, 1.5, height - AXIS_PX + 4);
  }

  paintBase() {
    const base = document.createElement("canvas");
    const { width, height } = fitted(this.canvas);
    const ratio = Math.min(devicePixelRatio || 1, 2);
    Object.assign(base, { width: width * ratio, height: height * ratio });
    const context = base.getContext("2d");
    context.scale(ratio, ratio);
    const rowHeight = (height - AXIS_PX) / this.rows;
    const n = this.data.visible.n_columns;
    const columnWidth = (width - LABEL_PX) / n;
    const gap = rowHeight > 4 ? ROW_GAP : 0;
    context.font = "10px system-ui, sans-serif";
    context.textBaseline = "middle";
    for (let row = 0; row < this.rows; row++) {
      const y = row * rowHeight;
      if (rowHeight >= 9 || row % Math.ceil(10 / rowHeight) === 0) {
        context.fillStyle = theme.css("muted");
        context.fillText(this.name(row).slice(0, 7), 0, y + rowHeight / 2);
      }
      context.fillStyle = theme.css(row === 0 ? "head-row" : "interpolated");
      for (let column = 0, next; column < n; column = next) {
        const share = this.share(row, column);
        next = column + 1;
        while (next < n && this.share(row, next) === share) next++;
        if (share === 0) continue;
        // What is complete is quiet; every step down is easy to see.
        context.globalAlpha = share === 1 ? 0.9 : 0.08 + 0.5 * share;
        context.fillRect(LABEL_PX + column * columnWidth, y, (next - column) * columnWidth, rowHeight - gap);
      }
      context.globalAlpha = 1;
    }
    this.paintSeconds(context, width, height);
    return base;
  }

  paintSeconds(context, width, height) {
    const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60].find((s) => (this.seconds / s) * 44 <= width - LABEL_PX) ?? 300;
    context.fillStyle = theme.css("muted");
    context.textAlign = "center";
    for (let t = 0; t <= this.seconds + 1e-9; t += step) {
      const x = LABEL_PX + (t / this.seconds) * (width - LABEL_PX);
      context.fillText(`${Number(t.toFixed(2))} s`, clamp(x, LABEL_PX + 8, width - 12), height - 7);
    }
  }

  hover(event) {
    const box = this.canvas.getBoundingClientRect();
    const row = Math.floor(((event.clientY - box.top) / (box.height - AXIS_PX)) * this.rows);
    const time = this.timeAt(event);
    this.tip.hidden = row < 0 || row >= this.rows || event.clientX - box.left < LABEL_PX;
    if (this.tip.hidden) return;
    const column = clamp(Math.floor(time / this.data.visible.secs_per_column), 0, this.data.visible.n_columns - 1);
    const share = this.share(row, column);
    const of = row === 0 ? 1 : this.data.counts[row - 1];
    const seen = row === 0 ? (share > 0 ? "pose found" : "no pose") : `${Math.round(share * of)} of ${of} markers`;
    this.tip.textContent = `${this.name(row)} at ${time.toFixed(2)} s: ${seen}`;
    const x = clamp(event.clientX - box.left, 90, box.width - 90);
    Object.assign(this.tip.style, { left: `${x}px`, top: `${event.clientY - box.top}px` });
  }
}

/** Puts the time into every plot over time; a click in a plot goes there. */
function wirePlots(player) {
  for (const plot of document.querySelectorAll("svg.plot[data-x0]")) {
    const [x0, x1, left, right] = ["x0", "x1", "left", "right"].map((name) => Number(plot.dataset[name]));
    const { width, height } = plot.viewBox.baseVal;
    const cursor = document.createElementNS("http://www.w3.org/2000/svg", "line");
    cursor.setAttribute("class", "cursor");
    cursor.setAttribute("y1", 12);
    cursor.setAttribute("y2", height - 40);
    plot.append(cursor);
    player.onTime((time) => {
      const x = left + clamp((time - x0) / (x1 - x0), 0, 1) * (right - left);
      cursor.setAttribute("x1", x);
      cursor.setAttribute("x2", x);
    });
    plot.addEventListener("click", (event) => {
      const box = plot.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * width;
      player.seek(x0 + clamp((x - left) / (right - left), 0, 1) * (x1 - x0));
    });
  }
}
