"""A sweep as it was asked for: scenes, what varies, how it is sampled, how far each point goes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from cranktopo.base.errors import CranktopoError, ExitCode, invalid, quoted, suggest
from cranktopo.base.reproducible import SEED
from cranktopo.design.halves import require_equal_halves
from cranktopo.design.loading import (
    design_text,
    load_scene,
    parse_toml,
    resolve_design,
    scene_from_dict,
    with_resolved_files,
)
from cranktopo.design.schema import Scene
from cranktopo.design.varying import check_keys, with_value
from cranktopo.tasks.fea.stage import MeshRequest
from cranktopo.tasks.sweep.fineness import Fineness
from cranktopo.tasks.sweep.variation import (
    MOST,
    STAGE,
    Variation,
    as_json,
    from_json,
    read_entry,
    varied_limits,
    with_goal_tables,
)

Stage = Literal["evaluate", "fatigue", "optimise", "remodel", "shape"]
_STAGES: tuple[Stage, ...] = get_args(Stage)
OPTIMISED: tuple[Stage, ...] = ("optimise", "remodel", "shape")
"""Stages that work on one web, which is that of both halves."""
_Sampling = Literal["grid", "latin", "sobol"]
_SAMPLINGS: tuple[_Sampling, ...] = get_args(_Sampling)
_Refine = Literal["all", "front"]
REFINE: tuple[_Refine, ...] = get_args(_Refine)


@dataclass(frozen=True)
class SweepPlan:
    """What a sweep consists of; its points follow from it and from nothing else.

    Attributes:
        designs: name of each scene as the user typed it.
        tables: the tables of each scene as they are written, file names absolute; the first is the original.
        vary: what varies in every scene.
        sampling: all combinations, or as many samples of a Latin hypercube or a Sobol sequence.
        stage: how far a point goes where `stage` does not vary.
        element_size_mm: of evaluations; None leaves the default.
        accuracy_percent: evaluations are refined until the bound of their error is no larger.
        refine: every point at full accuracy, or those alone that a coarse first look does not rule out.
        budget_s: time for points at full accuracy after the first look.
    """

    designs: tuple[str, ...]
    tables: tuple[dict[str, Any], ...]
    vary: tuple[Variation, ...] = ()
    sampling: _Sampling = "grid"
    samples: int | None = None
    stage: Stage = "evaluate"
    element_size_mm: float | None = None
    accuracy_percent: float | None = None
    refine: _Refine = "all"
    budget_s: float | None = None
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

    def as_json(self) -> dict[str, Any]:
        """Plain data, from which `plan_from_json` makes the same plan."""
        return {
            "designs": list(self.designs),
            "tables": list(self.tables),
            "vary": [as_json(variation) for variation in self.vary],
            "sampling": self.sampling,
            "samples": self.samples,
            "stage": self.stage,
            "element_size_mm": self.element_size_mm,
            "accuracy_percent": self.accuracy_percent,
            "refine": self.refine,
            "budget_s": self.budget_s,
            "seed": self.seed,
        }


def plan_from_json(data: Mapping[str, Any]) -> SweepPlan:
    """Return the plan that `as_json` told."""
    vary = tuple(from_json(entry) for entry in data["vary"])
    kept = {**data, "designs": tuple(data["designs"]), "tables": tuple(data["tables"]), "vary": vary}
    return SweepPlan(**kept)


def sweep_plan(
    designs: Sequence[str],
    vary: Sequence[Variation] = (),
    sampling: str = "grid",
    samples: int | None = None,
    stage: str = "evaluate",
    element_size_mm: float | None = None,
    accuracy_percent: float | None = None,
    refine: str = "all",
    budget_s: float | None = None,
    minimise: str | None = None,
    maximise: str | None = None,
    limits: Sequence[str] = (),
) -> SweepPlan:
    """Return a plan that was checked: every design is valid, every key exists.

    Args:
        designs: TOML paths or names of built-in designs; the first is the original.
        limits: such as `torsion >= 90:130:5 %`, which varies, or `bending >= 95 %`, which stays.

    Raises:
        CranktopoError: no such design or an invalid one, an unknown key, or settings that do not fit.
    """
    if not designs:
        raise invalid("scenes", list(designs), "at least one is needed", "Name a design.")
    scenes = [load_scene(design, whole=True) for design in designs]
    fixed, varied = varied_limits(limits)
    plan = SweepPlan(
        tuple(designs),
        tuple(with_goal_tables(_tables(d), d, minimise, maximise, fixed) for d in designs),
        (*vary, *varied),
        _one_of("sampling", sampling, _SAMPLINGS),
        samples,
        _one_of("stage", stage, _STAGES),
        element_size_mm,
        accuracy_percent,
        _one_of("refine", refine, REFINE),
        budget_s,
    )
    _check(plan)
    if set(plan.stages) & set(OPTIMISED):
        for scene in scenes:
            require_equal_halves(scene)
    if (minimise or maximise or limits) and not set(plan.stages) & set(OPTIMISED):
        raise _misused(
            f"stage {plan.stage} has no goal",
            f"Add --stage {', '.join(OPTIMISED[:-1])} or {OPTIMISED[-1]}.",
        )
    return plan


def _one_of(key: str, value: str, words: tuple[Any, ...]) -> Any:
    if value not in words:
        near = suggest(value[:100], list(words))
        raise CranktopoError(f"{key} = {quoted(value)}: unknown choice.", hint=near, code=ExitCode.USAGE)
    return value


def _tables(design: str) -> dict[str, Any]:
    path = resolve_design(design)
    return with_resolved_files(parse_toml(design_text(design), str(path)), path.resolve().parent)


def _check(plan: SweepPlan) -> None:
    MeshRequest(plan.element_size_mm, plan.accuracy_percent)
    if plan.budget_s is not None and plan.refine != "front":
        raise _misused("--budget is time for what a first look does not rule out", "Add --refine front.")
    keys = [variation.key for variation in plan.vary]
    twice = next((key for key in keys if keys.count(key) > 1), None)
    if twice is not None:
        raise _misused(f"{twice} varies twice", "Give all its values at once.")
    for variation in plan.vary:
        if variation.key == STAGE:
            for value in variation.values or ("a range",):
                _one_of(STAGE, str(value), _STAGES)
    _check_sampling(plan)
    for design, tables in zip(plan.designs, plan.tables, strict=True):
        for variation in plan.vary:
            if variation.key != STAGE:
                tables = with_value(tables, variation.key, variation.at(0.0))
        check_keys(tables, design)


def _check_sampling(plan: SweepPlan) -> None:
    ranges = [variation.key for variation in plan.vary if variation.ends is not None]
    if plan.sampling != "grid":
        if plan.samples is None or not 1 <= plan.samples <= MOST:
            raise _misused(
                f"sampling {plan.sampling} needs a number of samples up to {MOST}", "Add --samples."
            )
        if not plan.vary:
            raise _misused("nothing varies", "Add --vary KEY=A:B.")
        return
    if plan.samples is not None:
        raise _misused("samples are of a Latin hypercube or a Sobol sequence", "Add --sampling latin.")
    if ranges:
        raise _misused(f"{ranges[0]} has two ends and no number of values", "Write A:B:N, or add --sampling.")
    count = len(plan.designs)
    for variation in plan.vary:
        count *= len(variation.values)
    if count > MOST:
        raise _misused(f"{count} points are more than {MOST}", "Take fewer values, or --sampling sobol.")


def _misused(what: str, hint: str) -> CranktopoError:
    return CranktopoError(f"sweep: {what}.", hint=hint, code=ExitCode.USAGE)


_WORDS = ("stage", "sampling", "refine", "minimise", "maximise")
_NUMBERS = {"element_size_mm": (1e-3, 1e3), "accuracy_percent": (1e-3, 99.0), "budget_s": (1.0, 1e8)}
"""Keys with their least and greatest value."""
_KEYS = ("schema_version", "design", "scenes", "samples", "limits", "vary", *_WORDS, *_NUMBERS)


def read_plan(file: Path) -> SweepPlan:
    """The plan in a TOML file: `design` or `scenes`, `[vary]`, and the settings of `sweep_plan` by name.

    Raises:
        CranktopoError: an unknown key, or as `sweep_plan`.
    """
    data = parse_toml(design_text(str(file)), str(file))
    unknown = [key for key in data if key not in _KEYS]
    if unknown:
        raise CranktopoError(f"{file}: unknown key {unknown[0]}.", hint=suggest(unknown[0], list(_KEYS)))
    if data.get("schema_version", 1) != 1:
        raise invalid(f"{file}: schema_version", data["schema_version"], "must be 1")
    words: dict[str, Any] = {key: str(data[key]) for key in _WORDS if key in data}
    numbers: dict[str, Any] = {key: _number(file, data, key) for key in _NUMBERS if key in data}
    return sweep_plan(
        _designs(file, data),
        [read_entry(key, entry) for key, entry in _flat(_table(file, data, "vary"))],
        samples=_count(file, data),
        limits=_texts(file, data, "limits"),
        **words,
        **numbers,
    )


def is_plan(text: str) -> bool:
    """Tell whether what the user typed is the file of a sweep and no design."""
    path = Path(text)
    if path.suffix.lower() != ".toml" or not path.is_file():
        return False
    data = parse_toml(design_text(text), text)
    return "throw" not in data and bool({"vary", "design", "scenes", "sampling"} & data.keys())


def _designs(file: Path, data: Mapping[str, Any]) -> list[str]:
    """Designs by name, or by their path from the folder of the file."""
    given = data.get("scenes", [data["design"]] if "design" in data else [])
    if ("design" in data) == ("scenes" in data) or not isinstance(given, list):
        raise CranktopoError(
            f"{file}: needs either design or scenes.",
            hint='Write design = "mikron-iiic", or scenes = ["a.toml", "b.toml"].',
        )
    paths = [(str(name), file.resolve().parent / str(name)) for name in given]
    return [str(path) if path.is_file() else name for name, path in paths]


def _flat(table: Mapping[str, Any], head: str = "") -> list[tuple[str, Any]]:
    """Entries by their whole key: `"web.width_mm"`, `web.width_mm` and `[vary.web] width_mm` are the same."""
    found: list[tuple[str, Any]] = []
    for key, value in table.items():
        path = f"{head}{key}"
        found += _flat(value, f"{path}.") if isinstance(value, dict) else [(path, value)]
    return found


def _table(file: Path, data: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = data.get(key, {})
    if not isinstance(value, dict):
        raise invalid(f"{file}: {key}", value, "must be a table", f"Write [{key}].")
    return value


def _count(file: Path, data: Mapping[str, Any]) -> int | None:
    value = data.get("samples")
    if value is not None and (not isinstance(value, int) or isinstance(value, bool)):
        raise invalid(f"{file}: samples", value, "must be an integer")
    return value


def _texts(file: Path, data: Mapping[str, Any], key: str) -> list[str]:
    value = data.get(key, [])
    if not isinstance(value, list) or not all(isinstance(text, str) for text in value):
        raise invalid(f"{file}: {key}", value, "must be a list of texts")
    return value


def _number(file: Path, data: Mapping[str, Any], key: str) -> float:
    value, (low, high) = data[key], _NUMBERS[key]
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise invalid(f"{file}: {key}", value, f"must be a number >= {low:g} and <= {high:g}")
    return float(value)
