"""What an effect costs: extra solves, cells and seconds, estimated before anything is solved."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from cranktopo.domain.build import GridContent
from cranktopo.domain.resolution import estimated_cells
from cranktopo.scene import Scene
from cranktopo.scene.geometry import Journal


@dataclass(frozen=True)
class Cost:
    """Extra work of an effect; negative where it saves work.

    Attributes:
        solves: solves in each iteration of the optimiser, or once of the evaluation.
        cells: cells of the optimiser's grid or elements of the evaluation's mesh.
    """

    solves: float = 0.0
    cells: int = 0
    seconds: float = 0.0

    def as_json(self) -> dict[str, Any]:
        """The cost as numbers."""
        return {"solves": self.solves, "cells": self.cells, "seconds": self.seconds}

    def __str__(self) -> str:
        parts = []
        if self.solves:
            parts.append(f"{self.solves:+g} solve" + ("s" if abs(self.solves) > 1 else ""))
        if self.cells:
            parts.append(f"{self.cells:+d} cells")
        if self.seconds:
            parts.append(f"{self.seconds:+.0f} s")
        return ", ".join(parts) if parts else "nothing"


@dataclass(frozen=True)
class CostRates:
    """Rates that turn solves and cells into seconds; measured ones may replace these orders of magnitude.

    Attributes:
        iterations: designs until an optimisation converges; 31 on the built-in engine.
        seconds_per_cell_solve: one load case of one design iteration, per cell; 2.9e-6 to 4.8e-6 on two
            cores ("Cost of effects", docs/pages/archive.md), without compilation.
        seconds_per_element: one direct solve per quadratic tetrahedron; an order of magnitude.
    """

    iterations: int = 35
    seconds_per_cell_solve: float = 4e-6
    seconds_per_element: float = 5e-4


class Costing:
    """Costs of a scene's effects at given rates."""

    def __init__(self, scene: Scene, rates: CostRates, mirrored: bool) -> None:
        self._scene = scene
        self._rates = rates
        self._mirrored = mirrored

    @property
    def half_throw_cells(self) -> int:
        """Cells of the half throw's grid at the resolution."""
        edge = self._scene.optimise.resolution_mm
        return round(estimated_cells(self._scene, edge, quarter=False, target=_target(self._scene)))

    def load_case(self) -> Cost:
        """One more solve in every iteration."""
        cells = self.half_throw_cells // (2 if self._mirrored else 1)
        return Cost(1.0, 0, self._optimiser_seconds(cells))

    def mirror(self) -> Cost:
        """Half of the cells less, for one load case."""
        cells = self.half_throw_cells // 2
        return Cost(0.0, -cells, -self._optimiser_seconds(cells))

    def fatigue(self) -> Cost:
        """A mesh fine enough for stresses in the fillets, and two load states: a tenth of a solve each."""
        throw = self._scene.throw
        cells = _fillet_elements(throw.main_journal) + _fillet_elements(throw.crankpin)
        return Cost(2.0, cells, 1.2 * cells * self._rates.seconds_per_element)

    def _optimiser_seconds(self, cells: int) -> float:
        iterations = min(self._scene.optimise.max_iterations, self._rates.iterations)
        return cells * self._rates.seconds_per_cell_solve * iterations


def _target(scene: Scene) -> GridContent:
    """What the grid holds; a throw whose envelope is absent, or its file gone, is not optimised."""
    envelope = scene.envelope
    gone = envelope is not None and envelope.stl_file is not None and not envelope.stl_file.is_file()
    return "web" if envelope is None or gone else "envelope"


def _fillet_elements(journal: Journal) -> int:
    """Tetrahedra along both fillets of a journal.

    IACS UR M53 Appendix III: edges of a quarter of the radius along and around the fillet, three layers in
    depth; five tetrahedra fill a brick.
    """
    if journal.fillet_mm == 0:
        return 0
    edge = journal.fillet_mm / 4
    around = 2 * math.pi * journal.radius_mm / edge
    along = math.pi / 2 * journal.fillet_mm / edge
    return int(2 * around * along * 3 * 5)
