// A slice through the field, half transparent.
// Data, two vectors a vertex: place; color and opacity, gamma encoded.

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) color: vec4f,
};

@vertex
fn vertex(@builtin(vertex_index) k: u32) -> Out {
    return Out(globals.clip_from_head * vec4f(data[2u * k].xyz, 1.0), data[2u * k + 1u]);
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    return in.color;
}
