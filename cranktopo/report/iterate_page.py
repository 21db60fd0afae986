"""The report of a loop as content: the best step, every step beside the original, the webs to turn."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cranktopo.report.iterate_report import best_line, steps_estimate, steps_figure, steps_table
from cranktopo.report.page import Fact, Page, Picture, Section, Status
from cranktopo.report.sections import gallery_picture, origin_rows, pairs, versions_table
from cranktopo.report.viewer import Body, Scene3D
from cranktopo.scene import scene_from_dict
from cranktopo.store import read_json
from cranktopo.triangles.surface_files import read_stl

_FACTS = (
    ("torsion_per_mass", "Torsional stiffness per mass", 1),
    ("bending_per_mass", "Bending stiffness per mass", 1),
    ("mass", "Mass of the throw", -1),
)
"""Key, label, and which way is better."""
_ERRORS = {"torsion_per_mass": "torsion_error_percent", "bending_per_mass": "bending_error_percent"}


def iterate_page(data: Mapping[str, Any], manifest: Mapping[str, Any], folder: Path) -> Page:
    """The report of a loop, finished or after any of its steps.

    Args:
        data: content of iterate.json.
        manifest: content of the loop's manifest.json.
        folder: directory of the loop, with the folders of its steps.

    Raises:
        CranktopoError: a file of a step is missing or damaged.
    """
    bodies = tuple(_body(folder, step["number"]) for step in data["steps"])
    return Page(
        title=f"Loop over the crank web of {data['design']}",
        subtitle=f"Loop {manifest['run']}, {manifest['started'][:10]}",
        headline=_sentence(best_line(data)),
        facts=(*_facts(data), Fact("Ended", f"{len(bodies) - 1} steps", data["stop_reason"], "neutral")),
        sections=(_steps(data), _provenance(manifest)),
        scenery=Scene3D(bodies),
        picture=gallery_picture(bodies),
    )


def _sentence(line: str) -> str:
    return f"{line[0].upper()}{line[1:]}."


def _body(folder: Path, number: int) -> Body:
    name = "original web" if number == 0 else f"step {number}"
    place = folder / ("original" if number == 0 else f"step-{number:02d}")
    path = place / "step.json"
    scene = scene_from_dict(read_json(path)["scene"], str(path))
    return Body(name, read_stl(place / "web.stl"), scene.web_z_mm, scene.pitch_mm / 2)


def _facts(data: Mapping[str, Any]) -> tuple[Fact, ...]:
    """The best step, or the last where none beats the original, against the original web."""
    number = data["best_step"] or data["steps"][-1]["number"]
    step, original = data["steps"][number], data["steps"][0]
    return tuple(_fact(step, original, key, label, better) for key, label, better in _FACTS)


def _fact(step: Mapping[str, Any], original: Mapping[str, Any], key: str, label: str, better: int) -> Fact:
    change = step["percent_of_original"][key] - 100
    error = _ERRORS.get(key)
    estimate = max(step[error], original[error]) if error else 0.0
    note = f"step {step['number']} against the original web"
    if abs(change) < estimate:
        return Fact(label, f"{change:+.1f} %", f"{note}, less than the error estimate", "neutral")
    mood: Status = "good" if better * change > 0 else "bad"
    return Fact(label, f"{change:+.1f} %", note, mood)


def _steps(data: Mapping[str, Any]) -> Section:
    figure = steps_figure(data)
    figure.set_facecolor("none")
    alt = "Mass, stiffnesses and stiffnesses per mass of every step in percent of the original web's"
    return Section(
        "steps",
        "Steps",
        f"Judged with fillets on body-fitted elements; {steps_estimate(data['steps'])}. Every step keeps its "
        "web as TOML, STEP and STL in a folder beside this page.",
        (("Every step, the original web first", steps_table(data["steps"])),),
        (Picture("steps", figure, alt),),
    )


def _provenance(manifest: Mapping[str, Any]) -> Section:
    tables = (
        ("Loop", pairs(origin_rows(manifest))),
        ("Versions", versions_table(manifest["versions"])),
    )
    return Section("provenance", "Where this comes from", tables=tables)
