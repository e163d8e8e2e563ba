// selection: links each candidate to those before it whose discard sphere (eq. 11) holds it.
// Twin: `overlaps` in crates/reference/src/selection.rs
// One invocation per candidate, which looks for those in its own sphere. The order of the links is that of
// timing; nothing depends on it.

@group(0) @binding(2) var<storage, read> points: array<Point>;
/// All but their state is read.
@group(0) @binding(3) var<storage, read_write> candidates: array<Candidate>;
@group(0) @binding(4) var<storage, read> grid: array<u32>;
@group(0) @binding(5) var<storage, read> places: array<vec4<u32>>;
/// One more than the first link of each candidate; 0 for none.
@group(0) @binding(6) var<storage, read_write> heads: array<atomic<u32>>;
/// The candidate that discards, and one more than the next link.
@group(0) @binding(7) var<storage, read_write> links: array<vec2<u32>>;
@group(0) @binding(8) var<storage, read_write> counters: Counters;
@group(0) @binding(9) var<storage, read> curves: array<u32>;

/// Candidates that are listed at once, of those in a sphere: most spheres hold no more.
const MOST: u32 = 8u;
var<private> inside: array<u32, MOST>;

@compute @workgroup_size(64)
fn selection_overlaps(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let h = linear_index(id, groups);
    if h >= params.candidates {
        return;
    }
    let place = candidates[h].place;
    if place.w <= 0.0 {
        return;
    }
    if h < params.triangles {
        candidates[h].state = WAITING;
    }
    let sphere = params.lambda2 * candidates[h].size;
    // Most find themselves alone: to count costs less than to list.
    if count_within(place.xyz, sphere) > 1u {
        add_links(h, sphere);
    }
    note_cut_loops(candidates[h].corners.x);
}

/// Links the others in the sphere. Some of them are listed, then looked at, and so on: branches that neighbouring
/// candidates take differently cost more.
fn add_links(h: u32, sphere: f32) {
    let center = Seen(candidates[h].place.xyz, candidates[h].normal, record_of_candidate(h));
    let near_curves = is_near_curves(center.position, sphere);
    var walk = ball_walk(center.position, sphere);
    var entries = vec2(0u);
    var goes_on = true;
    while goes_on {
        var size = 0u;
        while size < MOST && goes_on {
            if entries.x < entries.y {
                let entry = places[entries.x];
                let d = bitcast<vec3<f32>>(entry.xyz) - center.position;
                inside[size] = entry.w;
                size += u32(dot3(d, d) < sphere * sphere);
                entries.x += 1u;
            } else if is_over(walk) {
                goes_on = false;
            } else {
                entries = next_entries(&walk);
            }
        }
        var kept = 0u;
        for (var i = 0u; i < size; i++) {
            let x = inside[i];
            inside[kept] = x;
            kept += u32(precedes(h, x) && same_side(center.normal, candidates[x].normal));
        }
        if with_curves {
            kept = keep_seen(center, near_curves, sphere, kept);
        }
        for (var i = 0u; i < kept; i++) {
            add_link(inside[i], h);
        }
    }
}

/// Keeps the listed candidates on the same sheet as the centre, and returns how many are left.
fn keep_seen(center: Seen, near_curves: bool, sphere: f32, size: u32) -> u32 {
    var meets_curves = near_curves | center.record != NONE;
    for (var i = 0u; i < size; i++) {
        meets_curves |= record_of_candidate(inside[i]) != NONE;
    }
    if !meets_curves {
        return size;
    }
    var seen = 0u;
    for (var i = 0u; i < size; i++) {
        let x = inside[i];
        let other = Seen(candidates[x].place.xyz, candidates[x].normal, record_of_candidate(x));
        inside[seen] = x;
        seen += u32(sees(center, near_curves, sphere, other));
    }
    return seen;
}

fn add_link(x: u32, h: u32) {
    let link = new_link();
    if link != NONE {
        links[link] = vec2(h, atomicExchange(&heads[x], link + 1u));
    }
}

fn curve_word(at: u32) -> u32 {
    return curves[at];
}
