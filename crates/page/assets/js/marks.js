// ---- marks.js: what is drawn over the hair: markers, wind arrows, the frame of the slice.

const MARKER_VERTEX = `
layout(location = 0) in vec4 at;
uniform mat4 camera, head;
uniform vec3 eye;
uniform float size;
out float tone;
void main() {
  vec4 p = head * vec4(at.xyz, 1.0);
  gl_Position = camera * p;
  gl_Position.z = nearer(camera, p, normalize(eye - p.xyz), gl_Position.w);
  gl_PointSize = size / gl_Position.w;
  tone = at.w;
}`;

const MARKER_FRAGMENT = `
uniform vec3 markerColor, headColor;
in float tone;
out vec4 color;
void main() {
  vec2 q = gl_PointCoord * 2.0 - 1.0;
  float r = dot(q, q);
  if (r > 1.0) discard;
  vec3 n = vec3(q.x, -q.y, sqrt(1.0 - r));
  vec3 base = mix(markerColor, headColor, tone);
  float glow = 0.45 + 0.75 * max(dot(n, normalize(vec3(0.4, 0.7, 0.6))), 0.0);
  float spark = pow(max(dot(n, normalize(vec3(0.3, 0.6, 0.75))), 0.0), 24.0) * 0.5;
  color = vec4(shown(base * glow + spark), 1.0 - smoothstep(0.8, 1.0, r));
}`;

const THREAD_VERTEX = `
layout(location = 0) in vec4 at;
uniform mat4 camera, head;
void main() { gl_Position = camera * (head * vec4(at.xyz, 1.0)); }`;

const THREAD_FRAGMENT = `
uniform vec3 lineColor;
uniform float presence;
out vec4 color;
void main() { color = vec4(shown(lineColor), presence); }`;

// An arrow is a thin quad and a head, turned to face the eye: 9 corners, from tail (0) to tip (1).
const ARROW_VERTEX = `
layout(location = 0) in vec4 from;
layout(location = 1) in vec4 vector;
uniform mat4 camera, head;
uniform vec3 eye, colorOutside, colorInterpolated, colorMeasured;
out vec4 tint;
const vec2 corners[9] = vec2[](vec2(0, -1), vec2(0, 1), vec2(1, 1), vec2(0, -1), vec2(1, 1), vec2(1, -1),
                               vec2(1, -3.4), vec2(1, 3.4), vec2(2, 0));
void main() {
  vec3 tail = (head * vec4(from.xyz, 1.0)).xyz;
  vec3 v = mat3(head) * vector.xyz;
  float strength = min(length(v), 1.6);
  vec3 direction = v / max(length(v), 1e-6);
  float size = strength * vector.w;
  float head_size = min(0.45 * size, 0.011);
  vec2 corner = corners[gl_VertexID];
  vec3 sideways = normalize(cross(direction, eye - tail) + 1e-6);
  float by = corner.x < 1.5 ? corner.x * (size - head_size) : size;
  float thick = 0.00075 * (0.6 + 0.4 * strength) * (corner.x > 0.5 && abs(corner.y) > 2.0 ? head_size / 0.011 : 1.0);
  vec3 p = tail + direction * (by - 0.5 * size) + sideways * corner.y * thick;
  gl_Position = camera * vec4(p, 1.0);
  float kind = from.w;
  vec3 base = kind > 1.5 ? colorMeasured : kind > 0.5 ? colorInterpolated : colorOutside;
  float fade = kind > 1.5 ? 0.95 : kind > 0.5 ? 0.7 : 0.34;
  tint = vec4(base, fade * smoothstep(0.02, 0.35, strength));
}`;

const ARROW_FRAGMENT = `
in vec4 tint;
out vec4 color;
void main() { color = vec4(shown(tint.rgb), tint.a); }`;

/** Voxels between arrows, by where the vector comes from: what was measured is shown whole, the rest thinned out. */
const ARROW_STRIDES = [4, 2, 1];

/** The arrows of one moment; 8 floats each. */
class Arrows {
  constructor(wind, bust) {
    this.wind = wind;
    const [nx, ny, nz] = wind.data.dims;
    this.candidates = [];
    for (let x = 0; x < nx; x++)
      for (let y = 0; y < ny; y++)
        for (let z = 0; z < nz; z++) {
          const at = wind.center(x, y, z);
          if (bust.headDistance(at) < 0.004) continue;
          const onEvery = (stride) => [x, y, z].every((i) => i % stride === stride >> 1);
          this.candidates.push({ at, flat: wind.flat(x, y, z), fits: ARROW_STRIDES.map(onEvery) });
        }
  }

  at(time) {
    const { wind } = this;
    const moment = wind.at(time);
    const flags = moment.nearer * wind.n;
    const { top, edge_m } = wind.data;
    const floats = [];
    const vector = [0, 0, 0];
    for (const { at, flat, fits } of this.candidates) {
      const flag = wind.flags[flags + flat];
      if (!fits[flag]) continue;
      wind.vector(flat, moment, vector);
      const longest = 0.85 * edge_m * Math.max(ARROW_STRIDES[flag], 2);
      floats.push(...at, flag, ...scale(vector, 1 / (top || 1)), longest);
    }
    return new Float32Array(floats);
  }
}

/** The frame of the slice and of the grid, as line segments: 4 floats a corner. */
function frameLines(corners, axis, place) {
  const [u, v] = [0, 1, 2].filter((a) => a !== axis);
  const corner = (i, j) => {
    const p = [0, 0, 0, 0];
    p[axis] = place;
    p[u] = corners[i][u];
    p[v] = corners[j][v];
    return p;
  };
  const ring = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
  return new Float32Array(ring.flatMap((p, k) => [...p, ...ring[(k + 1) % 4]]));
}
