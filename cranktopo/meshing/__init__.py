"""Ten-node tetrahedra on exact solids and in closed surfaces."""
