"""The half throw as a body: exact solid, prisms, cells, tetrahedra, volume."""
