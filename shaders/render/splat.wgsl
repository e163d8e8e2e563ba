// A point as a disc on its tangent plane: the visibility passes and the attribute pass.
//
// A disc is drawn as the square around it. The rasteriser interpolates with perspective, so a pixel's place in the disc
// is exact and the outline is the true ellipse.
//
// Discs that turn their backs come after the others, and only where their centre is not hidden by those: around the
// outline of a closed surface they would stick out from behind it.

/// Radius of a disc for each unit of a point's radius. The discs of the visibility passes are smaller and decide what
/// is seen; those of the attribute pass overlap more, so that they blend smoothly.
override disc: f32 = 1.0;
/// Share of a disc's radius by which the visibility passes push it away from the eye: discs that overlap within this
/// depth are one surface and blend. 0 in the attribute pass.
override push: f32 = 0.0;
/// A disc whose normal turns farther from the eye than this cosine shows its back. Not 0: at the outline of a coarse
/// cloud discs lean over a little.
const BACK: f32 = -0.25;

struct Point {
    position: vec3<f32>,
    radius: f32,
    normal: vec3<f32>,
    level: u32,
}

/// What a point may have beyond the record of the engine.
struct Extra {
    /// The disc ends where the offset from its centre has a product with the first three that exceeds the fourth; zero
    /// for no end.
    ends: array<vec4<f32>, 2>,
    /// sRGB, red in the lowest byte.
    paint: u32,
    /// Bit 0 and 1 tell that an end has the normal of another disc in the same place, bit 2 and 3 the opposite.
    sides: u32,
    padding: vec2<f32>,
}

@group(0) @binding(1) var<storage, read> ramp: array<u32, 256>;
@group(1) @binding(0) var<storage, read> points: array<Point>;
/// One a point, or one alone that holds for all.
@group(1) @binding(1) var<storage, read> extras: array<Extra>;
/// Depth of the discs that show their fronts.
@group(0) @binding(2) var fronts: texture_depth_2d;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    /// Place in the disc, whose outline is the unit circle.
    @location(0) place: vec2<f32>,
    /// How far beyond both ends.
    @location(1) ends: vec2<f32>,
    @location(2) @interpolate(flat) color: vec3<f32>,
    @location(3) @interpolate(flat) normal: vec3<f32>,
}

/// Only discs that show their fronts.
@vertex
fn front(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Corner {
    if shows_back(points[instance]) {
        return nowhere();
    }
    return corner(index, instance);
}

/// Only discs that show their backs.
@vertex
fn back(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Corner {
    if !shows_back(points[instance]) || is_hidden(instance) {
        return nowhere();
    }
    return corner(index, instance);
}

@vertex
fn either(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Corner {
    if shows_back(points[instance]) && is_hidden(instance) {
        return nowhere();
    }
    return corner(index, instance);
}

fn extra_of(instance: u32) -> Extra {
    return extras[min(instance, arrayLength(&extras) - 1u)];
}

fn shows_back(point: Point) -> bool {
    // Raw points hide nothing, so half of them would.
    if view.dot_radius > 0.0 {
        return false;
    }
    let to_eye = view.eye - point.position;
    return dot(point.normal, to_eye) < BACK * length(point.normal) * length(to_eye);
}

/// Whether discs that show their fronts lie before the centre, or another side of the crease shows its front.
fn is_hidden(instance: u32) -> bool {
    let position = points[instance].position;
    let extra = extra_of(instance);
    let to_eye = view.eye - position;
    for (var i = 0u; i < 2u; i++) {
        let turned = dot(extra.ends[i].xyz, to_eye);
        let is_front = (extra.sides & (1u << i)) != 0u && turned > 0.0;
        if is_front || ((extra.sides & (4u << i)) != 0u && turned < 0.0) {
            return true;
        }
    }
    let center = project(position, 0.0);
    let size = vec2<f32>(textureDimensions(fronts));
    let place = (vec2(0.5, -0.5) * center.xy / center.w + 0.5) * size;
    if any(place < vec2(0.0)) || any(place >= size) {
        return false;
    }
    return center.z < textureLoad(fronts, vec2<u32>(place), 0) * center.w;
}

/// All corners in one place, so that nothing is drawn.
fn nowhere() -> Corner {
    return Corner(vec4(0.0, 0.0, 0.0, 1.0), vec2(0.0), vec2(0.0), vec3(0.0), vec3(0.0));
}

fn corner(index: u32, instance: u32) -> Corner {
    let point = points[instance];
    let extra = extra_of(instance);
    let distance = dot(point.position - view.eye, view.forward);
    let pixel = distance * view.pixel;
    let length = length(point.normal);
    let is_dot = view.dot_radius > 0.0 || length == 0.0 || point.radius <= 0.0;
    let normal = select(-view.forward, point.normal / length, length > 0.0);
    // Three quarters of a subpixel at least, so that a far point leaves a trace.
    let disc_radius = max(disc * view.disc_scale * point.radius, 0.75 * pixel);
    let dot_radius = max(view.dot_radius, 0.75 * f32(view.supersampling)) * pixel;
    let radius = select(disc_radius, dot_radius, is_dot);
    let along = select(tangent(normal), view.right, is_dot);
    let across = select(cross(normal, along), view.up, is_dot);
    let place = vec2(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let offset = radius * (place.x * along + place.y * across);
    let ends = vec2(beyond(offset, extra.ends[0]), beyond(offset, extra.ends[1]));

    var out: Corner;
    out.clip = project(point.position + offset, select(push * radius, 0.0, is_dot));
    out.place = place;
    out.ends = select(ends, vec2(0.0), is_dot);
    out.color = color(point, normal, extra.paint);
    out.normal = normal;
    if shows_back(point) {
        out.normal = -normal;
        if view.coloring != NORMAL {
            out.color = vec3(0.75, 0.12, 0.03);
        }
    }
    return out;
}

fn beyond(offset: vec3<f32>, end: vec4<f32>) -> f32 {
    return dot(offset, end.xyz) - end.w;
}

/// A unit vector at right angles to `n`.
fn tangent(n: vec3<f32>) -> vec3<f32> {
    let helper = select(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), abs(n.x) > 0.7);
    return normalize(cross(helper, n));
}

/// Clip coordinates with depth near / distance, after the point was pushed away from the eye along its ray.
fn project(position: vec3<f32>, pushed: f32) -> vec4<f32> {
    let ray = position - view.eye;
    let distance = dot(ray, view.forward);
    let far = distance * (1.0 + pushed / length(ray));
    let x = dot(ray, view.right) * view.scale.x;
    let y = dot(ray, view.up) * view.scale.y;
    return vec4(x, y, view.near * distance / far, distance);
}

fn color(point: Point, normal: vec3<f32>, paint: u32) -> vec3<f32> {
    switch view.coloring {
        case PAINT, DATA: {
            return to_linear(unpack4x8unorm(paint).rgb);
        }
        case NORMAL: {
            return to_linear(0.5 + 0.5 * normal);
        }
        case RADIUS: {
            return ramp_color(point.radius);
        }
        case LEVEL: {
            return ramp_color(f32(point.level & 0xffu));
        }
        default: {
            return vec3(0.62, 0.59, 0.55);
        }
    }
}

fn ramp_color(value: f32) -> vec3<f32> {
    let t = clamp((value - view.ramp_low) * view.ramp_inverse, 0.0, 1.0);
    return to_linear(unpack4x8unorm(ramp[u32(255.0 * t + 0.5)]).rgb);
}

fn is_outside(corner: Corner) -> bool {
    return dot(corner.place, corner.place) > 1.0 || max(corner.ends.x, corner.ends.y) > 0.0;
}

@fragment
fn visibility(corner: Corner) {
    if is_outside(corner) {
        discard;
    }
}

struct Sums {
    /// Weighted colour, and the weight.
    @location(0) color: vec4<f32>,
    @location(1) normal: vec4<f32>,
}

@fragment
fn attributes(corner: Corner) -> Sums {
    if is_outside(corner) {
        discard;
    }
    let inside = 1.0 - dot(corner.place, corner.place);
    // Fades towards the outline, so that discs blend without a seam, but never to nothing.
    let weight = 0.01 + inside * inside;
    return Sums(weight * vec4(corner.color, 1.0), weight * vec4(corner.normal, 0.0));
}
