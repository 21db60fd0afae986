"""Finished studies of a design, the loop and what accuracy costs: in words and as a table."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from cranktopo.report.result_table import ResultTable
from cranktopo.runs.kind import LOOP, RESULT_FILES
from cranktopo.runs.stored import unchanged
from cranktopo.tasks.accuracy.page import accuracy_headline, limit_lines, recommendation_table
from cranktopo.tasks.bench.job_kinds import KEPT_EARLY
from cranktopo.tasks.iterate.result import LoopResult
from cranktopo.tasks.iterate.text import best_line, shape_lines, steps_tables, unmade_lines
from cranktopo.tasks.throw_fea.studies import StudyResult


class StudyWords(NamedTuple):
    """Readers of a study's run: what it found in lines, and its table, the heads first."""

    words: Callable[[Path], list[str]]
    table: Callable[[Path], list[list[str]]]


def loop_of(run: Path) -> LoopResult:
    """Return the result of a loop."""
    return LoopResult.read(unchanged(run / RESULT_FILES[LOOP]))


def _loop_words(run: Path) -> list[str]:
    loop = loop_of(run)
    return [best_line(loop), f"ended: {loop.stop_reason}", *shape_lines(loop), *unmade_lines(loop)]


def _loop_table(run: Path) -> list[list[str]]:
    _, (_, percent) = steps_tables(loop_of(run).steps)
    return _rows(percent)


def _accuracy(run: Path) -> StudyResult:
    return StudyResult.read(unchanged(run / KEPT_EARLY["accuracy"]))


def _accuracy_words(run: Path) -> list[str]:
    study = _accuracy(run)
    return [accuracy_headline(study), *limit_lines(study), *(f"no answer: {one}" for one in study.failures)]


def _accuracy_table(run: Path) -> list[list[str]]:
    return _rows(recommendation_table(_accuracy(run)))


def _rows(table: ResultTable) -> list[list[str]]:
    heads = [" ".join(table.head(column)).strip() for column in table.columns]
    cells = ([table.page_cell(row, column) for column in table.columns] for row in range(len(table.rows)))
    return [heads, *cells]


STUDIES = {
    "iterate": StudyWords(_loop_words, _loop_table),
    "accuracy": StudyWords(_accuracy_words, _accuracy_table),
}
"""Studies by kind of their job."""
