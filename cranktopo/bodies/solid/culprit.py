"""Feature of a half throw that the CAD kernel makes wrong, found by adding one after another."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from cranktopo.base.notes import note
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.table import Drilling

Misfit = Callable[[Scene], float]
"""Difference of the kernel's volume of a half throw from the closed form over what is allowed."""
_POWER = 0.4
"""The misfit of a rounding grows with about the 2.5th power of its radius."""
_SHRINK, _TRIES = 0.9, 4


@dataclass(frozen=True)
class Culprit:
    """A feature at which the kernel departs: its key path and value as a message names them, what to do."""

    feature: str
    hint: str


@dataclass(frozen=True)
class _BuildStep:
    """A half throw with a feature and all before it."""

    feature: str
    scene: Scene
    rounded: int | None = None
    """Number of the drilling whose outlets it rounds."""


def culprit(scene: Scene, misfit: Misfit) -> Culprit:
    """Return the first feature with which a half throw misfits that misfits as a whole."""
    note("looking for the feature that the CAD kernel makes wrong: one after another is added")
    *before, last = _steps(scene)
    found = next((step for step in before if misfit(step.scene) > 1), last)
    if found.rounded is None:
        hint = "Change one of its dimensions, or its distance from what it touches, by 0.1 mm."
        return Culprit(found.feature, hint)
    return Culprit(found.feature, _smaller_rounding(found.scene, found.rounded, misfit))


def _smaller_rounding(scene: Scene, number: int, misfit: Misfit) -> str:
    """Return the advice on a rounding that is too large, with one that the kernel was seen to make."""
    drilling = scene.throw.drilling[number]
    radius = drilling.outlet_radius_mm / misfit(scene) ** _POWER
    for _ in range(_TRIES):
        radius = float(f"{_SHRINK * radius:.2g}")
        smaller = drilling.model_copy(update={"outlet_radius_mm": radius})
        if misfit(scene.with_drillings((*scene.throw.drilling[:number], smaller))) <= 1:
            return f"Reduce it: {radius:g} mm is made right."
    return "Reduce it, or enlarge diameter_mm."


def _steps(scene: Scene) -> Iterator[_BuildStep]:
    """Yield the half throw from the bare outline on, each time with one feature more, the whole one last."""
    web, throw = scene.web, scene.throw
    bare = dict.fromkeys(web.feature_keys, ()) | dict.fromkeys(web.single_keys)
    sharp = {name: _sharp(throw, name) for name in ("main_journal", "crankpin")}
    at = _with_web(scene, bare).model_copy(
        update={"throw": throw.model_copy(update={**sharp, "drilling": ()})}
    )
    yield _BuildStep(f"web.outline = '{web.outline}'", at)
    for name in sharp:
        at = at.model_copy(update={"throw": at.throw.model_copy(update={name: getattr(throw, name)})})
        yield _BuildStep(f"throw.{name}.fillet_mm = {getattr(throw, name).fillet_mm:g}", at)
    for key in web.single_keys:
        if getattr(web, key) is not None:
            at = _with_web(at, {key: getattr(web, key)})
            yield _BuildStep(f"web.{key}", at)
    for key in web.feature_keys:
        for index in range(len(getattr(web, key))):
            at = _with_web(at, {key: getattr(web, key)[: index + 1]})
            yield _BuildStep(f"web.{key}[{index}]", at)
    for number, drilling in enumerate(throw.drilling):
        yield from _drilled(at, number, throw.drilling[:number], drilling)
        at = at.with_drillings(throw.drilling[: number + 1])


def _drilled(
    at: Scene, number: int, before: tuple[Drilling, ...], drilling: Drilling
) -> Iterator[_BuildStep]:
    """Yield a drilling without and with the roundings of its outlets."""
    key, sharp = f"throw.drilling[{number}]", drilling.model_copy(update={"outlet_radius_mm": 0.0})
    yield _BuildStep(f"{key}.diameter_mm = {drilling.diameter_mm:g}", at.with_drillings((*before, sharp)))
    if drilling.outlet_radius_mm:
        feature = f"{key}.outlet_radius_mm = {drilling.outlet_radius_mm:g}"
        yield _BuildStep(feature, at.with_drillings((*before, drilling)), number)


def _sharp(throw: Any, name: str) -> Any:
    none = {"fillet_mm": 0.0, "fillet_axial_mm": None, "recess_mm": None}
    return getattr(throw, name).model_copy(update=none)


def _with_web(scene: Scene, update: dict[str, Any]) -> Scene:
    return scene.model_copy(update={"web": scene.web.model_copy(update=update)})
