"""Meshes a cloud by ball pivoting and subdivides the mesh: what gallery.sh holds against the refinement (Figure 8).

Usage: butterfly.py CLOUD.ply MESH.ply   (needs the package pymeshlab)
"""

import sys

import pymeshlab

LEVELS = 4

meshes = pymeshlab.MeshSet()
meshes.load_new_mesh(sys.argv[1])
meshes.generate_surface_reconstruction_ball_pivoting()
meshes.meshing_close_holes()
meshes.meshing_remove_unreferenced_vertices()
meshes.meshing_surface_subdivision_butterfly(
    iterations=LEVELS,
    # A threshold of nothing splits every edge; closing the holes has left their faces selected.
    threshold=pymeshlab.PureValue(0),
    selected=False,
)
mesh = meshes.current_mesh()
# Without the radii of the cloud: those that fit the mesh are made of its edges.
mesh = pymeshlab.Mesh(vertex_matrix=mesh.vertex_matrix(), face_matrix=mesh.face_matrix())
meshes.add_mesh(mesh)
meshes.save_current_mesh(sys.argv[2])
