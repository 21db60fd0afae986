"""The page of a sweep: scatter, parallel coordinates, filters and table of its points, all linked."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

from cranktopo.report.page import quantity_words
from cranktopo.report.report_file import TEMPLATES
from cranktopo.report.result_table import ResultTable
from cranktopo.report.typeset import typeset
from cranktopo.report.viewer.scene3d import SCRIPT
from cranktopo.tasks.sweep.result import COARSE, ERRORS, PointResult, SweepResult
from cranktopo.tasks.sweep.text import condition_words, fillet_words, reader_name, reader_number, safety_words

_FOLDER = Path(__file__).parent
_TEMPLATES, _SCRIPT = _FOLDER / "template", _FOLDER / "sweep.js"
_MOST_LETTERS = 9_400_000
"""Of the page's data; what does not fit has no picture in the page, and says so."""
_DIGITS = 6
_SENSES = {
    "mass_kg": -1,
    "web_mass_kg": -1,
    "second_web_mass_kg": -1,
    "inertia_kg_mm2": -1,
    "unbalance_kg_mm": -1,
    "torsion_Nm_per_rad": 1,
    "bending_N_per_mm": 1,
    "torsion_per_mass_Nm_per_rad_kg": 1,
    "bending_per_mass_N_per_mm_kg": 1,
    "natural_frequency_Hz": 1,
    "fatigue_safety": 1,
    "stress_MPa": -1,
}
"""Quantities of which less (-1) or more (+1) is better, in the order in which the page offers them."""
_TOLD_APART = ("id", "varied", "run", "reason", "sha256", "version", "target", "status", "design", "stage")


def sweep_html(data: SweepResult, webs: Mapping[str, str]) -> str:
    """Return the page as the text of an HTML file.

    Of the bodies from `packed_web`, by the id of their point, those of picks and front go first where the
    page cannot hold all; without that of the original it has no 3D view.
    """
    from jinja2 import Environment, FileSystemLoader
    from markupsafe import Markup

    environment = Environment(loader=FileSystemLoader([_TEMPLATES, TEMPLATES]), autoescape=True)
    numbers, original = _text(_page_data(data)), webs.get(data.original.id, "")
    rows = {row.id: row for row in data.points}
    return environment.get_template("sweep.html.j2").render(
        data=data,
        objectives=", ".join(ResultTable({}, ()).head(name)[0] for name in data.objectives),
        picks=[
            (name, _pick_words(data.points, rows[one]) + safety_words(rows[one]))
            for name, one in data.picks.items()
        ],
        conditions=condition_words(data),
        fillets=fillet_words(data),
        style=Markup(_joined(TEMPLATES / "report.css", _TEMPLATES / "sweep.css")),
        script=Markup(_joined(*[SCRIPT] * bool(original), _SCRIPT)),
        points=Markup(numbers),
        webs=Markup(_text(_fitting(data, webs, _MOST_LETTERS - len(numbers)))),
        original=Markup(original),
        version=metadata.version("cranktopo"),
    )


def _pick_words(points: Sequence[PointResult], row: PointResult) -> str:
    """Return what tells a point from the others in words: `web width 51 mm, web thickness 19 mm`."""
    varied = [quantity_words(key.replace(".", " "), value) for key, value in row.varied.items()]
    apart = len({point.design for point in points}) > 1 or not varied
    return typeset(", ".join([row.design, *varied] if apart else varied))


def _joined(*files: Path) -> str:
    return "".join(file.read_text(encoding="utf-8") for file in files)


def _page_data(data: SweepResult) -> dict[str, Any]:
    """Return what the page's program reads: columns, rows of cells, and which rows are what.

    Returns:
        `columns`: name, label, unit, whether it varied, better direction, column of its error in percent,
        bound; `rows`, `original`: one cell per column; `about`: id, status, directory and reason of each row;
        `coarse`: rows of a first look, which read too stiff and belong to no front.
    """
    rows = data.points
    names = _columns(data)
    place = {row.id: number for number, row in enumerate(rows)}
    return {
        "columns": [_column(name, names, data) for name in names],
        "rows": [[_cell(_value(row, name)) for name in names] for row in rows],
        "about": [[row.id, row.status, row.run, row.reason] for row in rows],
        "original": [_cell(_value(data.original, name)) for name in names],
        "front": [place[one] for one in data.front],
        "coarse": [number for number, row in enumerate(rows) if row.number("accuracy") == COARSE],
        "picks": [[name, place[one]] for name, one in data.picks.items()],
    }


def _text(data: object) -> str:
    """Return JSON that may stand in a script element."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return text.replace("</", "<\\/").replace("<!--", "<\\!--")


def _fitting(data: SweepResult, webs: Mapping[str, str], letters: int) -> list[str | None]:
    """Return the web of each row, as far as so many letters go: picks and front first, then by rows."""
    rows = [row.id for row in data.points]
    kept: dict[str, str] = {}
    for one in dict.fromkeys([*data.picks.values(), *data.front, *rows]):
        letters -= len(webs.get(one, ""))
        if one in webs and letters > 0:
            kept[one] = webs[one]
    return [kept.get(one) for one in rows]


def _columns(data: SweepResult) -> list[str]:
    rows = [point.row() for point in data.points]
    names = dict.fromkeys(name for row in rows for name in row)
    apart = [name for name in ("design", "stage") if len({row[name] for row in rows}) > 1]
    compared = [name for name in _SENSES if name in names]
    varied = [*data.varied, *(name for name in apart if name not in data.varied)]
    rest = [name for name in names if name not in (*_TOLD_APART, *varied, *compared)]
    return [*varied, *compared, *(name for name in rest if not name.startswith("bound_"))]


def _column(name: str, names: Sequence[str], data: SweepResult) -> dict[str, Any]:
    label, unit = ResultTable({}, ()).head(name if name in data.varied else reader_name(name))
    error, sense = ERRORS.get(name), _SENSES.get(name, 0)
    bounds = [bound for row in data.points if (bound := row.number(f"bound_{name}")) is not None]
    return {
        "name": name,
        "label": label,
        "unit": typeset(unit),
        "varied": name in data.varied,
        "sense": sense,
        "error": names.index(error) if error in names else None,
        "bound": _cell(reader_number(name, (min if sense < 0 else max)(bounds))) if bounds else None,
    }


def _value(point: PointResult, name: str) -> Any:
    if name in _SENSES:
        return reader_number(name, point.number(name))
    return point.varied.get(name, point.row().get(name))


def _cell(value: Any) -> Any:
    """Return a number rounded for the page; words and yes or no as text; None where there is nothing."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return float(f"{value:.{_DIGITS}g}") if math.isfinite(value) else None
    return None if value is None else str(value)
