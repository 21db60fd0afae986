"""Undamaged files of every kind that is damaged: bodies, runs, studies, imported cranks, benches."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import patch

import pytest

from cranktopo import shape_settings
from cranktopo.app.main import main
from cranktopo.base.files import write_text
from cranktopo.base.machine import this_machine
from cranktopo.base.progress import Json
from cranktopo.bodies.solid.files import export_solid, kernel_surface_of
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import design_text, load_scene
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.numerics.surfaces.files import write_surface
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.accuracy.stage import pareto_front
from cranktopo.tasks.accuracy.study import Study
from cranktopo.tasks.bench.project import Project
from cranktopo.tasks.sweep.job import Job, do_job
from cranktopo.tasks.throw_fea.studies import EVALUATION, Level, store_study
from cranktopo.tasks.web_shape import evaluated_web
from cranktopo.tasks.web_shape import run as shape_run
from cranktopo.tasks.web_shape.each_web import rounds, run
from tests import sweep_cases
from tests.cli.test_iterate import ARGUMENTS, with_stand_ins
from tests.plain_runs import plain_loops, plain_runs
from tests.shaft_stand_in import told_shaft
from tests.shape_stand_in import ShapeStandIn

DESIGN = "mikron-iiic-plain"
Files = dict[str, bytes]
BODIES = ("step", "stl", "brep", "3mf", "obj")
CACHE = "cache"
"""Folder of stored studies beside a case."""
_SKIPPED = (".lock", ".html", ".png", ".vtu", ".parquet")


def made(kind: str, folder: Path) -> Files:
    """The undamaged files of a kind by name."""
    if kind in BODIES:
        _body(kind, folder / f"x.{kind}")
    else:
        _STORED[kind](folder)
    found = [file for file in folder.rglob("*") if file.is_file() and not file.name.endswith(_SKIPPED)]
    return {str(file.relative_to(folder)): file.read_bytes() for file in found}


def _body(kind: str, path: Path) -> None:
    scene = load_scene(DESIGN)
    if kind in ("step", "stl"):
        export_solid(scene, "half", path, 6.0)
    elif kind == "3mf":
        write_surface(path, kernel_surface_of(scene, "throw"), "3mf")
    elif kind == "obj":
        path.write_text(_obj(kernel_surface_of(scene, "throw")), encoding="utf-8")
    else:
        export_solid(scene, "throw", path.with_suffix(".step"))
        _as_brep(path.with_suffix(".step"), path)
        path.with_suffix(".step").unlink()


def _obj(mesh: SurfaceMesh) -> str:
    points = "".join("v {:.7g} {:.7g} {:.7g}\n".format(*point) for point in mesh.vertices_mm)
    return points + "".join("f {} {} {}\n".format(*(face + 1)) for face in mesh.faces)


def _as_brep(step: Path, path: Path) -> None:
    from cranktopo.numerics.gmsh_session import cad_session

    with cad_session("throw") as gmsh:
        gmsh.model.occ.importShapes(str(step))
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))


def _optimise(folder: Path) -> None:
    words = ["optimise", DESIGN, "--volume-fraction", "0.3", "--resolution-mm", "4.5", "--quiet"]
    with plain_runs():
        assert main([*words, "--max-iterations", "3", "--out", str(folder / "run")]) == 5


def _sweep(folder: Path) -> None:
    """A sweep that the command line began and resumes, its stage of the numbers of `sweep_cases`."""

    def stage(name: str, scene: Scene, place: Path, fineness: object) -> Json:
        write_text(place / "design.toml", toml_text(scene, f"Point: {name}"))
        numbers = sweep_cases.empty(scene)
        per_mass = {"torsion_per_mass_Nm_per_rad_kg": numbers["torsion_Nm_per_rad"] / numbers["mass_kg"]}
        return {**numbers, **per_mass, "target": "design.toml"}

    def compute(jobs: Sequence[Job], pool: object, done: Callable[..., None], enough: object) -> None:
        for job in jobs:
            done(job, do_job(job))

    words = ["sweep", DESIGN, "--vary", "web.width_mm=50,52,54", "--out", str(folder / "run"), "--quiet"]
    where = "cranktopo.tasks.sweep"
    with patch(f"{where}.job.run_stage", stage), patch(f"{where}.computed.compute", compute):
        assert main(words) == 0


def _shape(folder: Path) -> None:
    goal = with_goal(load_scene(DESIGN), minimise="mass")
    ShapeStandIn().design(goal, shape_settings(goal), folder / "run", "", ["cranktopo", "shape"], None)


def _iterate(folder: Path) -> None:
    with pytest.MonkeyPatch.context() as patched, plain_loops():
        with_stand_ins(patched)
        assert main([*ARGUMENTS, "--out", str(folder / "run"), "--quiet"]) == 0


def _each_web(folder: Path) -> None:
    safeties = (1.2, 1.3, 1.6, 1.5, 1.5, 1.6, 1.3, 1.2)
    after = iter([told_shaft((1.2,) * 8, 5.6), told_shaft((1.2,) * 8, 5.32)])
    search = ShapeStandIn({"mass": 90.0})
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(run, "loaded_shaft", lambda scene, fraction: told_shaft(safeties, 6.0))
        patched.setattr(rounds, "loaded_shaft", lambda design, fraction: next(after))
        patched.setattr(evaluated_web, "web_safety", lambda scene, judging: 2.0)
        patched.setattr(shape_run, "shape_design", search.design)
        patched.setattr(shape_run, "resume_shape", search.resume)
        words = ["shape", "mikron-iiic", "--each-web", "--quiet", "--out", str(folder / "run")]
        assert main(words) == 0


def _accuracy(folder: Path) -> None:
    """A study of two meshes, kept where commands with `--accuracy` look for it."""
    levels = tuple(
        Level(
            EVALUATION,
            f"graded {size:g}",
            "graded",
            {"steps": steps, "graded": True, "order": 2},
            size,
            1000,
            8.0 / size,
            200.0,
            {"torsion_Nm_per_rad": 1e5 + size**2, "bending_N_per_mm": 2e5 + size**2},
            0.3,
            0.5,
            {},
        )
        for steps, size in enumerate((4.0, 6.0, 9.0))
    )
    with patch.dict(os.environ, {"XDG_CACHE_HOME": str(folder / CACHE)}):
        found = pareto_front(Study(DESIGN, 30.0, 20.0, this_machine(), levels, (), False))
        assert store_study(DESIGN, found) is not None


def _remodel(folder: Path) -> None:
    """An optimise run with its re-model, the web of the design as what was fitted."""
    from cranktopo.tasks.refit import stage
    from cranktopo.tasks.refit.fit import FittedWeb

    _optimise(folder)
    fitted = FittedWeb(load_scene(DESIGN), ("web.width_mm",), (50.0,), (), (0.8,), ())
    with patch.object(stage, "fit_web", lambda *_, **__: fitted):
        assert main(["remodel", str(folder / "run"), "--no-evaluation", "--quiet"]) == 0


def _import(folder: Path) -> None:
    export_solid(load_scene(DESIGN), "throw", folder / "throw.step")
    assert main(["import", str(folder / "throw.step"), "--out", str(folder / "imported"), "--quiet"]) == 0


def _bench(folder: Path) -> None:
    text = design_text(DESIGN)
    (folder / "x.toml").write_text(text, encoding="utf-8")
    project = Project.opened(folder, text, "x.toml", "opened", "cranktopo bench x.toml")
    project.change({"web.width_mm": 52.0}, "wider")
    project.change({"web.thickness_mm": 20.0}, "thicker")
    project.close()


_STORED: dict[str, Callable[[Path], None]] = {
    "optimise": _optimise,
    "sweep": _sweep,
    "shape": _shape,
    "iterate": _iterate,
    "each-web": _each_web,
    "accuracy": _accuracy,
    "remodel": _remodel,
    "import": _import,
    "bench": _bench,
}


class BenchOfFiles:
    """Stand-in of a bench: it opens the session and reads all of it, without processes."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def open_text(self, text: str, source: str, what: str, command: str) -> None:
        from cranktopo.tasks.bench.jobs import Jobs

        project = Project.opened(self.folder, text, source, what, command)
        try:
            project.as_json()
            project.data()
            Jobs(project.place / "jobs").all()
        finally:
            project.close()


def server_of_files(bench: BenchOfFiles, **_: object) -> SimpleNamespace:
    """Stand-in of the server of a bench."""
    return SimpleNamespace(bench=bench, address="http://nowhere", close=lambda: None)
