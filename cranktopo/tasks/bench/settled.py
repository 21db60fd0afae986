"""The settled answer after a release: body-fitted stiffness, then fatigue safety with its colours."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import silent
from cranktopo.bodies.shown_solid import display_half
from cranktopo.design.halves import difference
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import has_vibration, planned_scene
from cranktopo.engine.throw_compliance import throw_stiffness_Nm_per_rad
from cranktopo.numerics.surfaces.mesh import mesh_of
from cranktopo.report.viewer.scene3d import Scene3D, ShownBody, StressScale, packed
from cranktopo.tasks.bench.colours import web_colours
from cranktopo.tasks.bench.engine_plots import vibration_plots
from cranktopo.tasks.bench.kept_mesh import KeptMesh
from cranktopo.tasks.bench.live import (
    first_frequency,
    load_warnings,
    may_vibrate,
    rests_on_stiffness,
    rule_values,
)
from cranktopo.tasks.film.stage import oil_films
from cranktopo.tasks.shaft.stage import evaluate_shaft, of_stiffness, with_throw_stiffness
from cranktopo.tasks.throw_fatigue.largest_stress import largest_of_field_MPa
from cranktopo.tasks.throw_fatigue.needs import check_inputs
from cranktopo.tasks.throw_fatigue.remarks import yield_warning
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_field
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.quantities import goal_values
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.web_shape.start import kept_features

_METHOD = "lsa"
_SAFETY_ERROR_PERCENT = 1.0
"""Of a least safety on the mesh of `cranktopo fatigue`: 0.2 to 0.8 % against elements of half the size."""
KEPT = KeptMesh()
"""Of this process, which settles one web after another."""


def settled_stiffness(data: dict[str, Any]) -> dict[str, Any]:
    """Return the body-fitted quantities of a design, and the bound of their error in percent."""
    began, target = time.perf_counter(), _target(data)
    found = evaluate(target)
    return {
        "gauges": goal_values(target.scene, found.result),
        "error_percent": {"torsion": found.torsion_error_percent, "bending": found.bending_error_percent},
        "seconds": time.perf_counter() - began,
    }


def settled_shaft(data: dict[str, Any]) -> dict[str, Any]:
    """Return the first natural frequency by the stiffness of a throw in elements, as `vibration` does.

    Nothing where the design has no shaft line, or gives that stiffness itself.
    """
    began, target = time.perf_counter(), _target(data)
    if not rests_on_stiffness(target.scene):
        return {"gauges": {}}
    throws = evaluate_shaft(target, "rigid").stiffness.throws_Nm_per_rad
    return {
        "gauges": first_frequency(of_stiffness(target.scene, throws)),
        "throw_stiffnesses_Nm_per_rad": list(throws),
        "stiffness_factors": [throw / throw_stiffness_Nm_per_rad(target.scene) for throw in throws],
        "shaft_seconds": time.perf_counter() - began,
    }


def settled_vibration(data: dict[str, Any], throws_Nm_per_rad: Sequence[float] = ()) -> dict[str, Any]:
    """Return plots of the vibrating shaft, gauges of the rule under its torque, and what `plan` leaves out.

    Nothing where the design has no shaft line.

    Args:
        throws_Nm_per_rad: stiffness of each throw by elements; empty where the design gives it.
    """
    scene = scene_from_dict(data, "design", whole=True)
    if not may_vibrate(scene):
        return {"gauges": {}}
    stiff = of_stiffness(scene, throws_Nm_per_rad) if throws_Nm_per_rad else scene
    plots = vibration_plots(stiff) if stiff.shaft and stiff.shaft.has_takeoff else []
    return {"gauges": rule_values(stiff), "load_warnings": load_warnings(stiff), "plots": plots}


def settled_film(data: dict[str, Any]) -> dict[str, Any]:
    """Return the thinnest oil film of all bearings and the largest pressure in one, as `film` tells them.

    Nothing where the design has no `[bearings]`.
    """
    scene = scene_from_dict(data, "design", whole=True)
    if scene.bearings is None:
        return {"gauges": {}}
    with silent():
        films = [film for at_speed in oil_films(scene).speeds for film in at_speed.least_films]
    thinnest = min(film.film_um for film in films)
    return {"gauges": {"film": thinnest, "film_pressure": max(film.pressure_MPa for film in films)}}


def settled_safety(data: dict[str, Any], throws_Nm_per_rad: Sequence[float] = ()) -> dict[str, Any]:
    """Return the least fatigue safety as `cranktopo fatigue` tells it, and its place; or why not.

    Args:
        throws_Nm_per_rad: stiffness of each throw by elements, for the torque of the vibrating shaft.
    """
    began = time.perf_counter()
    try:
        field = solved_field(json.dumps(data), tuple(throws_Nm_per_rad))
    except CranktopoError as error:
        return {"gauges": {}, "missing": str(error)}
    critical = field.critical
    gauges = {
        "fatigue_safety": float(critical.safety),
        "pin_fillet_safety": field.fillet_safety["pin"],
        "journal_fillet_safety": field.fillet_safety["journal"],
        "stress": largest_of_field_MPa(field),
    }
    if field.at_outlet is not None:
        gauges["outlet_safety"] = float(field.at_outlet.safety)
    return {
        "gauges": gauges,
        "error_percent": dict.fromkeys(gauges, _SAFETY_ERROR_PERCENT),
        "elsewhere": float(field.safety[:, field.model.parts["elsewhere"]].min()),
        "place": critical.place,
        "point_mm": [round(float(x), 3) for x in critical.point_mm],
        "warnings": list(filter(None, [yield_warning(field, field.model.scene.material.yield_MPa)])),
        "seconds": time.perf_counter() - began,
    }


def settled_colours(
    data: dict[str, Any], throws_Nm_per_rad: Sequence[float], stiffness: Mapping[str, float]
) -> dict[str, Any]:
    """Return the picture of a web with its colours; nothing where it has no safety, or its halves differ.

    Args:
        throws_Nm_per_rad: as of `settled_safety`.
        stiffness: gauges of `settled_stiffness`, for the colours of what removal costs.
    """
    scene = _target(data).scene
    if difference(scene):
        return {"gauges": {}}
    field = solved_field(json.dumps(data), tuple(throws_Nm_per_rad))
    return {"gauges": {}, **_picture(scene, field, stiffness)}


@lru_cache(maxsize=1)
def solved_field(text: str, throws_Nm_per_rad: tuple[float, ...]) -> FatigueField:
    """Return the safety of a design as JSON, solved once for the numbers and for the colours."""
    target = _target(json.loads(text))
    check_inputs(target, _METHOD, "extremes")
    meshed = None if target.file else KEPT.of(target)
    return fatigue_field(_with_stiffness(target, throws_Nm_per_rad), _METHOD, meshed=meshed)


def _picture(scene: Scene, field: FatigueField, stiffness: Mapping[str, float]) -> dict[str, Any]:
    colours = web_colours(field, stiffness)
    body = ShownBody(scene.name, mesh_of(display_half(scene)), scene.web_z_mm, scene.pitch_mm / 2, colours)
    scales = tuple(StressScale(one.name, one.label, one.top) for one in colours.cases)
    legends = [{"name": one.name, "legend": one.label} for one in colours.cases]
    return {"picture": packed(Scene3D((body,), stress_scales=scales)), "colours": legends}


def _with_stiffness(target: Target, throws_Nm_per_rad: Sequence[float]) -> Target:
    """Return the target with the stiffness of its throws, solved if unknown, where its loads need them."""
    if not throws_Nm_per_rad:
        return with_throw_stiffness(target)
    if not has_vibration(target.scene):
        return target
    return replace(target, scene=of_stiffness(target.scene, throws_Nm_per_rad))


def _target(data: dict[str, Any]) -> Target:
    scene = scene_from_dict(data, "design", whole=True)
    return Target(scene.name, planned_scene(scene, kept_features(scene)))
