"""Text with control characters, which no page or terminal shows, is refused wherever a design has text."""

from __future__ import annotations

import typing
from collections.abc import Iterator
from typing import Any, Literal

import pytest
from pydantic import BaseModel, ValidationError

from cranktopo.base.errors import CranktopoError
from cranktopo.base.table import UNSHOWN_TEXT
from cranktopo.design.loading import load_scene, parse_scene, scene_from_dict
from cranktopo.design.schema import Scene
from tests.unit.design.test_scene_messages import MIKRON, error_of


def tables(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield the tables of an annotation and those inside them."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
        for field in annotation.model_fields.values():
            yield from tables(field.annotation)
    for part in typing.get_args(annotation):
        yield from tables(part)


def is_text(annotation: Any) -> bool:
    if typing.get_origin(annotation) is Literal:
        return False
    return annotation is str or any(is_text(part) for part in typing.get_args(annotation))


FIELDS = {
    f"{table.__name__}.{name}": (table, field.alias or name)
    for table in tables(Scene)
    for name, field in table.model_fields.items()
    if is_text(field.annotation)
}


def test_a_design_has_many_texts() -> None:
    assert {"Material.name", "Scene.description", "Drawing.notes", "Crank.throws"} <= FIELDS.keys()
    assert len(FIELDS) > 50


@pytest.mark.parametrize("text", ["a\x01b", "\x1b[31m", "a\x7f", "\x9b31m", "a\rb", "\ud800", "a\uffff"])
@pytest.mark.parametrize("field", FIELDS)
def test_every_text_is_looked_at(field: str, text: str) -> None:
    table, key = FIELDS[field]
    for value, place in ((text, ()), ([text], (0,)), (["x", [text]], (1, 0))):
        with pytest.raises(ValidationError) as caught:
            table.model_validate({key: value})
        (found,) = caught.value.errors()
        if found["type"] != "library":  # a name alone, which no library has
            assert found["type"] == UNSHOWN_TEXT
            assert found["ctx"]["place"] == (key, *place)


def test_the_message_tells_key_text_and_character() -> None:
    found = error_of(('name = "31CrMoV9"', 'name = "31CrMoV9"\nsource = "mine\\u0001x"'))
    assert found == (
        "my.toml: material.source = 'mine\\x01x': must hold no control character, here U+0001. "
        "Correct that value."
    )
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    with pytest.raises(CranktopoError, match=r"drawing\.notes\[1\] = 'a\\x1b': must hold no control"):
        scene_from_dict({**data, "drawing": {"notes": ["good", "a\x1b"]}})


def test_lines_tabs_and_other_alphabets_stay() -> None:
    text = "Prüfling\\n\\t曲轴 коленвал 🔧\\u00a0"
    found = parse_scene(MIKRON.replace('description = "', f'description = "{text}', 1))
    assert found.description.startswith("Prüfling\n\t曲轴 коленвал 🔧\xa0")
