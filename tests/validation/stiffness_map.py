"""Torsional stiffness of throws by three formulae of practice against elements, over their proportions.

Formulae of B. C. Carter (Engineering, 1928), W. Ker Wilson (Practical Solution of Torsional Vibration
Problems, 1956) and P. M. Heldt, each a sum S of lengths over fourth powers of diameters, with
k = pi G / (32 S). Journals and crankpin have the same diameter, 100 mm, length and bore, no fillets; the web
is obround; sections are free to move laterally. `python -m tests.validation.stiffness_map` meshes the throws
anew and writes `data/throw_stiffness.csv`.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.schema import Scene
from cranktopo.tasks.throw_fea.condense import condense, torsional_stiffness_Nm_per_rad
from tests.physics.fea.evaluation_cases import elastic, throw_scene
from tests.validation.table import lines_of

STORED = Path(__file__).parent / "data" / "throw_stiffness.csv"
DIAMETER_MM, LENGTH_MM = 100.0, 80.0
SHEAR_MPA = 210e3 / 2.6
ELEMENT_MM = DIAMETER_MM / 7
HEAD = "thickness", "width", "radius", "bore", "stiffness_Nm_per_rad"


@dataclass(frozen=True)
class Proportions:
    """Thickness and width of the web, throw radius and bore, over the diameter of the journals."""

    thickness: float
    width: float
    radius: float
    bore: float

    def scene(self) -> Scene:
        journal = {"outer_diameter_mm": DIAMETER_MM, "length_mm": LENGTH_MM}
        journal |= {"bore_diameter_mm": self.bore * DIAMETER_MM}
        shape = {"thickness_mm": self.thickness * DIAMETER_MM, "width_mm": self.width * DIAMETER_MM}
        throw = {"radius_mm": self.radius * DIAMETER_MM, "main_journal": journal, "crankpin": journal}
        return throw_scene(throw, shape | {"outline": "obround"})

    def by_formula(self) -> dict[str, float]:
        """Stiffness by each formula and by the mean of Carter and Ker Wilson, N m/rad."""
        d, length = DIAMETER_MM, LENGTH_MM
        h, b, r = self.thickness * d, self.width * d, self.radius * d
        j, flank = d**4 * (1 - self.bore**4), h * b**3
        sums = {
            "Carter": (length + 0.8 * h) / j + 0.75 * length / j + 1.5 * r / flank,
            "Ker Wilson": 2 * (length + 0.4 * d) / j + (r - 0.4 * d) / flank,
            "Heldt": (length + 0.4 * d) / j + 1.096 * length / j + 1.284 * r / flank,
        }
        found = {name: math.pi * SHEAR_MPA / (32e3 * s) for name, s in sums.items()}
        return found | {MEAN: (found["Carter"] + found["Ker Wilson"]) / 2}

    def by_elements(self, element_mm: float = ELEMENT_MM) -> float:
        scene = self.scene()
        model = elastic(mesh_throw(scene, element_mm, graded=False).mesh, scene)
        return torsional_stiffness_Nm_per_rad(condense(model, scene, "antisymmetric", "odd"), "free")


MEAN = "mean of Carter and Ker Wilson"
FORMULAE = "Carter", "Ker Wilson", "Heldt", MEAN
THICKNESSES, WIDTHS = (0.3, 0.4, 0.5, 0.6), (1.2, 1.4, 1.6, 1.8)
RADII, BORES = (0.6, 0.8, 1.0, 1.2), (0.0, 0.25, 0.4, 0.5)
WEBS = [[Proportions(h, b, 1.0, 0.0) for b in WIDTHS] for h in THICKNESSES]
JOURNALS = [[Proportions(0.45, 1.4, r, d) for r in RADII] for d in BORES]
"""Two sections through the range; the radius is below 1 where journal and crankpin overlap."""


def throws() -> Iterator[Proportions]:
    yield from (one for family in (WEBS, JOURNALS) for line in family for one in line)


def stored() -> dict[Proportions, float]:
    """Stiffness by elements of every throw, N m/rad."""
    with STORED.open(encoding="utf-8", newline="") as file:
        lines = [[float(value) for value in line] for line in list(csv.reader(file))[1:]]
    return {Proportions(*line[:4]): line[4] for line in lines}


def off_percent(formula: str, family: list[list[Proportions]]) -> NDArray[np.float64]:
    """Return the excess of a formula over the elements."""
    elements = stored()
    return np.array([[100 * (p.by_formula()[formula] / elements[p] - 1) for p in line] for line in family])


def table() -> str:
    """Least, mean and largest difference of each formula over both sections."""
    rows = []
    for formula in FORMULAE:
        off = np.concatenate([off_percent(formula, family).ravel() for family in (WEBS, JOURNALS)])
        within = 100 * float((np.abs(off) <= 12).mean())
        cells = *(f"{value:+.0f} %" for value in (off.min(), off.mean(), off.max())), f"{within:.0f} %"
        rows.append((formula, *cells))
    return lines_of(("formula", "least", "mean", "largest", "throws within 12 %"), rows)


def draw(path: Path) -> None:
    """Heat maps of the differences, one row for each section."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    sections = (
        (WEBS, "width / diameter", WIDTHS, "thickness / diameter", THICKNESSES),
        (JOURNALS, "throw radius / diameter", RADII, "bore / diameter", BORES),
    )
    with rc_context({"svg.hashsalt": "cranktopo", "svg.fonttype": "none"}):
        figure = Figure(figsize=(11.0, 5.6), layout="constrained")
        for row, (family, across, xs, up, ys) in zip(figure.subplots(2, 4), sections, strict=True):
            for axes, formula in zip(row, FORMULAE, strict=True):
                off = off_percent(formula, family)
                shown = axes.imshow(off, cmap="RdBu_r", vmin=-40, vmax=40, origin="lower", aspect="auto")
                for (i, j), value in np.ndenumerate(off):
                    axes.text(j, i, f"{round(value):+d}", ha="center", va="center", fontsize=8)
                axes.set_title(formula, fontsize=9)
                axes.set_xlabel(across)
                axes.set_ylabel(up)
                axes.set_xticks(range(len(xs)), [f"{x:g}" for x in xs])
                axes.set_yticks(range(len(ys)), [f"{y:g}" for y in ys])
        figure.colorbar(shown, ax=figure.axes, label="formula over elements, percent more")
        figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    found = [(*astuple(p), f"{p.by_elements():.6g}") for p in throws()]
    with STORED.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD, *found])
