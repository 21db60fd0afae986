"""Stiffness of a flying web between the rigid middle sections of its crankpins, with bounds of its error.

Torsion is the torque about the crank axis over the rotation of one section relative to the other. Bending is
a couple about an axis across over the tilt that it makes about that axis: softest and stiffest one. Couples
are the same about any point, so neither depends on where the sections' centres lie.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note
from cranktopo.base.units import MPA_PER_GPA, NMM_PER_NM, density_kg_per_mm3
from cranktopo.bodies.mesh.flying_mesh import MeshedFlyingWeb, mesh_flying_web
from cranktopo.bodies.volume import bolted_mass, web_volume_mm3
from cranktopo.design.flying_web import FlyingWeb
from cranktopo.design.halves import default_element_size_mm
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.hierarchical_error import (
    DiscretisationError,
    hierarchical_estimator,
    straightened,
)
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, plane_nodes
from cranktopo.numerics.tetrahedra.solver import RESIDUAL_LIMIT
from cranktopo.numerics.tetrahedra.superelement import HeldBody, Superelement, superelement
from cranktopo.tasks.throw_fea.condense import torsion_motion, torsional_stiffness_Nm_per_rad
from cranktopo.tasks.throw_fea.error_bound import (
    BENDING_VOLUME_FACTOR,
    bound_percent,
    torsion_bound_percent,
)
from cranktopo.tasks.throw_fea.result import FlyingWebBending, FlyingWebResult, MeshSize

_VOLUME_TOLERANCE = 0.02


@dataclass(frozen=True)
class PrincipalBending:
    """Stiffness against a couple about one axis across the shaft whose tilt has the same axis.

    Attributes:
        axis_deg: of the couple, ahead of the near throw in the sense of rotation, from 0 up to 180.
        motion: of both sections under a couple of 1 N mm, (12,).
    """

    stiffness_Nm_per_rad: float
    axis_deg: float
    motion: Array


def evaluate_flying_web(web: FlyingWeb, element_size_mm: float | None = None) -> FlyingWebResult:
    """Return mass, stiffnesses and bounds of their errors of a flying web.

    Raises:
        CranktopoError: impossible geometry, no valid mesh, or a failed solve.
    """
    size = element_size_mm or min(map(default_element_size_mm, (web.near, web.far)))
    note(f"{web.name}: element size {size:.3g} mm")
    start = time.perf_counter()
    meshed = mesh_flying_web(web, size)
    youngs, poisson = web.near.material.E_GPa * MPA_PER_GPA, web.near.material.poisson
    model = assemble(meshed.mesh, youngs, poisson)
    _check_volume(web, model, meshed)
    block = condensed(model, web.length_mm)
    soft, stiff = principal_bending(block)
    missed = _missed(model, meshed, block, youngs, poisson)
    found = FlyingWebResult(
        name=web.name,
        turn_deg=web.turn_deg,
        mass_kg=_mass_kg(web),
        torsion={
            "free_Nm_per_rad": torsional_stiffness_Nm_per_rad(block, "free"),
            "held_Nm_per_rad": torsional_stiffness_Nm_per_rad(block, "held"),
        },
        bending=FlyingWebBending(
            softest_Nm_per_rad=soft.stiffness_Nm_per_rad,
            softest_axis_deg=soft.axis_deg,
            stiffest_Nm_per_rad=stiff.stiffness_Nm_per_rad,
        ),
        mesh=MeshSize(element_size_mm=meshed.element_size_mm, nodes=model.nodes_mm.shape[1]),
        error_estimate_percent={
            "torsion": max(torsion_bound_percent(block, missed, way) for way in ("free", "held")),
            "bending": max(_bending_bound_percent(one, missed) for one in (soft, stiff)),
        },
        seconds=0.0,
    )
    return found.model_copy(update={"seconds": time.perf_counter() - start})


def condensed(model: Elasticity, length_mm: float) -> Superelement:
    """Return a body condensed to the motions of its rigid sections z = 0 and z = length."""
    sections = [plane_nodes(model.nodes_mm, 2, z) for z in (0.0, length_mm)]
    held = np.unique(np.concatenate([(3 * one[:, None] + np.arange(3)).ravel() for one in sections]))
    body = HeldBody(sections, held, length_mm, 1)
    return superelement(model, body, tuple(range(6)), None, None, RESIDUAL_LIMIT)


def principal_bending(block: Superelement) -> tuple[PrincipalBending, PrincipalBending]:
    """Return bending about the axis of least stiffness and about that of largest."""
    couples = np.zeros((len(block.motions), 2))
    for column, turn in enumerate((RX, RY)):
        couples[block.index(turn, 6 + turn), column] = -1.0, 1.0
    motions = np.column_stack([torsion_motion(block, "free", force=one) for one in couples.T])
    compliance, axes = np.linalg.eigh((couples.T @ motions + motions.T @ couples) / 2)
    soft, stiff = (
        PrincipalBending(1.0 / float(compliance[k]) / NMM_PER_NM, _axis_deg(axes[:, k]), motions @ axes[:, k])
        for k in (1, 0)
    )
    return soft, stiff


def _axis_deg(axis: Array) -> float:
    """Return the angle of an axis (x, y) ahead of +y in the sense of rotation, from 0 up to 180 deg."""
    return float(np.round(np.degrees(np.arctan2(*axis)), 3)) % 180.0


def _missed(
    model: Elasticity, meshed: MeshedFlyingWeb, block: Superelement, youngs: float, poisson: float
) -> DiscretisationError:
    (surplus,) = hierarchical_estimator(model, [block], youngs, poisson, (0.0, 0.0))
    (straight,), added_mm3 = straightened(model, meshed.mesh, [block], youngs, poisson)
    left = model.volume_error(1, meshed.body.volume_mm3) - added_mm3 / model.volume_mm3
    return DiscretisationError(surplus, straight, left)


def _bending_bound_percent(bent: PrincipalBending, missed: DiscretisationError) -> float:
    per_tilt = bent.stiffness_Nm_per_rad * NMM_PER_NM
    surplus, straight = (
        float(bent.motion @ form @ bent.motion) * per_tilt for form in (missed.surplus, missed.straight)
    )
    return bound_percent(surplus, straight, missed.volume_error, BENDING_VOLUME_FACTOR)


def _mass_kg(web: FlyingWeb) -> float:
    """Return the mass of both webs between their crankpins, with what is bolted to them."""
    density = density_kg_per_mm3(web.near.material.density_kg_m3)
    return sum(density * web_volume_mm3(half) + bolted_mass(half).volume for half in (web.near, web.far))


def _check_volume(web: FlyingWeb, model: Elasticity, meshed: MeshedFlyingWeb) -> None:
    error = model.volume_error(1, meshed.body.volume_mm3)
    if abs(error) > _VOLUME_TOLERANCE:
        raise CranktopoError(
            f"{web.name}: the mesh holds {error:+.1%} of the body's volume more.",
            hint="Choose another element size.",
            code=ExitCode.SOLVER,
        )


def flying_line(found: FlyingWebResult) -> str:
    """Return what `evaluate` tells of a flying web."""
    errors, bending = found.error_estimate_percent, found.bending
    return (
        f"{found.name}, turned by {found.turn_deg:g} deg: {found.mass_kg:.3f} kg; torsion "
        f"{found.torsion['free_Nm_per_rad'] / 1000:.2f} kN m/rad, +-{errors['torsion']:.2g} %; bending "
        f"{bending.softest_Nm_per_rad / 1000:.2f} kN m/rad about {bending.softest_axis_deg:.0f} deg, "
        f"{bending.stiffest_Nm_per_rad / 1000:.2f} across, +-{errors['bending']:.2g} %; {found.seconds:.1f} s"
    )
