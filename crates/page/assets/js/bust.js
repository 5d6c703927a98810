// ---- bust.js: the body as one smooth surface, meshed once in the browser.
//
// What the hair can touch are the session's shapes: an ellipsoid, capsules. Drawn bare they look like a pawn; here
// they are blended where they meet, and a body named "head" gets a face. Face and blend are for the eye only: the
// shapes themselves are all inside.

/** Signed distance (about) to a shape, m; below 0 inside. */
function shapeDistance(shape, p) {
  if (shape.kind === "capsule") {
    const axis = sub(shape.b_m, shape.a_m);
    const from = sub(p, shape.a_m);
    const share = clamp(dot(from, axis) / (dot(axis, axis) || 1), 0, 1);
    return norm(sub(from, scale(axis, share))) - shape.radius_m;
  }
  const q = sub(p, shape.center_m);
  const r = shape.half_axes_m;
  const k0 = Math.hypot(q[0] / r[0], q[1] / r[1], q[2] / r[2]);
  const k1 = Math.hypot(q[0] / (r[0] * r[0]), q[1] / (r[1] * r[1]), q[2] / (r[2] * r[2]));
  return k1 > 0 ? (k0 * (k0 - 1)) / k1 : -Math.min(...r);
}

/** The smaller of two distances, rounded over `width` where they are near each other. */
function blended(a, b, width) {
  const h = Math.max(width - Math.abs(a - b), 0) / width;
  return Math.min(a, b) - (h * h * h * width) / 6;
}

const ellipsoid = (center_m, half_axes_m) => ({ kind: "ellipsoid", center_m, half_axes_m });
const capsule = (a_m, b_m, radius_m) => ({ kind: "capsule", a_m, b_m, radius_m });

class Bust {
  constructor(shapes) {
    this.head = shapes.filter((s) => s.on_head);
    this.torso = shapes.filter((s) => !s.on_head);
    this.skull = shapes.find((s) => s.kind === "ellipsoid" && s.on_head);
    this.face = this.skull?.name === "head" ? faceOf(this.skull) : null;
    const shoulders = shapes.find((s) => s.name === "shoulders" && s.kind === "capsule");
    this.chest = shoulders ? chestOf(shoulders) : null;
    this.fade = shoulders ? [shoulders.a_m[2] - 0.075, shoulders.a_m[2] + 0.02] : [-9, -8.9];
  }

  headDistance(p) {
    let d = this.head.reduce((d, s) => blended(d, shapeDistance(s, p), 0.03), 9);
    if (this.face) {
      d = blended(d, shapeDistance(this.face.jaw, p), 0.045);
      for (const socket of this.face.sockets) d = -blended(-d, shapeDistance(socket, p), 0.03);
      d = blended(d, shapeDistance(this.face.nose, p), 0.028);
      d = blended(d, shapeDistance(this.face.lips, p), 0.03);
    }
    return d;
  }

  torsoDistance(p) {
    let d = this.torso.reduce((d, s) => blended(d, shapeDistance(s, p), 0.075), 9);
    if (this.chest) d = blended(d, shapeDistance(this.chest, p), 0.07);
    return d;
  }

  distance(p) {
    return blended(this.headDistance(p), this.torsoDistance(p), 0.035);
  }

  /** The gradient of the distance, unit length. */
  normal(p) {
    const e = 0.0015;
    return unit(
      [0, 1, 2].map((axis) => {
        const step = [0, 0, 0];
        step[axis] = e;
        return this.distance(add(p, step)) - this.distance(sub(p, step));
      }),
    );
  }

  /** The box that holds everything drawn: two corners. */
  box() {
    const low = [9, 9, 9];
    const high = [-9, -9, -9];
    const grow = (p, r) => {
      for (let a = 0; a < 3; a++) {
        low[a] = Math.min(low[a], p[a] - r[a]);
        high[a] = Math.max(high[a], p[a] + r[a]);
      }
    };
    const extra = [this.face?.nose, this.face?.jaw, this.chest].filter(Boolean);
    for (const s of [...this.head, ...this.torso, ...extra]) {
      if (s.kind === "ellipsoid") grow(s.center_m, s.half_axes_m);
      else for (const end of [s.a_m, s.b_m]) grow(end, [s.radius_m, s.radius_m, s.radius_m]);
    }
    low[2] = Math.max(low[2], this.fade[0] - 0.01);
    return [low.map((c) => c - 0.015), high.map((c) => c + 0.015)];
  }

  /** Position, normal, and (head weight, occlusion, wig cap) of every vertex, 9 floats each, and triangles. */
  mesh() {
    const [low, high] = this.box();
    if (low[0] > high[0]) return { vertices: new Float32Array(0), triangles: new Uint32Array(0) };
    const { positions, triangles } = surfaceNet(low, high, 0.0068, (p) => this.distance(p));
    const vertices = new Float32Array(9 * positions.length);
    positions.forEach((p, k) => {
      // A net's vertices lie within a cell of the surface; a step along the gradient puts them onto it.
      p = sub(p, scale(this.normal(p), this.distance(p)));
      const normal = this.normal(p);
      vertices.set([...p, ...normal, this.headWeight(p), this.occlusion(p, normal), 0], 9 * k);
    });
    return { vertices, triangles };
  }

  /** 1 where the surface turns with the head, 0 where it stays with the torso, smooth along the neck. */
  headWeight(p) {
    if (this.torso.length === 0) return 1;
    return smoothstep(-0.025, 0.025, this.torsoDistance(p) - this.headDistance(p));
  }

  /** How much of the sky a place sees, by looking at the distance a little way out (Evans 2006). */
  occlusion(p, normal) {
    let lost = 0;
    for (let i = 1; i <= 5; i++) {
      const out = 0.012 * i;
      lost += (out - this.distance(add(p, scale(normal, out)))) / (out * 2 ** i);
    }
    return clamp(1 - 1.1 * lost, 0.12, 1);
  }

  /** Colors the mesh like a wig's cap near the roots of the hair: the last float of each vertex. */
  putCap(vertices, roots) {
    if (!this.skull) return;
    // Of many thousand roots, some say where the hair grows.
    const some = roots.filter((_, k) => k % Math.ceil(roots.length / 250) === 0);
    for (let i = 0; i < vertices.length; i += 9) {
      let sum = 0;
      for (const root of some) {
        const d = (vertices[i] - root[0]) ** 2 + (vertices[i + 1] - root[1]) ** 2 + (vertices[i + 2] - root[2]) ** 2;
        if (d < 0.0081) sum += Math.exp(-d / (0.03 * 0.03));
      }
      vertices[i + 8] = smoothstep(0.4, 0.9, sum);
    }
  }
}

/** A quiet face for a head: proportions of the head's own half axes. */
function faceOf({ center_m: c, half_axes_m: [a, b, h] }) {
  const at = (x, y, z) => [c[0] + x * a, c[1] + y * b, c[2] + z * h];
  return {
    jaw: ellipsoid(at(0.3, 0, -0.5), [0.5 * a, 0.58 * b, 0.56 * h]),
    nose: capsule(at(0.95, 0, 0.12), at(1.08, 0, -0.2), 0.075 * a),
    lips: capsule(at(0.85, -0.1, -0.5), at(0.85, 0.1, -0.5), 0.055 * a),
    sockets: [-1, 1].map((side) => ellipsoid(at(1.1, 0.46 * side, 0.12), [0.2 * a, 0.3 * b, 0.15 * h])),
  };
}

/** What is below the shoulders, as far as the picture shows it. */
function chestOf({ a_m, b_m, radius_m: r }) {
  const middle = scale(add(a_m, b_m), 0.5);
  const half = norm(sub(a_m, b_m)) / 2;
  return ellipsoid(add(middle, [0.1 * r, 0, -2.2 * r]), [1.35 * r, half + 0.55 * r, 4 * r]);
}

/** Naive surface nets (Gibson 1998): a vertex in each cell that the surface crosses, joined across its edges. */
function surfaceNet(low, high, cell, distance) {
  const n = [0, 1, 2].map((a) => Math.ceil((high[a] - low[a]) / cell) + 1);
  const place = (x, y, z) => (x * n[1] + y) * n[2] + z;
  const values = distances(n, low, cell, distance);

  const positions = [];
  const vertexOf = new Int32Array(values.length).fill(-1);
  for (let x = 0; x < n[0] - 1; x++)
    for (let y = 0; y < n[1] - 1; y++)
      for (let z = 0; z < n[2] - 1; z++) {
        const crossing = meanCrossing(x, y, z, (a, b, c) => values[place(a, b, c)]);
        if (!crossing) continue;
        vertexOf[place(x, y, z)] = positions.length;
        positions.push(crossing.map((c, axis) => low[axis] + c * cell));
      }

  const triangles = [];
  for (let x = 1; x < n[0] - 1; x++)
    for (let y = 1; y < n[1] - 1; y++)
      for (let z = 1; z < n[2] - 1; z++) {
        const here = values[place(x, y, z)] < 0;
        const quads = [
          [place(x + 1, y, z), [[0, 0, 0], [0, -1, 0], [0, -1, -1], [0, 0, -1]]],
          [place(x, y + 1, z), [[0, 0, 0], [0, 0, -1], [-1, 0, -1], [-1, 0, 0]]],
          [place(x, y, z + 1), [[0, 0, 0], [-1, 0, 0], [-1, -1, 0], [0, -1, 0]]],
        ];
        for (const [other, corners] of quads) {
          if (here === values[other] < 0) continue;
          const [a, b, c, d] = corners.map(([i, j, k]) => vertexOf[place(x + i, y + j, z + k)]);
          if (Math.min(a, b, c, d) < 0) continue;
          if (here) triangles.push(a, b, c, a, c, d);
          else triangles.push(a, c, b, a, d, c);
        }
      }
  return { positions, triangles: new Uint32Array(triangles) };
}

/** The distance at every corner of the net; where a block of corners lies far from the surface, only its middle's. */
function distances(n, low, cell, distance) {
  const BLOCK = 5;
  // What is off by more than this from a block's middle is on the same side of the surface in the whole block; the
  // distance to an ellipsoid is only about right, hence half as much again.
  const safe = 1.5 * BLOCK * 0.5 * cell * Math.sqrt(3);
  const values = new Float32Array(n[0] * n[1] * n[2]);
  const at = (x, y, z) => [low[0] + x * cell, low[1] + y * cell, low[2] + z * cell];
  for (let x0 = 0; x0 < n[0]; x0 += BLOCK)
    for (let y0 = 0; y0 < n[1]; y0 += BLOCK)
      for (let z0 = 0; z0 < n[2]; z0 += BLOCK) {
        const middle = distance(at(x0 + (BLOCK - 1) / 2, y0 + (BLOCK - 1) / 2, z0 + (BLOCK - 1) / 2));
        const far = Math.abs(middle) > safe;
        for (let x = x0; x < Math.min(x0 + BLOCK, n[0]); x++)
          for (let y = y0; y < Math.min(y0 + BLOCK, n[1]); y++)
            for (let z = z0; z < Math.min(z0 + BLOCK, n[2]); z++)
              values[(x * n[1] + y) * n[2] + z] = far ? middle : distance(at(x, y, z));
      }
  return values;
}

/** The mean of the places where the surface cuts a cell's edges, in cells; null if it cuts none. */
function meanCrossing(x, y, z, value) {
  const sum = [0, 0, 0];
  let count = 0;
  for (let corner = 0; corner < 8; corner++) {
    const a = [corner & 1, (corner >> 1) & 1, corner >> 2];
    const va = value(x + a[0], y + a[1], z + a[2]);
    for (let axis = 0; axis < 3; axis++) {
      if (a[axis] === 1) continue;
      const b = [...a];
      b[axis] = 1;
      const vb = value(x + b[0], y + b[1], z + b[2]);
      if (va < 0 === vb < 0) continue;
      const share = va / (va - vb);
      for (let k = 0; k < 3; k++) sum[k] += a[k] + (k === axis ? share : 0);
      count++;
    }
  }
  return count === 0 ? null : [x + sum[0] / count, y + sum[1] / count, z + sum[2] / count];
}

const BUST_VERTEX = `
layout(location = 0) in vec3 at;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 kind;
uniform mat4 camera, head;
out vec3 place, facing, what;
void main() {
  vec4 p = mix(vec4(at, 1.0), head * vec4(at, 1.0), kind.x);
  place = p.xyz;
  facing = mix(normal, mat3(head) * normal, kind.x);
  what = kind;
  gl_Position = camera * p;
}`;

const BUST_FRAGMENT = `
uniform vec3 eye, key, up, plaster, capColor, sky, ground;
uniform float fadeLow, fadeHigh, hairShown;
uniform mat4 light;
uniform sampler2DShadow shadow;
in vec3 place, facing, what;
out vec4 color;
void main() {
  vec3 n = normalize(facing), v = normalize(eye - place);
  vec3 h = normalize(key + v);
  float arrives = lit(shadow, light, place + n * 0.004, 0.0015, 1.6 / 1024.0);
  float cap = what.z * hairShown;
  vec3 base = mix(plaster, capColor, cap);
  float wrapped = clamp((dot(n, key) + 0.25) / 1.25, 0.0, 1.0);
  vec3 ambient = mix(ground, sky, 0.5 + 0.5 * dot(n, up)) * what.y;
  // A little red comes through where light grazes, as in wax.
  vec3 through = vec3(0.10, 0.035, 0.02) * (1.0 - cap) * smoothstep(0.0, 0.5, wrapped) * (1.0 - wrapped);
  float gloss = pow(max(dot(n, h), 0.0), mix(38.0, 14.0, cap)) * mix(0.10, 0.05, cap);
  float rim = pow(1.0 - max(dot(n, v), 0.0), 4.0) * 0.16 * what.y;
  vec3 lightIn = base * (ambient + 1.3 * wrapped * wrapped * arrives) + through + gloss * arrives + rim * sky;
  color = vec4(shown(lightIn), smoothstep(fadeLow, fadeHigh, dot(place, up)));
}`;
