"""Unit stresses on the surface of a throw, solved once: for fatigue, concentration factors and pictures."""

from __future__ import annotations

import time
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import Pace
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, serves_polynomials
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.fitted_stress import fitted_stress
from cranktopo.numerics.tetrahedra.sharp_edges import near_sharp_edges
from cranktopo.numerics.tetrahedra.solver import get_ready
from cranktopo.numerics.tetrahedra.stress import (
    Surface,
    SurfaceStress,
    principal_stresses,
    von_mises,
)
from cranktopo.numerics.tetrahedra.unit_stress import UnitStress
from cranktopo.tasks.throw_fatigue.fillets import (
    cut_outlet_nodes,
    on_either_half,
    on_fillets,
    outlet_nodes,
    rounded_outlet_nodes,
)
from cranktopo.tasks.throw_fatigue.mesh_quality import Quality
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION, longest_edge_of, mesh_for_stress
from cranktopo.tasks.throw_fea.evaluation import meshed_throw_kg
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import FieldKind, UnitField, unit_fields

_RESIDUAL = 1e-4
"""Accepted of the unit loads; solves aim at a hundredth of it, which changes the safety by 5e-7."""
NEAR_PEAK = 0.98
"""Fraction of the largest stress from which a node counts as the place where the rule checks the mesh."""


@dataclass(frozen=True)
class Image:
    """One mirror image of the model that makes up the throw.

    Attributes:
        flip_x, flip_z: whether it is mirrored in x = 0, and in the mid-pin plane.
        signs: of each field, shape (fields,).
    """

    flip_x: bool
    flip_z: bool
    signs: Array

    def points_mm(self, points_mm: Array, pitch_mm: float) -> Array:
        """Points of the model moved into the image, (3, n).

        Args:
            points_mm: points (3, n) of the model.
        """
        x, y, z = points_mm
        return np.stack([-x if self.flip_x else x, y, pitch_mm - z if self.flip_z else z])


@dataclass(frozen=True)
class StressModel:
    """Stresses of unit loads on the surface of the half throw, or of its half x >= 0.

    Of a throw whose halves differ it is the whole one, with the fillets of both webs.

    Attributes:
        stress: of each field per unit load.
        on_journal, on_pin: which surface nodes lie on the fillets, shape (n,).
        whole: the model is the whole throw.
        fitted: stresses on fillets and outlets are those of polynomials, else means over elements.
    """

    name: str
    scene: Scene
    throw_kg: float
    kinds: tuple[FieldKind, ...]
    surface: Surface
    stress: SurfaceStress
    images: tuple[Image, ...]
    on_journal: NDArray[np.bool_]
    on_pin: NDArray[np.bool_]
    quality: Quality
    whole: bool = False
    fitted: bool = False

    @property
    def on_second(self) -> NDArray[np.bool_]:
        """Tell of each surface node whether it is beyond the middle of the crankpin."""
        return self.surface.points_mm[2] > halves(self.scene)[0].pitch_mm / 2

    @cached_property
    def judged(self) -> NDArray[np.bool_]:
        """Surface nodes whose stress is that of the shaft: none at sharp inner edges or cut outlets, (n,)."""
        return ~(self.sharp | self.at_cut)

    @cached_property
    def sharp(self) -> NDArray[np.bool_]:
        """Mask of the surface nodes at sharp inner edges, where the mesh decides the stress."""
        return ~self.on_fillet & near_sharp_edges(self.surface)

    @cached_property
    def at_cut(self) -> NDArray[np.bool_]:
        """Mask of the surface nodes at outlets across a section where the model ends, which is held rigid."""
        return ~self.on_fillet & on_either_half(
            self.scene, self.whole, cut_outlet_nodes, self.surface.points_mm
        )

    @property
    def parts(self) -> dict[str, NDArray[np.bool_]]:
        """Surface nodes of the "pin" and "journal" fillets, and "elsewhere" all else that is judged."""
        elsewhere = self.judged & ~self.on_fillet
        return {"pin": self.on_pin, "journal": self.on_journal, "elsewhere": elsewhere}

    @cached_property
    def at_outlet(self) -> NDArray[np.bool_]:
        """Mask of the surface nodes at an outlet of an oil bore, off the fillets."""
        return ~self.on_fillet & on_either_half(self.scene, self.whole, outlet_nodes, self.surface.points_mm)

    @property
    def judged_outlet(self) -> NDArray[np.bool_]:
        """Surface nodes at an outlet of an oil bore whose stress is no matter of the mesh, (n,)."""
        return self.at_outlet & self.judged

    @property
    def on_fillet(self) -> NDArray[np.bool_]:
        """Tell of each surface node whether it lies on either fillet."""
        return self.on_journal | self.on_pin


_STEPS = ("a mesh that follows the fillets", "unit loads", "stresses on the surface")


def solve_stresses(
    target: Target,
    kinds: Collection[FieldKind],
    fillet_fraction: float = RULE_FRACTION,
    *,
    by_rule: bool = False,
    meshed: MeshedThrow | None = None,
) -> StressModel:
    """Mesh a throw for stresses and solve the unit loads that are asked for.

    Args:
        fillet_fraction: element size in the fillets over their radius.
        by_rule: means over the elements at a node on a regular mesh, whose quality IACS UR M53 asks for; else
            fitted polynomials, where the elements are fine enough for them.
        meshed: of a target without a file, where its mesh is there.

    Raises:
        CranktopoError: a surface file, a fillet of radius 0, or a failed mesh or solve.
    """
    get_ready()
    start = time.perf_counter()
    pace = Pace(f"{target.name}: stresses", len(_STEPS))
    pace.begin(_STEPS[0])
    if meshed is None:
        meshed, scene = mesh_for_stress(target, fillet_fraction, by_rule=by_rule)
    else:
        scene = target.scene
    pace.begin(_STEPS[1])
    began_solving = time.perf_counter()
    model = assemble(
        meshed.mesh, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson, earlier=meshed.earlier
    )
    fields = unit_fields(model, scene, meshed.mesh.mirrored, kinds, whole=meshed.whole, residual=_RESIDUAL)
    pace.begin(_STEPS[2])
    found = stress_model(target.name, scene, meshed, model, fields, fillet_fraction, by_rule=by_rule)
    mesh_s, solve_s = began_solving - start, time.perf_counter() - began_solving
    return replace(found, quality=replace(found.quality, mesh_seconds=mesh_s, solve_seconds=solve_s))


def stress_model(
    name: str,
    scene: Scene,
    meshed: MeshedThrow,
    model: Elasticity,
    fields: Sequence[UnitField],
    fillet_fraction: float,
    *,
    by_rule: bool = False,
) -> StressModel:
    """Return the stresses of displacement fields on the surface of a throw, without the times that they took.

    Raises:
        CranktopoError: no node on the fillets.
    """
    elastic = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    moved = np.stack([f.displacement_mm for f in fields])
    end = scene.pitch_mm if meshed.whole else scene.pitch_mm / 2
    planes = [(2, 0.0), (2, end)] + ([(0, 0.0)] if meshed.mesh.mirrored else [])
    found = UnitStress(model, moved, elastic, tuple(planes))
    surface, stress = found.surface, found.stress
    journal, pin = on_fillets(scene, meshed.whole, surface.points_mm)
    fitted = serves_polynomials(fillet_fraction) and not by_rule
    if fitted:
        on = journal | pin | on_either_half(scene, meshed.whole, rounded_outlet_nodes, surface.points_mm)
        stress.stress_MPa[:, on], stress.depth_MPa_per_mm[:, on] = fitted_stress(
            model, surface, on, moved, elastic
        )
    at_fillets = [
        index for index, field in enumerate(fields) if field.kind != "side_moment"
    ]  # no factor there
    judged = SurfaceStress(
        stress.stress_MPa[at_fillets], stress.depth_MPa_per_mm[at_fillets], stress.jump_MPa[at_fillets]
    )
    return StressModel(
        name,
        scene,
        meshed_throw_kg(meshed, scene),
        tuple(f.kind for f in fields),
        surface,
        stress,
        images_of(fields, meshed.mesh.mirrored, whole=meshed.whole),
        journal,
        pin,
        _quality(scene, surface, judged, (journal, pin), fillet_fraction, model.nodes_mm.shape[1]),
        meshed.whole,
        fitted,
    )


def images_of(fields: Sequence[UnitField], mirrored: bool, *, whole: bool = False) -> tuple[Image, ...]:
    """Return the mirror images of the model that make up the throw; a whole one has none along the shaft."""
    sign_x = np.array([f.sign_x for f in fields], dtype=float)
    sign_z = np.array([f.sign_z for f in fields], dtype=float)
    one = np.ones(len(fields))
    return tuple(
        Image(x, z, (sign_x if x else one) * (sign_z if z else one))
        for z in ((False,) if whole else (False, True))
        for x in ((False, True) if mirrored else (False,))
    )


def _quality(
    scene: Scene,
    surface: Surface,
    stress: SurfaceStress,
    fillets: tuple[NDArray[np.bool_], NDArray[np.bool_]],
    fraction: float,
    nodes: int,
) -> Quality:
    on = fillets[0] | fillets[1]
    if not on.any():
        raise CranktopoError(
            "mesh: no nodes on the fillets.", hint="Report this design.", code=ExitCode.INTERNAL
        )
    equivalent = von_mises(stress.stress_MPa)
    where = _examined(equivalent, fillets)
    examined, node = stress.stress_MPa[where], np.nonzero(where)[1]
    normal = np.abs(normal_stress(examined, surface.normals[node]))
    largest = np.abs(principal_stresses(examined)).max(axis=-1)
    radii = tuple(journal.fillet.least_radius_mm for journal, _ in scene.throw.journals)
    return Quality(
        fraction * min(radii),
        longest_edge_of(scene, surface.points_mm, surface.faces[:3], fillets),
        nodes,
        float(100 * (normal / largest).max()),
        float(100 * (stress.jump_MPa / equivalent)[where].max()),
        0.0,
        0.0,
    )


def _examined(stress: Array, fillets: tuple[NDArray[np.bool_], NDArray[np.bool_]]) -> NDArray[np.bool_]:
    """Nodes near the peak of each field in each fillet, shape (fields, n)."""
    where = np.zeros(stress.shape, dtype=bool)
    for on in fillets:
        inside = np.where(on, stress, 0.0)
        where |= inside >= NEAR_PEAK * inside.max(axis=1, keepdims=True)
    return where


def normal_stress(stress: Array, normals: Array) -> Array:
    """Return the stress on the surface's own plane, normal to it, (..., n) of (..., n, 6)."""
    x, y, z = normals.T
    weights = np.stack([x * x, y * y, z * z, 2 * x * y, 2 * y * z, 2 * z * x], axis=1)
    return np.asarray((stress * weights).sum(axis=-1))
