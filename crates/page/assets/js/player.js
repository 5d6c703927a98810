// ---- player.js: one clock for everything on the page, and the bar that drives it.

class Player {
  constructor([first, last], start, stepSecs) {
    Object.assign(this, { first, last, time: start, stepSecs });
    this.speed = 1;
    this.loop = true;
    this.playing = false;
    this.listeners = [];
    this.bar = Object.fromEntries(
      ["play", "clock", "scrub", "speed", "loop", "keys", "keys-list", "profile"].map((id) => [
        id,
        document.getElementById(id),
      ]),
    );
    this.wire();
  }

  wire() {
    const { bar } = this;
    Object.assign(bar.scrub, { min: this.first, max: this.last, value: this.time });
    bar.play.addEventListener("click", () => this.toggle());
    bar.scrub.addEventListener("input", () => this.seek(Number(bar.scrub.value)));
    bar.speed.addEventListener("change", () => (this.speed = Number(bar.speed.value)));
    bar.loop.addEventListener("click", () => this.setLoop(!this.loop));
    bar.keys.addEventListener("click", () => this.toggleKeys());
    this.show();
  }

  /** Called with the time whenever it changes. */
  onTime(listener) {
    this.listeners.push(listener);
  }

  toggle() {
    if (!this.playing && !this.loop && this.time >= this.last) this.time = this.first;
    this.playing = !this.playing;
    this.show();
  }

  setLoop(loop) {
    this.loop = loop;
    this.show();
  }

  toggleKeys() {
    const open = this.bar["keys-list"].hidden;
    this.bar["keys-list"].hidden = !open;
    this.bar.keys.setAttribute("aria-expanded", String(open));
  }

  seek(time) {
    this.time = clamp(time, this.first, this.last);
    this.show();
  }

  /** Moves the clock on by what passed on the wall, if it is playing. */
  advance(wallSecs) {
    if (!this.playing) return;
    // A tab that slept for a minute goes on where it was.
    let time = this.time + Math.min(wallSecs, 0.25) * this.speed;
    if (time > this.last) {
      if (this.loop) {
        const span = this.last - this.first;
        time = span > 0 ? this.first + ((time - this.first) % span) : this.first;
      } else {
        time = this.last;
        this.playing = false;
      }
    }
    this.time = time;
    this.show();
  }

  show() {
    const { bar } = this;
    bar.clock.textContent = `${this.time.toFixed(2)} s`;
    bar.scrub.value = this.time;
    bar.scrub.setAttribute("aria-valuetext", `${this.time.toFixed(2)} seconds`);
    bar.scrub.style.setProperty("--share", `${(100 * (this.time - this.first)) / (this.last - this.first || 1)}%`);
    bar.play.classList.toggle("playing", this.playing);
    bar.play.setAttribute("aria-label", this.playing ? "Pause" : "Play");
    bar.loop.setAttribute("aria-pressed", String(this.loop));
    this.listeners.forEach((f) => f(this.time));
  }

  /** Draws how strong the wind was behind the scrubber: values at `times`, the strongest fills the height. */
  drawProfile(times, values) {
    const { context, width, height } = fitted(this.bar.profile);
    const top = Math.max(...values, 1e-9);
    const x = (t) => ((t - this.first) / (this.last - this.first || 1)) * width;
    context.beginPath();
    context.moveTo(x(times[0]), height);
    times.forEach((t, k) => context.lineTo(x(t), height - (height - 2) * (values[k] / top)));
    context.lineTo(x(times[times.length - 1]), height);
    context.closePath();
    context.fillStyle = theme.css("profile");
    context.fill();
  }
}

/** Keys that drive the player and the view. They keep out of the way of form fields. */
function wireKeys(player, stage) {
  const actions = {
    " ": () => player.toggle(),
    ArrowLeft: (e) => player.seek(player.time - (e.shiftKey ? 0.5 : player.stepSecs)),
    ArrowRight: (e) => player.seek(player.time + (e.shiftKey ? 0.5 : player.stepSecs)),
    Home: () => player.seek(player.first),
    End: () => player.seek(player.last),
    l: () => player.setLoop(!player.loop),
    "?": () => player.toggleKeys(),
    "+": () => stage.zoom(0.85),
    "-": () => stage.zoom(1 / 0.85),
    h: () => stage.toggle("hair"),
    f: () => stage.toggle("full"),
    c: () => stage.toggle("compared"),
    m: () => stage.toggle("markers"),
    w: () => stage.toggle("wind"),
    s: () => stage.toggle("slice"),
  };
  Object.keys(VIEWS).forEach((name, k) => (actions[k + 1] = () => stage.setView(name)));
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    // Arrows in a slider move that slider (the time's own is ours); space on a button presses that button.
    const typed = event.target.closest?.("input, select, textarea");
    if (typed && typed.id !== "scrub") return;
    if (event.key === " " && event.target.closest?.("button, summary")) return;
    const action = actions[event.key] ?? actions[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action(event);
  });
}
