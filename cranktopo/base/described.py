"""Models whose JSON schema says of each field what the text below it in its class does."""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

if TYPE_CHECKING:
    from pydantic import GetJsonSchemaHandler
    from pydantic_core import CoreSchema


class Described(BaseModel):
    """A model with a text below each field that tells its meaning.

    Pydantic can read such texts itself (`use_attribute_docstrings`), while a class is made: for all classes
    of a design together a quarter of the time that a command needs to begin. Here a schema reads them.
    """

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler, /
    ) -> dict[str, Any]:
        """Return the schema of the model, with the text below each field as its description."""
        schema = handler(core_schema)
        properties = handler.resolve_ref_schema(schema).get("properties", {})
        for name, field in cls.model_fields.items():
            text = field.description or _text_of(cls, name)
            key = field.serialization_alias or name
            if text and key in properties:
                properties[key].setdefault("description", text)
        return schema


def _text_of(cls: type, name: str) -> str:
    """Return the text below a field in the class that declares it; empty where there is none."""
    declaring = next(kind for kind in cls.__mro__ if name in inspect.get_annotations(kind))
    return _texts(declaring).get(name, "")


def _texts(cls: type) -> dict[str, str]:
    return _texts_in(cls.__module__)[cls.__qualname__]


@cache
def _texts_in(module: str) -> dict[str, dict[str, str]]:
    """Return the texts of the fields of each class of a module, by its qualified name.

    The source of a class alone (`inspect.getsource`) would parse the whole module for each.
    """
    tree = ast.parse(inspect.getsource(sys.modules[module]))
    return {name: _texts_below(found) for name, found in _classes(tree, "")}


def _classes(node: ast.AST, before: str) -> Iterator[tuple[str, ast.ClassDef]]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.expr):  # no class is in one, and most of a tree is
            continue
        inner = before
        if isinstance(child, ast.ClassDef):
            yield before + child.name, child
            inner = f"{before}{child.name}."
        elif isinstance(child, ast.FunctionDef):
            inner = f"{before}{child.name}.<locals>."
        yield from _classes(child, inner)


def _texts_below(statement: ast.ClassDef) -> dict[str, str]:
    return {
        field.target.id: inspect.cleandoc(below.value.value)
        for field, below in pairwise(statement.body)
        if isinstance(field, ast.AnnAssign)
        and isinstance(field.target, ast.Name)
        and isinstance(below, ast.Expr)
        and isinstance(below.value, ast.Constant)
        and isinstance(below.value.value, str)
    }
