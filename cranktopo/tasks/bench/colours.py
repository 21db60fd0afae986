"""Colours of a settled web: used strength, largest stress, and what it costs to take material off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import KG_PER_TONNE, MPA_PER_GPA, NMM_PER_NM, density_tonne_per_mm3
from cranktopo.numerics.tetrahedra.stress import strain_energy_density
from cranktopo.tasks.fatigue.criterion import larger_end_MPa
from cranktopo.tasks.throw_fatigue.largest_stress import largest_of_field_MPa
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.stress_model import StressModel
from cranktopo.tasks.throw_fea.unit_fields import FieldKind

_STIFFNESSES: dict[FieldKind, float] = {"torsion": NMM_PER_NM, "bending": 1.0}
"""Gauges of stiffness over that of the unit load of their field, N mm/rad and N/mm."""
_MOST_COST = 3.0
"""Removal that costs more has the last colour."""


@dataclass(frozen=True)
class Colour:
    """Set of colours: the value of the last one, and a sentence for the legend."""

    name: str
    label: str
    top: float


@dataclass(frozen=True)
class WebColours:
    """Values at the surface nodes of a throw's model.

    Attributes:
        values: of each case and mirror image of the model, shape (cases, images, n).
    """

    model: StressModel
    cases: Sequence[Colour]
    values: Array
    element_size_mm: float = 1.0

    def at(self, points_mm: Array) -> Array:
        """Return the values at the nearest surface node of a half throw, (cases, points)."""
        from scipy.spatial import cKDTree

        model, way = self.model, points_mm.copy()
        mirrored = any(image.flip_x for image in model.images)
        if mirrored:
            way[:, 0] = np.abs(way[:, 0])
        nearest = cKDTree(model.surface.points_mm.T).query(way)[1]
        found = np.zeros((len(self.cases), len(points_mm)))
        for flipped in {image.flip_x for image in model.images}:
            images = [number for number, image in enumerate(model.images) if image.flip_x == flipped]
            side = (points_mm[:, 0] < 0) == flipped if mirrored else slice(None)
            found[:, side] = self.values[:, images].max(axis=1)[:, nearest][:, side]
        return found


def web_colours(field: FatigueField, stiffness: Mapping[str, float]) -> WebColours:
    """Return the colours of a web whose fatigue safety is known.

    Args:
        stiffness: "torsion", N m/rad, and "bending", N/mm, of the whole throw, as far as they are known.
    """
    model, critical = field.model, field.critical
    used, stress = 1 / field.safety, larger_end_MPa(field.amplitude_MPa, field.mean_MPa)
    top = largest_of_field_MPa(field)
    least = f"share of the fatigue strength that is used; the last is the least safety, {critical.safety:.3f}"
    coloured = [
        (Colour("safety", least, 1 / critical.safety), used),
        (Colour("stress", f"largest von Mises stress of all load states, 0 to {top:.0f} MPa", top), stress),
    ]
    for name in (name for name in _STIFFNESSES if name in model.kinds and name in stiffness):
        cost = np.broadcast_to(removal_cost(model, name, stiffness[name]), used.shape)
        coloured.append((Colour(name, _of_removal(name), _MOST_COST), cost))
    return WebColours(model, [colour for colour, _ in coloured], np.stack([values for _, values in coloured]))


def removal_cost(model: StressModel, kind: FieldKind, stiffness: float) -> Array:
    """Return the share of a stiffness that goes with a layer at surface nodes, over its share of the mass.

    Below 1 the throw gets stiffer per mass where the layer is taken off. It is the energy density there over
    the mean of the whole throw: dk/k = -2 w k dV under a unit load (derivative of the compliance by shape).

    Args:
        stiffness: of the throw, N m/rad of "torsion", N/mm of "bending".
    """
    material = model.scene.material
    unit = model.stress.stress_MPa[model.kinds.index(kind)]
    energy = strain_energy_density(unit, material.E_GPa * MPA_PER_GPA, material.poisson)
    volume_mm3 = model.throw_kg / KG_PER_TONNE / density_tonne_per_mm3(material.density_kg_m3)
    return 2 * energy * stiffness * _STIFFNESSES[kind] * volume_mm3


def _of_removal(name: FieldKind) -> str:
    return (
        f"percent of the stiffness in {name} lost for each percent of mass taken off there, "
        f"0 to {_MOST_COST:g}; below 1 the web gets stiffer per mass"
    )
