"""Depths of treatments that are worth a factor of 1.3: `python -m tests.studies.factor_of_hardening`.

J. Voparil (Brno University of Technology, 2011) takes 1.3 for hardened fillets without depth or hardness. Two
points: the one that he prints, in a web whose size he does not print, and the pin fillet of the Mikron
(`cranktopo fatigue mikron-iiic --fillet-fraction 0.45`). The criterion is local stress analysis with the core
of the Mikron's steel.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from cranktopo.design.hardening import Process, vickers
from cranktopo.design.loading import load_scene
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.lsa import lsa, lsa_strength
from cranktopo.tasks.throw_fatigue.hardened_layer import HardenedLayer
from cranktopo.tasks.throw_fatigue.hardening import TreatedFillet, least_safety
from cranktopo.tasks.throw_fatigue.m53 import dimensions, fatigue_strength_MPa
from cranktopo.tasks.throw_fatigue.m53_hardening import surface_strength_MPa
from cranktopo.tasks.throw_fatigue.stress_below import NotchShape, notch_shape
from tests.validation.table import lines_of

SCENE = load_scene("mikron-iiic")
CORE_HV = vickers(SCENE.material.ultimate_MPa or 0.0) or 0.0
FACTOR = 1.3
DEPTHS_MM = np.arange(0.05, 4.001, 0.05)
USUAL_NITRIDED_MM = 0.4


@dataclass(frozen=True)
class Point:
    """Local stress, and the shapes of web and notch that it may lie in."""

    name: str
    stress: LocalStress
    shapes: tuple[NotchShape, ...]


def _stress(amplitude_MPa: float, mean_MPa: float, gradient_per_mm: float) -> LocalStress:
    return LocalStress(*(np.array([value]) for value in (amplitude_MPa, mean_MPa, gradient_per_mm)))


POINTS = (
    Point(
        "his: 241 MPa, gradient 0.228 1/mm",
        _stress(241.08, 330.95, 0.228),
        tuple(NotchShape(factor, middle) for factor in (2.0, 2.8) for middle in (10.0, 15.0)),
    ),
    Point(
        "the Mikron's pin fillet: 303 MPa, gradient 0.743 1/mm",
        _stress(303.49, 128.33, 0.7432),
        (notch_shape(SCENE, "pin"),),
    ),
)
HARDNESS_HV: tuple[tuple[Process, tuple[float, ...]], ...] = (
    ("induction", (430.0, 700.0)),
    ("nitrided", (550.0, 900.0)),
    ("rolled", (360.0, 440.0)),
)


def gain(
    process: Process, depth_mm: float, surface_HV: float, stress: LocalStress, shape: NotchShape
) -> float:
    """Least safety over all depths of a treated fillet over that of the same point untreated."""
    below = 0.9 * CORE_HV if process == "induction" else CORE_HV
    layer = HardenedLayer(process, depth_mm, surface_HV, CORE_HV, below)
    treated = TreatedFillet("pin", layer, shape, np.ones(1, bool))
    return float((least_safety(_judge, treated, stress) / _judge(stress))[0])


def _judge(stress: LocalStress) -> np.ndarray:
    return lsa(stress, lsa_strength(SCENE)).safety


def shallowest_mm(gain_at: Callable[[float], float]) -> float | None:
    """Least depth from which a treatment is worth the factor; None where none of the depths is."""
    worth = np.array([gain_at(float(depth)) for depth in DEPTHS_MM]) >= FACTOR
    if not worth.any():
        return None
    first = int(worth.argmax())
    return float(brentq(lambda depth: gain_at(depth) - FACTOR, *DEPTHS_MM[first - 1 : first + 1]))


def row(point: Point, process: Process, surface_HV: float) -> list[str]:
    """Cells of one treatment of a point."""
    least = [
        shallowest_mm(lambda d, s=s: gain(process, d, surface_HV, point.stress, s)) for s in point.shapes
    ]
    usual = [gain(process, USUAL_NITRIDED_MM, surface_HV, point.stress, s) for s in point.shapes]
    most = [
        max(gain(process, float(depth), surface_HV, point.stress, s) for depth in DEPTHS_MM)
        for s in point.shapes
    ]
    found = [depth for depth in least if depth is not None]
    depth = span(found, " mm") if found else f"none; {span(most)} at most"
    return [point.name, process, f"{surface_HV:g}", depth, span(usual) if process == "nitrided" else "-"]


def span(values: list[float], unit: str = "") -> str:
    """Least and largest value to two decimals, one where both are the same."""
    low, high = f"{min(values):.2f}", f"{max(values):.2f}"
    return (low if low == high else f"{low} to {high}") + unit


def rule_hardness_HV(process_factor: float) -> float:
    """Hardness of an induction-hardened surface that the rule gives 1.3 times the strength of the core."""
    size = dimensions(SCENE)
    core = fatigue_strength_MPa(size.pin, size.pin_fillet, SCENE.material.ultimate_MPa or 0.0, process_factor)

    def more(surface_HV: float) -> float:
        layer = HardenedLayer("induction", 1.0, surface_HV, CORE_HV, CORE_HV)
        return surface_strength_MPa(layer) - FACTOR * core

    return float(brentq(more, 400.0, 1500.0))


def factor_table() -> str:
    rows = [row(point, process, hv) for point in POINTS for process, values in HARDNESS_HV for hv in values]
    return lines_of(("point", "process", "hardness HV", "depth worth 1.3", "gain at 0.4 mm"), rows)


if __name__ == "__main__":
    print(factor_table())
    print(
        *(f"By the rule, process factor {k:g}: {rule_hardness_HV(k):.0f} HV" for k in (1.0, 1.05)), sep="\n"
    )
