"""Stress concentration of overlapped cranks by elements over their proportions, beside the rule IACS UR M53.

The rule's polynomials are a fit of measured cranks. One ratio varies at a time about a throw within their
validity: overlap, thickness and width of the web, radius of both fillets, over the diameter of the crankpin.
Pin and journal are solid, of one diameter, 100 mm, and 0.8 of it long; the web is obround.
`python -m tests.validation.concentration_map` solves the throws anew and writes `data/concentration.csv`.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cranktopo.design.schema import Scene
from cranktopo.tasks.throw_fatigue.m53 import ConcentrationFactors, concentration_factors, dimensions
from cranktopo.tasks.throw_fatigue.rule_fillets import element_factors
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.fea.evaluation_cases import throw_scene
from tests.validation.table import lines_of

STORED = Path(__file__).parent / "data" / "concentration.csv"
DIAMETER_MM, LENGTH_MM = 100.0, 80.0
FRACTION = 0.35
"""Elements in the fillets over the radius: all factors but that of shear are within 1.1 % of the finest."""
FACTORS = {
    "alpha_bending": "pin, bending",
    "alpha_torsion": "pin, torsion",
    "beta_bending": "journal, bending",
    "beta_torsion": "journal, torsion",
}
"""Without the shear factor of the journal, which is the remainder of two large stresses."""


@dataclass(frozen=True)
class Ratios:
    """Ratios of a throw over the diameter of its crankpin."""

    overlap: float = 0.2
    thickness: float = 0.35
    width: float = 1.5
    fillet: float = 0.06

    def scene(self) -> Scene:
        d = DIAMETER_MM
        journal = {"outer_diameter_mm": d, "length_mm": LENGTH_MM, "fillet_mm": self.fillet * d}
        throw = {"radius_mm": (1 - self.overlap) * d, "main_journal": journal, "crankpin": journal}
        web = {"thickness_mm": self.thickness * d, "width_mm": self.width * d, "outline": "obround"}
        return throw_scene(throw, web)

    def by_rule(self) -> ConcentrationFactors:
        return concentration_factors(dimensions(self.scene()))

    def by_elements(self, fraction: float = FRACTION) -> ConcentrationFactors:
        kinds = ("moment", "bending", "torsion")
        return element_factors(solve_stresses(Target("throw", self.scene()), kinds, fraction, by_rule=True))


VALUES: dict[str, tuple[float, ...]] = {
    "overlap": (-0.2, 0.0, 0.2, 0.3, 0.4),
    "thickness": (0.25, 0.35, 0.45, 0.55),
    "width": (1.2, 1.5, 1.8, 2.1),
    "fillet": (0.04, 0.06, 0.09, 0.12),
}
"""Of each ratio, the others being those of `Ratios()`; below an overlap of 0 pin and journal lie apart."""


def family(ratio: str) -> list[Ratios]:
    """Throws in which one ratio varies."""
    return [replace(Ratios(), **{ratio: value}) for value in VALUES[ratio]]


def throws() -> list[Ratios]:
    """All throws, each once."""
    return list(dict.fromkeys(one for ratio in VALUES for one in family(ratio)))


def stored() -> dict[Ratios, ConcentrationFactors]:
    """Factors of every throw by elements."""
    with STORED.open(encoding="utf-8", newline="") as file:
        lines = [[float(value) for value in line] for line in list(csv.reader(file))[1:]]
    return {Ratios(*line[:4]): ConcentrationFactors(*line[4:]) for line in lines}


def off_percent(factor: str, ratio: str) -> NDArray[np.float64]:
    """Return the excess of the rule over the elements along a family."""
    found = stored()
    pairs = [(getattr(one.by_rule(), factor), getattr(found[one], factor)) for one in family(ratio)]
    return np.array([100 * (rule / elements - 1) for rule, elements in pairs])


def table() -> str:
    """Least and largest difference of each factor over each family."""
    rows = []
    for factor, name in FACTORS.items():
        off = [off_percent(factor, ratio) for ratio in VALUES]
        rows.append((name, *(f"{round(one.min()):+d} to {round(one.max()):+d} %" for one in off)))
    ranges = (f"{ratio} {values[0]:g} to {values[-1]:g}" for ratio, values in VALUES.items())
    return lines_of(("fillet, load", *ranges), rows)


def draw(path: Path) -> None:
    """Draw the polynomials as curves and the elements as points, one panel for each ratio and load."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    found = stored()
    with rc_context({"svg.hashsalt": "cranktopo", "svg.fonttype": "none"}):
        figure = Figure(figsize=(11.0, 5.6), layout="constrained")
        for row, load in zip(figure.subplots(2, 4, sharey="row"), ("bending", "torsion"), strict=True):
            for axes, ratio in zip(row, VALUES, strict=True):
                values = VALUES[ratio]
                fine = [replace(Ratios(), **{ratio: x}) for x in np.linspace(values[0], values[-1], 40)]
                xs = [getattr(one, ratio) for one in fine]
                for fillet, colour in (("alpha", "tab:blue"), ("beta", "tab:red")):
                    factor = f"{fillet}_{load}"
                    points = [getattr(found[one], factor) for one in family(ratio)]
                    curve = [getattr(one.by_rule(), factor) for one in fine]
                    axes.plot(xs, curve, color=colour, label=f"{FACTORS[factor]}, rule")
                    axes.plot(values, points, "o", color=colour, ms=4, label=f"{FACTORS[factor]}, elements")
                axes.set_xlabel(f"{ratio} / pin diameter")
            row[0].set_ylabel("concentration factor")
            row[0].set_ylim(bottom=0)
            row[-1].legend(frameon=False, fontsize=8)
        figure.savefig(path, metadata={"Date": None})


def _lines() -> Iterator[tuple[str | float, ...]]:
    yield (*(one.name for one in fields(Ratios)), *(one.name for one in fields(ConcentrationFactors)))
    for one in throws():
        yield (*astuple(one), *(f"{value:.5g}" for value in astuple(one.by_elements())))


if __name__ == "__main__":
    rows = list(_lines())
    with STORED.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)
