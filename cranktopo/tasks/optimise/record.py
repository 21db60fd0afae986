"""Everything that a finished run says about itself: what its page is a function of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import LoadAnalysis
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.viewer.scene3d import DesignSnapshot
from cranktopo.tasks.fea.case_stress import CaseStress


@dataclass(frozen=True)
class RunRecord:
    """A finished optimise run.

    Attributes:
        folder: the run directory, as it was named.
        metrics, manifest: content of metrics.json and manifest.json.
        history: rows of history.csv.
        scene: the scene as it was simulated.
        loads: loads of its engine; None without an engine.
        mesh: surface of the half throw, mm; None where the density has none.
        snapshots: its intermediate designs, as far as they were kept.
        fatigue, accuracy, remodel: what those commands print with --json, where the run holds it.
        stress: of its load cases by the body-fitted evaluation, where it was solved.
    """

    folder: str
    metrics: Mapping[str, Any]
    manifest: Mapping[str, Any]
    history: Sequence[Mapping[str, Any]]
    scene: Scene
    loads: LoadAnalysis | None
    mesh: SurfaceMesh | None
    snapshots: tuple[DesignSnapshot, ...]
    fatigue: Mapping[str, Any] | None
    accuracy: Mapping[str, Any] | None
    stress: CaseStress | None
    remodel: Mapping[str, Any] | None = None
