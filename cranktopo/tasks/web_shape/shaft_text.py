"""Safety in the shaft of a web whose search judged a throw alone, in words: what is worse stands first."""

from __future__ import annotations

import shlex
from pathlib import Path

from cranktopo.base.units import change_text
from cranktopo.tasks.throw_fatigue.verdicts import SAME
from cranktopo.tasks.web_shape.result import ShaftCheck, ShapeResult

_COARSE = 0.05
"""Share by which the mesh of the check may tell less than that of an evaluation; 2.1 to 4.3 % was found."""


def less_safe_in_shaft(shape: ShapeResult) -> str:
    """Return what stands in front of a verdict where the web is less safe in its shaft; empty where not."""
    one = shape.shaft_check
    if one is None or not (against := _lacks(shape, one)):
        return ""
    return (
        f"LESS SAFE IN ITS SHAFT: {_least(one)}, {', '.join(against)}; effects.continuous_shaft = 'on' makes "
        "a web for its shaft"
    )


def shaft_lines(shape: ShapeResult, folder: Path | None = None) -> list[str]:
    """Return what is told of the shaft beside the verdict, and with its folder what judges it better."""
    if shape.shaft_unjudged:
        return [f"not judged in its shaft: {shape.shaft_unjudged}"]
    one = shape.shaft_check
    if one is None:
        return []
    low, high = one.speeds_rpm
    told = (
        f"in its shaft, on all bearings from {low:,.0f} to {high:,.0f} rpm, least fatigue safety "
        f"{_least(one)}, {_against_original(one)}, by elements of {one.fillet_fraction:g} of a fillet; the "
        "search judged its throw alone"
    )
    return [told, *([_finer(shape, one, folder)] if folder and _lacks(shape, one) else [])]


def _finer(shape: ShapeResult, one: ShaftCheck, folder: Path) -> str:
    web, (low, high) = shlex.quote(str(folder / shape.files.design)), one.speeds_rpm
    return f"by finer elements: cranktopo shaft {web} --method lsa --speeds {low:g}:{high:g}:5"


def _lacks(shape: ShapeResult, one: ShaftCheck) -> list[str]:
    """Return what a web lacks in its shaft by more than safeties scatter from mesh to mesh.

    Both webs are on meshes alike; what a limit asks for and what the throw alone has are not.
    """
    alone = shape.values.result.get("fatigue_safety")
    fine = one.result / (1 - _COARSE)
    limited = one.required is not None and fine < one.required != one.original
    return [
        *([_against_original(one)] if one.result < (1 - SAME) * one.original else []),
        *([f"below the limit of {one.required:.3f}"] if limited else []),
        *([f"below the {alone:.3f} of its throw alone"] if alone and fine < alone else []),
    ]


def _against_original(one: ShaftCheck) -> str:
    change = change_text(100 * (one.result / one.original - 1), 100 * SAME)
    return f"{change} against the original's {one.original:.3f}"


def _least(one: ShaftCheck) -> str:
    return f"{one.result:.3f} (web {one.web}, {one.part.replace('_', ' ')})"
