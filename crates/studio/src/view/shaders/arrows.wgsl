// Arrows of the wind, flat and facing the camera.
// Data, three vectors an arrow: its middle; from tail to head; color, gamma encoded.

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) color: vec4f,
};

// Shaft: two triangles. Head: one. Along the arrow 0 to 1, across it in half widths of the head.
const CORNERS = array<vec2f, 9>(
    vec2f(0.0, -0.3), vec2f(0.6, -0.3), vec2f(0.6, 0.3),
    vec2f(0.0, -0.3), vec2f(0.6, 0.3), vec2f(0.0, 0.3),
    vec2f(0.55, -1.0), vec2f(1.0, 0.0), vec2f(0.55, 1.0),
);

@vertex
fn vertex(@builtin(vertex_index) k: u32, @builtin(instance_index) arrow: u32) -> Out {
    let middle = data[3u * arrow].xyz;
    let vector = data[3u * arrow + 1u].xyz;
    let length_m = length(vector);
    let along = vector / max(length_m, 1e-6);
    let side = normalize(cross(along, to_eye(middle)) + vec3f(1e-6, 0.0, 0.0));
    let half = clamp(0.13 * length_m, 0.9 * pixel_at(middle), 0.0032);
    let corner = CORNERS[k];
    let at = middle + vector * (corner.x - 0.5) + side * corner.y * half;
    return Out(globals.clip_from_head * vec4f(at, 1.0), data[3u * arrow + 2u]);
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    return in.color;
}
