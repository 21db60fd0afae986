"""Functions of a scene that sweeps of tests compute: numbers without a mesh, and a trace of every call."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.schema import Scene
from cranktopo.tasks.sweep.result import PointResult
from cranktopo.throw.outline import ObroundWeb

WIDTH, FILLET = "web.width_mm", "throw.crankpin.fillet_mm"
TRACE, HELD, CALLS = "CRANKTOPO_TEST_TRACE", "CRANKTOPO_TEST_SECONDS", "CRANKTOPO_TEST_CALLS"


def width_mm(scene: Scene) -> float:
    """Width of the web, which is an obround in every design of these sweeps."""
    assert isinstance(scene.web, ObroundWeb)
    return scene.web.width_mm


def empty(scene: Scene) -> dict[str, float]:
    """Numbers that cost nothing; each call leaves a line, and takes as long as is asked for.

    After as many calls as are asked for none comes to an end.
    """
    time.sleep(float(os.environ.get(HELD, "0")))
    if TRACE in os.environ:
        trace = Path(os.environ[TRACE])
        calls = len(trace.read_text(encoding="ascii").splitlines())
        if calls >= float(os.environ.get(CALLS, "inf")):
            time.sleep(3600)
        with trace.open("a", encoding="ascii") as file:
            file.write(f"{scene.name}\n")
    width = width_mm(scene)
    return {"mass_kg": width / 30, "torsion_Nm_per_rad": 1000 * (width - 10 * scene.throw.crankpin.fillet_mm)}


def failing(scene: Scene) -> dict[str, float]:
    """Fails in every way by the width of the web."""
    width = width_mm(scene)
    if width == 51:
        raise CranktopoError("the solver failed.", code=ExitCode.SOLVER)
    if width == 52:
        raise CranktopoError("no such web.")
    if width == 53:
        raise ZeroDivisionError("a defect")
    return empty(scene)


def deadly(scene: Scene) -> dict[str, float]:
    """Kills its worker, once or always, by the width of the web."""
    width, trace = width_mm(scene), Path(os.environ[TRACE])
    once = trace.with_name(f"{scene.name}.once")
    if width == 52 or (width == 51 and not once.exists()):
        once.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return empty(scene)


def point_result(name: str, **told: Any) -> PointResult:
    """A point that ended, with numbers by name; what it is made of does not matter."""
    known = {"stage": "evaluate", "design": "mikron-iiic-plain", "varied": {}, "status": "done", "reason": ""}
    return PointResult(
        **{"id": name, "sha256": name, "run": f"points/{name}", "version": "0", **known, **told}
    )
