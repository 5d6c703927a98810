// ---- tracks.js: what moves, unpacked, and where it is at any time.

const MISSING = -32768;

/** Quantized positions as meters; NaN where there is none. */
async function unpackPositions({ packed, positions, center_m, step_m }) {
  const integers = await unpack(packed ?? positions);
  const meters = new Float32Array(integers.length);
  for (let i = 0; i < integers.length; i++) {
    meters[i] = integers[i] === MISSING ? NaN : center_m[i % 3] + step_m * integers[i];
  }
  return meters;
}

/** Index of the last time at or before `time`, and how far it is to the next one. */
function placeIn(times, time) {
  const last = times.length - 1;
  if (last === 0 || time <= times[0]) return [0, 0];
  if (time >= times[last]) return [last - 1, 1];
  let [low, high] = [0, last];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return [low, (time - times[low]) / (times[high] - times[low])];
}

/** Positions of control points over time; cubic between frames (Catmull-Rom), so that slow motion is smooth. */
class Motion {
  constructor(times, meters) {
    Object.assign(this, { times, meters, row: meters.length / times.length });
    this.now = new Float32Array(this.row);
  }

  at(time) {
    const { meters, row, now, times } = this;
    const [k, s] = placeIn(times, time);
    const last = times.length - 1;
    const frames = [Math.max(k - 1, 0), k, Math.min(k + 1, last), Math.min(k + 2, last)].map((f) => f * row);
    const weights = [
      -0.5 * s + s * s - 0.5 * s ** 3,
      1 - 2.5 * s * s + 1.5 * s ** 3,
      0.5 * s + 2 * s * s - 1.5 * s ** 3,
      -0.5 * s * s + 0.5 * s ** 3,
    ];
    for (let i = 0; i < row; i++) {
      now[i] =
        weights[0] * meters[frames[0] + i] +
        weights[1] * meters[frames[1] + i] +
        weights[2] * meters[frames[2] + i] +
        weights[3] * meters[frames[3] + i];
    }
    return now;
  }
}

/** The captured markers: linear between frames that both saw one, else where the nearer frame saw it. */
class Markers {
  constructor(data, meters) {
    Object.assign(this, { meters, counts: data.counts, rate: data.rate_hz, last: data.n_frames - 1 });
    this.row = 3 * data.counts.reduce((a, b) => a + b, 0);
    this.now = new Float32Array(this.row);
  }

  at(time) {
    const { meters, row, now } = this;
    const place = clamp(time * this.rate, 0, Math.max(this.last, 0));
    const before = Math.min(Math.floor(place), Math.max(this.last - 1, 0));
    const after = Math.min(before + 1, this.last);
    const share = place - before;
    for (let i = 0; i < row; i++) {
      const [a, b] = [meters[before * row + i], meters[after * row + i]];
      const both = mix(a, b, share);
      now[i] = Number.isNaN(both) ? (share < 0.5 ? a : b) : both;
    }
    return now;
  }
}

/** How the head turns on the torso. */
class Turn {
  constructor(data, integers, pivot) {
    Object.assign(this, { data, integers, pivot });
  }

  /** `torso_from_head` at a time, as a matrix. */
  at(time) {
    if (!this.data) return turnAbout([0, 0, 0, 1], this.pivot);
    const { start_secs, rate_hz, n } = this.data;
    const place = clamp((time - start_secs) * rate_hz, 0, n - 1);
    const before = Math.min(Math.floor(place), Math.max(n - 2, 0));
    const after = Math.min(before + 1, n - 1);
    const q = [0, 1, 2, 3].map((c) => mix(this.integers[4 * before + c], this.integers[4 * after + c], place - before));
    const length = Math.hypot(...q);
    return turnAbout(q.map((c) => c / length), this.pivot);
  }
}

/** The wind on the grid. */
class Wind {
  constructor(data, vectors, flags) {
    Object.assign(this, { data, vectors, flags });
    this.n = data.dims[0] * data.dims[1] * data.dims[2];
    this.times = Array.from({ length: data.n_steps }, (_, k) => data.start_secs + k / data.rate_hz);
  }

  /** The steps round a time; flags hold from the nearer one. */
  at(time) {
    const last = this.data.n_steps - 1;
    const place = clamp((time - this.data.start_secs) * this.data.rate_hz, 0, last);
    const before = Math.min(Math.floor(place), Math.max(last - 1, 0));
    const after = Math.min(before + 1, last);
    const share = place - before;
    return { before, after, share, nearer: share < 0.5 ? before : after };
  }

  /** The vector of a voxel (flat index) at a moment that `at` gave. */
  vector(voxel, { before, after, share }, out) {
    const { vectors, n } = this;
    for (let axis = 0; axis < 3; axis++) {
      const a = vectors[(before * 3 + axis) * n + voxel];
      const b = vectors[(after * 3 + axis) * n + voxel];
      out[axis] = (a + (b - a) * share) * this.data.step;
    }
    return out;
  }

  outside({ before, after, share }) {
    const { outside } = this.data;
    return [0, 1, 2].map((axis) => mix(outside[before][axis], outside[after][axis], share));
  }

  flat(x, y, z) {
    return (x * this.data.dims[1] + y) * this.data.dims[2] + z;
  }

  center(x, y, z) {
    const { first_m, edge_m } = this.data;
    return [first_m[0] + x * edge_m, first_m[1] + y * edge_m, first_m[2] + z * edge_m];
  }
}
