// What every shader shares. All in head space, meters; colors are linear until `encoded`.

struct Globals {
    clip_from_head: mat4x4f,
    head_from_torso: mat4x4f,
    eye: vec4f,
    right: vec4f,
    up: vec4f,
    forward: vec4f,
    // Width and height of the picture, pixels; 0; 0.
    size: vec4f,
    // Samples a strand; hairs a strand (0 for ribbons); 0; 0.
    hair: vec4f,
};

@group(0) @binding(0) var<uniform> globals: Globals;
@group(0) @binding(1) var<storage, read> data: array<vec4f>;

// The key light stands over the camera's left shoulder, so that what is looked at is lit.
fn to_key_light() -> vec3f {
    return normalize(globals.up.xyz * 0.75 - globals.right.xyz * 0.6 - globals.forward.xyz * 0.65);
}

// A weaker one behind, for the rim.
fn to_rim_light() -> vec3f {
    return normalize(globals.up.xyz * 0.5 + globals.right.xyz * 0.8 + globals.forward.xyz * 0.55);
}

fn to_eye(place: vec3f) -> vec3f {
    return normalize(globals.eye.xyz - place);
}

// How large a pixel is at a place, m.
fn pixel_at(place: vec3f) -> f32 {
    let depth = max(dot(place - globals.eye.xyz, globals.forward.xyz), 0.01);
    // Half the height of the view is tan(0.2 rad) at depth 1.
    return 2.0 * 0.20271 * depth / globals.size.y;
}

// The picture's texture holds gamma values: egui takes it as it is.
fn encoded(linear: vec3f) -> vec3f {
    let c = clamp(linear, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c < vec3f(0.0031308));
}

fn hash(n: u32) -> f32 {
    // PCG (O'Neill 2014), one round.
    let state = n * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return f32((word >> 22u) ^ word) / 4294967296.0;
}
