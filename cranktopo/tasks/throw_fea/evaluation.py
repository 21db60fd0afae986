"""Evaluation of one throw: mass properties, stiffness for every support, and bounds of their errors."""

from __future__ import annotations

import time
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from cranktopo.base.notes import note
from cranktopo.base.side_by_side import LazyFuture
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.memory import check_element_size
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, mesh_throw
from cranktopo.bodies.volume import bolted_mass, web_volume_mm3
from cranktopo.design.assumed import EVALUATED, Assumption, filter_by_table
from cranktopo.design.balance_factor import balance_factor_percent
from cranktopo.design.halves import default_element_size_mm, halves, of_halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.mesh import RATIO
from cranktopo.tasks.throw_fea.result import (
    ErrorsBySupport,
    EvaluatedMass,
    EvaluationResult,
    EvaluationSeconds,
    FlyingWebResult,
    MeshSize,
    StiffnessPerMass,
    SupportNames,
    known,
)
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.throw.moments import Moments

if TYPE_CHECKING:
    from cranktopo.numerics.tetrahedra.elasticity import Order
    from cranktopo.tasks.throw_fea.throw_stiffness import Stiffness

SCHEMA_VERSION = 1


@dataclass(frozen=True)
class Evaluation:
    """All that is reported about one target; units in the field names.

    Attributes:
        second_web_kg: mass of the second web where the halves of the throw differ, else None.
        balance_factor_percent: of the oscillating mass, what the throw balances; None without any.
        unbalance_kg_mm: mass times y of the centre of mass.
        assumed: what the design does not say and the stiffnesses depend on.
        triangles: the body is a surface of triangles, which the mesh replaces.
        flying_webs: each distinct one of the crank that the throw is of.
    """

    target: str
    throw_kg: float
    web_kg: float
    inertia_kg_mm2: float
    unbalance_kg_mm: float
    fine: Stiffness
    torsion_support: str
    bending_support: str
    torsion_error_percent: float
    bending_error_percent: float
    total_seconds: float
    assumed: tuple[Assumption, ...] = ()
    triangles: bool = False
    second_web_kg: float | None = None
    balance_factor_percent: float | None = None
    flying_webs: tuple[FlyingWebResult, ...] = ()

    @property
    def torsion_Nm_per_rad(self) -> float:
        """Torsional stiffness with the scene's support."""
        return known(self.fine.torsion[self.torsion_support])

    @property
    def bending_N_per_mm(self) -> float:
        """Bending stiffness with the scene's support."""
        return known(self.fine.bending[self.bending_support])

    @property
    def error_percent(self) -> float:
        """The larger of the two error estimates."""
        return max(self.torsion_error_percent, self.bending_error_percent)

    @property
    def result(self) -> EvaluationResult:
        """The evaluation as one entry of `evaluate --json`."""
        fine, kg = self.fine, self.throw_kg
        return EvaluationResult(
            target=self.target,
            mass_kg=EvaluatedMass(throw=kg, web=self.web_kg, second_web=self.second_web_kg),
            inertia_kg_mm2=self.inertia_kg_mm2,
            unbalance_kg_mm=self.unbalance_kg_mm,
            balance_factor_percent=self.balance_factor_percent,
            torsion={f"{name}_Nm_per_rad": value for name, value in fine.torsion.items()},
            bending={f"{name}_N_per_mm": value for name, value in fine.bending.items()},
            supports=SupportNames(torsion=self.torsion_support, bending=self.bending_support),
            stiffness_per_mass=StiffnessPerMass(
                torsion_Nm_per_rad_kg=self.torsion_Nm_per_rad / kg,
                bending_N_per_mm_kg=self.bending_N_per_mm / kg,
            ),
            mesh=MeshSize(element_size_mm=fine.element_size_mm, nodes=fine.nodes, triangles=self.triangles),
            error_estimate_percent={
                "torsion": self.torsion_error_percent,
                "bending": self.bending_error_percent,
            },
            error_by_support_percent=ErrorsBySupport(
                torsion=dict(fine.torsion_error_percent), bending=dict(fine.bending_error_percent)
            ),
            seconds=EvaluationSeconds(
                mesh=fine.mesh_seconds, solve=fine.solve_seconds, total=self.total_seconds
            ),
            assumed=self.assumed,
            flying_webs=self.flying_webs or None,
        )


@dataclass(frozen=True)
class MeshResult:
    """A target on one mesh."""

    target: Target
    meshed: MeshedThrow
    stiffness: Stiffness
    graded: bool = True

    @property
    def seconds(self) -> float:
        """Wall time of mesh and solve."""
        return self.stiffness.mesh_seconds + self.stiffness.solve_seconds


def evaluate(target: Target, element_size_mm: float | None = None) -> Evaluation:
    """Evaluate a target on a mesh of the given size.

    Triangles are remeshed, which moves their surface: a mesh 1.5 times coarser tells how much that matters.

    Raises:
        CranktopoError: impossible geometry or a failed solve.
    """
    size = element_size_mm or default_element_size_mm(target.scene)
    check_element_size(target.scene, size)
    coarse = evaluate_on_mesh(target, size * RATIO) if target.triangles else None
    fine = evaluate_on_mesh(target, size)
    return evaluation(fine, coarse, fine.seconds + (coarse.seconds if coarse else 0.0))


def evaluate_on_mesh(
    target: Target,
    element_size_mm: float,
    *,
    graded: bool = True,
    order: Order = 2,
) -> MeshResult:
    """Return a target on one mesh; `graded` refines at fillets and sharp rings, and always in surface files.

    Raises:
        CranktopoError: impossible geometry or a failed solve.
    """
    check_element_size(target.scene, element_size_mm)
    note(f"{target.name}: element size {element_size_mm:.3g} mm")
    LazyFuture(_get_ready).begin()
    start = time.perf_counter()
    meshed = mesh_target(target, element_size_mm, graded)
    if meshed.note:
        note(f"{target.name}: {meshed.note}")
    from cranktopo.tasks.throw_fea.throw_stiffness import condensed_stiffness

    seconds, size = time.perf_counter() - start, meshed.element_size_mm or element_size_mm
    stiffness = condensed_stiffness(meshed, target.scene, size, seconds, order)
    return MeshResult(target, meshed, stiffness, graded)


def _get_ready() -> None:
    """Load and compile what the solve needs, SciPy's sparse matrices first, beside the native mesher."""
    from cranktopo.numerics.tetrahedra.solver import get_ready

    get_ready()
    import_module("cranktopo.tasks.throw_fea.throw_stiffness")


def mesh_target(target: Target, element_size_mm: float, graded: bool = True) -> MeshedThrow:
    """Return the mesh of a target's half throw, or of its whole one where the halves differ.

    Raises:
        CranktopoError: impossible geometry, or no valid mesh.
    """
    if target.file is None:
        return mesh_throw(target.scene, element_size_mm, graded=graded)
    from cranktopo.tasks.importing.imported_body import mesh_file

    return mesh_file(target.file, target.scene, element_size_mm, target.align, own=target.run is not None)


def evaluation(fine: MeshResult, coarse: MeshResult | None, seconds: float) -> Evaluation:
    """Return all that is reported; of triangles `coarse` is the target on a mesh 1.5 times coarser."""
    target, meshed = fine.target, fine.meshed
    scene = target.scene
    (near, far), supports = halves(scene), scene.supports
    density = density_kg_per_mm3(scene.material.density_kg_m3)
    unbalance = (
        meshed.copies * density * meshed.body.volume_mm3 * meshed.body.centre_mm[1] + _bolted(scene).first_y
    )
    torsion, bending = _error_percent(fine.stiffness, coarse.stiffness if coarse else None, scene)
    return Evaluation(
        target=target.name,
        throw_kg=meshed_throw_kg(meshed, scene),
        web_kg=density * meshed.web_volume_mm3 + bolted_mass(near).volume,
        second_web_kg=None if far is near else density * web_volume_mm3(far) + bolted_mass(far).volume,
        inertia_kg_mm2=throw_inertia_kg_mm2(meshed, scene),
        unbalance_kg_mm=unbalance,
        balance_factor_percent=balance_factor_percent(scene, unbalance),
        fine=fine.stiffness,
        torsion_support=supports.torsion,
        bending_support=supports.bending,
        torsion_error_percent=torsion,
        bending_error_percent=bending,
        total_seconds=seconds,
        assumed=filter_by_table(target.assumed, EVALUATED),
        triangles=target.triangles,
    )


def _error_percent(fine: Stiffness, coarse: Stiffness | None, scene: Scene) -> tuple[float, float]:
    torsion = known(fine.torsion_error_percent[scene.supports.torsion])
    bending = known(fine.bending_error_percent[scene.supports.bending])
    if coarse is None:
        return torsion, bending
    from cranktopo.tasks.throw_fea.error_bound import change_bound_percent

    return (
        max(torsion, change_bound_percent(coarse.torsion, fine.torsion)),
        max(bending, change_bound_percent(coarse.bending, fine.bending)),
    )


def meshed_throw_kg(meshed: MeshedThrow, scene: Scene) -> float:
    """Return the mass of the whole throw from the exact volume, bolted counterweights counted."""
    density = density_kg_per_mm3(scene.material.density_kg_m3)
    return meshed.copies * density * meshed.body.volume_mm3 + _bolted(scene).volume


def throw_inertia_kg_mm2(meshed: MeshedThrow, scene: Scene) -> float:
    """Return the inertia of the whole throw about the crank axis."""
    density = density_kg_per_mm3(scene.material.density_kg_m3)
    return meshed.copies * density * meshed.body.inertia_z_mm5 + _bolted(scene).polar


def _bolted(scene: Scene) -> Moments:
    one, other = of_halves(scene, bolted_mass)
    return one + other
