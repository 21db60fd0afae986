"""Ten-node tetrahedra on exact solids of the throw."""
