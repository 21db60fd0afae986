"""What the numbers of a report are worth, and what the next digit costs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import cycle
from typing import Any

from cranktopo.report.axes_style import GREY, plain
from cranktopo.report.page import Picture, Section
from cranktopo.report.sections import pairs, picture
from cranktopo.report.tables import ResultTable

_MARKERS, _COLOURS = "osD^vP*X", ("C0", "C1", "C2")
_TORSION, _BENDING, _STRESS = "torsion_Nm_per_rad", "bending_N_per_mm", "fillet_stress_MPa"
_KILO = 1000.0
# Name, decimals, and where a rung holds it.
_Column = tuple[str, int, Callable[[Mapping[str, Any]], str | float | None]]


def _scaled(name: str) -> Callable[[Mapping[str, Any]], float | None]:
    """A stiffness in thousands of its unit."""
    return lambda rung: None if rung.get(name) is None else rung[name] / _KILO


def _of(table: str, name: str) -> Callable[[Mapping[str, Any]], float | None]:
    return lambda rung: rung[table].get(name)


_COST: tuple[_Column, ...] = (
    ("rung", 0, lambda rung: rung["name"]),
    ("unknowns", 0, lambda rung: float(rung["unknowns"])),
    ("time_s", 1, lambda rung: rung["seconds"]),
    ("memory_MiB", 0, lambda rung: rung["peak_memory_MiB"]),
)
_UNCERTAINTY: _Column = ("uncertainty_percent", 2, lambda rung: rung["uncertainty_percent"])
_COLUMNS: dict[str, tuple[_Column, ...]] = {
    "judge": (
        ("torsion_kNm_per_rad", 2, _scaled(_TORSION)),
        ("error_percent", 2, _of("errors_percent", _TORSION)),
        ("bending_kN_per_mm", 2, _scaled(_BENDING)),
        ("error_percent", 2, _of("errors_percent", _BENDING)),
        _UNCERTAINTY,
        ("order_in_torsion", 1, _of("orders", _TORSION)),
        ("in_bending", 1, _of("orders", _BENDING)),
    ),
    "fillet stress": (
        (_STRESS, 1, lambda rung: rung.get(_STRESS)),
        ("error_percent", 2, _of("errors_percent", _STRESS)),
        _UNCERTAINTY,
        ("order", 1, _of("orders", _STRESS)),
    ),
    "optimiser": (
        ("iterations", 0, lambda rung: float(rung["settings"]["iterations"])),
        ("torsion_kNm_per_rad", 2, _scaled(_TORSION)),
        ("shape_percent", 2, _of("errors_percent", _TORSION)),
        ("own_value_percent", 2, _of("model_errors_percent", _TORSION)),
        ("bending_kN_per_mm", 2, _scaled(_BENDING)),
        ("shape_percent", 2, _of("errors_percent", _BENDING)),
        ("own_value_percent", 2, _of("model_errors_percent", _BENDING)),
        _UNCERTAINTY,
    ),
}


def accuracy_section(metrics: Mapping[str, Any], ladder: Mapping[str, Any] | None, folder: str) -> Section:
    """Residuals and volume errors of a run, and error against seconds where the run has them.

    Args:
        metrics: content of metrics.json.
        ladder: what `cranktopo accuracy --json` prints; None without.
        folder: the run directory.
    """
    solver, surface = metrics["solver"], metrics["surface"]
    rows = [
        ("largest cell edge", f"{metrics['grid']['cell_mm']:.3g} mm"),
        *_estimates(metrics["load_cases"]),
        ("relative residual of the reported solve", f"{solver['final_relative_residual']:.1e}"),
        ("cycles per solve, mean and most", "{mean:.1f}, {max}".format(**solver["cg_iterations"])),
    ]
    if "web_volume_error_percent" in surface:
        error = surface["web_volume_error_percent"]
        rows.append(("volume of the surface against the density", f"{error:+.4f} %"))
    text = (
        "Cells cut by a cylinder make the optimiser's model a little too stiff; the error falls with the "
        "cell size and is nearly the same for both webs. 'cranktopo evaluate' gives a value with an error "
        "estimate."
    )
    tables = [("This run", pairs(rows))]
    pictures: tuple[Picture, ...] = _own_picture(metrics)
    if not ladder:
        text += f" 'cranktopo accuracy {folder}' adds what each digit costs, from cheap to exact."
    if ladder and ladder.get("rungs"):
        tables += [*rung_tables(ladder), ("Cheapest rung", recommendation_table(ladder))]
        pictures = ladder_pictures(ladder)
    return Section("accuracy", "Accuracy and its price", text, tuple(tables), pictures)


def _own_picture(metrics: Mapping[str, Any]) -> tuple[Picture, ...]:
    """The run's own error estimates against its seconds, where it has estimates."""
    seconds = metrics["seconds"]["total"]
    rungs = [
        {"name": name, "seconds": seconds, "error_percent": case["error_estimate_percent"]}
        for name, case in metrics["load_cases"].items()
        if "error_estimate_percent" in case
    ]
    return (error_picture(rungs),) if rungs else ()


def _estimates(load_cases: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Error estimates of the stiffnesses, where a run has them."""
    return [
        (f"error estimate, {name}", f"{case['error_estimate_percent']:.2g} %")
        for name, case in load_cases.items()
        if "error_estimate_percent" in case
    ]


def rung_tables(result: Mapping[str, Any]) -> list[tuple[str, ResultTable]]:
    """One table per ladder, a star at the rungs that no cheaper one beats.

    Args:
        result: what `cranktopo accuracy --json` prints.
    """
    found = []
    for ladder, columns in _COLUMNS.items():
        rungs = [rung for rung in result["rungs"] if rung["ladder"] == ladder]
        if rungs:
            found.append((ladder.capitalize(), _rung_table(rungs, columns)))
    return found


def recommendation_table(result: Mapping[str, Any]) -> ResultTable:
    """The cheapest rung of each ladder for each accuracy.

    Args:
        result: what `cranktopo accuracy --json` prints.
    """
    rows = tuple(
        (f"{r['accuracy_percent']:g} %", r["ladder"], r["rung"] or "none within this budget", r["seconds"])
        for r in result["recommendations"]
    )
    return ResultTable(("accuracy", "ladder", "cheapest_rung", "time_s"), rows, (0, 0, 0, 1))


def limit_lines(result: Mapping[str, Any]) -> list[str]:
    """The extrapolated values with their uncertainty, one line per ladder.

    Args:
        result: what `cranktopo accuracy --json` prints.
    """
    lines = []
    for ladder, limits in result["limits"].items():
        values = [_limit_text(name, limit) for name, limit in limits.items()]
        lines.append(f"{ladder}, extrapolated: {', '.join(values) or 'nothing, fewer than two rungs'}")
    return lines


def _limit_text(name: str, limit: Mapping[str, Any]) -> str:
    units = {_TORSION: ("torsion", "kN m/rad", _KILO), _BENDING: ("bending", "kN/mm", _KILO)}
    label, unit, scale = units.get(name, ("fillet stress", "MPa", 1.0))
    order = "" if limit["order"] is None else f", order {limit['order']:.1f}"
    return f"{label} {limit['value'] / scale:.5g} {unit} +-{limit['uncertainty_percent']:.2g} %{order}"


def _rung_table(rungs: Sequence[Mapping[str, Any]], columns: Sequence[_Column]) -> ResultTable:
    every = (*_COST, *columns)
    return ResultTable(
        tuple(name for name, _, _ in every),
        tuple(tuple(read(rung) for _, _, read in every) for rung in rungs),
        tuple(digits for _, digits, _ in every),
        _stars(rungs),
    )


def _stars(rungs: Sequence[Mapping[str, Any]]) -> frozenset[tuple[int, int]]:
    return frozenset((row, 0) for row, rung in enumerate(rungs) if rung["efficient"])


def ladder_pictures(result: Mapping[str, Any]) -> tuple[Picture, ...]:
    """Error against seconds, where any error is known.

    Args:
        result: what `cranktopo accuracy --json` prints.
    """
    rungs = result["rungs"]
    return (error_picture(rungs),) if any(rung["error_percent"] for rung in rungs) else ()


def error_picture(rungs: Sequence[Mapping[str, Any]]) -> Picture:
    """Error against seconds, both logarithmic.

    Args:
        rungs: each with `name`, `seconds` and `error_percent`; where they have `ladder` and `efficient`, the
            efficient ones of each ladder are joined and named.
    """
    drawn = [rung for rung in rungs if rung["error_percent"]]
    words = "; ".join(f"{r['name']}: {r['error_percent']:.2g} % in {r['seconds']:.3g} s" for r in drawn)
    draw = _draw_frontier if any("efficient" in rung for rung in drawn) else _draw_errors
    return picture("accuracy", f"Error against seconds. {words}", draw, drawn)


def _draw_errors(axes: Any, rungs: Sequence[Mapping[str, Any]]) -> None:
    for rung, marker in zip(rungs, cycle(_MARKERS), strict=False):
        axes.plot(rung["seconds"], rung["error_percent"], marker, label=rung["name"])
    _frame(axes)


def _draw_frontier(axes: Any, rungs: Sequence[Mapping[str, Any]]) -> None:
    ladders = dict.fromkeys(rung["ladder"] for rung in rungs)
    for ladder, marker, colour in zip(ladders, _MARKERS, _COLOURS, strict=False):
        mine = [rung for rung in rungs if rung["ladder"] == ladder]
        best = sorted((rung for rung in mine if rung["efficient"]), key=lambda rung: rung["seconds"])
        others = [rung for rung in mine if not rung["efficient"]]
        axes.plot(*_points(best), marker, color=colour, ls="-", label=f"{ladder}, efficient frontier")
        if others:
            axes.plot(*_points(others), marker, color=colour, mfc="none", ls="")
        for rung in best:
            _name(axes, rung)
    _frame(axes)


def _points(rungs: Sequence[Mapping[str, Any]]) -> tuple[list[float], list[float]]:
    return [rung["seconds"] for rung in rungs], [rung["error_percent"] for rung in rungs]


def _name(axes: Any, rung: Mapping[str, Any]) -> None:
    place = rung["seconds"], rung["error_percent"]
    style = {"textcoords": "offset points", "xytext": (4, 4), "fontsize": 6, "color": GREY}
    axes.annotate(rung["name"], place, **style)


def _frame(axes: Any) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter

    axes.set(xscale="log", yscale="log", xlabel="seconds", ylabel="error (%)")
    for axis in (axes.xaxis, axes.yaxis):  # a range below one decade has no power of ten to label
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    axes.margins(0.15 if len(axes.texts) == 0 else 0.25, 0.15)
    axes.legend(fontsize=8)
    axes.grid(color="0.9", linewidth=0.8)
    plain(axes)
