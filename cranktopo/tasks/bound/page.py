"""How far a result is from the best possible web, as a section of its page."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.report.page import Section
from cranktopo.tasks.bound.scale import bound_picture
from cranktopo.tasks.bound.text import bound_table, statement_line, statements


def bound_sections(data: Mapping[str, Any], model: str) -> tuple[Section, ...]:
    """One section, none where no bound was asked for.

    Args:
        data: with `bound` as shape.json, metrics.json or iterate.json holds it.
        model: what judged original and result.
    """
    told = statements(data)
    if not told:
        return ()
    known = [entry for entry in told if "none" not in entry and entry["value"] is not None]
    lines = (statement_line(entry) for entry in told)
    text = " ".join(f"{line[:1].upper()}{line[1:]}." for line in lines)
    return (
        Section(
            "bound",
            "How far from the best possible web",
            f"{text} Original and result are those of {model}; the bound is a change against the original in "
            "the cells of the bound.",
            tables=tuple((_caption(entry), bound_table(entry)) for entry in known),
            pictures=tuple(bound_picture(bound_table(entry), entry["quantity"]) for entry in known),
        ),
    )


def _caption(bound: Mapping[str, Any]) -> str:
    return f"{QUANTITIES[bound['quantity']].label.capitalize()}, percent of the original"
