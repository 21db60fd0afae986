"""A comparison in each form of `compare --format`."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass

from cranktopo.report.goal_table import goal_line, limits_table
from cranktopo.report.latex import PREAMBLE, latex, latex_text
from cranktopo.report.result_table import ResultTable, comma_separated, escaped, markdown, terminal
from cranktopo.tasks.compare.result import Comparison
from cranktopo.tasks.compare.text import (
    balance_lines,
    comparison_result,
    comparison_tables,
    fillet_lines,
    flat_table,
    left_off_lines,
    method_lines,
    safety_method,
    safety_places,
    star_lines,
)
from cranktopo.tasks.throw_fatigue.text import load_words


@dataclass(frozen=True)
class _Form:
    """Form of tables and lines, what stands first, what is between two lines of one block."""

    table: Callable[[ResultTable], str]
    line: Callable[[str], str]
    first: tuple[str, ...] = ()
    last: tuple[str, ...] = ()
    between: str = "\n\n"


_STAR = "A star marks the best of a column, unless another is within the error bound."
"""On paper nothing else says what the star is."""
_FORMS = {
    "table": _Form(terminal, str, between="\n"),
    "markdown": _Form(markdown, escaped),
    "latex": _Form(latex, latex_text, (PREAMBLE,), (_STAR,)),
}


def comparison_text(comparison: Comparison, form: str) -> str:
    """Return the comparison as `compare --format` prints it."""
    if form == "json":
        return json.dumps(comparison_result(comparison).as_json(), indent=2)
    if form == "csv":
        return comma_separated(flat_table(comparison))
    by = _FORMS[form]
    tables = [by.table(table) for table in comparison_tables(comparison)]
    above = [*filter(None, [comparison.mirrored]), *balance_lines(comparison), *left_off_lines(comparison)]
    above += [*fillet_lines(comparison.bare), *comparison.pitches]
    below = [*by.last, *star_lines(comparison), *method_lines(comparison)]
    parts = [*by.first, *map(by.line, above), *tables, *map(by.line, below), *_verdicts(comparison, by)]
    return "\n\n".join([*parts, *_goals(comparison, by)])


def _verdicts(comparison: Comparison, by: _Form) -> list[str]:
    """Return a block for each method, under its name."""
    blocks = (
        (f"Safety by {one.result.method}, {load_words(one.result)}:", *one.verdicts, *safety_places(one))
        for one in comparison.fatigues
    )
    return [by.between.join(map(by.line, lines)) for lines in blocks]


def _goals(comparison: Comparison, by: _Form) -> list[str]:
    return [by.line(line) for line in safety_method(comparison)] + [
        f"{by.line(f'{name}: {goal_line(goal, comparison.base.name)}')}\n\n{by.table(limits_table(goal))}"
        for name, goal in comparison.goals.items()
    ]
