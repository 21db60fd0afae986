"""Results of a sweep, as `sweep.json` holds them: points with their numbers, Pareto front, picks."""

from __future__ import annotations

from typing import Any, Self

from pydantic import ConfigDict, model_validator

from cranktopo.base.files import is_inside
from cranktopo.base.result import UNLESS_NONE, FileName, Result
from cranktopo.tasks.sweep.plan import Stage
from cranktopo.tasks.sweep.variation import Value

DONE, IMPOSSIBLE, FAILED = "done", "impossible", "failed"
"""End of a point: with numbers, with a reason why there is no such web, by a failed solve or worker."""
COARSE, FULL = "coarse", "full"
"""The accuracy at which a point stands, where points are computed coarse first."""
ERRORS = {
    "torsion_Nm_per_rad": "torsion_error_percent",
    "torsion_per_mass_Nm_per_rad_kg": "torsion_error_percent",
    "bending_N_per_mm": "bending_error_percent",
    "bending_per_mass_N_per_mm_kg": "bending_error_percent",
}
"""Number that holds the error of another one."""
VIEW = "view"
"""Body of a point as text for the page; no table holds it."""


class PointResult(Result):
    """One point; its numbers are further keys, units in their names, and differ from stage to stage."""

    model_config = ConfigDict(extra="allow")

    id: str
    """Beginning of the SHA-256 over scene and settings: the name of its directory."""
    stage: Stage
    """Last stage of the point."""
    design: str
    """The design that it is a variant of."""
    varied: dict[str, Value]
    """Value of every key that varies."""
    sha256: str
    """Over scene and settings."""
    run: str
    """Its directory below that of the sweep; empty for a point that cannot be."""
    status: str
    """End of the point: done, impossible or failed."""
    reason: str
    """Why it has no numbers; empty for a point that has."""
    version: str
    """Version of cranktopo that computed it."""

    @model_validator(mode="after")
    def _check_files(self) -> Self:
        for name in (self.run, self.number("target")):
            if name and not (isinstance(name, str) and is_inside(name)):
                raise ValueError("leads out of its folder")
        return self

    @property
    def numbers(self) -> dict[str, Any]:
        """Its numbers by name, and what else its stage told: target for `compare`, seconds, how it ended."""
        return dict(self.model_extra or {})

    def number(self, name: str) -> Any:
        """Return a number by its name; None where the point does not have it."""
        return (self.model_extra or {}).get(name)

    def row(self) -> dict[str, Any]:
        """Return all of it by name, as one row of a table."""
        return {**vars(self), **self.numbers}


class SweepFiles(Result):
    """Files beside `sweep.json`."""

    table: FileName
    parquet: FileName
    page: FileName


class SweepSeconds(Result):
    """Time of the last run of the sweep."""

    total: float


class SweepResult(Result):
    """A finished sweep."""

    schema_version: int = 1
    run: str
    """Name of its directory."""
    design: str
    """The first design, which the points are compared with."""
    varied: tuple[str, ...]
    """Keys that vary."""
    sampling: str
    """Choice of the points: grid, latin or sobol."""
    points: tuple[PointResult, ...]
    ends: dict[str, int]
    """Number of points that ended in each way."""
    original: PointResult
    """The first design as it is."""
    objectives: dict[str, str]
    """Quantities that the front compares, each with `less` or `more`, whichever is better."""
    front: tuple[str, ...]
    """Ids of the points that no other one beats."""
    picks: dict[str, str]
    """Ids of the points that most users look for."""
    operating_conditions: tuple[str, ...] | None = UNLESS_NONE
    """Keys of speed and load that vary: in front and picks a web counts by its condition of least safety."""
    balance: str | None = UNLESS_NONE
    """Distance of the points' balance from that of the original with its counterweights, in words; if any."""
    left_off: tuple[str, ...] | None = UNLESS_NONE
    """Loads that the safeties do not count although they are above the threshold, in words, by design."""
    undecided: tuple[str, ...] | None = UNLESS_NONE
    """Ids of coarse points that may be on the front, for which the budget left no time."""
    files: SweepFiles
    seconds: SweepSeconds
