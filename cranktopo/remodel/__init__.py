"""Exact solids: the throw of a scene as an OCC body through gmsh, its checks, its mesh, STEP and STL."""
