"""Fields of nodes at the points of faces, interpolated by the shape functions."""

import numpy as np

from cranktopo.numerics.tetrahedra.node_gradients import nodal_values


def at_faces(faces, field):
    """A field of nodes (nodes, k) at the points of faces, shape (k, faces, points)."""
    return np.einsum("neq,nek->keq", nodal_values(faces), field[faces.element_dofs])
