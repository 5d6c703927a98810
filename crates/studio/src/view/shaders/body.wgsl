// The body: matte, like a mannequin.
// Data, two vectors a vertex: place and whether it stays with the torso; normal.

struct Out {
    @builtin(position) clip: vec4f,
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
};

@vertex
fn vertex(@builtin(vertex_index) k: u32) -> Out {
    let place = data[2u * k];
    let normal = data[2u * k + 1u].xyz;
    let turned = globals.head_from_torso * vec4f(place.xyz, 1.0);
    let turned_normal = (globals.head_from_torso * vec4f(normal, 0.0)).xyz;
    let at = select(place.xyz, turned.xyz, place.w > 0.5);
    return Out(globals.clip_from_head * vec4f(at, 1.0), at, select(normal, turned_normal, place.w > 0.5));
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    let n = normalize(in.normal);
    let v = to_eye(in.place);
    let key = max(dot(n, to_key_light()), 0.0);
    let sky = 0.5 + 0.5 * n.z;
    let rim = pow(1.0 - max(dot(n, v), 0.0), 3.0) * max(dot(n, to_rim_light()) + 0.3, 0.0);
    let skin = vec3f(0.36, 0.31, 0.28);
    let light = vec3f(0.05, 0.055, 0.065) + sky * vec3f(0.10, 0.105, 0.115) + key * vec3f(0.62, 0.58, 0.53);
    return vec4f(encoded(skin * light + rim * vec3f(0.10, 0.13, 0.15)), 1.0);
}
