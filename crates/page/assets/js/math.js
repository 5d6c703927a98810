// ---- math.js: vectors are arrays of 3, matrices columns of 4 in a Float32Array, as WebGL has them.

const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const mix = (a, b, share) => a + (b - a) * share;
const smoothstep = (a, b, x) => {
  const share = clamp((x - a) / (b - a), 0, 1);
  return share * share * (3 - 2 * share);
};

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => scale(a, 1 / (norm(a) || 1));

function multiply(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      out[4 * column + row] = sum;
    }
  }
  return out;
}

/** A perspective whose middle is moved sideways and up by shares of half the picture. */
function perspective(fovY, aspect, near, far, shiftX, shiftY) {
  const f = 1 / Math.tan(fovY / 2);
  const m = new Float32Array(16);
  m[0] = f / aspect;
  m[5] = f;
  m[8] = -shiftX;
  m[9] = -shiftY;
  m[10] = (far + near) / (near - far);
  m[11] = -1;
  m[14] = (2 * far * near) / (near - far);
  return m;
}

/** A parallel projection of a cube of half width `reach`, `depth` deep. */
function parallel(reach, depth) {
  const m = new Float32Array(16);
  m[0] = m[5] = 1 / reach;
  m[10] = -2 / depth;
  m[14] = -1;
  m[15] = 1;
  return m;
}

function lookAt(eye, target, up) {
  const back = unit(sub(eye, target));
  const right = unit(cross(up, back));
  const above = cross(back, right);
  const m = new Float32Array(16);
  [right, above, back].forEach((axis, row) => {
    for (let k = 0; k < 3; k++) m[4 * k + row] = axis[k];
    m[12 + row] = -dot(axis, eye);
  });
  m[15] = 1;
  return m;
}

/** `p -> pivot + R(p - pivot)`, from a quaternion x y z w. */
function turnAbout([x, y, z, w], pivot) {
  const m = new Float32Array([
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0,
    0, 0, 0, 1,
  ]);
  const turned = transform(m, pivot);
  for (let k = 0; k < 3; k++) m[12 + k] = pivot[k] - turned[k];
  return m;
}

function transform(m, p) {
  return [0, 1, 2].map((row) => m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]);
}

/** A small random number generator with a seed: the same hair at every visit (mulberry32). */
function randomFrom(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}
