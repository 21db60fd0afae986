"""Webs on body-fitted elements, each on its own mesh.

A mesh of its own costs less than moving another's far; nothing is remembered from web to web.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.progress import Json
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.tasks.fea.evaluation import evaluate_on_mesh
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.shape.free_bores import kept_features
from cranktopo.tasks.shape.mesh_model import MeshModel, MeshResponses
from cranktopo.throw.manufacturing_limits import ManufacturingLimits


class MeshedWebs:
    """Webs of a throw on meshes of one element size."""

    def __init__(
        self,
        scene: Scene,
        limits: ManufacturingLimits,
        element_size_mm: float,
        fillet_fraction: float | None = None,
        shares: Mapping[str, float] | None = None,
    ) -> None:
        """Say how webs are meshed.

        Args:
            fillet_fraction: element size on a fillet over its radius; with it the fatigue safety is found.
            shares: factors by quantity that bring the numbers of the mesh to finer ones.
        """
        self.scene, self._limits, self._size = scene, limits, element_size_mm
        self._fraction, self._shares = fillet_fraction, shares or {}

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
        model = MeshModel(self.scene, web.layout, values, self._size, self._fraction)
        return model.responses(values, quantities).scaled(self._shares)


def coarse_shares(scene: Scene, element_size_mm: float, original: Mapping[str, float]) -> Json:
    """Return factors by quantity that bring the original web on a coarse mesh to a finer evaluation.

    Args:
        original: its quantities by the latter.

    Raises:
        CranktopoError: impossible geometry, or a failed solve.
    """
    target = Target(scene.name, planned_scene(scene, kept_features(scene)))
    found, supports = evaluate_on_mesh(target, element_size_mm).stiffness, scene.supports
    torsion, bending = found.torsion[supports.torsion], found.bending[supports.bending]
    assert torsion is not None
    assert bending is not None
    shares = {"torsion": original["torsion"] / torsion, "bending": original["bending"] / bending}
    return {**shares, **{f"{name}_per_mass": share for name, share in shares.items()}}
