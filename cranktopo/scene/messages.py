"""One clear line out of a pydantic validation error."""

from __future__ import annotations

import types
import typing
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from cranktopo.errors import CranktopoError, suggest
from cranktopo.scene.schema import Scene


def explain(error: ValidationError, source: str) -> CranktopoError:
    """The first problem of a validation error as a CranktopoError, and how many more there are.

    Args:
        error: what pydantic raised for the scene.
        source: file shown in front of the key path.
    """
    details = error.errors(include_url=False)
    # A misspelt key also shows up as the right key missing: name the misspelling.
    first = next((d for d in details if d["type"] == "extra_forbidden"), details[0])
    more = f" ({len(details) - 1} more)" if len(details) > 1 else ""
    path = ".".join(str(part) for part in _key_path(first["loc"]))
    message, hint = _describe(first, path)
    return CranktopoError(f"{source}: {message}{more}.", hint=hint)


def _describe(detail: ErrorDetails, path: str) -> tuple[str, str]:
    kind = detail["type"]
    if kind == "extra_forbidden":
        valid = _valid_keys(detail["loc"][:-1])
        return f"unknown key {path}", suggest(str(detail["loc"][-1]), valid)
    if kind == "missing":
        return f"{path} is missing", f"Add {path.rsplit('.', 1)[-1]} to the scene."
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        context = detail.get("ctx", {})
        tag = str(context.get("discriminator", "")).strip("'")
        valid = [
            word.strip(" '") for word in str(context.get("expected_tags", "")).split(",") if word.strip()
        ]
        value = context.get("tag")
        return f"{path}.{tag} = {value!r}: unknown choice", suggest(str(value), valid) if valid else (
            f"Give {tag}."
        )
    text = detail["msg"].replace("Input should be", "must be").replace("Value error, ", "")
    return f"{path} = {detail['input']!r}: {text}", "Correct that value."


def _key_path(loc: tuple[int | str, ...]) -> list[int | str]:
    """Location without the union tags that pydantic inserts (`web.obround.width_mm` -> `web.width_mm`)."""
    path: list[int | str] = []
    annotation: Any = Scene
    for part in loc:
        if _is_tag(annotation, part):
            annotation = _member(annotation, str(part))
            continue
        path.append(part)
        annotation = _child(annotation, part)
    return path


def _valid_keys(loc: tuple[int | str, ...]) -> list[str]:
    annotation: Any = Scene
    for part in loc:
        annotation = _member(annotation, str(part)) if _is_tag(annotation, part) else _child(annotation, part)
    return sorted({name for model in _models(annotation) for name in model.model_fields})


def _models(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if typing.get_origin(annotation) in (typing.Union, types.UnionType, typing.Annotated):
        return [model for arg in typing.get_args(annotation) for model in _models(arg)]
    return []


def _tags(model: type[BaseModel]) -> set[str]:
    return {
        tag
        for name in ("outline", "shape")
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
        if part in model.model_fields:
            return model.model_fields[part].annotation
    return None
