"""Exactness of the points of a sweep: elements of its evaluation, cells of its optimisation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.schema import Scene
from cranktopo.tasks.throw_fea.evaluation import Evaluation, evaluate
from cranktopo.tasks.throw_fea.levels import ErrorTarget, evaluate_to
from cranktopo.tasks.throw_fea.targets import Target

if TYPE_CHECKING:
    from cranktopo.tasks.web_shape.optimum import ShapeSettings

_COARSER = 1.5
"""Elements and cells of a first look over those of full accuracy: the error bounds of differences are
calibrated on such meshes."""


@dataclass(frozen=True)
class Fineness:
    """Settings that the numbers of a point depend on beside its scene, never on the machine.

    Attributes:
        accuracy_percent: evaluations are refined until the bound of their error is no larger.
        coarser: factor on elements and cells.
    """

    element_size_mm: float | None = None
    accuracy_percent: float | None = None
    coarser: float = 1.0

    @property
    def first_look(self) -> Fineness:
        """The same, coarse: what shows which points are worth full accuracy."""
        return Fineness(self.element_size_mm, coarser=_COARSER)

    def settings(self) -> Mapping[str, Any]:
        """Return settings for the hash of a point, without those as by default, which came later."""
        accuracy = {} if self.accuracy_percent is None else {"accuracy_percent": self.accuracy_percent}
        coarser = {} if self.coarser == 1 else {"coarser": self.coarser}
        return {"element_size_mm": self.element_size_mm, **accuracy, **coarser}

    def evaluation(self, target: Target) -> Evaluation:
        """Return the evaluation of a target; what this machine measured earlier has no say in it."""
        if self.accuracy_percent is not None:
            return evaluate_to(target, ErrorTarget(self.accuracy_percent))[0]
        return evaluate(target, self._element_size_mm(target.scene))

    def scene(self, scene: Scene) -> Scene:
        """Return the scene with the cells of its optimisation."""
        if self.coarser == 1:
            return scene
        return scene.with_optimise(resolution_mm=self.coarser * scene.optimise.resolution_mm)

    def shape_settings(self, usual: ShapeSettings, scene: Scene) -> ShapeSettings:
        """Return settings with cells and elements; trials are judged on nothing finer than the result."""
        size = self._element_size_mm(scene)
        coarse = replace(usual, cell_mm=self.coarser * usual.cell_mm, mesh_mm=self.coarser * usual.mesh_mm)
        return replace(coarse, element_size_mm=size, mesh_mm=max(coarse.mesh_mm, size or 0.0))

    def _element_size_mm(self, scene: Scene) -> float | None:
        if self.coarser == 1:
            return self.element_size_mm
        return self.coarser * (self.element_size_mm or default_element_size_mm(scene))
