"""Stiffnesses of a throw on one mesh and their derivatives by its nodes.

A stiffness needs no adjoint solve: its compliance is a minimum of energy, so that with the displacements held
its derivative is that of the energy, and the supports are algebra on the condensed matrices.
"""

from __future__ import annotations

from cranktopo.base.arrays import Array
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity
from cranktopo.tasks.fea.condense import RZ, Superelement
from cranktopo.tasks.fea.node_gradients import mean_slopes, section_slopes, work_slopes
from cranktopo.tasks.fea.support_stiffness import (
    bending_motion,
    bending_stiffness_N_per_mm,
    torsion_motion,
    torsional_stiffness_Nm_per_rad,
)
from cranktopo.tasks.fea.unit_fields import support_spring


def torsion_slopes(model: Elasticity, scene: Scene, block: Superelement) -> tuple[float, Array]:
    """Torsional stiffness, N m/rad, with the scene's support, and its derivative by the nodes, (3, nodes).

    Args:
        block: antisymmetric condensation.
    """
    support = scene.supports.torsion
    spring = support_spring(scene, support)
    value = torsional_stiffness_Nm_per_rad(block, support, spring)
    motion = torsion_motion(block, support, spring)
    field = block.displacement[:, : len(motion)] @ motion
    twist = float(motion[block.motions.index(RZ)])
    return value, value / twist * block.parts * _work(model, scene, field)


def bending_slopes(model: Elasticity, scene: Scene, block: Superelement) -> tuple[float, Array]:
    """Bending stiffness, N/mm, with the scene's support, and its derivative by the nodes, (3, nodes).

    Args:
        block: symmetric condensation.
    """
    support = scene.supports.bending
    spring = support_spring(scene, support)
    value = bending_stiffness_N_per_mm(block, support, spring)
    motion = bending_motion(block, block.load, support, spring)
    count = len(motion)
    field = block.displacement[:, :count] @ motion + block.displacement[:, count] / block.parts
    sunk = -2 * mean_slopes(model, 1, scene.web_z_mm[1], field) - block.parts * _work(model, scene, field)
    return value, -(value**2) / 2 * sunk


def _work(model: Elasticity, scene: Scene, field: Array) -> Array:
    """Derivative of field' K field by the nodes, the section moving rigidly as it does."""
    inner = work_slopes(model, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson, field, field)
    return inner + 2 * section_slopes(model, model.stiffness @ field, field)
