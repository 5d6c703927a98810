// A wall that is a little lighter in the middle.

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) at: vec2f,
};

@vertex
fn vertex(@builtin(vertex_index) k: u32) -> Out {
    let at = vec2f(f32((k << 1u) & 2u), f32(k & 2u)) * 2.0 - 1.0;
    return Out(vec4f(at, 1.0, 1.0), at);
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    let aspect = globals.size.x / globals.size.y;
    let far = length(vec2f(in.at.x * aspect * 0.75, in.at.y - 0.15));
    let light = mix(0.034, 0.009, smoothstep(0.0, 1.7, far));
    return vec4f(encoded(vec3f(light * 0.95, light, light * 1.1)), 1.0);
}
