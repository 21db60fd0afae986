"""Webs on coarse body-fitted elements, each on its own mesh, as shares of the original web on such a mesh.

A mesh of its own costs less than moving another's far; nothing is remembered from web to web.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from cranktopo.effects import planned_scene
from cranktopo.evaluate.evaluation import evaluate_on_mesh
from cranktopo.evaluate.targets import Target
from cranktopo.remodel.family import Layout
from cranktopo.remodel.manufacturing_limits import ManufacturingLimits
from cranktopo.remodel.parametric_web import ParametricWeb
from cranktopo.scene import Scene
from cranktopo.shape.free_bores import kept_features
from cranktopo.shape.mesh_model import MeshModel, MeshResponses
from cranktopo.shape.meshed_webs import rules_web
from cranktopo.store import Json, Work

Array = NDArray[np.float64]


class CoarseWebs:
    """Such webs of a throw, without fatigue; the original is evaluated once."""

    def __init__(
        self,
        scene: Scene,
        limits: ManufacturingLimits,
        element_size_mm: float,
        original: Mapping[str, float],
        work: Work,
    ) -> None:
        """Evaluate the original web.

        Args:
            original: its quantities by a finer evaluation, to which the coarse numbers are brought.

        Raises:
            CranktopoError: impossible geometry, or a failed solve.
        """
        self._scene, self._limits, self._size = scene, limits, element_size_mm
        coarse = work.once("original-coarse", self._original)
        shares = {name: original[name] / value for name, value in coarse.items()}
        both = {f"{name}_per_mass": share for name, share in shares.items()}
        self._shares = {**shares, **both}

    @property
    def scene(self) -> Scene:
        """The throw."""
        return self._scene

    def web(self, layout: Layout) -> ParametricWeb:
        """A web of the layout, for its bounds and manufacturing constraints."""
        return rules_web(layout, self._scene, self._limits)

    def responses(self, web: ParametricWeb, values: Array, quantities: Collection[str]) -> MeshResponses:
        """Quantities of a web with these values, and their gradients.

        Raises:
            CranktopoError: no sound web, no valid mesh, or a failed solve.
        """
        found = MeshModel(self._scene, web.layout, values, self._size).responses(values, quantities)
        return found.scaled(self._shares)

    def _original(self) -> Json:
        scene = self._scene
        target = Target(scene.name, planned_scene(scene, kept_features(scene)))
        found, supports = evaluate_on_mesh(target, self._size).stiffness, scene.supports
        return {"torsion": found.torsion[supports.torsion], "bending": found.bending[supports.bending]}
