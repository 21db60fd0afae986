"""Concentration factors of oil bore outlets from finite elements, whatever way the bore leans.

Source: IACS UR M53, Appendix VI, as in Lloyd's Register, Guidance Notes for the Calculation of Stress
Concentration Factors (July 2021), chapter 4: the largest principal stress of all nodes of the outlet over the
nominal stress of the crankpin, in pure bending and in pure torsion. The plane of bending holds the outlet
here, because the rule's nominal stress is that at the outlet.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.stress import principal_stresses, von_mises
from cranktopo.tasks.throw_fatigue.fillets import at_outlet
from cranktopo.tasks.throw_fatigue.mesh_quality import MeshChecks
from cranktopo.tasks.throw_fatigue.stress_model import NEAR_PEAK, StressModel, normal_stress
from cranktopo.tasks.throw_fea.unit_fields import FieldKind
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.outlet import DrillOutlet

_IN_PLANE = 1e-6
"""Sine of the angle of an outlet about the pin below which it lies in the plane of the crank."""


@dataclass(frozen=True)
class OutletFactors:
    """Concentration factors of an outlet from elements, and the checks of the mesh at their peaks."""

    gamma_bending: float
    gamma_torsion: float
    checks: MeshChecks


def off_plane(outlet: DrillOutlet) -> bool:
    """Tell whether an outlet lies off the plane of the crank, so that its bending has a part across it."""
    return abs(float(outlet.normal[0])) > _IN_PLANE


def element_outlet_factors(model: StressModel, bore: DrillBore, outlet: DrillOutlet) -> OutletFactors:
    """Return the factors of an outlet on the crankpin.

    Args:
        model: on the rule's mesh, with the bore in its first half, and with the fields "moment" and
            "torsion", and "side_moment" for outlets off the plane of the crank.
    """
    if any(image.flip_x for image in model.images) and outlet.point_mm[0] < 0:
        outlet = outlet.mirrored()  # which the model of one side has
    near = at_outlet(bore, outlet, model.surface.points_mm) & ~model.on_fillet
    pin = model.scene.throw.crankpin
    modulus = math.pi / 32 * (pin.outer_diameter_mm**4 - pin.bore_diameter_mm**4) / pin.outer_diameter_mm
    bending, of_bending = _peak(model, near, *_bending(model, outlet))
    torsion, of_torsion = _peak(model, near, *_field(model, "torsion"))
    checks = MeshChecks(
        max(of_bending.normal_percent, of_torsion.normal_percent),
        max(of_bending.jump_percent, of_torsion.jump_percent),
    )
    return OutletFactors(modulus * bending, 2 * modulus * torsion, checks)


def _bending(model: StressModel, outlet: DrillOutlet) -> tuple[Array, Array]:
    """Stress, and at most its jump, under a unit moment whose plane holds the outlet.

    A moment about +x pulls along the throw, one about -y across it.
    """
    aside, along, _ = (float(v) for v in outlet.normal)
    stress, jump = _field(model, "moment")
    stress, jump = along * stress, abs(along) * jump
    if off_plane(outlet):
        more, more_jump = _field(model, "side_moment")
        return stress - aside * more, jump + abs(aside) * more_jump
    return stress, jump


def _field(model: StressModel, kind: FieldKind) -> tuple[Array, Array]:
    index = model.kinds.index(kind)
    return model.stress.stress_MPa[index], model.stress.jump_MPa[index]


def _peak(
    model: StressModel, near: NDArray[np.bool_], stress: Array, jump: Array
) -> tuple[float, MeshChecks]:
    """Return the largest principal stress of some nodes, and the mesh checks around it."""
    size = np.where(near, np.abs(principal_stresses(stress)).max(axis=-1), 0.0)
    where = size >= NEAR_PEAK * size.max()
    normal = np.abs(normal_stress(stress, model.surface.normals))[where] / size[where]
    departs = jump[where] / von_mises(stress)[where]
    return float(size.max()), MeshChecks(100 * float(normal.max()), 100 * float(departs.max()))
