"""metrics.json of an optimise run, which `optimise --json` prints as well."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from pydantic import Field

from cranktopo.base.result import UNLESS_NONE, FileName, Result
from cranktopo.design.assumed import Assumption
from cranktopo.design.goal.balance_moved import MovedBalance
from cranktopo.design.goal.outcome import GoalOutcome
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.plan.effect import Effect
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.runs.directories import RunStore
from cranktopo.runs.kind import read_result
from cranktopo.tasks.bound.result import BoundStatements, NoBound
from cranktopo.tasks.density.state import CoarseStart
from cranktopo.tasks.extraction.result import NoSurface, RunSurface, ThrowMasses, WallMeasures
from cranktopo.tasks.throw_fea.quantities import MASS, STIFFNESS, Quantity, percent_change


class VolumeFraction(Result):
    """Share of the design space that is solid; a run with a goal has no target."""

    target: float | None
    reached: float


class CellSize(Result):
    """Edges of the cells, mm."""

    x: float
    y: float
    z_min: float
    z_max: float


class GridSummary(Result):
    """The cells of a run."""

    cells: list[int]
    cell_mm: float
    cell_size_mm: CellSize
    padding_cells: list[int]
    design_cells: int
    symmetry: list[str]
    extent: str


class CaseMetrics(Result):
    """A web under one load case in the optimiser's model; a body force has no stiffness."""

    stiffness_Nm_per_rad: float | None = UNLESS_NONE
    stiffness_N_per_mm: float | None = UNLESS_NONE
    error_estimate_percent: float | None = UNLESS_NONE
    compliance_N_mm: float
    support: str
    load: LoadCase

    @property
    def stiffness(self) -> float:
        """Stiffness, N m/rad or N/mm; 0 where there is none."""
        return self.stiffness_Nm_per_rad or self.stiffness_N_per_mm or 0.0


class OriginalWeb(Result):
    """The design's own web in the same model, and what the optimised one gains on it."""

    mass_kg: ThrowMasses
    load_cases: dict[str, CaseMetrics]
    stiffness_per_mass: dict[str, float]
    gain_of_stiffness_per_mass_percent: dict[str, float]


class Cycles(Result):
    """Multigrid cycles of a solve."""

    mean: float
    max: int


class SolverMetrics(Result):
    """Solver of a run and its accuracy."""

    precision: str
    tolerance: float
    cg_iterations: Cycles
    levels: int
    final_relative_residual: float


class RunSeconds(Result):
    """Wall times of a run, s; `total` is without the page until that is written."""

    total: float
    compile: float
    per_iteration_median: float
    iterations: float
    outputs: float
    evaluation: float | None = UNLESS_NONE
    bound: float | None = UNLESS_NONE
    report: float | None = UNLESS_NONE


class RunMetrics(Result):
    """All that an optimise run reached."""

    schema_version: int = 1
    run: str
    design: str
    status: str
    stop_reason: str
    iterations: int
    coarse_start: CoarseStart | None = UNLESS_NONE
    volume_fraction: VolumeFraction
    mass_kg: ThrowMasses
    greyness: float
    connected: bool
    grid: GridSummary
    load_cases: dict[str, CaseMetrics]
    stiffness_per_mass: dict[str, float]
    original_web: OriginalWeb
    goal: GoalOutcome | None = UNLESS_NONE
    """Goal and limits, by the evaluation where it judged them."""
    surface: RunSurface | NoSurface
    solver: SolverMetrics
    seconds: RunSeconds
    peak_memory_MiB: float
    files: dict[str, FileName]
    effects: tuple[Effect, ...]
    left_off: str | None = UNLESS_NONE
    """Loads that do not count although they are above the threshold, in words."""
    notices: list[str] = Field(default_factory=list)
    assumed: tuple[Assumption, ...] = ()
    balance: MovedBalance | None = UNLESS_NONE
    """Balance factor that moved, if no limit holds it there."""
    bound: NoBound | BoundStatements | None = UNLESS_NONE
    """Proven limit of every web of the envelope, beside the result."""

    @property
    def refusal(self) -> str:
        """Reason why the density has no surface; empty where it has one."""
        return self.surface.refusal if isinstance(self.surface, NoSurface) else ""

    @property
    def walls(self) -> WallMeasures | None:
        """Measured walls of the surface; None without a surface, or where nothing limits them."""
        return self.surface.walls if isinstance(self.surface, RunSurface) else None

    @property
    def changes_percent(self) -> dict[Quantity, float]:
        """Changes of mass and stiffnesses against the original web, %."""
        original = self.original_web
        found = {MASS: percent_change(self.mass_kg.throw, original.mass_kg.throw)}
        for quantity in STIFFNESS:
            if quantity.key in self.load_cases:
                webs = (self.load_cases[quantity.key], original.load_cases[quantity.key])
                found[quantity] = percent_change(*(case.stiffness for case in webs))
        return found

    @property
    def ended(self) -> str:
        """End of the run, and the number of its iterations, in words."""
        text = f"{self.status} after {self.iterations} iterations"
        first = self.coarse_start
        return f"{text}, and {first.iterations} before on cells of {first.cell_mm:.3g} mm" if first else text


class OptimisedRun(NamedTuple):
    """A finished optimise run."""

    folder: Path
    metrics: RunMetrics
    half_throw: SurfaceMesh | None
    """Its surface, mm; None where the density has none."""


def read_metrics(run: RunStore) -> RunMetrics | None:
    """Return what an optimise run reached; None before its end."""
    found = read_result(run)
    where = f"run '{run.path}': its results are damaged"
    return None if found is None else RunMetrics.of_json(found, where)
