"""Stress on the fillets of a whole throw by its unknowns, from fields of the part that is meshed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.tasks.throw_fatigue.shaft_stress import ShaftStress
from cranktopo.tasks.throw_fatigue.stress_model import Image

_ACROSS_X, _ACROSS_Z = np.array([3, 5]), np.array([4, 5])
"""Components of xx, yy, zz, xy, yz, zx that a mirror across x or z turns around."""


@dataclass(frozen=True)
class FilletRecovery:
    """Stress of a throw per unit of each of its unknowns, in its own axes, at the nodes of all its fillets.

    Nodes in a plane of mirror symmetry of the throw are there once for each side of it.

    Attributes:
        points_mm: from the near section, (nodes, 3).
        on_pin: whether the node is on a fillet of the crankpin, else on one of a journal, (nodes,).
        on_second: whether it is on the web that is nearer to the output, (nodes,).
        stress_MPa: xx, yy, zz, xy, yz, zx, (unknowns, nodes, 6).
    """

    points_mm: Array
    on_pin: NDArray[np.bool_]
    on_second: NDArray[np.bool_]
    stress_MPa: Array


def fillet_stress(throw: ShaftStress) -> FilletRecovery:
    """Return the stress of a throw with mass; `throw` as of `moving_stress`."""
    model, pitch_mm = throw.model, throw.model.scene.pitch_mm
    on = np.flatnonzero(model.on_fillet)
    points, fields = model.surface.points_mm[:, on], model.stress.stress_MPa[:, on]
    return FilletRecovery(
        np.concatenate([image.points_mm(points, pitch_mm).T for image in model.images]),
        np.tile(model.on_pin[on], len(model.images)),
        np.concatenate([model.on_second[on] ^ image.flip_z for image in model.images]),
        np.concatenate([_in_image(image, fields, throw.shares) for image in model.images], axis=1),
    )


def _in_image(image: Image, fields: Array, shares: Array) -> Array:
    """Return the stress of an image by the unknowns of the throw, (unknowns, nodes, 6)."""
    turned = np.ones(6)
    turned[_ACROSS_X] *= -1 if image.flip_x else 1
    turned[_ACROSS_Z] *= -1 if image.flip_z else 1
    return np.asarray(np.einsum("fu,fnc->unc", shares * image.signs[:, None], fields, optimize=True) * turned)
