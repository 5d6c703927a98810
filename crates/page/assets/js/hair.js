// ---- hair.js: strands as bundles of reed-shaped ribbons.
//
// Each frame the script lays a smooth curve through every strand's control points and writes it into a texture;
// the vertex shader makes ribbons of it that face the eye. A groom of a few locks is drawn as a full head of hair the
// way production hair is: the simulated locks are guides, and ribbons between them are blends of a lock and its
// neighbors, nearer to their own lock towards the tip. "Full" off shows the locks alone.

const SAMPLES = 26; // places on a strand's curve
const TEXELS = 3 * SAMPLES + 1; // position + occlusion, tangent + half width, normal + share; then the neighbors
const NEIGHBOR_M = 0.05; // roots farther apart than this are no neighbors

class HairCurves {
  constructor(counts, widths, bust) {
    Object.assign(this, { counts, widths, bust });
    this.texels = new Float32Array(4 * TEXELS * counts.length);
    this.hasNeighbors = false;
    this.rootSpread = 0;
  }

  /** Notes for each strand the two whose roots are nearest; itself where there is none near enough. */
  findNeighbors(now) {
    const roots = rootsOf(this.counts, now);
    const many = roots.length > 1500; // full hair already; and the search is quadratic
    let apart = 0;
    roots.forEach((root, strand) => {
      const near = many ? [] : nearestRoots(roots, root, strand);
      if (near.length > 0) apart += norm(sub(roots[near[0]], root)) / roots.length;
      const [a, b] = [near[0] ?? strand, near[1] ?? near[0] ?? strand];
      this.texels.set([a, b, 0, 0], 4 * (TEXELS * strand + 3 * SAMPLES));
    });
    this.rootSpread = 0.75 * apart;
    this.hasNeighbors = true;
  }

  /** Fills the texture for control points `now` (flat x y z, head space). */
  fill(now) {
    if (!this.hasNeighbors) this.findNeighbors(now);
    let first = 0;
    this.counts.forEach((count, strand) => {
      this.strand(now, first, count, strand);
      first += count;
    });
    return this.texels;
  }

  strand(now, first, count, strand) {
    const { texels } = this;
    const row = 4 * TEXELS * strand;
    const half = this.widths[strand] / 2;
    let normal = null;
    for (let k = 0; k < SAMPLES; k++) {
      const share = k / (SAMPLES - 1);
      const { at, tangent } = curvePoint(now, first, count, share);
      normal = carried(normal ?? this.outward(at), tangent);
      texels.set([...at, this.openness(at), ...tangent, half, ...normal, share], row + 12 * k);
    }
  }

  /** Away from the head: where the first normal points. */
  outward(p) {
    const center = this.bust.skull?.center_m ?? [0, 0, 0];
    return sub(p, center);
  }

  /** How much light reaches hair at a place: less near the scalp, under the hair above it. */
  openness(p) {
    const skull = this.bust.skull;
    if (!skull) return 1;
    return 0.42 + 0.58 * smoothstep(-0.004, 0.055, shapeDistance(skull, p));
  }
}

/** The first control point of each strand. */
function rootsOf(counts, now) {
  let first = 0;
  return counts.map((count) => {
    const root = Array.from(now.subarray(3 * first, 3 * first + 3));
    first += count;
    return root;
  });
}

/** The two strands, other than `strand`, whose roots are nearest and near enough. */
function nearestRoots(roots, root, strand) {
  return roots
    .map((other, index) => ({ index, apart: norm(sub(other, root)) }))
    .filter(({ index, apart }) => index !== strand && apart < NEIGHBOR_M)
    .sort((a, b) => a.apart - b.apart)
    .slice(0, 2)
    .map(({ index }) => index);
}

/** Position and direction at a share of the control polygon, on a Catmull-Rom curve through its points. */
function curvePoint(now, first, count, share) {
  const place = share * (count - 1);
  const k = Math.min(Math.floor(place), count - 2);
  const s = place - k;
  const index = (i) => 3 * (first + clamp(i, 0, count - 1));
  const [i0, i1, i2, i3] = [index(k - 1), index(k), index(k + 1), index(k + 2)];
  const at = [0, 0, 0];
  const tangent = [0, 0, 0];
  for (let c = 0; c < 3; c++) {
    const p1 = now[i1 + c];
    const p2 = now[i2 + c];
    // Beyond its ends the curve goes on straight.
    const p0 = i0 === i1 ? 2 * p1 - p2 : now[i0 + c];
    const p3 = i3 === i2 ? 2 * p2 - p1 : now[i3 + c];
    const [b, d] = [2 * p0 - 5 * p1 + 4 * p2 - p3, 3 * p1 - p0 - 3 * p2 + p3];
    at[c] = p1 + 0.5 * (s * (p2 - p0) + s * s * b + s * s * s * d);
    tangent[c] = p2 - p0 + 2 * s * b + 3 * s * s * d;
  }
  return { at, tangent: unit(tangent) };
}

/** A normal carried along the curve without twisting it: what is across the new tangent. */
function carried(normal, tangent) {
  const across = sub(normal, scale(tangent, dot(normal, tangent)));
  if (norm(across) > 1e-6) return unit(across);
  return unit(cross(tangent, Math.abs(tangent[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
}

const HAIR_VERTEX = `
uniform highp sampler2D curves;
uniform int n_ribbons, n_samples;
uniform float full, spread, rootSpread, ribbonHalf, thin;
uniform mat4 camera, head;
uniform vec3 eye, toward, skullCenter, skullHalf;
#ifdef SHADED
uniform mat4 light;
uniform sampler2DShadow shadow;
#endif
out vec3 place, along, across;
out vec2 spot;
out float open, seed, arrives;

struct Curve { vec3 at; float open; vec3 along; float half_width; vec3 normal; };
Curve curve(int strand, int k) {
  vec4 p = texelFetch(curves, ivec2(3 * k, strand), 0);
  vec4 t = texelFetch(curves, ivec2(3 * k + 1, strand), 0);
  return Curve(p.xyz, p.w, t.xyz, t.w, texelFetch(curves, ivec2(3 * k + 2, strand), 0).xyz);
}

void main() {
  int strand = gl_InstanceID / n_ribbons, ribbon = gl_InstanceID - strand * n_ribbons;
  uint a = uint(strand), b = uint(ribbon);
  float share = float(gl_VertexID >> 1) / float(n_samples - 1);
  float side = float(gl_VertexID & 1) * 2.0 - 1.0;
  float reach = thin > 0.0 ? 1.0 : mix(0.82, 1.0, sqrt(random(a, b + 11u)));
  int at = int(share * reach * float(n_samples - 1) + 0.5);
  Curve c = curve(strand, at);

  if (full > 0.0) {
    ivec2 near = ivec2(texelFetch(curves, ivec2(3 * n_samples, strand), 0).xy);
    float leaving = full * (1.0 - 0.7 * share * share);
    float u = random(a, b + 91u) * 0.5 * leaving, v = random(a, b + 97u) * 0.4 * leaving;
    Curve p = curve(near.x, at), q = curve(near.y, at);
    c.at += u * (p.at - c.at) + v * (q.at - c.at);
    c.along += u * (p.along - c.along) + v * (q.along - c.along);
    c.normal += u * (p.normal - c.normal) + v * (q.normal - c.normal);
    c.open += u * (p.open - c.open) + v * (q.open - c.open);
  }
  c.along = normalize(c.along);
  c.normal = normalize(c.normal - c.along * dot(c.normal, c.along) + 1e-5);

  // A reed: narrow where it leaves the scalp, widest in the middle, pointed at the tip.
  float reed = mix(0.6, 1.0, smoothstep(0.0, 0.3, share)) * (1.0 - 0.6 * share * share);
  float leaf = reed * (1.0 - 0.85 * smoothstep(0.68, 1.0, share));
  float angle = 6.2832 * (random(a, b + 23u) + 0.35 * (random(a, 5u) - 0.5) * share);
  float away = thin > 0.0 ? 0.0 : c.half_width * spread * sqrt(random(a, b + 37u)) * reed;
  c.at += (c.normal * cos(angle) + cross(c.along, c.normal) * sin(angle)) * away;

  // The roots of full hair cover the scalp round their lock's own and gather into the lock further out.
  if (full > 0.0) {
    vec3 out_ward = normalize(c.at - skullCenter);
    float turn = 6.2832 * random(a, b + 61u);
    vec3 flat_ward = cross(out_ward, vec3(cos(turn), sin(turn), 0.3));
    c.at += flat_ward * rootSpread * sqrt(random(a, b + 67u)) * (1.0 - smoothstep(0.0, 0.5, share));
  }

  // A blend of two locks may cut through the head between them: it is laid on the scalp.
  vec3 within = (c.at - skullCenter) / (skullHalf + 0.0015 + 0.003 * random(a, b + 41u));
  float deep = length(within);
  if (deep < 1.0 && thin == 0.0) c.at = mix(c.at, skullCenter + within / deep * (skullHalf + 0.003), step(0.5, deep));

  vec4 turned = head * vec4(c.at, 1.0);
  vec3 direction = mat3(head) * c.along;
  vec3 view = toward == vec3(0.0) ? normalize(eye - turned.xyz) : toward;
  vec3 sideways = cross(direction, view);
  sideways /= max(length(sideways), 0.05);
  float width = thin > 0.0 ? thin : ribbonHalf * mix(0.6, 1.4, random(a, b + 53u)) * leaf;
#ifdef SHADED
  arrives = mix(0.2, 1.0, lit(shadow, light, turned.xyz, 0.005, 2.2 / 1024.0));
#endif
  turned.xyz += sideways * side * width;

  place = turned.xyz;
  along = direction;
  across = cross(sideways, direction);
  spot = vec2(side, share);
  open = c.open;
  seed = fract(random(a, b + 71u) + 0.37 * random(a, 3u));
  gl_Position = camera * turned;
  gl_Position.z = nearer(camera, turned, view, gl_Position.w);
}`;

// Kajiya and Kay's hair: light depends on the angle to the strand; two highlights, one white at the surface, one
// colored by the way through the hair, shifted against each other (Marschner 2003; Scheuermann 2004).
const HAIR_FRAGMENT = `
uniform vec3 eye, key, back, up, rootColor, tipColor, sky, ground;
uniform sampler2D noise;
in vec3 place, along, across;
in vec2 spot;
in float open, seed, arrives;
out vec4 color;

float highlight(float th, float power) {
  return smoothstep(-1.0, 0.0, th) * pow(max(1.0 - th * th, 1e-4), 0.5 * power);
}
void main() {
  float fine = texture(noise, vec2(spot.x * 0.012 + seed, 0.5)).r;
  float coarse = texture(noise, vec2(seed * 3.7, 0.5)).r;
  float edge = 1.0 - smoothstep(0.5, 1.0, abs(spot.x) + (fine - 0.5) * 0.6);
  if (edge < EDGE) discard;

  vec3 t = normalize(along), n = normalize(across), v = normalize(eye - place);
  vec3 base = mix(rootColor, tipColor, 0.75 * smoothstep(0.05, 1.0, spot.y) + 0.3 * coarse);
  base *= 0.6 + 0.4 * fine + 0.55 * fract(seed * 7.3);

  float tl = dot(t, key);
  float diffuse = sqrt(max(1.0 - tl * tl, 0.0));
  float wrapped = clamp(0.55 + 0.45 * dot(normalize(n + 0.35 * v), key), 0.0, 1.0);
  float shift = (fract(seed * 13.7) - 0.5) * 0.2;
  vec3 h = normalize(key + v);
  float white = 0.13 * highlight(dot(normalize(t + n * (shift - 0.08)), h), 110.0);
  vec3 tinted = base * 1.9 * highlight(dot(normalize(t + n * (shift + 0.12)), h), 16.0);
  vec3 rim = (base + 0.02) * highlight(dot(t, normalize(back + v)), 24.0) * open * open;

  vec3 ambient = mix(ground, sky, 0.5 + 0.5 * dot(n, up)) * open * open * 0.8;
  vec3 lightIn = base * ambient + (base * diffuse * wrapped * 1.15 + white + tinted) * arrives * open + rim;
  color = vec4(shown(lightIn), edge);
}`;

const HAIR_SHADOW_FRAGMENT = `
in vec2 spot;
void main() { if (abs(spot.x) > 0.8) discard; }`;

const LINE_FRAGMENT = `
uniform vec3 lineColor;
in vec2 spot;
out vec4 color;
void main() { color = vec4(shown(lineColor), 0.95 * (1.0 - smoothstep(0.6, 1.0, abs(spot.x)))); }`;
