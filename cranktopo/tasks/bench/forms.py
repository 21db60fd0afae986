"""Tables behind the forms of the page, and designs that begin here: by six answers, or a dropped file."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple, get_args

from cranktopo.base.errors import invalid
from cranktopo.base.files import read_text_file
from cranktopo.base.units import UNITS
from cranktopo.design.free_dimensions import DIMENSIONS, free_key, key_of
from cranktopo.design.loading import parse_scene
from cranktopo.design.reference import scene_reference
from cranktopo.design.starting_point import LayoutName
from cranktopo.design.writing import design_name
from cranktopo.engine.indicator import TRACE_ENCODING
from cranktopo.tasks.bench.design_files import changed_files
from cranktopo.tasks.designs.beginning import KNOWN, begun, begun_line

_MATERIAL = "material"
_REMARKS = 8
BODIES = (".step", ".stp", ".brep", ".stl", ".3mf", ".obj")
"""Files that may hold a crank from CAD."""


def form_reference() -> dict[str, Any]:
    """Return every table of a design with its keys, as `docs/pages/scene.md` has them, and all units.

    And of dimensions that `shape` keeps unless they have a range the key of that range.
    """
    ranges = {key_of(name): f"shape.free.{free_key(name)}" for name in DIMENSIONS}
    return {"tables": [asdict(table) for table in scene_reference()], "units": UNITS, "ranges": ranges}


class Begun(NamedTuple):
    """A design that six answers gave: text, name, the command that gives the same, and what was assumed."""

    text: str
    name: str
    command: str
    assumed: tuple[str, ...]


def new_design(answers: Mapping[str, Any]) -> Begun:
    """Return a design of usual proportions.

    Args:
        answers: layout, cylinders, bore_mm and stroke_mm, and of speed_rpm, rod_length_mm,
            peak_pressure_MPa, compression_ratio, bank_angle_deg, power_kW, material and name what is known;
            power gives the peak pressure, or the intake pressure where the peak is known.
    """
    layout: Any = answers.get("layout")
    if layout not in get_args(LayoutName):
        raise invalid("layout", layout, f"must be one of {', '.join(get_args(LayoutName))}")
    size = [_number(answers, key) for key in ("cylinders", "bore_mm", "stroke_mm")]
    name = str(answers.get("name") or "my-engine")
    name = design_name(Path(f"{name.replace('/', '-')}.toml"))
    numbers = [key for key in (*KNOWN, "power_kW") if key != _MATERIAL and answers.get(key)]
    known: dict[str, float | str] = {key: _number(answers, key) for key in numbers}
    known |= {_MATERIAL: str(answers[_MATERIAL])} if answers.get(_MATERIAL) else {}
    engine_answers = (layout, int(size[0]), size[1], size[2], known)
    began = begun(name, *engine_answers)
    return Begun(began.text, name, begun_line(f"{name}.toml", *engine_answers), began.assumed)


def _number(answers: Mapping[str, Any], key: str) -> float:
    value = answers.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise invalid(key, value, "must be a number")
    return value


def read_upload(path: Path) -> tuple[str | None, str]:
    """Return the design that a dropped file is or gives, and its file name; no design for a pressure trace.

    Runs in a process of its own: the file is foreign.
    """
    if path.suffix.lower() == ".toml":
        text = read_text_file(path, f"'{path.name}'")
        parse_scene(text, path.name, path.parent, whole=True)
        return text, path.name
    if path.suffix.lower() == ".csv":
        read_text_file(
            path, f"'{path.name}'", otherwise=TRACE_ENCODING
        )  # the design that names it checks what it says
        return None, path.name
    from cranktopo.tasks.crank_import.stage import import_crank

    name = design_name(path.with_suffix(".toml"))
    file = path.parent / f"{name}-import" / f"{name}.toml"
    if not file.is_file():
        import_crank(path, out=file.parent)
    return changed_files(read_text_file(file, f"'{file}'"), file.parent), file.name


def remarks_of(text: str) -> str:
    """Return what the first lines of a read design tell of the body that it was read from."""
    head = itertools.takewhile(lambda line: line.startswith("#"), text.splitlines())
    return "\n".join([line.removeprefix("# ") for line in head][:_REMARKS])
