"""Clear lines out of a pydantic validation error: each problem with its key path and a next step."""

from __future__ import annotations

import operator
import types
import typing
from collections.abc import Iterator, Sequence
from dataclasses import replace
from difflib import get_close_matches
from functools import reduce
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from cranktopo.base.errors import CranktopoError, quoted, suggest
from cranktopo.base.faults import MISSING, UNKNOWN_KEY, Fault, faults_of
from cranktopo.base.table import UNSHOWN_TEXT

_MOST = 20
"""Problems that are listed; whoever has more has another file in hand."""
_MEANT = {
    "diameter_mm": "outer_diameter_mm",
    "outer_radius_mm": "outer_diameter_mm",
    "bore_mm": "bore_diameter_mm",
    "inner_diameter_mm": "bore_diameter_mm",
    "rod_mass_kg": "rod_kg",
    "connecting_rod_kg": "rod_kg",
    "stroke_mm": "radius_mm",
    "throw_mm": "radius_mm",
    "E_MPa": "E_GPa",
    "youngs_modulus_GPa": "E_GPa",
    "nu": "poisson",
    "rpm": "speed_rpm",
}
"""Other names of keys that no likeness of letters finds."""
_NUMBERS = {
    "float_type": "a finite number",
    "finite_number": "a finite number",
    "int_type": "an integer",
    "int_parsing_size": "an integer",
}
_BOUNDS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")


_ROOT: list[type[BaseModel]] = []


def register_root(root: type[BaseModel]) -> None:
    """Name the table whose keys are explained; the schema, which comes later, does it once."""
    _ROOT[:] = [root]


def explain(error: ValidationError, source: str, table: tuple[str, ...] = ()) -> CranktopoError:
    """Return all problems of a validation error as one error: one line, or one per problem below a headline.

    Args:
        table: where in the scene the validated table is.
    """
    return listed(_problems(faults_of(error), table), source)


def explain_unknown(error: ValidationError, source: str) -> CranktopoError | None:
    """The unknown keys among the problems of a validation error, as `explain`; None where there are none."""
    found = [fault for fault in faults_of(error) if fault.kind == UNKNOWN_KEY]
    return listed(_problems(found, ()), source) if found else None


def listed(problems: Sequence[tuple[str, str]], source: str) -> CranktopoError:
    """Problems, each with its next step, as one error: one line, or one per problem below a headline."""
    if len(problems) == 1:
        message, hint = problems[0]
        return CranktopoError(f"{source}: {message}.", hint=hint)
    lines = [f"  {message}. {hint}".rstrip() for message, hint in problems[:_MOST]]
    more = [f"  and {len(problems) - _MOST} more."] if len(problems) > _MOST else []
    return CranktopoError("\n".join([f"{source}: {len(problems)} errors.", *lines, *more]))


def _problems(found: list[Fault], table: tuple[str, ...]) -> list[tuple[str, str]]:
    """Message and next step of each problem, unknown keys first; a misspelt key is not missing too."""
    faults = [replace(fault, place=(*table, *fault.place)) for fault in map(_of_text, found)]
    unknown = [fault for fault in faults if fault.kind == UNKNOWN_KEY]
    meant = {(*fault.place[:-1], _nearest(fault.place)) for fault in unknown}
    missing = [fault for fault in faults if fault.kind == MISSING and fault.place not in meant]
    values = [fault for fault in faults if fault.kind not in (UNKNOWN_KEY, MISSING)]
    return [_describe(fault, _dotted(fault.place)) for fault in (*unknown, *missing, *values)]


def _of_text(fault: Fault) -> Fault:
    """Return a problem of a text as one of its own place: its table, which found it, tells itself."""
    if fault.kind != UNSHOWN_TEXT:
        return fault
    place = fault.context["place"]
    return replace(fault, place=(*fault.place, *place), value=reduce(operator.getitem, place, fault.value))


def _describe(fault: Fault, path: str) -> tuple[str, str]:
    if not fault.place:
        return f"{quoted(fault.value)}: must be a table", "Give the tables of a scene."
    if fault.kind == UNKNOWN_KEY:
        return f"unknown key {path}", _instead(fault.place)
    if fault.kind == MISSING:
        table, _, key = path.rpartition(".")
        return f"{path} is missing", f"Add {key} to {f'[{table}]' if table else 'the scene'}."
    if fault.kind in ("union_tag_invalid", "union_tag_not_found"):
        return _choice(fault, path)
    value = f"{path} = {quoted(fault.value)}"
    if fault.kind == "library":
        value = f"{path}.name = {quoted(fault.value['name'])}"
        return f"{value}: {fault.message}", fault.context["hint"]
    if fault.kind == "statement":
        value = path if isinstance(fault.value, dict) else value
        return f"{value}: {fault.message}", fault.context["hint"]
    limits = _limits(fault.place)
    if fault.kind in _NUMBERS:
        bounds = f" {limits}" if limits else ""
        unquoted = " without quotes" if isinstance(fault.value, str) else ""
        return f"{value}: must be {_NUMBERS[fault.kind]}{bounds}{unquoted}", "Correct that value."
    if fault.kind in _BOUNDS:
        return f"{value}: must be {limits}", "Correct that value, or its unit."
    text = fault.message.replace("Input should be", "must be")
    return f"{value}: {text}", "Correct that value."


def _choice(fault: Fault, path: str) -> tuple[str, str]:
    tag = str(fault.context["discriminator"]).strip("'")
    table = fault.value if isinstance(fault.value, dict) else {}
    valid = sorted(name for model in _models(_annotation(fault.place)) for name in _tags(model))
    if tag not in table:
        return f"{path}.{tag} is missing", f"Valid: {', '.join(valid)}."
    return f"{path}.{tag} = {quoted(table[tag])}: unknown choice", suggest(str(table[tag])[:100], valid)


def _instead(loc: tuple[int | str, ...]) -> str:
    """Return what to write instead of an unknown key: the key it is like, its table, or all keys."""
    key = str(loc[-1])
    near = _nearest(loc)
    if near is not None:
        return f"Did you mean '{near}'?"
    found = [(table, needed) for table, name, needed in _all_keys(_ROOT[0]) if name == key]
    homes = [table for table, needed in found if needed] or [table for table, _ in found]
    if homes:
        tables = [f"[{home}]" if home else "the top of the file" for home in sorted(set(homes))[:3]]
        return f"It belongs to {' or '.join(tables)}."
    return f"Valid: {', '.join(_valid_keys(loc[:-1]))}."


def _nearest(loc: tuple[int | str, ...]) -> str | None:
    key, valid = str(loc[-1])[:100], _valid_keys(loc[:-1])
    if _MEANT.get(key) in valid:
        return _MEANT[key]
    if any(name == key for _, name, _ in _all_keys(_ROOT[0])):
        return None  # the right key in the wrong table
    near = get_close_matches(key, valid, n=1, cutoff=0.7)
    return near[0] if near else None


def _limits(loc: tuple[int | str, ...]) -> str:
    words = []
    for sign, name in ((">=", "ge"), (">", "gt"), ("<=", "le"), ("<", "lt")):
        found = [getattr(rule, name) for rule in _rules(_field(loc)) if getattr(rule, name, None) is not None]
        words += [f"{sign} {found[-1]:g}"] if found else []
    return " and ".join(words)


def _rules(annotation: Any) -> Iterator[Any]:
    if isinstance(annotation, FieldInfo):
        yield from annotation.metadata
        yield from _rules(annotation.annotation)
        return
    for part in typing.get_args(annotation):
        if isinstance(part, FieldInfo):
            yield from part.metadata
        elif part is not Ellipsis:
            yield from _rules(part)


def _walked(loc: tuple[int | str, ...]) -> Iterator[tuple[int | str | None, Any]]:
    """Yield each part of a location with the type there; a union tag, which pydantic inserts, is no part."""
    annotation: Any = _ROOT[0]
    for part in loc:
        tag = _is_tag(annotation, part)
        annotation = _member(annotation, str(part)) if tag else _child(annotation, part)
        yield None if tag else part, annotation


def _dotted(loc: tuple[int | str, ...]) -> str:
    """Location without union tags: `web.obround.width_mm` is `web.width_mm`."""
    parts = [part for part, _ in _walked(loc) if part is not None]
    path = (f"[{part}]" if isinstance(part, int) else f".{quoted(part)[1:-1]}" for part in parts)
    return "".join(path).removeprefix(".")


def _annotation(loc: tuple[int | str, ...]) -> Any:
    return [_ROOT[0], *(annotation for _, annotation in _walked(loc))][-1]


def _field(loc: tuple[int | str, ...]) -> Any:
    table, key = _annotation(loc[:-1]), loc[-1]
    for model in _models(table):
        if key in _fields(model):
            return _fields(model)[str(key)]
    return _field(loc[:-1]) if isinstance(key, int) and len(loc) > 1 else None


def _valid_keys(loc: tuple[int | str, ...]) -> list[str]:
    return sorted({name for model in _models(_annotation(loc)) for name in _fields(model)})


def _all_keys(table: Any, path: str = "", needed: bool = True) -> Iterator[tuple[str, str, bool]]:
    """Yield table and name of every key, and whether every scene has the table."""
    for model in _models(table):
        for name, field in _fields(model).items():
            yield path, name, needed
            below = f"{path}.{name}" if path else name
            yield from _all_keys(field.annotation, below, needed and field.is_required())


def _fields(model: type[BaseModel]) -> dict[str, FieldInfo]:
    return {field.alias or name: field for name, field in model.model_fields.items()}


def _models(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if typing.get_origin(annotation) in (typing.Union, types.UnionType, typing.Annotated, tuple):
        return [model for arg in typing.get_args(annotation) for model in _models(arg)]
    return []


def _tags(model: type[BaseModel]) -> set[str]:
    return {
        tag
        for name in ("outline", "shape", "kind")
        if name in model.model_fields
        for tag in typing.get_args(model.model_fields[name].annotation)
    }


def _is_tag(annotation: Any, part: int | str) -> bool:
    models = _models(annotation)
    return len(models) > 1 and any(part in _tags(model) for model in models)


def _member(annotation: Any, tag: str) -> Any:
    return next(model for model in _models(annotation) if tag in _tags(model))


def _child(annotation: Any, part: int | str) -> Any:
    if isinstance(part, int):
        return next((a for a in typing.get_args(annotation) if a is not Ellipsis), None)
    for model in _models(annotation):
        if part in _fields(model):
            return _fields(model)[part].annotation
    return None
