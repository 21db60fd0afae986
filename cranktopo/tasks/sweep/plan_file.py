"""A sweep as a TOML file describes it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError, invalid, suggest
from cranktopo.design.loading import design_text, parse_toml
from cranktopo.tasks.sweep.plan import SweepPlan, sweep_plan
from cranktopo.tasks.sweep.variation import read_entry

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
