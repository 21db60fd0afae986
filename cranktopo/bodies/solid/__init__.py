"""Exact solids of web, throw and crankshaft through gmsh's OCC kernel: STEP, STL, volumes."""
