// The picture: sums of the attribute pass divided by their weights, lit, and averaged over a pixel's subpixels.

@group(1) @binding(0) var colors: texture_2d<f32>;
@group(1) @binding(1) var normals: texture_2d<f32>;
/// 0 where nothing is seen.
@group(1) @binding(2) var depth: texture_depth_2d;

@vertex
fn everywhere(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the picture.
    return vec4(4.0 * f32(index & 1u) - 1.0, 4.0 * f32(index >> 1u) - 1.0, 0.0, 1.0);
}

@fragment
fn resolve(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
    let side = view.supersampling;
    let first = vec2<u32>(place.xy) * side;
    var sum = vec4(0.0);
    for (var i = 0u; i < side * side; i++) {
        sum += subpixel(first + vec2(i % side, i / side));
    }
    sum /= f32(side * side);
    // The sum is premultiplied; PNG wants it otherwise.
    return vec4(to_srgb(clamp(sum.rgb / max(sum.a, 1e-6), vec3(0.0), vec3(1.0))), sum.a);
}

/// Light and opacity of a subpixel, premultiplied.
fn subpixel(at: vec2<u32>) -> vec4<f32> {
    let color = textureLoad(colors, at, 0);
    if textureLoad(depth, at, 0) == 0.0 || color.a == 0.0 {
        return vec4(to_linear(view.background.rgb) * view.background.a, view.background.a);
    }
    let sum = textureLoad(normals, at, 0).xyz;
    let size = vec2<f32>(textureDimensions(colors));
    let place = (vec2<f32>(at) + 0.5) / size * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
    let ray = view.forward + place.x / view.scale.x * view.right + place.y / view.scale.y * view.up;
    // Opposite normals may cancel, but for the rounding of half floats.
    let is_left = dot(sum, sum) > 1e-5 * color.a * color.a;
    let normal = select(-view.forward, normalize(sum), is_left);
    return vec4(shade(color.rgb / color.a, normal, normalize(-ray)), 1.0);
}
