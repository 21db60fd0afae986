"""A table as LaTeX in the style of the package booktabs, and texts as LaTeX prints them."""

from __future__ import annotations

import re
import textwrap

from cranktopo.report.result_table import ResultTable, folded

PREAMBLE = "% needs \\usepackage{booktabs}, and \\usepackage{textcomp} before LaTeX of 2020"
_SIGNS = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"{\char34}",
    "`": r"\textasciigrave{}",
    "'": r"\textquotesingle{}",
    "[": "{[}",
    "]": "{]}",
    "*": "{*}",
    "µ": r"\textmu{}",
    "°": r"\textdegree{}",
    "±": r"\textpm{}",
    "²": r"\textsuperscript{2}",
    "³": r"\textsuperscript{3}",
    **{sign: f"\\{sign}" for sign in "{}$&#_%"},
}
"""Commands of LaTeX. In German documents `"` is one too; behind a row's end so are `[` and `*`."""
_POWER = re.compile(r"(?<=m)[23]\b")
_NUMBER = re.compile(r"-?[\d,]*\.?\d+")


def latex_text(text: str) -> str:
    """Return a text on one line, so that LaTeX prints it as it is; `--` stays two hyphens."""
    signs = "".join(_SIGNS.get(sign, sign) for sign in " ".join(text.split()))
    return re.sub("-(?=-)", "-{}", signs)


def latex(table: ResultTable) -> str:
    """Return the table as `tabular`s of booktabs, one wider than a page folded as on the terminal."""
    return "\n\n".join(map(_tabular, folded(table)))


def _tabular(table: ResultTable) -> str:
    first = next(iter(table.columns))
    sides = "".join("l" if name == first or table.is_text(name) else "r" for name in table.columns)
    rows = [[_cell(table, row, name) for name in table.columns] for row in range(len(table.rows))]
    lines = [rf"\begin{{tabular}}{{{sides}}}", r"\toprule", *map(_row, _heads(table)), r"\midrule"]
    return "\n".join([*lines, *map(_row, rows), r"\bottomrule", r"\end{tabular}"])


def _row(cells: list[str]) -> str:
    return f"{' & '.join(cells)} \\\\"


def _heads(table: ResultTable) -> list[list[str]]:
    """Return the lines of the head, a long one broken, the unit last."""
    columns = [_head(table, name) for name in table.columns]
    most = max(map(len, columns))
    lines = zip(*([""] * (most - len(column)) + column for column in columns), strict=True)
    return [list(line) for line in lines if any(line)]


def _head(table: ResultTable, name: str) -> list[str]:
    label, unit = table.head(name)
    cells = (table.cell(row, name) for row in range(len(table.rows)))
    width = max(map(len, (unit, *label.split(), *cells)))
    return [*(latex_text(line) for line in textwrap.wrap(label, width) or [""]), _unit(unit)]


def _unit(unit: str) -> str:
    """Return a unit with thin spaces and powers: `kg mm2` as kg\\,mm with a raised 2."""
    return _POWER.sub(r"\\textsuperscript{\g<0>}", latex_text(unit)).replace(" ", r"\,")


def _cell(table: ResultTable, row: int, name: str) -> str:
    """Return a cell; the star of the best takes no room, so that digits stay below each other."""
    if table.rows[row][name] is None:
        return "--"
    best = (row, name) in table.best
    text = table.cell(row, name).removesuffix("*" if best else "")
    number = not isinstance(table.rows[row][name], str) and _NUMBER.fullmatch(text)
    typeset = text.replace("-", "$-$") if number else latex_text(text)
    return typeset + r"\rlap{*}" * best
