"""Cost of an effect: extra solves, cells and seconds, estimated before anything is solved."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cranktopo.base.result import Result
from cranktopo.bodies.cells.layers import GridContent
from cranktopo.bodies.memory import estimated_cells
from cranktopo.design.goal.scene_goal import judged_by_evaluation
from cranktopo.design.halves import default_element_size_mm, usual_scale
from cranktopo.design.schema import Scene
from cranktopo.throw.journal import Journal

_BOUND_CELL_MM = 4.0


class Cost(Result):
    """Extra work of an effect; negative where it saves work."""

    solves: float = 0.0
    """Solves in each iteration of the optimiser, or once of the evaluation."""
    cells: int = 0
    """Cells of the optimiser's grid or elements of the evaluation's mesh."""
    seconds: float = 0.0

    def __str__(self) -> str:
        parts = []
        if self.solves:
            parts.append(f"{self.solves:+g} solve" + ("s" if abs(self.solves) > 1 else ""))
        if self.cells:
            parts.append(f"{self.cells:+d} cells")
        if self.seconds:
            parts.append(f"{self.seconds:+z.0f} s")
        return ", ".join(parts) if parts else "nothing"


def bound_cell_mm(scene: Scene) -> float:
    """Return the cells on which the bound beside a result is proven: those of the run, but not below 4 mm.

    Smaller ones move it by less than what a result lacks (docs/pages/bound.md). A throw of unusual size has
    them in proportion.
    """
    return max(scene.optimise.resolution_mm, _BOUND_CELL_MM / usual_scale(scene))


@dataclass(frozen=True)
class CostRates:
    """Rates that turn solves and cells into seconds; measured ones may replace these orders of magnitude.

    Attributes:
        iterations: designs until an optimisation converges; 31 on the built-in engine.
        seconds_per_solve: one load case of one design iteration, however few cells, without compilation.
        seconds_per_cell_solve: the same per cell; from default cells to those of 0.4 mm ("Fine cells",
            docs/pages/benchmarks.md) both together are what two cores take, within a quarter.
        seconds_per_element: one solve per quadratic tetrahedron; an order of magnitude.
        moves: how often limits are moved until they hold by the evaluation; 1 to 3 on the built-in engines.
        iterations_per_move: designs until an optimisation has converged again.
        bound_steps: designs until the searches of a bound beside a result have settled.
        seconds_per_evaluation: body-fitted, of a surface, default size and coarser mesh, on two cores.
    """

    iterations: int = 35
    seconds_per_solve: float = 0.03
    seconds_per_cell_solve: float = 0.8e-6
    seconds_per_element: float = 2e-4
    moves: int = 2
    iterations_per_move: int = 10
    bound_steps: int = 30
    seconds_per_evaluation: float = 15.0

    def solve_s(self, cells: float) -> float:
        """Return one load case of one design iteration."""
        return self.seconds_per_solve + cells * self.seconds_per_cell_solve


@dataclass(frozen=True)
class ExpectedWork:
    """Work of a density optimisation whatever its cells and load cases.

    Attributes:
        designs: solved in each iteration: the eroded one, too, where members or gaps have a least size.
        iterations: designs until it has converged in the cells.
        more_iterations: those after its limits were moved.
        evaluations: body-fitted, of the original, the first surface and one after each move.
        evaluation_seconds: of them all, at rates that were not measured on this machine.
    """

    designs: int
    iterations: int
    more_iterations: int
    evaluations: int
    evaluation_seconds: float


def effort(scene: Scene, rates: CostRates | None = None) -> ExpectedWork:
    """Return what the density optimisation of a scene is expected to do."""
    rates, settings = rates or CostRates(), scene.optimise
    lengths = (settings.min_member_mm, settings.min_gap_mm)
    moves = rates.moves if judged_by_evaluation(scene) else 0
    iterations = min(settings.max_iterations, rates.iterations)
    more = min(settings.max_iterations - iterations, moves * rates.iterations_per_move)
    evaluations = moves + 2 if moves else 0
    designs = 1 if lengths == (None, None) else 2
    return ExpectedWork(designs, iterations, more, evaluations, evaluations * rates.seconds_per_evaluation)


class Costing:
    """Costs of a scene's effects at given rates."""

    def __init__(self, scene: Scene, rates: CostRates, mirrored: bool) -> None:
        self._scene = scene
        self._rates = rates
        self._mirrored = mirrored
        self._effort = effort(scene, rates)

    @property
    def half_throw_cells(self) -> int:
        """Cells of the half throw's grid at the resolution."""
        edge = self._scene.optimise.resolution_mm
        return round(estimated_cells(self._scene, edge, quarter=False, target=_target(self._scene)))

    def load_case(self) -> Cost:
        """Return one more solve of each design in every iteration."""
        cells = self.half_throw_cells // (2 if self._mirrored else 1)
        seconds = self._optimiser_solves() * self._rates.solve_s(cells)
        return Cost(solves=float(self._effort.designs), seconds=seconds)

    def mirror(self) -> Cost:
        """Half of the cells less, for one load case."""
        cells = self.half_throw_cells // 2
        seconds = self._optimiser_solves() * cells * self._rates.seconds_per_cell_solve
        return Cost(cells=-cells, seconds=-seconds)

    def fatigue(self) -> Cost:
        """A mesh fine enough for stresses in the fillets, and two load states: a tenth of a solve each."""
        throw = self._scene.throw
        cells = _fillet_elements(throw.main_journal) + _fillet_elements(throw.crankpin)
        return Cost(solves=2.0, cells=cells, seconds=1.2 * cells * self._rates.seconds_per_element)

    def whole_throw(self, volume_mm3: float) -> Cost:
        """Elements of the evaluation without those that half of the volume needs, and their part of its time.

        Regular tetrahedra of the default size fill the throw, with nothing refined.
        """
        edge = default_element_size_mm(self._scene)
        cells = round(volume_mm3 / 2 / (edge**3 / (6 * math.sqrt(2))))
        return Cost(cells=cells, seconds=cells * self._rates.seconds_per_element)

    def bound(self) -> Cost:
        """Searches on cells of their own, once for both load cases."""
        edge = bound_cell_mm(self._scene)
        cells = round(estimated_cells(self._scene, edge, self._mirrored, _target(self._scene)))
        solves = 2 * self._rates.bound_steps
        return Cost(solves=float(solves), cells=cells, seconds=solves * self._rates.solve_s(cells))

    def _optimiser_solves(self) -> int:
        """Solves of a load case in the whole optimisation."""
        return self._effort.designs * (self._effort.iterations + self._effort.more_iterations)


def _target(scene: Scene) -> GridContent:
    """Return what the grid holds; a throw whose envelope is absent, or its file gone, is not optimised."""
    envelope = scene.envelope
    gone = envelope is not None and envelope.stl_file is not None and not envelope.stl_file.is_file()
    return "web" if envelope is None or gone else "envelope"


def _fillet_elements(journal: Journal) -> int:
    """Tetrahedra along both fillets of a journal.

    IACS UR M53 Appendix III: edges of a quarter of the (least) radius along and around the fillet, three
    layers in depth; five tetrahedra fill a brick.
    """
    if journal.fillet_mm == 0:
        return 0
    edge = journal.fillet.least_radius_mm / 4
    around = 2 * math.pi * journal.radius_mm / edge
    along = math.pi / 2 * journal.fillet.mean_mm / edge
    return int(2 * around * along * 3 * 5)
