// ---- stage.js: the 3D view: what is shown, and the order in which it is drawn.

const MARKER_M = 0.0085; // drawn a little larger than real markers of 3 to 6 mm

class Stage {
  constructor(canvas, body, bust, leeward) {
    const software = rendersInSoftware();
    const gl = canvas.getContext("webgl2", { antialias: !software, alpha: false, powerPreference: "high-performance" });
    if (!gl) throw new Error("this browser offers no WebGL2. The rest of the page works");
    Object.assign(this, { canvas, gl, body, bust, software });
    this.camera = new Camera(canvas, body.up, bust.skull?.center_m ?? [0, 0, 0], leeward);
    this.shown = { hair: true, full: true, compared: false, markers: false, wind: false, slice: false };
    this.detail = software ? 0.7 : 1;
    this.dirty = true;
    this.visible = true;
    this.build();
    this.recolor();
    this.wire();
  }

  build() {
    const { gl } = this;
    this.programs = {
      bust: new Program(gl, BUST_VERTEX, BUST_FRAGMENT),
      bustShadow: new Program(gl, BUST_VERTEX, "void main() {}"),
      // Without samples to spread an edge over, it is cut in the middle.
      hair: new Program(gl, HAIR_VERTEX, HAIR_FRAGMENT, ["SHADED", `EDGE ${this.software ? 0.5 : 0.06}`]),
      hairShadow: new Program(gl, HAIR_VERTEX, HAIR_SHADOW_FRAGMENT),
      line: new Program(gl, HAIR_VERTEX, LINE_FRAGMENT),
      marker: new Program(gl, MARKER_VERTEX, MARKER_FRAGMENT),
      thread: new Program(gl, THREAD_VERTEX, THREAD_FRAGMENT),
      arrow: new Program(gl, ARROW_VERTEX, ARROW_FRAGMENT),
      backdrop: new Program(gl, BACKDROP_VERTEX, this.software ? BACKDROP_PLAIN_FRAGMENT : BACKDROP_FRAGMENT),
    };
    this.shadow = shadowMap(gl, this.software ? 512 : 1024);
    this.nothing = gl.createVertexArray();
    this.mesh ??= this.bust.mesh();
    const { vertices, triangles } = this.mesh;
    this.bustMesh = { ...vertexArray(gl, [3, 3, 3], vertices), count: triangles.length };
    gl.bindVertexArray(this.bustMesh.array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    this.pointArray = vertexArray(gl, [4], null);
    this.headMarkerArray = vertexArray(gl, [4], new Float32Array(this.body.head_markers_m.flatMap((p) => [...p, 1])));
    this.threadArray = vertexArray(gl, [4], null);
    this.frameArray = vertexArray(gl, [4], null);
    this.arrowArray = vertexArray(gl, [4, 4], null, { divisor: 1 });
    this.noise = noiseTexture(gl);
    this.curves = dataTexture(gl);
    this.comparedCurves = dataTexture(gl);
  }

  recolor() {
    this.colors = Object.fromEntries(
      ["plaster", "cap", "hair-root", "hair-tip", "sky", "ground", "backdrop-near", "backdrop-far", "compared",
        "measured", "interpolated", "outside", "marker", "head-marker", "ink"].map((name) => [name, linearColor(name)]),
    );
    this.dirty = true;
  }

  /** The hairstyle to show: control points over time, perhaps a second motion to lay over it. */
  setHair({ counts, widths_m }, motion, compared) {
    Object.assign(this, { motion, compared, counts });
    const { gl, bust, mesh, bustMesh } = this;
    this.hairCurves = new HairCurves(counts, widths_m, bust);
    bust.putCap(mesh.vertices, rootsOf(counts, motion.meters));
    gl.bindBuffer(gl.ARRAY_BUFFER, bustMesh.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, mesh.vertices, gl.STATIC_DRAW);
    // Few locks are drawn as many ribbons each, many strands as few: the picture costs about the same.
    this.ribbons = clamp(Math.round((this.software ? 600 : 2600) / counts.length), 1, 48);
    this.ribbonHalf = clamp(0.056 / Math.sqrt(this.ribbons * counts.length), 0.0005, 0.003);
    this.dirty = true;
  }

  toggle(what) {
    if (this.button(what).hidden) return;
    this.shown[what] = !this.shown[what];
    this.showButtons();
  }

  button(what) {
    return document.querySelector(`[data-show="${what}"]`);
  }

  showButtons() {
    for (const [what, on] of Object.entries(this.shown)) this.button(what).setAttribute("aria-pressed", String(on));
    for (const button of document.querySelectorAll("[data-view]")) {
      button.setAttribute("aria-pressed", String(this.camera.isAt(button.dataset.view)));
    }
    this.dirty = true;
  }

  setView(name) {
    this.camera.setView(name);
    this.showButtons();
  }

  zoom(factor) {
    this.camera.zoom(factor);
    this.dirty = true;
  }

  wire() {
    const { canvas } = this;
    this.camera.wire(() => this.showButtons());
    for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", () => this.setView(button.dataset.view));
    for (const button of document.querySelectorAll("[data-show]")) button.addEventListener("click", () => this.toggle(button.dataset.show));
    canvas.addEventListener("webglcontextlost", (e) => e.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => { this.build(); this.dirty = true; });
    new IntersectionObserver(([entry]) => { this.visible = entry.isIntersecting; this.dirty = true; }).observe(canvas);
    new ResizeObserver(() => (this.dirty = true)).observe(canvas);
    this.showButtons();
  }

  /** Draws if anything changed since the last time; `wallSecs` moves the camera towards its goal. */
  draw(time, wallSecs) {
    if (!this.visible) return;
    const moving = this.camera.settle(wallSecs);
    if (this.dirty || moving || time !== this.lastTime) {
      this.dirty = false;
      this.lastTime = time;
      this.stillSecs = 0;
      this.resize(this.detail);
      this.paint(time);
      this.watchSpeed(wallSecs);
    } else if (this.detail < 1 && this.stillSecs < 0.4) {
      // Where motion is drawn coarsely, a picture that stands still is drawn again, well.
      this.stillSecs += wallSecs;
      if (this.stillSecs < 0.4) return;
      this.resize(1);
      this.paint(time);
    }
  }

  /** Where frames come late (software rendering), the picture gets coarser rather than jerky. */
  watchSpeed(wallSecs) {
    const late = wallSecs > 0.055 ? Math.min(wallSecs, 0.5) / 0.055 : -0.5;
    this.slow = Math.max((this.slow ?? 0) + late, 0);
    if (this.slow > 16 && this.detail > 0.5) {
      this.detail = Math.max(this.detail * 0.8, 0.5);
      this.slow = 0;
    }
  }

  resize(detail) {
    const { canvas } = this;
    const ratio = Math.min(devicePixelRatio || 1, 2) * detail;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((c) => Math.max(1, Math.round(c * ratio)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  }

  paint(time) {
    const { gl, colors, bust } = this;
    const view = this.camera.look();
    const light = this.camera.light(view.eye);
    const head = this.headTurn.at(time);
    this.upload(this.curves, this.hairCurves.fill(this.motion.at(time)));
    const common = {
      camera: view.matrix, eye: view.eye, head, key: light.key, back: light.back, light: light.matrix,
      up: this.camera.frame.up, sky: colors.sky, ground: colors.ground, n_samples: SAMPLES, n_ribbons: this.ribbons,
      full: this.shown.full ? 1 : 0, spread: this.shown.full ? 1.6 : 1, rootSpread: this.hairCurves.rootSpread, ribbonHalf: this.ribbonHalf, thin: 0,
      toward: [0, 0, 0], skullCenter: bust.skull?.center_m ?? [0, 0, 0], skullHalf: bust.skull?.half_axes_m ?? [0, 0, 0],
    };
    this.castShadow(common);
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.disable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.paintBackdrop();
    gl.enable(gl.DEPTH_TEST);
    this.paintBust(common);
    if (this.shown.hair) this.paintHair(common);
    if (this.shown.compared && this.compared) this.paintCompared(common, time);
    if (this.shown.markers && this.markers) this.paintMarkers(common, time);
    if (this.shown.wind && this.arrows) this.paintArrows(common, time);
    if (this.shown.slice && this.slicePlace) this.paintSlice(common);
  }

  upload(texture, texels) {
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, TEXELS, texels.length / (4 * TEXELS), 0, gl.RGBA, gl.FLOAT, texels);
  }

  castShadow(common) {
    const { gl, programs, shadow } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, shadow.target);
    gl.viewport(0, 0, shadow.size, shadow.size);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    const seen = { ...common, camera: common.light, toward: common.key };
    programs.bustShadow.use(seen);
    this.drawBust();
    if (this.shown.hair) {
      // Fewer and wider: a shadow is soft anyway.
      const ribbons = Math.ceil(this.ribbons / 4);
      const wider = { n_ribbons: ribbons, ribbonHalf: 2 * this.ribbonHalf };
      programs.hairShadow.use({ ...seen, ...wider, curves: { slot: 0, texture: this.curves } });
      this.drawRibbons(ribbons);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  paintBackdrop() {
    const { gl, programs, colors, canvas } = this;
    const wide = canvas.clientWidth > WIDE_PX;
    programs.backdrop.use({
      near: colors["backdrop-near"], far: colors["backdrop-far"],
      middle: wide ? [0.65, 0.5] : [0.5, 0.42], aspect: canvas.width / canvas.height,
    });
    gl.bindVertexArray(this.nothing);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * BACKDROP_CELLS[0] * BACKDROP_CELLS[1]);
  }

  paintBust(common) {
    const { gl, programs, colors, bust } = this;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    programs.bust.use({
      ...common, plaster: colors.plaster, capColor: colors.cap, hairShown: this.shown.hair ? 1 : 0.25,
      fadeLow: bust.fade[0], fadeHigh: bust.fade[1], shadow: { slot: 1, texture: this.shadow.texture },
    });
    gl.enable(gl.CULL_FACE);
    this.drawBust();
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.BLEND);
  }

  drawBust() {
    const { gl, bustMesh } = this;
    gl.bindVertexArray(bustMesh.array);
    gl.drawElements(gl.TRIANGLES, bustMesh.count, gl.UNSIGNED_INT, 0);
  }

  paintHair(common) {
    const { gl, programs, colors } = this;
    // Coverage instead of blending: hair needs no sorting.
    gl.enable(gl.SAMPLE_ALPHA_TO_COVERAGE);
    programs.hair.use({
      ...common, rootColor: colors["hair-root"], tipColor: colors["hair-tip"],
      curves: { slot: 0, texture: this.curves }, shadow: { slot: 1, texture: this.shadow.texture },
      noise: { slot: 2, texture: this.noise },
    });
    this.drawRibbons(this.ribbons);
    gl.disable(gl.SAMPLE_ALPHA_TO_COVERAGE);
  }

  drawRibbons(ribbons) {
    const { gl } = this;
    gl.bindVertexArray(this.nothing);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 2 * SAMPLES, this.counts.length * ribbons);
  }

  paintCompared(common, time) {
    const { gl, programs, colors } = this;
    this.upload(this.comparedCurves, this.hairCurves.fill(this.compared.at(time)));
    this.blendOver(() => {
      programs.line.use({
        ...common, n_ribbons: 1, full: 0, thin: 0.0011, lineColor: colors.compared,
        curves: { slot: 0, texture: this.comparedCurves },
      });
      this.drawRibbons(1);
    });
  }

  paintMarkers(common, time) {
    const { gl, programs, colors, markers } = this;
    const now = markers.at(time);
    const points = [];
    const threads = [];
    let first = 0;
    for (const count of markers.counts) {
      let before = null;
      for (let k = 0; k < count; k++) {
        const at = now.subarray(3 * (first + k), 3 * (first + k) + 3);
        if (Number.isNaN(at[0])) continue;
        points.push(at[0], at[1], at[2], 0);
        if (before) threads.push(...before, 0, ...at, 0);
        before = at;
      }
      first += count;
    }
    this.blendOver(() => {
      programs.thread.use({ ...common, lineColor: colors.marker, presence: 0.6 });
      this.drawDynamic(this.threadArray, new Float32Array(threads), 4, gl.LINES);
    });
    gl.enable(gl.SAMPLE_ALPHA_TO_COVERAGE);
    programs.marker.use({
      ...common, size: (MARKER_M * this.canvas.height) / (2 * Math.tan(FOV_Y / 2)),
      markerColor: colors.marker, headColor: colors["head-marker"],
    });
    this.drawDynamic(this.pointArray, new Float32Array(points), 4, gl.POINTS);
    gl.bindVertexArray(this.headMarkerArray.array);
    gl.drawArrays(gl.POINTS, 0, this.body.head_markers_m.length);
    gl.disable(gl.SAMPLE_ALPHA_TO_COVERAGE);
  }

  paintArrows(common, time) {
    const { gl, programs, colors, arrows } = this;
    const data = arrows.at(time);
    this.blendOver(() => {
      programs.arrow.use({
        ...common, colorMeasured: colors.measured,
        colorInterpolated: colors.interpolated, colorOutside: colors.outside,
      });
      gl.bindVertexArray(this.arrowArray.array);
      gl.bindBuffer(gl.ARRAY_BUFFER, this.arrowArray.buffer);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, 9, data.length / 8);
    });
  }

  paintSlice(common) {
    const { gl, programs, colors, slicePlace } = this;
    this.blendOver(() => {
      programs.thread.use({ ...common, lineColor: colors.ink, presence: 0.7 });
      this.drawDynamic(this.frameArray, frameLines(slicePlace.corners, slicePlace.axis, slicePlace.place), 4, gl.LINES);
    });
  }

  /** Draws see-through things: behind what is solid they are hidden, among each other they mix. */
  blendOver(paint) {
    const { gl } = this;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    paint();
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  drawDynamic({ array, buffer }, data, floats, mode) {
    const { gl } = this;
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    gl.drawArrays(mode, 0, data.length / floats);
  }
}

// A soft glow behind the head, worked out at the corners of a coarse net: 16 x 12 cells of 6 corners.
const BACKDROP_CELLS = [16, 12];
const BACKDROP_VERTEX = `
uniform vec3 near, far;
uniform vec2 middle;
uniform float aspect;
out vec3 glow;
void main() {
  int cell = gl_VertexID / 6, corner = gl_VertexID - 6 * cell;
  ivec2 step = ivec2(corner == 1 || corner == 2 || corner == 4, corner >= 2 && corner != 3 ? 1 : 0);
  vec2 at = vec2(ivec2(cell % ${BACKDROP_CELLS[0]}, cell / ${BACKDROP_CELLS[0]}) + step) / vec2(${BACKDROP_CELLS.map((n) => n.toFixed(1))});
  vec2 d = (at - middle) * vec2(min(aspect, 1.6), 1.0);
  glow = pow(mix(near, far, smoothstep(0.0, 1.0, length(d) * 1.05)), vec3(1.0 / 2.2));
  gl_Position = vec4(at * 2.0 - 1.0, 0.999, 1.0);
}`;

const BACKDROP_FRAGMENT = `
in vec3 glow;
out vec4 color;
void main() {
  // Less than a step of noise keeps the gradient from showing its steps (Jimenez 2014).
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
  color = vec4(glow + noise / 255.0, 1.0);
}`;
const BACKDROP_PLAIN_FRAGMENT = `
in vec3 glow;
out vec4 color;
void main() { color = vec4(glow, 1.0); }`;
