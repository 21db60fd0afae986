"""A schema says of each field what the text below it in its class does, as Pydantic itself would."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import BaseModel, ConfigDict, Field

from cranktopo.base.described import Described


class Part(Described):
    """A part."""

    mass_kg: float
    """With its fillets."""
    source: str = Field(alias="from")
    """Where it comes from:
    CAD or typed."""
    own: int = Field(default=1, description="Said otherwise.")
    """Never shown."""
    untold: int = 2


class Web(Part):
    """A web."""

    untold: int = 3
    mass_kg: float = 1.0
    part: Part | None = None
    """Another one."""


class PartByPydantic(BaseModel):
    """A part."""

    model_config = ConfigDict(use_attribute_docstrings=True, title="Part")
    mass_kg: float
    """With its fillets."""
    source: str = Field(alias="from")
    """Where it comes from:
    CAD or typed."""
    own: int = Field(default=1, description="Said otherwise.")
    """Never shown."""
    untold: int = 2


@pytest.mark.parametrize("mode", ["validation", "serialization"])
def test_a_schema_has_the_texts_of_its_class(mode: Any) -> None:
    found = Part.model_json_schema(mode=mode)
    assert found == PartByPydantic.model_json_schema(mode=mode)
    assert found["properties"]["from"]["description"] == "Where it comes from:\nCAD or typed."


def test_the_class_that_declares_a_field_tells_of_it() -> None:
    """A field that is declared anew without a text has none; one that is inherited has its own."""
    properties = Web.model_json_schema()["properties"]
    assert "description" not in properties["mass_kg"]
    assert properties["from"]["description"].startswith("Where")
    assert properties["part"]["description"] == "Another one."
