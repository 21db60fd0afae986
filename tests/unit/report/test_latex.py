"""Tables for LaTeX, read back by a reader of its own that knows what LaTeX does with each sign."""

from __future__ import annotations

import re

import pytest

from cranktopo.report.latex import latex, latex_text
from cranktopo.report.result_table import ResultTable

COMMANDS = {
    "textbackslash": "\\",
    "textasciitilde": "~",
    "textasciicircum": "^",
    "textless": "<",
    "textgreater": ">",
    "textbar": "|",
    "textasciigrave": "`",
    "textquotesingle": "'",
    "textmu": "µ",
    "textdegree": "°",
    "textpm": "±",
    "char34": '"',
}
TOKEN = re.compile(r"\\([A-Za-z]+\d*)|\\(.)|([{}])|([#$%&_^~])|([^\\])", re.DOTALL)


def typeset(source: str) -> str:
    """The letters that LaTeX would print; a sign of its own that is not escaped is an error."""
    source = re.sub(r"\\textsuperscript\{(\d)\}", r"\1", source)
    printed, open_ = "", 0
    for command, escaped, brace, special, plain in TOKEN.findall(source):
        assert not special, f"{special} in {source}"
        assert not escaped or escaped in "{}$&#_%,", source
        open_ += {"{": 1, "}": -1}.get(brace, 0)
        assert open_ >= 0
        printed += COMMANDS[command] if command else (" " if escaped == "," else escaped) or plain
    assert open_ == 0, source
    assert "--" not in source, "an en dash"
    return printed


NAMES = [
    "a_b & c",
    "50 %",
    r"C:\webs\new",
    "{x}^2~$y#1",
    "<a>|b",
    'the "best"',
    "[left] *",
    "a--b---c",
    "it's `x`",
    "10 µm ± 1 °",
]


@pytest.mark.parametrize("name", NAMES)
def test_a_text_is_printed_as_it_is(name: str) -> None:
    assert typeset(latex_text(name)) == name
    assert latex_text(f"{name}\n{name}").count("\n") == 0


def tabulars(text: str) -> list[tuple[str, list[list[str]], list[list[str]]]]:
    """Sides, lines of the head and rows of each tabular."""
    found = re.findall(
        r"\\begin\{tabular\}\{(\w+)\}\n\\toprule\n(.*?)\n\\midrule\n(.*?)\n\\bottomrule\n\\end\{tabular\}",
        text,
        re.DOTALL,
    )
    cells = [
        [[re.split(r"(?<!\\) ?& ?", line) for line in re.split(r" \\\\\n?", part)[:-1]] for part in parts]
        for _, *parts in found
    ]
    return [(sides, head, rows) for (sides, *_), (head, rows) in zip(found, cells, strict=True)]


def test_a_table_of_booktabs() -> None:
    """Units in the head, the star without room, minus signs, dashes, a name that looks like LaTeX."""
    columns = {"target": 0, "mass_kg": 2, "inertia_kg_mm2": 0, "change_percent": 1, "safety": 3}
    table = ResultTable(
        columns,
        (
            dict(zip(columns, ("[a_b] & 5 %", 1.5, 2057.0, -3.25, None), strict=True)),
            dict(zip(columns, ("b", 10.0, 2068.0, 2.0, 1.0), strict=True)),
        ),
        frozenset({(0, "mass_kg")}),
    )
    ((sides, head, rows),) = tabulars(latex(table))
    assert sides == "lrrrr"
    assert not re.search(r"(\\\\|rule)\s*[\[*]", latex(table)), (
        "read as an option of the row's end, or of the rule"
    )
    assert [typeset(cell) for cell in head[-1]] == ["", "kg", "kg mm2", "%", ""]
    assert head[-1][2] == r"kg\,mm\textsuperscript{2}"
    assert [typeset(cell) for cell in head[0]] == ["target", "mass", "inertia", "change", "safety"]
    assert typeset(rows[0][0]) == "[a_b] & 5 %"
    assert rows[0][1:] == [r"1.50\rlap{*}", "2057", "$-$3.2", "--"]
    assert rows[1][1:] == ["10.00", "2068", "2.0", "1.000"]


def test_a_wide_table_is_folded_with_the_names_of_its_rows() -> None:
    columns = {"target": 0} | dict.fromkeys((f"quantity_{number}_kNm_per_rad_kg" for number in range(9)), 2)
    rows = tuple({"target": name} | dict.fromkeys(list(columns)[1:], 1.0) for name in ("a", "b"))
    found = tabulars(latex(ResultTable(columns, rows, frozenset({(1, "quantity_8_kNm_per_rad_kg")}))))
    assert len(found) > 1
    assert all([row[0] for row in rows] == ["a", "b"] for _, _, rows in found)
    assert sum(len(sides) - 1 for sides, _, _ in found) == 9
    assert found[-1][2][1][-1] == r"1.00\rlap{*}"
    assert sum(cell.endswith("*}") for _, _, rows in found for row in rows for cell in row) == 1
