"""By how much cells misjudge a web: the same on coarse body-fitted elements, both against the original.

Cells overrate bending beside pockets by several percent, so that a pocket seems to pay which does not.
"""

from __future__ import annotations

from cranktopo.effects import planned_scene
from cranktopo.evaluate.evaluation import (
    RATIO,
    default_element_size_mm,
    evaluate_on_mesh,
    meshed_throw_kg,
)
from cranktopo.evaluate.targets import Target
from cranktopo.scene import Scene
from cranktopo.shape.free_bores import kept_features
from cranktopo.shape.search import Found, shaped_scene
from cranktopo.shape.web_model import WebModel
from cranktopo.store import Json, Work


class CellErrors:
    """Errors of webs on some cells; the original is evaluated once."""

    def __init__(self, model: WebModel, work: Work) -> None:
        self._model, self._work = model, work
        self._original = self._evaluated(model.scene, "original-coarse")

    def of(self, found: Found, name: str) -> dict[str, float]:
        """Factors by quantity by which the cells overrate a web.

        Args:
            name: under which the work keeps its evaluation.

        Raises:
            CranktopoError: impossible geometry, or a failed solve.
        """
        scene = shaped_scene(self._model.scene, found.layout, found.values)
        truth, cells, start = self._evaluated(scene, name), found.responses.values, self._model.original
        return {
            quantity: cells[quantity] / start[quantity] * self._original[quantity] / value
            for quantity, value in truth.items()
        }

    def _evaluated(self, scene: Scene, name: str) -> dict[str, float]:
        """Mass and stiffnesses with fillets on the coarser mesh of a default evaluation."""

        def make() -> Json:
            target = Target(scene.name, planned_scene(scene, kept_features(scene)))
            found = evaluate_on_mesh(target, RATIO * default_element_size_mm(scene))
            supports, mass = scene.supports, meshed_throw_kg(found.meshed, scene)
            torsion = found.stiffness.torsion[supports.torsion]
            bending = found.stiffness.bending[supports.bending]
            assert torsion is not None
            assert bending is not None
            ratios = {"torsion_per_mass": torsion / mass, "bending_per_mass": bending / mass}
            return {"mass": mass, "torsion": torsion, "bending": bending, **ratios}

        return self._work.once(name, make)
