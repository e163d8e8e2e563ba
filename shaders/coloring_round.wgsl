// coloring: prepares the next round: how many workgroups it takes, for the points of the next
// range and those that wait.
// One invocation. dispatch: number of that round, most workgroups of a row.

/// Number of points that wait in even and in odd rounds.
@group(0) @binding(2) var<storage, read_write> rounds: array<u32, 2>;
/// The first point of each range of priorities and one more, then the points by range.
@group(0) @binding(3) var<storage, read> order: array<u32>;
@group(0) @binding(4) var<storage, read_write> workgroups: array<u32, 3>;

@compute @workgroup_size(64)
fn coloring_round(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x > 0u {
        return;
    }
    let parity = dispatch.x & 1u;
    rounds[1u - parity] = 0u;
    var points = rounds[parity];
    if dispatch.x < RANGES {
        points += order[dispatch.x + 1u] - order[dispatch.x];
    }
    let groups = (points + 63u) / 64u;
    workgroups[0] = min(groups, dispatch.y);
    workgroups[1] = (groups + dispatch.y - 1u) / dispatch.y;
    workgroups[2] = 1u;
}
