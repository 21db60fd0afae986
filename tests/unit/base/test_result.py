"""Results are their own JSON."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import Field

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import write_json
from cranktopo.base.result import UNLESS_NONE, Result


class Part(Result):
    mass_kg: float
    source: str = Field(alias="from")
    note: str | None = UNLESS_NONE
    bound: float | None = None


class Whole(Result):
    schema_version: int = 1
    parts: tuple[Part, ...]


def test_fields_are_keys_in_order() -> None:
    whole = Whole(parts=(Part(mass_kg=1.5, source="CAD"), Part(mass_kg=2.0, source="typed", note="heavy")))
    assert list(whole.as_json()) == ["schema_version", "parts"]
    first, second = whole.as_json()["parts"]
    assert isinstance(whole.as_json()["parts"], list)
    assert first == {"mass_kg": 1.5, "from": "CAD", "bound": None}
    assert second == {"mass_kg": 2.0, "from": "typed", "note": "heavy", "bound": None}


def test_what_was_written_is_read_back(tmp_path: Path) -> None:
    whole = Whole(parts=(Part(mass_kg=1.5, source="CAD"),))
    write_json(tmp_path / "whole.json", {**whole.as_json(), "newer": 1})
    assert Whole.read(tmp_path / "whole.json") == whole


def test_damage_is_named_with_its_key() -> None:
    with pytest.raises(CranktopoError, match=r"run 'a': parts\.0\.mass_kg: "):
        Whole.of_json({"parts": [{"mass_kg": "heavy", "from": "CAD"}]}, "run 'a'")
