// Hair, lit as Kajiya and Kay (1989) light it: by the angle between the light and the strand.
// Data, two vectors a sample: place and half the lock's width; outward normal and tint (0 plain, 1 chosen, 2 hovered).
// An instance is a whole lock (ribbons) or one hair of it (lines): a strip of two vertices a sample.

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) place: vec3f,
    @location(1) tangent: vec3f,
    @location(2) normal: vec3f,
    // Across the strip, -1 to 1; along it, 0 to 1; chance; tint.
    @location(3) across: vec4f,
};

fn sample_at(first: u32, s: f32) -> array<vec4f, 2> {
    let last = u32(globals.hair.x) - 1u;
    let x = clamp(s, 0.0, 1.0) * f32(last);
    let k = min(u32(x), last - 1u);
    let f = x - f32(k);
    let at = 2u * (first + k);
    return array<vec4f, 2>(mix(data[at], data[at + 2u], f), mix(data[at + 1u], data[at + 3u], f));
}

fn tangent_at(first: u32, s: f32) -> vec3f {
    let h = 1.0 / (globals.hair.x - 1.0);
    let a = sample_at(first, s - h);
    let b = sample_at(first, s + h);
    return normalize(b[0].xyz - a[0].xyz + vec3f(0.0, 0.0, -1e-7));
}

@vertex
fn vertex(@builtin(vertex_index) v: u32, @builtin(instance_index) instance: u32) -> Out {
    let n_samples = u32(globals.hair.x);
    let n_hairs = u32(globals.hair.y);
    let is_line = n_hairs > 0u;
    let strand = instance / max(n_hairs, 1u);
    let side = select(-1.0, 1.0, (v & 1u) == 1u);
    let along = f32(v >> 1u) / f32(n_samples - 1u);
    let chance = hash(instance * 3u + 1u);
    // Hairs of a lock are not all of one length.
    let s = along * select(1.0, 0.86 + 0.14 * hash(instance * 3u + 2u), is_line);
    let first = strand * n_samples;
    let here = sample_at(first, s);
    let tangent = tangent_at(first, s);
    let outward = normalize(here[1].xyz);
    let wide = normalize(cross(tangent, outward));
    // Locks gather at the root and at the tip.
    let belly = mix(0.55, 1.0, smoothstep(0.0, 0.25, s)) * mix(1.0, 0.22, smoothstep(0.45, 1.0, s));
    let half = here[0].w * belly;
    var place = here[0].xyz;
    var normal = outward;
    var width = half;
    if (is_line) {
        let angle = 6.2832 * hash(instance * 3u + 7u);
        let radius = sqrt(hash(instance * 3u + 11u));
        let wave = 0.10 * sin(9.0 * s + 6.2832 * chance);
        let u = cos(angle) * radius + wave;
        let w = sin(angle) * radius;
        place += (wide * u + outward * w * 0.6) * half * 1.5;
        normal = normalize(outward * (0.6 + 0.5 * w) + wide * u * 0.8);
        width = max(0.00022, 0.62 * pixel_at(place)) * mix(1.0, 0.45, smoothstep(0.8, 1.0, along));
    } else {
        width = max(half, 0.8 * pixel_at(place));
    }
    let flat_side = normalize(cross(tangent, to_eye(place)) + vec3f(1e-7, 0.0, 0.0));
    let at = place + flat_side * side * width;
    let clip = globals.clip_from_head * vec4f(at, 1.0);
    return Out(clip, at, tangent, normal, vec4f(side, s, chance, here[1].w));
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    let is_line = globals.hair.y > 0.0;
    let t = normalize(in.tangent);
    let v = to_eye(in.place);
    var n = normalize(in.normal);
    var streak = in.across.z;
    if (!is_line) {
        // A ribbon is shaded as the round bundle it stands for, with streaks along it.
        let wide = normalize(cross(t, v));
        n = normalize(v * sqrt(max(1.0 - in.across.x * in.across.x, 0.05)) + wide * in.across.x + n * 0.5);
        let lane = floor((in.across.x * 0.5 + 0.5) * 11.0);
        streak = hash(u32(lane) + u32(in.across.z * 4096.0) * 17u);
    }
    let l = to_key_light();
    // The lobe is shifted towards the root, by another amount for each hair: scales lie on it like tiles.
    let shifted = normalize(t + n * (0.10 + 0.22 * (streak - 0.5)));
    let h = normalize(l + v);
    let th = dot(shifted, h);
    let spec = pow(max(1.0 - th * th, 0.0), 60.0);
    let glow = pow(max(1.0 - th * th, 0.0), 9.0);
    let tl = dot(t, l);
    let lit = sqrt(max(1.0 - tl * tl, 0.0));
    // Hair shades hair: what faces away from the light, and what is near the root, gets less.
    let facing = clamp(0.35 + 0.65 * dot(n, l), 0.08, 1.0);
    let depth = mix(0.45, 1.0, smoothstep(0.0, 0.45, in.across.y));
    var base = mix(vec3f(0.075, 0.037, 0.018), vec3f(0.27, 0.155, 0.078), streak);
    base = mix(base, vec3f(0.03, 0.55, 0.58) + 0.25 * streak, 0.9 * f32(in.across.w > 0.5 && in.across.w < 1.5));
    base = base * select(1.0, 1.9, in.across.w > 1.5);
    let rl = dot(t, to_rim_light());
    let rim = pow(sqrt(max(1.0 - rl * rl, 0.0)), 4.0) * pow(1.0 - abs(dot(n, v)), 2.0);
    var color = base * (0.16 + 0.95 * lit * facing * depth);
    color += base * glow * 0.9 * facing * depth + vec3f(0.30, 0.27, 0.23) * spec * facing * depth * 0.55;
    color += base * rim * 0.7;
    return vec4f(encoded(color), 1.0);
}
