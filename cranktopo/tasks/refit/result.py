"""remodel.json: the parametric web fitted to a run, and how true it is to the body."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from cranktopo.base.result import UNLESS_NONE, FileName, Result
from cranktopo.design.goal.balance_moved import MovedBalance, balance_quantities
from cranktopo.report.report_file import REPORT
from cranktopo.tasks.extraction.result import ShapedUndercuts
from cranktopo.tasks.refit.select import FitTrial, ResidualRegion
from cranktopo.tasks.throw_fea.result import EvaluationResult
from cranktopo.throw.manufacturing_limits import ProcessLimits

_Point = tuple[float, float, float]


class FittedParameter(Result):
    """A parameter of the fitted web before rounding."""

    name: str
    value: float
    unit: str


class Overlaps(Result):
    """Intersection over union of fitted web and body."""

    web: float
    half_throw: float


class SurfaceDistance(Result):
    """Distances between the surfaces of fitted web and body, both ways."""

    mean: float
    max: float
    max_at: list[float]


class WebMasses(Result):
    """Masses of fitted web and body, kg, each with what is bolted to it."""

    fitted: float
    body: float
    difference_percent: float


class RefitThrow(Result):
    """Mass and balance of a throw with what is bolted to its webs, rods left out but of the factor."""

    mass_kg: float
    unbalance_kg_mm: float
    """Positive toward the crankpin."""
    balance_factor_percent: float | None = UNLESS_NONE
    """Of the oscillating mass; None where the design has none."""

    @property
    def quantities(self) -> dict[str, float]:
        """Its balance by the names of the goal's quantities."""
        return balance_quantities(self.unbalance_kg_mm, self.balance_factor_percent)


class RefitThrows(Result):
    """Throws of the original web, of the body of the run, which has no fillets, and of the fitted web."""

    original: RefitThrow | None
    """None where a body from a file is the original."""
    body: RefitThrow
    fitted: RefitThrow
    moved: MovedBalance | None = UNLESS_NONE
    """A balance factor that left the original's and that no limit holds."""


class RefitStiffness(Result):
    """Evaluations, and differences of the fitted web without fillets from the body, which has none."""

    body: EvaluationResult
    fitted_without_fillets: EvaluationResult
    fitted: EvaluationResult
    difference_percent: dict[str, float]


class UnrepresentedRegion(Result):
    """A region that the parametric web cannot follow; its share is of the body's web."""

    kind: str
    volume_mm3: float
    centre_mm: _Point
    low_mm: _Point
    high_mm: _Point
    pair: bool
    face: str | None
    share_percent: float

    @classmethod
    def of(cls, region: ResidualRegion, web_mm3: float) -> UnrepresentedRegion:
        """Return what is told of a region of a body whose web has that volume."""
        return cls(**vars(region), share_percent=100 * region.volume_mm3 / web_mm3)


class RefitFiles(Result):
    """Files of a re-model."""

    design: FileName
    step: FileName = "half_throw.step"
    stl: FileName = "half_throw.stl"
    drawing: FileName = "drawing.png"
    drawing_svg: FileName = "drawing.svg"
    result: FileName = Field(default="remodel.json", alias="json")
    report: FileName = REPORT


class RefitResult(Result):
    """A fitted web; `remodel --json` prints it with the folder that it is in."""

    schema_version: int = 1
    run: str
    design: str
    web: dict[str, Any]
    parameters: list[FittedParameter]
    iou: Overlaps
    distance_mm: SurfaceDistance
    web_mass_kg: WebMasses
    throws: RefitThrows | None = UNLESS_NONE
    """None in results of an earlier version."""
    stiffness: RefitStiffness | None
    trials: list[FitTrial]
    overlap_by_start: list[float]
    not_represented: list[UnrepresentedRegion]
    rules: ProcessLimits
    """Limits of the fit, with what the design's process requires of its features; `free` requires nothing."""
    undercuts: ShapedUndercuts | None = UNLESS_NONE
    """The check by rays through the solid that was written; None in results of an earlier version."""
    files: RefitFiles
    seconds: dict[str, float]
    folder: str | None = UNLESS_NONE
