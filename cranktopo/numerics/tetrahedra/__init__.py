"""Linear elasticity on ten-node tetrahedra: meshes, assembly, solves, stresses."""
