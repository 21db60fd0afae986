"""A shape optimisation that takes no time: the run directory of a real one, with a web that is known."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.goal.outcome import goal_outcome
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_from_run, toml_text
from cranktopo.runs.directories import RunStore, create_run, open_run
from cranktopo.tasks.web_shape.optimum import ShapeSettings
from cranktopo.tasks.web_shape.result import ShapeResult
from cranktopo.tasks.web_shape.run import ShapedRun, kept_settings
from tests.told_evaluation import told_evaluation

ORIGINAL = {
    "mass": 1.6,
    "torsion": 1600.0,
    "bending": 230.0,
    "torsion_per_mass": 1000.0,
    "bending_per_mass": 230 / 1.6,
    "fatigue_safety": 2.0,
}


LESS_SAFE_IN_SHAFT = {
    "original": 1.267,
    "result": 1.086,
    "required": None,
    "web": 8,
    "part": "journal_fillet",
    "speeds_rpm": [700.0, 2800.0],
    "fillet_fraction": 0.5,
}
"""What `shaft_check` of a result is, of a web that loses safety in its shaft."""


@dataclass
class ShapeStandIn:
    """What stands for `shape_design` and `resume_shape`; it ends in the web of the scene that it was given.

    Attributes:
        percent: of the original what the result has of mass, torsion, bending and fatigue safety.
        error: raised in place of a result while it is set.
        more: further keys of the result.
        asked: scene and start of every optimisation that was begun, and the folder of every continued one.
    """

    percent: dict[str, float] = field(default_factory=dict)
    error: CranktopoError | None = None
    more: dict[str, Any] = field(default_factory=dict)
    asked: list[Any] = field(default_factory=list)

    def design(
        self,
        scene: Scene,
        settings: ShapeSettings,
        out: Path,
        design_toml: str | None,
        command: list[str],
        begun: Scene | None,
    ) -> ShapedRun:
        self.asked.append((scene, settings, begun))
        run = create_run(
            design=scene.name,
            design_toml=toml_text(scene, "design"),
            scene=scene.model_dump(mode="json"),
            options={"shape": kept_settings(settings)},
            command=command,
            out=out,
        )
        return self._ended(run, scene)

    def resume(self, reference: str | Path, loads: Any = None) -> ShapedRun:
        run = open_run(reference)
        self.asked.append(run.path)
        return self._ended(run, design_from_run(run))

    def _ended(self, run: RunStore, scene: Scene) -> ShapedRun:
        if self.error is not None:
            run.set_status("interrupted" if self.error.code == ExitCode.INTERRUPTED else "failed")
            raise self.error
        (run.path / "web.toml").write_text(toml_text(scene.model_copy(update={"goal": None}), "result"))
        export_solid(scene, "half", run.path / "web.stl", 6.0)
        result = ShapeResult.of_json(self._data(scene), "shape.json")
        (run.path / "shape.json").write_text(json.dumps(result.as_json()))
        run.set_done(["shape.json", "web.stl", "web.toml"])
        return ShapedRun(run.path, result)

    def _data(self, scene: Scene) -> dict[str, Any]:
        goal = goal_of(scene)
        assert goal is not None
        now = {name: ORIGINAL[name] * self.percent.get(name, 100.0) / 100 for name in ORIGINAL}
        now |= {f"{name}_per_mass": now[name] / now["mass"] for name in ("torsion", "bending")}
        return {
            "design": scene.name,
            "status": "converged",
            "stop_reason": "as it was told",
            "original": told_evaluation(),
            "change_percent": {name: 100 * (now[name] / ORIGINAL[name] - 1) for name in now},
            "parameters": [],
            "worst_case_percent": {"tolerance": 0.1},
            "prices": [],
            "goal_on_cells": {},
            "prices_remainder_percent": 0.0,
            "rule_prices": [],
            "trials": [],
            "rounds": [],
            "best_round": 0,
            "iterations": 0,
            "evaluations": 0,
            "goal": goal_outcome(goal, now, ORIGINAL, 5e-4).as_json(),
            "values": {"original": ORIGINAL, "result": now},
            "result": told_evaluation(now["torsion"], now["bending"], now["mass"]),
            "seconds": {"total": 1.0},
            "files": {"design": "web.toml"},
            **self.more,
        }
