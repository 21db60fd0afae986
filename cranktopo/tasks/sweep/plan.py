"""A sweep as it was asked for: scenes, what varies, how it is sampled, how far each point goes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, get_args

from pydantic import ConfigDict

from cranktopo.base.errors import CranktopoError, ExitCode, invalid, quoted, suggest
from cranktopo.base.reproducible import SEED
from cranktopo.base.result import Result
from cranktopo.design.halves import require_equal_halves
from cranktopo.design.loading import (
    check_keys,
    design_text,
    resolve_design,
    scene_from_dict,
    with_value,
)
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.pitch import JOURNAL_LENGTHS
from cranktopo.design.scene_files import with_resolved_files
from cranktopo.design.schema import Scene
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.sweep.fineness import Fineness
from cranktopo.tasks.sweep.variation import (
    MOST,
    STAGE,
    Variation,
    read_entry,
    varied_limits,
    with_goal_tables,
)
from cranktopo.tasks.throw_fea.stage import MeshRequest

Stage = Literal["evaluate", "fatigue", "optimise", "remodel", "shape"]
_STAGES: tuple[Stage, ...] = get_args(Stage)
OPTIMISED: tuple[Stage, ...] = ("optimise", "remodel", "shape")
"""Stages that work on one web, which is that of both halves."""
"""Keys of the lengths that follow where the pitch is kept."""
_CHOICES = {
    "sampling": ("grid", "latin", "sobol"),
    STAGE: _STAGES,
    "refine": ("all", "front"),
    "keep": ("journals", "pitch"),
}
"""Settings that take one of a few words, the first by default."""


class SweepPlan(Result):
    """All that a sweep consists of, as its manifest keeps it; its points follow from it alone."""

    model_config = ConfigDict(extra="forbid")

    designs: tuple[str, ...]
    """Each scene as the user typed it."""
    tables: tuple[dict[str, Any], ...]
    """The tables of each scene as they are written, file names absolute; the first is the original."""
    vary: tuple[Variation, ...] = ()
    """Keys that vary in every scene."""
    sampling: Literal["grid", "latin", "sobol"] = "grid"
    """All combinations, or as many `samples` of a Latin hypercube or a Sobol sequence."""
    samples: int | None = None
    stage: Stage = "evaluate"
    """Last stage of a point where `stage` does not vary."""
    element_size_mm: int | float | None = None
    """Of evaluations; None leaves the default. An integer stays one, as the hashes of points hold it."""
    accuracy_percent: int | float | None = None
    """Evaluations are refined until the bound of their error is no larger."""
    refine: Literal["all", "front"] = "all"
    """Every point at full accuracy, or those alone that a coarse first look does not rule out."""
    budget_s: int | float | None = None
    """Time for points at full accuracy after the first look."""
    keep: Literal["journals", "pitch"] = "journals"
    """Dimension that stays when webs or pins get longer: main journals, or the pitch of the throws."""
    seed: int = SEED

    @property
    def fineness(self) -> Fineness:
        """Of a point at full accuracy."""
        return Fineness(self.element_size_mm, self.accuracy_percent)

    @property
    def original(self) -> Scene:
        """The scene that the points are compared with."""
        return scene_from_dict(self.tables[0], self.designs[0], whole=True)

    @property
    def stages(self) -> tuple[Stage, ...]:
        """The stages that its points go to."""
        varied = {value for variation in self.vary if variation.key == STAGE for value in variation.values}
        return tuple(stage for stage in _STAGES if stage in varied) or (self.stage,)


def sweep_plan(
    designs: Sequence[DesignLike],
    vary: Sequence[Variation] = (),
    *,
    minimise: str | None = None,
    maximise: str | None = None,
    limits: Sequence[str] = (),
    **settings: Any,
) -> SweepPlan:
    """Return a plan that was checked: every design is valid, every key exists.

    Args:
        designs: scenes, TOML paths or names of built-in designs; the first is the original.
        limits: such as `torsion >= 90:130:5 %`, which varies, or `bending >= 95 %`, which stays.
        settings: further fields of `SweepPlan`.

    Raises:
        CranktopoError: no such design or an invalid one, an unknown key, or settings that do not fit.
    """
    if not designs:
        raise invalid("scenes", list(designs), "at least one is needed", "Name a design.")
    scenes = [as_scene(design) for design in designs]
    names = [design.name if isinstance(design, Scene) else str(design) for design in designs]
    fixed, varied = varied_limits(limits)
    tables = [
        with_goal_tables(_tables(design), name, minimise, maximise, fixed)
        for design, name in zip(designs, names, strict=True)
    ]
    for key, words in _CHOICES.items():
        _check_choice(key, settings.get(key, words[0]), words)
    plan = SweepPlan(designs=tuple(names), tables=tuple(tables), vary=(*vary, *varied), **settings)
    _check(plan)
    optimised = set(plan.stages) & set(OPTIMISED)
    for scene in scenes if optimised else ():
        require_equal_halves(scene)
    if (minimise or maximise or limits) and not optimised:
        raise _misused(
            f"stage {plan.stage} has no goal",
            f"Add --stage {', '.join(OPTIMISED[:-1])} or {OPTIMISED[-1]}.",
        )
    return plan


def _check_choice(key: str, value: str, words: Sequence[str]) -> None:
    if value not in words:
        near = suggest(value[:100], list(words))
        raise CranktopoError(f"{key} = {quoted(value)}: unknown choice.", hint=near, code=ExitCode.USAGE)


def _tables(design: DesignLike) -> dict[str, Any]:
    if isinstance(design, Scene):
        return design.model_dump(mode="json", exclude_none=True)
    path = resolve_design(str(design))
    return with_resolved_files(parse_toml(design_text(str(design)), str(path)), path.resolve().parent)


def _check(plan: SweepPlan) -> None:
    MeshRequest(plan.element_size_mm, plan.accuracy_percent)
    if plan.budget_s is not None and plan.refine != "front":
        raise _misused("--budget is time for what a first look does not rule out", "Add --refine front.")
    keys = [variation.key for variation in plan.vary]
    for key in set(keys) & set(JOURNAL_LENGTHS) if plan.keep == "pitch" else ():
        raise _misused(f"{key} varies, and the pitch decides it", "Leave out --keep pitch.")
    for key in (key for key in keys if keys.count(key) > 1):
        raise _misused(f"{key} varies twice", "Give all its values at once.")
    for stage in (s for one in plan.vary if one.key == STAGE for s in one.values or ("a range",)):
        _check_choice(STAGE, str(stage), _STAGES)
    _check_sampling(plan)
    for design, tables in zip(plan.designs, plan.tables, strict=True):
        for variation in (one for one in plan.vary if one.key != STAGE):
            tables = with_value(tables, variation.key, variation.at(0.0))
        check_keys(tables, design)


def _check_sampling(plan: SweepPlan) -> None:
    ranges = [variation.key for variation in plan.vary if variation.ends is not None]
    if plan.sampling != "grid":
        if not 1 <= (plan.samples or 0) <= MOST:
            what = f"sampling {plan.sampling} needs a number of samples up to {MOST}"
            raise _misused(what, "Add --samples.")
        if not plan.vary:
            raise _misused("nothing varies", "Add --vary KEY=A:B.")
        return
    if plan.samples is not None:
        raise _misused("samples are of a Latin hypercube or a Sobol sequence", "Add --sampling latin.")
    if ranges:
        raise _misused(f"{ranges[0]} has two ends and no number of values", "Write A:B:N, or add --sampling.")
    count = len(plan.designs) * math.prod(len(variation.values) for variation in plan.vary)
    if count > MOST:
        raise _misused(f"{count} points are more than {MOST}", "Take fewer values, or --sampling sobol.")


def _misused(what: str, hint: str) -> CranktopoError:
    return CranktopoError(f"sweep: {what}.", hint=hint, code=ExitCode.USAGE)


_WORDS = ("stage", "sampling", "refine", "keep", "minimise", "maximise")
_NUMBERS = {"element_size_mm": (1e-3, 1e3), "accuracy_percent": (1e-3, 99.0), "budget_s": (1.0, 1e8)}
"""Keys with their smallest and largest value."""
_KEYS = ("schema_version", "design", "scenes", "samples", "limits", "vary", *_WORDS, *_NUMBERS)


def read_plan(file: Path) -> SweepPlan:
    """Return the plan in a TOML file: `design` or `scenes`, `[vary]`, and what `sweep_plan` takes by name."""
    data = parse_toml(design_text(str(file)), str(file))
    unknown = [key for key in data if key not in _KEYS]
    if unknown:
        raise CranktopoError(f"{file}: unknown key {unknown[0]}.", hint=suggest(unknown[0], list(_KEYS)))
    if data.get("schema_version", 1) != 1:
        raise invalid(f"{file}: schema_version", data["schema_version"], "must be 1")
    settings: dict[str, Any] = {key: str(data[key]) for key in _WORDS if key in data}
    settings |= {key: _number(file, data, key) for key in _NUMBERS if key in data}
    designs = _designs(file, data)
    vary, samples, limits = data.get("vary", {}), data.get("samples"), data.get("limits", [])
    if not isinstance(vary, dict):
        raise invalid(f"{file}: vary", vary, "must be a table", "Write [vary].")
    varied = [read_entry(key, entry) for key, entry in _flat(vary)]
    if samples is not None and (not isinstance(samples, int) or isinstance(samples, bool)):
        raise invalid(f"{file}: samples", samples, "must be an integer")
    if not isinstance(limits, list) or not all(isinstance(text, str) for text in limits):
        raise invalid(f"{file}: limits", limits, "must be a list of texts")
    return sweep_plan(designs, varied, samples=samples, limits=limits, **settings)


def is_plan(text: str) -> bool:
    """Tell whether what the user typed is the file of a sweep and no design."""
    path = Path(text)
    if path.suffix.lower() != ".toml" or not path.is_file():
        return False
    data = parse_toml(design_text(text), text)
    return "throw" not in data and bool({"vary", "design", "scenes", "sampling"} & data.keys())


def _designs(file: Path, data: Mapping[str, Any]) -> list[str]:
    names = data.get("scenes", [data["design"]] if "design" in data else [])
    if ("design" in data) == ("scenes" in data) or not isinstance(names, list):
        raise CranktopoError(
            f"{file}: needs either design or scenes.",
            hint='Write design = "mikron-iiic", or scenes = ["a.toml", "b.toml"].',
        )
    paths = [(str(name), file.resolve().parent / str(name)) for name in names]
    return [str(path) if path.is_file() else name for name, path in paths]


def _flat(table: Mapping[str, Any], head: str = "") -> list[tuple[str, Any]]:
    """Return entries by their whole key, be it `"web.width_mm"`, `web.width_mm` or `[vary.web] width_mm`."""
    found: list[tuple[str, Any]] = []
    for key, value in table.items():
        path = f"{head}{key}"
        found += _flat(value, f"{path}.") if isinstance(value, dict) else [(path, value)]
    return found


def _number(file: Path, data: Mapping[str, Any], key: str) -> float:
    value, (low, high) = data[key], _NUMBERS[key]
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise invalid(f"{file}: {key}", value, f"must be a number >= {low:g} and <= {high:g}")
    return float(value)
