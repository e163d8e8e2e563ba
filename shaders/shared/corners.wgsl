// Corners of triangles. Expects `points` and what pn_triangle.wgsl has.

fn corner(p: u32) -> Corner {
    return Corner(points[p].position, points[p].normal);
}

fn triangle_of(corners: vec3<u32>) -> Triangle {
    return Triangle(corner(corners.x), corner(corners.y), corner(corners.z));
}
