"""Exact derivatives by the dimensions of a rod of what elements find, by an adjoint solve for each unit load.

Safeties are those of `smooth_extremes`, so that the slopes are those of all nodes near the worst one. The
mesh moves with the dimensions, the loads change with the masses, and each load stays closed. Pressures of
rigid pins that touch are held.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, get_args

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.notes import at_work
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.design.rod import EYES, Eye
from cranktopo.engine.rod_forces import RodMotion
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.node_gradients import moments, sums_of_work_slopes
from cranktopo.tasks.fatigue.criteria import criterion
from cranktopo.tasks.fatigue.criterion import Judge, LocalStress, larger_end_MPa
from cranktopo.tasks.fatigue.smooth_extremes import JudgedSurface, least_safety
from cranktopo.tasks.fatigue.superposition import SIGNED, TENSOR
from cranktopo.tasks.rod.element_stress import (
    PLACES,
    ElementStress,
    cycle_states,
    image_cycles,
    place_of,
)
from cranktopo.tasks.rod.elements import diameter_rows, eye_shapes
from cranktopo.tasks.rod.faces import moved_rod
from cranktopo.tasks.rod.lighter import resized
from cranktopo.tasks.rod.unit_fields import RodFields
from cranktopo.tasks.rod.unit_loads import PRESSED, SHAPING, RodLoads, copies, is_quarter, rod_material

Kind = Literal["yield_safety", "fatigue_safety", "margin of ovalisation"]
"""Safeties are of a place, the margin is of a bore."""
KINDS: tuple[Kind, ...] = get_args(Kind)
SAFETIES: tuple[Kind, ...] = KINDS[:2]
MARGIN: Kind = KINDS[2]
Quantity = tuple[str, Kind]
"""A place or bore, and what is judged of it."""
_STEP_MM = 1e-4
"""Step of central differences of masses and press fit by dimensions."""
_RESIDUAL = 1e-3
"""Accepted of adjoint solves, which aim at a hundredth of it."""


@dataclass(frozen=True)
class _Sensitivity:
    """Derivatives of the logarithm of a quantity.

    Attributes:
        by_fields: displacements of the unit loads, (fields, unknowns).
        by_nodes: (3, nodes), displacements held.
        by_loads: parameters through the loads, (parameters,), displacements held.
    """

    by_fields: Array
    by_nodes: Array
    by_loads: Array


class RodGradients:
    """A rod that elements have judged, and how what they found changes with its dimensions."""

    def __init__(
        self, stress: ElementStress, motions: Sequence[RodMotion], method: str, names: Sequence[str]
    ) -> None:
        """Find how the mesh and the loads move with dimensions of some names.

        Raises:
            CranktopoError: part of the rod's surface is none of its faces.
        """
        self._stress, self._fields = stress, stress.fields
        model, scene = self._fields.model, self._fields.scene
        mesh = TetMesh(model.mesh.doflocs, model.mesh.dofs.element_dofs, is_quarter(model))
        self.moved = moved_rod(mesh, scene, names)
        self._names, self._motion = tuple(names), self.moved.velocities(self.moved.mesh, self.moved.values)
        self._unit = replace(stress.unit, at_once=0)  # stresses in elements are taken often
        self._states = cycle_states(self._fields, motions)
        self._load_slopes = self._slopes_of_loads(motions)
        self._judges: dict[Kind, Judge] = {
            "yield_safety": partial(_yield_safety, rod_material(scene).yield_MPa or np.nan),
            "fatigue_safety": lambda local: criterion(method).point_safety(scene, local).safety,
        }

    @at_work("slopes of the rod")
    def of(self, quantities: Collection[Quantity]) -> dict[Quantity, Array]:
        """Return the derivatives of the logarithms of some quantities by the dimensions, (names,), 1/mm."""
        found: dict[Quantity, _Sensitivity] = {}
        for place in dict.fromkeys(name for name, kind in quantities if kind in SAFETIES):
            kinds = [kind for name, kind in quantities if name == place and kind in SAFETIES]
            found |= {(place, kind): self._of_safety(place, kind) for kind in kinds}
        for eye in EYES:
            if (key := (f"{eye} end", MARGIN)) in quantities:
                found[key] = self._of_margin(eye)
        slopes = self._by_dimensions(list(found.values()))
        return dict(zip(found, slopes, strict=True))

    def _slopes_of_loads(self, motions: Sequence[RodMotion]) -> Array:
        """Derivatives of the states by the dimensions, (names, states, fields)."""
        inertia = self._slopes_of_inertia()
        found = []
        for unit, slope in zip(np.eye(len(self._names)), inertia, strict=True):
            ahead, back = (
                cycle_states(self._beside(sign * _STEP_MM, unit, slope), motions) for sign in (1.0, -1.0)
            )
            found.append((ahead - back) / (2 * _STEP_MM))
        return np.stack(found)

    def _beside(self, step_mm: float, unit: Array, inertia_slope: Array) -> RodFields:
        """The fields' loads with other dimensions, displacements as they are."""
        small, big = np.array(self._fields.inertia_kg) + step_mm * inertia_slope
        scene = resized(self._fields.scene, self._names, self.moved.values + step_mm * unit)
        return replace(self._fields, scene=scene, inertia_kg=(float(small), float(big)))

    def _slopes_of_inertia(self) -> Array:
        """Derivatives of the masses that each end's acceleration moves, (names, 2), kg/mm."""
        model = self._fields.model
        _, slopes = moments(model)
        volume, first_y = np.einsum("kin,inp->kp", slopes[:2], self._motion)
        density = copies(model) * density_kg_per_mm3(rod_material(self._fields.scene).density_kg_m3)
        small = first_y / self._fields.length_mm
        return density * np.stack([small, volume - small], axis=1)

    def _of_safety(self, place: str, kind: Kind) -> _Sensitivity:
        smooth = least_safety(self._surface_of(place, kind), lambda _: self._judges[kind])
        by_stress, by_depth = (one / smooth.value for one in smooth.adjoint)
        return _Sensitivity(*self._unit.adjoint((by_stress, by_depth)), smooth.by_loads / smooth.value)

    def _surface_of(self, place: str, kind: Kind) -> JudgedSurface:
        stress = self._stress
        at = place_of(self._fields, stress.surface.points_mm)
        nodes = np.flatnonzero(stress.judged & (at == PLACES.index(place)))
        states, slopes = image_cycles(self._states), image_cycles(self._load_slopes)
        measure = TENSOR if kind == "fatigue_safety" else SIGNED
        return JudgedSurface(self._unit.stress, states, nodes, slopes, measure)

    def _of_margin(self, eye: Eye) -> _Sensitivity:
        """Of the load that changes a bore most, of those that a limit is for; its bore stands still."""
        fields, loads = self._fields, self._states
        shapes = eye_shapes(fields, loads)
        own = [k for k, shape in enumerate(shapes) if shape.eye == f"{eye} end" and shape.permitted_um]
        number = max(own, key=lambda k: shapes[k].ovalisation_um)
        assert PRESSED[number][0] == eye
        state, rows = int(loads[:, number].argmax()), diameter_rows(fields, eye)
        factors = np.where(SHAPING, loads[state], 0.0)
        changes = rows @ (factors @ fields.displacement_mm)
        row, change = rows[np.abs(changes).argmax()], changes[np.abs(changes).argmax()]
        moved = self._load_slopes[:, state] * SHAPING
        return _Sensitivity(
            -factors[:, None] * row / change,
            np.zeros(fields.model.nodes_mm.shape),
            -moved @ (fields.displacement_mm @ row) / change,
        )

    def _by_dimensions(self, found: list[_Sensitivity]) -> list[Array]:
        """Bring derivatives back to the dimensions: what stresses, loads and stiffness change by."""
        if not found:
            return []
        fields, model = self._fields, self._fields.model
        by_nodes = np.stack([one.by_nodes for one in found])
        loads, first = RodLoads(fields.scene, model, fields.pressures), 0
        for group in loads.groups():
            which = slice(first, first := first + group.forces.shape[1])
            forces = np.concatenate([one.by_fields[which] for one in found]).T
            solved = model.equations.solver(group.held, _RESIDUAL)(np.ascontiguousarray(forces))
            adjoints = solved.T.reshape(len(found), -1, len(solved))
            by_nodes -= sums_of_work_slopes(model, *fields.elastic, fields.displacement_mm[which], adjoints)
            by_nodes += np.stack([loads.gradients(group, one.T) for one in adjoints])
        return list(
            np.einsum("kin,inp->kp", by_nodes, self._motion) + np.stack([one.by_loads for one in found])
        )


def _yield_safety(yield_MPa: float, local: LocalStress) -> Array:
    return np.asarray(yield_MPa / larger_end_MPa(local.amplitude_MPa, local.mean_MPa))
