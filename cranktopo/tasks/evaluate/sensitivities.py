"""Worth of a millimetre of each dimension of a parametric web: exact gradients, and what holds it."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import read_json
from cranktopo.base.notes import note
from cranktopo.bodies.memory import check_element_size
from cranktopo.design.free_dimensions import own_dimension_mm
from cranktopo.design.halves import WebName, default_element_size_mm
from cranktopo.design.named import DesignLike
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.engine.plan.simulated import Feature
from cranktopo.runs.kind import LOOP, SHAPE, kind_of, reading_results
from cranktopo.runs.stored import unchanged
from cranktopo.tasks.designs.run_webs import REMODEL, WebTarget, parametric_scene, web_target
from cranktopo.tasks.evaluate.result import WebSensitivities
from cranktopo.tasks.iterate.result import Settings
from cranktopo.tasks.refit.family import free_dimensions, with_free
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.refit.read_web import WebRead
from cranktopo.tasks.throw_fatigue.needs import check_inputs
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.web_shape.mesh_model import MeshedWebs
from cranktopo.tasks.web_shape.result import DimensionSensitivity
from cranktopo.tasks.web_shape.rules import rules_at
from cranktopo.tasks.web_shape.sensitivities import (
    active_constraints,
    dimension_sensitivities,
    sensitivity_table,
)
from cranktopo.tasks.web_shape.start import scene_start
from cranktopo.throw.manufacturing_limits import ManufacturingLimits, ProcessLimits

_COARSER = 2.0
"""Elements over the default size of an evaluation: relative changes differ by about 0.01 % per mm."""
_FILLETS: tuple[Feature, ...] = ("fillets",)
_FILLET_FRACTION = 1.0
"""Element size on a fillet over its radius, enough for relative changes of the safety."""


@dataclass(frozen=True)
class Sensitivities:
    """Worth of a millimetre of each dimension.

    Attributes:
        file: the design, or the scene file of the run's web.
    """

    file: str
    scene: Scene
    dimensions: tuple[DimensionSensitivity, ...]
    violated: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """Return the entry `sensitivities` of an evaluation."""
        return self.table.as_json()

    @property
    def table(self) -> WebSensitivities:
        """The dimensions with the worst case, and the broken rules."""
        found = sensitivity_table(self.dimensions, self.scene.shape.tolerance_mm)
        return WebSensitivities(**dict(found), broken_rules=self.violated)


def evaluate_sensitivities(
    target: DesignLike,
    element_size_mm: float | None = None,
    web: WebName | None = None,
    throw: int | None = None,
) -> Sensitivities:
    """Return what a millimetre of each dimension of a parametric web is worth, by exact gradients.

    Args:
        web: of a design with two different webs the one that is meant, whose throw has it twice.
        throw: of a crank with different throws, by default the worst loaded.

    Raises:
        CranktopoError: no such target, no parametric web, no valid mesh, or a failed solve.
    """
    found = web_target(target, web, throw)
    name = target.name if isinstance(target, Scene) else str(target)
    scene = parametric_scene(name, found)
    limits = _limits(found, scene)
    layout, values = _with_free(_read(name, scene, limits), scene)
    planned = planned_scene(scene, _FILLETS)
    size = element_size_mm or _COARSER * default_element_size_mm(planned)
    check_element_size(planned, size)
    note(f"{scene.name}: gradients of {len(values)} dimensions on elements of {size:.3g} mm")
    webs = MeshedWebs(planned, limits, size, _fraction(planned))
    parametric = webs.web(layout)
    rules = rules_at(planned, parametric, values)
    if rules.violated:
        note(f"{scene.name}: keeps these rules not: {'; '.join(rules.violated)}")
    responses = webs.responses(parametric, values)
    holders = active_constraints(planned, parametric, values, rules)
    worth = dimension_sensitivities(parametric, values, responses, responses.values, holders)
    return Sensitivities(str(found.file or name), scene, worth, rules.violated)


def _read(text: str, scene: Scene, limits: ManufacturingLimits) -> WebRead:
    found = scene_start(scene, limits)
    if found.left_out:
        raise CranktopoError(
            f"target '{text}': its web is not parametric: {'; '.join(found.left_out)}. A parametric web has "
            "an outline of stations, end bevels, a groove and pockets as the re-model writes them.",
            hint=f"`{shlex.join(['cranktopo', 'shape', text])}` makes one, `cranktopo remodel RUN` fits one.",
        )
    return found


def _with_free(web_read: WebRead, scene: Scene) -> tuple[Any, Any]:
    names = tuple(name for name in free_dimensions(scene) if own_dimension_mm(scene, name))
    return with_free(web_read.layout, web_read.values, scene, names)


def _limits(target: WebTarget, scene: Scene) -> ManufacturingLimits:
    run, file = target.run, target.file
    if run is None or file is None:
        return usual_limits(scene)
    options = run.manifest().options
    with reading_results(run):
        if (file.parent / REMODEL).is_file():
            return ManufacturingLimits(**read_json(unchanged(file.parent / REMODEL)).get("rules", {}))
        if kind_of(run) == LOOP:
            return Settings.from_json(options[LOOP]).limits
        return ProcessLimits(**options[SHAPE]["limits"])


def _fraction(scene: Scene) -> float | None:
    try:
        check_inputs(Target(scene.name, scene), "lsa", "extremes")
    except CranktopoError as error:
        note(f"{scene.name}: no fatigue safety in the table: {error}")
        return None
    return _FILLET_FRACTION
