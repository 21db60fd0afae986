"""What `remodel` prints: what was tried, shape error, stiffness, and what is not represented."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.report.tables.evaluation_table import estimate_line
from cranktopo.report.tables.result_table import Column, tabulate, terminal

_EVALUATED = ("body", "fitted_without_fillets", "fitted")
_TRIALS: tuple[Column[Mapping[str, Any]], ...] = (
    Column("tried", 0, lambda trial: trial["step"]),
    Column("parameters", 0, lambda trial: float(trial["parameters"])),
    Column("overlap_percent", 2, lambda trial: trial["iou_percent"]),
    Column("gain_percent", 2, lambda trial: trial["gain_percent"]),
    Column("kept", 0, lambda trial: "yes" if trial["kept"] else "no"),
)


def remodel_text(data: dict[str, Any]) -> str:
    """The content of remodel.json for a terminal."""
    lines = [
        terminal(tabulate(_TRIALS, data["trials"])),
        *_fits(data),
        "",
        *_shape_error(data),
        *_stiffness(data["stiffness"]),
        *_rest(data),
    ]
    names = (data["files"][kind] for kind in ("design", "step", "stl", "drawing", "drawing_svg", "json"))
    return "\n".join([*lines, "", *(f"{data['folder']}/{name}" for name in names)])


def _shape_error(data: dict[str, Any]) -> list[str]:
    iou, distance, mass = data["iou"], data["distance_mm"], data["web_mass_kg"]
    place = ", ".join(f"{value:.1f}" for value in distance["max_at"])
    half, web = 100 * iou["half_throw"], 100 * iou["web"]
    return [
        f"overlap (IoU)       half throw {half:.1f} %, web alone {web:.1f} %",
        f"surface distance    mean {distance['mean']:.2f} mm, largest {distance['max']:.2f} mm "
        f"at ({place}) mm",
        f"mass of the web     {mass['fitted']:.3f} kg, body {mass['body']:.3f} kg "
        f"({mass['difference_percent']:+.1f} %)",
    ]


def _stiffness(stiffness: dict[str, Any] | None) -> list[str]:
    if stiffness is None:
        return []
    found = [stiffness[which]["error_estimate_percent"] for which in _EVALUATED]
    return [
        _stiffness_line("torsion, kN m/rad", stiffness, "torsion", "Nm_per_rad"),
        _stiffness_line("bending, kN/mm", stiffness, "bending", "N_per_mm"),
        estimate_line(*([errors[kind] for errors in found] for kind in ("torsion", "bending"))),
    ]


def _stiffness_line(name: str, stiffness: dict[str, Any], kind: str, unit: str) -> str:
    def value(which: str) -> float:
        entry = stiffness[which]
        found: float = entry[kind][f"{entry['supports'][kind]}_{unit}"] / 1000
        return found

    difference = stiffness["difference_percent"][kind]
    return (
        f"{name:19} {value('fitted_without_fillets'):.1f} without fillets, body {value('body'):.1f} "
        f"({difference:+.1f} %); with fillets {value('fitted'):.1f}"
    )


def _rest(data: dict[str, Any]) -> list[str]:
    """One line per region that the parametric web cannot represent."""
    if not data["not_represented"]:
        return ["the parametric web represents the whole body to within two cells of its surface"]
    lines = [
        "not represented by the parametric web (mm; x across, y along the throw from the crank axis, "
        "z along the crank from the middle of the journal):"
    ]
    for item in data["not_represented"]:
        x, y, z = item["centre_mm"]
        place = f"(±{x:.1f}, {y:.1f}, {z:.1f})" if item["pair"] else f"(0, {y:.1f}, {z:.1f})"
        ranges = ", ".join(
            f"{axis} {low:.0f} to {high:.0f}"
            for axis, low, high in zip(("|x|", "y", "z"), item["low_mm"], item["high_mm"], strict=True)
        )
        size = f"{item['volume_mm3']:.0f} mm3 = {item['share_percent']:.1f} % of the web"
        lines.append(f"  {_kind(item)} of {size} around {place}: {ranges}")
    return lines


def _kind(item: dict[str, Any]) -> str:
    if item["kind"] == "recess":
        return f"recess in the {item['face']} face" if item["face"] else "recess in the side"
    return {"window": "window", "hollow": "hollow", "material": "missing material"}[item["kind"]]


def _fits(data: dict[str, Any]) -> list[str]:
    """Why so many stations, and what the final fit reached from each initial guess."""
    tried = [trial for trial in data["trials"] if trial["step"].endswith("stations")]
    kept = [trial["step"] for trial in tried if trial["kept"]]
    least = data["rules"]["least_gain_percent"]
    lines = [
        f"{step}: the fewest within {least:g} points of the most that any number tried reaches "
        f"({max(trial['iou_percent'] for trial in tried):.2f} %)"
        for step in kept
    ]
    starts = ", ".join(f"{100 * overlap:.2f}" for overlap in data["overlap_by_start"])
    return [
        *lines,
        f"final fit on finer cells, from {len(data['overlap_by_start'])} initial guesses: {starts} %",
    ]
