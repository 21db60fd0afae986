"""The parametric web that a run left, and the design whose own web is its original."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from pydantic import Field

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import inside, read_json
from cranktopo.base.notes import note
from cranktopo.base.result import Result
from cranktopo.design.halves import WebName, difference
from cranktopo.design.loading import builtin_designs, load_scene, one_web
from cranktopo.design.named import DesignLike
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_from_run
from cranktopo.engine.one_throw import one_throw, worse_web
from cranktopo.runs.directories import RUNS, RunStore, open_run, runs_named
from cranktopo.runs.kind import EACH_WEB, LOOP, SHAPE, has_result, kind_of, result_file, resume_command
from cranktopo.runs.stored import unchanged, unchanged_result

REMODEL = "remodel.json"
_WEB = "web.toml"


class LoopWeb(Result):
    """A web of a loop: the original one, that of a step, or that of the shape optimisation."""

    name: str = ""
    number: int

    @property
    def words(self) -> str:
        """The web in a sentence: `step 6`, or `shape`."""
        return SHAPE if self.name == SHAPE else f"step {self.number}"

    @property
    def folder(self) -> str:
        """Name of its folder in the loop's directory."""
        return SHAPE if self.name == SHAPE else f"step-{self.number:02d}"


Row = TypeVar("Row", bound=LoopWeb)


class _ShapeVerdict(Result):
    better_than_best_step: bool


class _Loop(Result):
    """Keys of iterate.json that tell which web is best."""

    best_step: int | None
    steps: list[LoopWeb] = Field(default_factory=list)
    shape: _ShapeVerdict | None = None


@dataclass(frozen=True)
class WebTarget:
    """Meaning of a target to a command that works with dimensions: the scene whose own web is the original.

    Attributes:
        file: scene of the web to begin with, a TOML file; None where that is the design's own web.
        run: where the web comes from; without a file its re-model is still to be made.
    """

    design: Scene
    file: Path | None = None
    run: RunStore | None = None

    @property
    def begun(self) -> Scene | RunStore | None:
        """Start of a shape optimisation, as it takes it."""
        return self.run if self.file is None else load_scene(str(self.file))


def web_target(
    text: DesignLike, web: WebName | None = None, throw: int | None = None, *, worse: bool = False
) -> WebTarget:
    """Return a target: a design, one of its two webs, a scene, its file, a run, or the folder of a re-model.

    Args:
        worse: of two webs without a name take the one that bends more, with a line that names it.

    Raises:
        CranktopoError: none of these, a run that is not finished, or two webs and none of them named.
    """
    if isinstance(text, Scene):
        return _of_design(text, web, throw, worse)
    path, text = Path(text), str(text)
    if web and path.suffix != ".toml" and text not in builtin_designs():
        raise CranktopoError(
            f"--web {web}: names a web of a design, and '{text}' is none.",
            hint="Leave it out: a run is of one web.",
            code=ExitCode.USAGE,
        )
    if (path / REMODEL).is_file():
        return _of_remodel(path)
    named = not path.exists() and text not in builtin_designs() and bool(runs_named(text))
    if not (path.is_dir() or named):
        return _of_design(load_scene(text, whole=True), web, throw, worse)
    run = open_run(text)
    return WebTarget(design_from_run(run), _run_web(run), run)


def _of_design(scene: Scene, web: WebName | None, throw: int | None, worse: bool) -> WebTarget:
    """Return the web asked for of a throw whose halves differ, or the worse one, which a line names."""
    taken = one_throw(scene, throw)
    if worse and web is None and difference(taken):
        web = worse_web(taken)
        other = "second" if web == "first" else "first"
        note(f"{taken.name}: the {web} web is taken, which bends more; --web {other} takes the other")
    return WebTarget(one_web(taken, web))


def parametric_scene(text: str, target: WebTarget) -> Scene:
    """Return the scene whose web has dimensions; raises CranktopoError for a run without such a web."""
    if target.run is not None and target.file is None:
        raise CranktopoError(
            f"target '{text}': the run has no parametric web, whose dimensions could be changed.",
            hint=f"Make one: {shlex.join(['cranktopo', 'remodel', text])}",
        )
    return target.design if target.file is None else load_scene(str(target.file))


def _run_web(run: RunStore) -> Path | None:
    """Return the scene file of a run's web: its result, its best, its newest re-model; None without one."""
    kind = kind_of(run)
    if not has_result(run):
        raise CranktopoError(
            f"run '{run.path}': is not finished and has no web yet.",
            hint=f"Continue it: {resume_command(run)}",
        )
    if kind == EACH_WEB:
        raise CranktopoError(
            f"run '{run.path}': has a web for every place of a crank.",
            hint="Name its design, or the folder of one of its searches.",
        )
    if kind == SHAPE:
        return run.unchanged(_WEB)
    if kind != LOOP:
        return _newest_remodel(run)
    loop = _Loop.read(result_file(run))
    best = best_web(loop.steps, loop.best_step, loop.shape is not None and loop.shape.better_than_best_step)
    if best is None:
        raise CranktopoError(
            f"run '{run.path}': its loop found no better web.", hint="Begin with its design instead."
        )
    return unchanged(run.path / best.folder / _WEB)


def _newest_remodel(run: RunStore) -> Path | None:
    """Return the scene file of the newest re-model of a run, in it or beside it or under runs/."""
    places = ((run.path, 1), (run.path.resolve().parent, 1), (RUNS, 1), (RUNS, 2))
    found = {file.resolve() for folder, depth in places for file in folder.glob("*/" * depth + REMODEL)}
    remodels = [file for file in found if read_json(unchanged_result(file)).get("run") == run.name]
    newest = max(remodels, key=lambda file: (file.stat().st_mtime_ns, str(file)), default=None)
    return None if newest is None else _design_of(newest.parent)


def _design_of(folder: Path) -> Path:
    files = read_json(unchanged_result(folder / REMODEL)).get("files")
    name = files.get("design") if isinstance(files, dict) else None
    if not isinstance(name, str):
        raise CranktopoError(
            f"re-model '{folder}': its {REMODEL} names no design.", hint="Make it anew: cranktopo remodel RUN"
        )
    return unchanged(inside(folder, name))


def _of_remodel(folder: Path) -> WebTarget:
    """Return the folder of a re-model; its original is that of the run that it was made of."""
    name = read_json(unchanged_result(folder / REMODEL)).get("run")
    beside = folder.resolve().parent
    for place in (beside, beside / str(name), RUNS / str(name)):
        if place.name == name and (place / "manifest.json").is_file():
            run = open_run(str(place))
            return WebTarget(design_from_run(run), _design_of(folder), run)
    file = shlex.quote(str(_design_of(folder)))
    raise CranktopoError(
        f"re-model '{folder}': the run '{name}' that it was made of is gone, so its original is not known.",
        hint=f"Give its scene, which then is its own original: {file}",
    )


def best_web(steps: Sequence[Row], best_step: int | None, shape_is_better: bool) -> Row | None:
    """Return the web of the shape optimisation where it is better than the best step, else that step's."""
    if shape_is_better:
        return steps[-1]
    return None if best_step is None else steps[best_step]
