"""Readings of a scene without a dear solve: texts to compare between two scenes."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import fields, is_dataclass
from datetime import datetime
from typing import Any

import numpy as np
from pydantic import BaseModel

from cranktopo import (
    check_balancer,
    check_bolts,
    check_rod_strength,
    engine_balance,
    oil_films,
    redesign_balancer,
)
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import redirected
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.volume import half_throw_volume_mm3, outlet_roundings_mm3, web_moments
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.throw_compliance import throw_compliance
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.balance.result import balance_result
from cranktopo.tasks.density.manufacturing import filter_radius_mm
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.loads.stage import loads_at_speeds
from cranktopo.tasks.modes.carried import parts_on, without_mass
from cranktopo.tasks.plan.stage import design_plan, plan_warnings
from cranktopo.tasks.plan.text import plan_text

WRITTEN = datetime(2026, 1, 1)
_CELL_MM = 6.0


def told(value: Any) -> str:
    """A result as text: all its values, but neither what is assumed nor the scene that it is of."""
    if hasattr(value, "__array__"):
        return hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()
    if isinstance(value, Scene):
        return "scene"
    if isinstance(value, BaseModel):
        return told({name: getattr(value, name) for name in type(value).model_fields if name != "assumed"})
    if is_dataclass(value) and not isinstance(value, type):
        return told({one.name: getattr(value, one.name) for one in fields(value) if one.name != "assumed"})
    if isinstance(value, dict):
        return "{" + ", ".join(f"{name}: {told(one)}" for name, one in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(told, value)) + "]"
    return repr(value)


def body(scene: Scene) -> Iterator[Any]:
    """Mass properties, closed form of the volume, and the cells of each web."""
    yield throw_balance(scene)
    for half in dict.fromkeys(halves(scene)):
        yield half_throw_volume_mm3(half), outlet_roundings_mm3(half), web_moments(half)


def compliance(scene: Scene) -> Iterator[Any]:
    """Closed form of what a throw gives."""
    yield throw_compliance(scene)


def cells(scene: Scene) -> Iterator[Any]:
    """The web on cells, and the design space where there is one."""
    for half in dict.fromkeys(halves(scene)):
        for target in ("web", "envelope") if scene.envelope else ("web",):
            found = build_domain(half, _CELL_MM, target)
            yield found.passive_fraction, found.design_fraction, found.web, found.pin


def effects(scene: Scene) -> Iterator[Any]:
    """All that `plan` prints."""
    found = design_plan(scene)
    yield plan_text(found, scene), found, plan_warnings(scene)


def loads(scene: Scene) -> Iterator[Any]:
    yield loads_at_speeds(scene)


def balance(scene: Scene) -> Iterator[Any]:
    yield balance_result(engine_balance(scene), None)


def film(scene: Scene) -> Iterator[Any]:
    yield oil_films(scene)


def bolts(scene: Scene) -> Iterator[Any]:
    yield check_bolts(scene)


def rod(scene: Scene) -> Iterator[Any]:
    """The rod by both methods of fatigue."""
    yield check_rod_strength(scene)
    yield check_rod_strength(scene, "fkm")


def balancer(scene: Scene) -> Iterator[Any]:
    yield check_balancer(scene)


def redesign(scene: Scene) -> Iterator[Any]:
    """The balancer shaft that `balancer --redesign` finds."""
    found, strength_after = redesign_balancer(scene)
    yield found.balancer, strength_after


def vibration(scene: Scene) -> Iterator[Any]:
    from cranktopo import shaft_vibration
    from cranktopo.tasks.vibration.result import vibration_result

    yield vibration_result(shaft_vibration(scene), ())


def carried(scene: Scene) -> Iterator[Any]:
    """Parts of the shaft as `modes` has them."""
    assert scene.shaft is not None
    yield parts_on(scene.shaft, "free"), parts_on(scene.shaft, "output"), without_mass(scene.shaft)


def crank(scene: Scene) -> Iterator[Any]:
    from cranktopo.engine.balance.crank import crank_mass

    yield crank_mass(scene)


def _texts(figure: Any) -> list[str]:
    return sorted(one.get_text() for part in (figure, *figure.axes) for one in part.texts)


def throw_sheet(scene: Scene) -> Iterator[Any]:
    """Texts of the drawing of a throw."""
    from cranktopo.tasks.drawing.sheet import drawing_figures, throw_sheets

    yield [_texts(figure) for figure in drawing_figures(throw_sheets(scene), throw_balance(scene))]


def raw_sheet(scene: Scene) -> Iterator[Any]:
    from cranktopo.bodies.raw_part import machined_out, raw_mass_kg

    yield raw_mass_kg(scene), machined_out(scene)


def crank_sheet(scene: Scene) -> Iterator[Any]:
    """Texts of the drawing of a crank; to find its edges takes longest."""
    from unittest.mock import patch

    from cranktopo.tasks.crank_drawing.crank_shape import crank_shape
    from cranktopo.tasks.crank_drawing.sheet import crank_figure

    edge = np.array([[0.0, -1.0], [1.0, 1.0]])
    with patch("cranktopo.tasks.crank_drawing.crank_views.visible_edges", lambda *_: [edge]):
        yield _texts(crank_figure(scene, crank_shape(scene), WRITTEN)[0])


def rod_sheet(scene: Scene) -> Iterator[Any]:
    from cranktopo.tasks.drawing.sheet import pages_figure
    from cranktopo.tasks.rod.drawing import rod_page

    yield _texts(pages_figure([rod_page(scene)], WRITTEN))


def balancer_sheet(scene: Scene) -> Iterator[Any]:
    from cranktopo.tasks.balancer.drawing import balancer_page
    from cranktopo.tasks.drawing.sheet import pages_figure

    yield _texts(pages_figure([balancer_page(scene)], WRITTEN))


def strength(scene: Scene) -> Iterator[Any]:
    """Safety of a point by each local method, strengths of the others, hardened layers."""
    from cranktopo.design.strength import strength_notes, strength_remarks
    from cranktopo.tasks.fatigue.criteria import LOCAL_METHODS, criterion
    from cranktopo.tasks.throw_fatigue.hardened_layer import layers
    from cranktopo.tasks.throw_fatigue.m53 import concentration_factors, dimensions, nominal_stresses
    from cranktopo.tasks.throw_fatigue.rule_fillets import fillet_checks

    stress = LocalStress(np.array([200.0]), np.array([60.0]), np.array([0.7]))
    yield strength_notes(scene), strength_remarks(scene)
    for method in LOCAL_METHODS:
        with suppress(CranktopoError):
            yield criterion(method).point_safety(scene, stress)
    size = dimensions(scene)
    nominal = nominal_stresses(size, 1e5, 1e4, 1e5)
    yield fillet_checks(scene, size, concentration_factors(size), nominal), scene.fatigue.treatment
    with suppress(CranktopoError):
        yield layers(scene)


def origins(scene: Scene) -> Iterator[Any]:
    """Lines that `--verbose` tells of any design."""
    from cranktopo.design.origins import origins as told_origins

    yield told_origins(scene)


def assumed(scene: Scene) -> Iterator[Any]:
    from cranktopo.design.assumed import THROW, assumptions

    yield [str(one) for one in assumptions(scene, (THROW,))]


def tilt(scene: Scene) -> Iterator[Any]:
    from cranktopo.engine.bearings import bearing_tilt_spring_Nmm_per_rad

    yield bearing_tilt_spring_Nmm_per_rad(scene)


def shape(scene: Scene) -> Iterator[Any]:
    """Ranges of the dimensions that the shape optimisation is free to change."""
    from cranktopo.design.free_dimensions import DIMENSIONS, free_range_mm

    yield [free_range_mm(scene, name) for name in DIMENSIONS]


def goal(scene: Scene) -> Iterator[Any]:
    """Goal and limits as every optimiser takes them."""
    yield goal_of(scene)


def problem(scene: Scene) -> Iterator[Any]:
    """The problem of the density optimisation, on coarse cells and without its finite elements."""
    from types import SimpleNamespace
    from unittest.mock import patch

    from cranktopo import load_cases, plan
    from cranktopo.engine.plan.planning import planned_scene
    from cranktopo.tasks.density import build

    cases, scene = load_cases(scene, plan(scene).enabled), planned_scene(scene)
    model = SimpleNamespace(case_names=[case.name for case in cases])
    domain = build_domain(scene, _CELL_MM)
    with (
        double_precision(),
        patch.object(build, "build_model", lambda *_, **__: model),
        patch.object(build, "check_start", lambda *_: None),
    ):
        found = build.build_problem(scene, domain, cases)
    chain = found.density_chain
    yield (
        found.weights,
        found.target,
        found.max_iterations,
        found.schedule,
        found.method.__name__,
        found.start,
    )
    yield chain.penalty, chain.projection, chain.process, filter_radius_mm(scene, domain)
    yield len(found.optimisation.goals)


READINGS: dict[str, Callable[[Scene], Iterator[Any]]] = {
    one.__name__: one
    for one in (
        body, cells, effects, loads, balance, film, bolts, rod, balancer, vibration, carried, crank,
        throw_sheet, raw_sheet, crank_sheet, rod_sheet, balancer_sheet, strength, origins, assumed, tilt,
        shape, goal, problem, redesign, compliance,
    )
}  # fmt: skip


def of_scene(scene: Scene, name: str) -> tuple[str, ...]:
    """All that a reading tells, refusals and lines among it, but not what is assumed."""
    lines, found = list[str](), list[str]()
    with redirected(lines.append):
        try:
            found += [told(value) for value in READINGS[name](scene)]
        except CranktopoError as error:
            found.append(f"refused: {error}")
    return (*found, *(line for line in lines if "assumed" not in line))
