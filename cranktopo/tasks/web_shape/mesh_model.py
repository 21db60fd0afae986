"""Webs on body-fitted elements: evaluation, and quantities on a mesh that moves, with exact gradients.

The elements stay the same while the parameters change, so that a search sees none of the noise of new
meshes; the gradients are those of these very numbers. A stiffness needs no adjoint solve: its compliance is a
minimum of energy, so that with the displacements held its derivative is that of the energy, and the supports
are algebra on the condensed matrices.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA, density_kg_per_mm3
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, mesh_throw
from cranktopo.design.balance_factor import balance_factor_percent, rods_kg_mm
from cranktopo.design.goal.quantities import quantity_named
from cranktopo.design.halves import require_equal_halves
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import Loads
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.node_gradients import mean_slopes, moments, work_slopes
from cranktopo.numerics.tetrahedra.rigid_motions import RZ, section_slopes
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.refit.family import Layout, exact_web_of, scene_at
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.throw_fea.condense import (
    Lateral,
    bending_motion,
    bending_stiffness_N_per_mm,
    condense,
    torsion_motion,
    torsional_stiffness_Nm_per_rad,
)
from cranktopo.tasks.throw_fea.unit_fields import support_spring, unit_force
from cranktopo.tasks.web_shape.bearing_films import film_slopes, limits_films
from cranktopo.tasks.web_shape.carried import Fastened, carried_at
from cranktopo.tasks.web_shape.mesh_stress import MeshStress
from cranktopo.tasks.web_shape.search_goal import Quantities
from cranktopo.tasks.web_shape.shaft_frequency import NAME, frequency_of, needed_for, slope_of
from cranktopo.tasks.web_shape.web_faces import moved_web
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

_RESIDUAL = 1e-4
"""Accepted in a search: errors far below those of its mesh; solves aim at a hundredth of it.

On 41,562 to 61,716 unknowns it changes stiffnesses by 2e-10, stress and safety by 7e-7, all slopes of one of
these together by 1.3e-5, and a small one alone by 1e-3 at most.
"""
_ByNodes = dict[str, tuple[float, Array]]
"""Quantities by name with their derivatives by the nodes, (3, nodes)."""


class MeshResponses(Quantities):
    """Quantities of a web on a body-fitted mesh and their gradients by its parameters.

    Torsion N m/rad, bending N/mm, mass kg, inertia kg mm2, unbalance kg mm, and both stiffnesses per mass;
    fatigue_safety and stress, MPa, where they are wanted: smooth, and the extreme one for the first web asked
    for.
    """

    def scaled(self, shares: Mapping[str, float]) -> MeshResponses:
        """Return the same with every quantity times its share, by default 1."""
        return MeshResponses(
            {name: shares.get(name, 1.0) * value for name, value in self.values.items()},
            {name: shares.get(name, 1.0) * slope for name, slope in self.gradients.items()},
        )

    def calibrated(self, truth: Mapping[str, float]) -> MeshResponses:
        """Return the same with the values of a truth; slopes in proportion, but not of what may be 0."""
        both = self.values.keys() & truth.keys()
        signed = {name for name in both if quantity_named(name).signed}
        found = self.scaled({name: truth[name] / self.values[name] for name in both - signed})
        return MeshResponses(found.values | {name: truth[name] for name in signed}, found.gradients)


class MeshModel:
    """A web of a layout on one mesh, as functions of its parameters."""

    def __init__(
        self,
        scene: Scene,
        layout: Layout,
        values: Array,
        element_size_mm: float,
        fillet_fraction: float | None = None,
        stressed: Collection[str] = ("fatigue_safety",),
        loads: Loads = "extremes",
    ) -> None:
        """Mesh the web with these values.

        Args:
            fillet_fraction: element size on a fillet over its radius; with it stresses are found.
            stressed: quantities to be read off them.
            loads: over which load states these are found.
        """
        require_equal_halves(scene)
        sized = scene_at(scene, layout, values)
        self.scene = scene_with_web(sized, exact_web_of(layout, values, sized))
        meshed = mesh_throw(self.scene, element_size_mm, fillet_fraction=fillet_fraction)
        self._layout = layout
        self.moved = moved_web(meshed.mesh, self.scene, layout, values)
        self._parts = 2 if meshed.mesh.mirrored else 1
        self._unmoved = self._model(self.moved.mesh)
        self._missing = _exact(meshed) - self._parts * moments(self._unmoved)[0]
        self._stress = None if fillet_fraction is None else MeshStress(self.scene, stressed, loads)
        self._smoothing: dict[str, float] = {}

    def responses(self, values: Array, quantities: Collection[str] | None = None) -> MeshResponses:
        """Return the wanted quantities of the web with these values, by default all, and their gradients.

        Masses are always there, stresses where the mesh was made for them.

        Raises:
            CranktopoError: the mesh folds, or a failed solve.
        """
        mesh = self.moved.at(values)
        model = self._unmoved if mesh is self.moved.mesh else self._model(mesh)
        carried = carried_at(self.scene, self._layout, values)
        scene = scene_at(self.scene, self._layout, values)
        solved, by_totals = self._solved(model, scene, carried.scene, mesh.mirrored, quantities)
        masses, beside = self._masses(model, carried)
        found = masses | solved
        beside |= {name: slopes @ carried.total_slopes for name, slopes in by_totals.items()}
        motion = self.moved.velocities(mesh, values)
        numbers = {name: value for name, (value, _) in found.items()}
        gradients = {name: np.einsum("in,inp->p", slope, motion) for name, (_, slope) in found.items()}
        gradients |= {name: gradients[name] + slope for name, slope in beside.items()}
        for name in [name for name in ("torsion", "bending") if name in found]:
            ratio = numbers[name] / numbers["mass"]
            numbers[f"{name}_per_mass"] = ratio
            gradients[f"{name}_per_mass"] = (gradients[name] - ratio * gradients["mass"]) / numbers["mass"]
        if shaft := frequency_of(self.scene, numbers):
            numbers[NAME], gradients[NAME] = shaft.frequency_Hz, slope_of(shaft, gradients)
        if quantities is None and limits_films(self.scene):
            films, slopes = film_slopes(self.scene, self._layout, values)
            numbers, gradients = numbers | films, gradients | slopes
        return MeshResponses(numbers, gradients)

    def _solved(
        self,
        model: Elasticity,
        scene: Scene,
        carried: Scene,
        mirrored: bool,
        quantities: Collection[str] | None,
    ) -> tuple[_ByNodes, dict[str, Array]]:
        """Return what solves give, and the derivatives of stresses by `pull_totals`."""
        found: _ByNodes = {}
        by_totals: dict[str, Array] = {}
        stress = self._stress
        if stress is not None and quantities is not None and not {*stress.names} & {*quantities}:
            stress = None

        def block(kind: str) -> Superelement | None:
            counts = quantities is None or {kind, f"{kind}_per_mass"} & needed_for(quantities)
            wanted = stress or counts
            return self._condensed(model, scene, carried, kind, mirrored) if wanted else None

        sideways = mirrored and stress is not None and bool(stress.extra_loads("odd"))
        twist, (bend, side) = side_by_side(
            lambda: block("torsion"),
            lambda: (block("bending"), block("tangential") if sideways else None),
        )
        if twist:
            found["torsion"] = _torsion_gradient(model, scene, twist)
        if bend:
            found["bending"] = _bending_gradient(model, scene, bend)
        if stress and twist and bend:
            stresses = stress.responses(model, scene, bend, twist, side, carried=carried)
            for name, (extreme, smooth, gradients, slopes) in stresses.items():
                factor = self._smoothing.setdefault(name, extreme / smooth)
                found[name], by_totals[name] = (factor * smooth, factor * gradients), factor * slopes
        return found, by_totals

    def _condensed(
        self, model: Elasticity, scene: Scene, carried: Scene, kind: str, mirrored: bool
    ) -> Superelement:
        if kind == "torsion":
            return condense(model, scene, "antisymmetric", "odd" if mirrored else "none", None, _RESIDUAL)
        lateral: Lateral = ("odd" if kind == "tangential" else "even") if mirrored else "none"
        extra_loads = self._stress.extra_loads(lateral) if self._stress else ()
        scenes = {load: carried if load == "centrifugal" else self.scene for load in extra_loads}
        forces = [unit_force(model, of, load, "symmetric", lateral) for load, of in scenes.items()]
        more = np.column_stack(forces) if forces else None
        return condense(model, scene, "symmetric", lateral, more, _RESIDUAL)

    def _model(self, mesh: TetMesh) -> Elasticity:
        material = self.scene.material
        return assemble(mesh, material.E_GPa * MPA_PER_GPA, material.poisson)

    def _masses(self, model: Elasticity, carried: Fastened) -> tuple[_ByNodes, dict[str, Array]]:
        """Return mass, inertia and unbalance of the throw and gradients, exact where the mesh was made.

        With the gradients by the parameters of what is fastened to the webs.
        """
        kg, names = (
            2 * density_kg_per_mm3(self.scene.material.density_kg_m3),
            ("mass", "unbalance", "inertia"),
        )
        integrals, gradients = moments(model)
        found = kg * (self._parts * integrals + self._missing) + 2 * carried.masses
        pairs = zip(found.tolist(), kg * self._parts * gradients, strict=True)
        masses = dict(zip(names, pairs, strict=True))
        beside = dict(zip(names, 2 * carried.mass_slopes, strict=True))
        unbalance, slope = masses["unbalance"]
        factor, (_, oscillating) = balance_factor_percent(self.scene, unbalance), rods_kg_mm(self.scene)
        if factor is not None:
            masses["balance_factor"] = factor, -100 / oscillating * slope
            beside["balance_factor"] = -100 / oscillating * beside["unbalance"]
        return masses, beside


def _exact(meshed: MeshedThrow) -> Array:
    """Return the volume of the half throw, its moment in y and that of x2 + y2, from the exact solid."""
    half = meshed.body
    return np.array([half.volume_mm3, half.volume_mm3 * half.centre_mm[1], half.inertia_z_mm5])


def _torsion_gradient(model: Elasticity, scene: Scene, block: Superelement) -> tuple[float, Array]:
    """Return the torsional stiffness, N m/rad, and its derivative by the nodes, by antisymmetry."""
    support = scene.supports.torsion
    spring = support_spring(scene, support)
    value = torsional_stiffness_Nm_per_rad(block, support, spring)
    motion = torsion_motion(block, support, spring)
    field = block.displacement[:, : len(motion)] @ motion
    twist = float(motion[block.motions.index(RZ)])
    return value, value / twist * block.parts * _work(model, scene, field)


def _bending_gradient(model: Elasticity, scene: Scene, block: Superelement) -> tuple[float, Array]:
    """Return the bending stiffness, N/mm, and its derivative by the nodes, by symmetry."""
    support = scene.supports.bending
    spring = support_spring(scene, support)
    value = bending_stiffness_N_per_mm(block, support, spring)
    motion = bending_motion(block, block.load, support, spring)
    count = len(motion)
    field = block.displacement[:, :count] @ motion + block.displacement[:, count] / block.parts
    sunk = -2 * mean_slopes(model, 1, scene.web_z_mm[1], field) - block.parts * _work(model, scene, field)
    return value, -(value**2) / 2 * sunk


def _work(model: Elasticity, scene: Scene, field: Array) -> Array:
    """Return the derivative of field' K field by the nodes, the section moving rigidly as it does."""
    inner = work_slopes(model, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson, field, field)
    return inner + 2 * section_slopes(model, model.stiffness @ field, field)


class MeshedWebs:
    """Webs of a throw on meshes of one element size."""

    def __init__(
        self,
        scene: Scene,
        limits: ManufacturingLimits,
        element_size_mm: float,
        fillet_fraction: float | None = None,
        shares: Mapping[str, float] | None = None,
        stressed: Collection[str] = ("fatigue_safety",),
        loads: Loads = "extremes",
    ) -> None:
        """Take what `MeshModel` takes, and factors by quantity that bring its numbers to finer ones."""
        self.scene, self._limits, self._size = scene, limits, element_size_mm
        self._fraction, self._shares = fillet_fraction, shares or {}
        self._stressed, self._loads = stressed, loads

    def web(self, layout: Layout) -> ParametricWeb:
        """Return a web of the layout, for its bounds and manufacturing constraints."""
        return ParametricWeb(layout, self.scene, self._limits, (np.zeros(0),) * 3)

    def responses(
        self, web: ParametricWeb, values: Array, quantities: Collection[str] | None = None
    ) -> MeshResponses:
        """Return quantities of a web with these values, by default all, and their gradients.

        Raises:
            CranktopoError: no sound web, no valid mesh, or a failed solve.
        """
        stresses = self._fraction, self._stressed, self._loads
        model = MeshModel(self.scene, web.layout, values, self._size, *stresses)
        return model.responses(values, quantities).scaled(self._shares)
