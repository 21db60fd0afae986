"""Tables behind the forms of the page, and designs that begin here: by six answers, or a dropped file."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, get_args

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.files import read_text_file
from cranktopo.design.loading import parse_scene
from cranktopo.design.reference import scene_reference, template
from cranktopo.design.schema import Scene
from cranktopo.design.starting_point import LayoutName, starting_values
from cranktopo.design.writing import design_name
from cranktopo.engine.analysis import analyse
from cranktopo.engine.performance import power_kW
from cranktopo.tasks.bench.edits import changed_files

_OWN = {
    "speed_rpm": "engine.speed_rpm",
    "rod_length_mm": "engine.rod_length_mm",
    "peak_pressure_MPa": "engine.gas.peak_pressure_MPa",
}
_BETWEEN_MPA = {"engine.gas.peak_pressure_MPa": (1.5, 40.0), "engine.gas.intake_pressure_MPa": (0.6, 0.03)}
"""Pressures that give a power, from the least power to the most: at one peak, more intake means less heat."""
_HALVINGS = 14
BODIES = (".step", ".stp", ".brep", ".stl", ".3mf", ".obj")
"""Files that may hold a crank from CAD."""


def form_reference() -> list[dict[str, Any]]:
    """Return every table of a design with its keys, as `docs/pages/scene.md` has them."""
    return [asdict(table) for table in scene_reference()]


def new_design(answers: Mapping[str, Any]) -> tuple[str, str, str]:
    """Return the text of a design of usual proportions, its name, and the command that does nearly the same.

    Args:
        answers: layout, cylinders, bore_mm and stroke_mm, and of speed_rpm, rod_length_mm,
            peak_pressure_MPa, power_kW, material and name what is known; power gives the peak pressure,
            or the intake pressure where the peak is known.
    """
    layout: Any = answers.get("layout")
    if layout not in get_args(LayoutName):
        raise invalid("layout", layout, f"must be one of {', '.join(get_args(LayoutName))}")
    numbers = {key: _number(answers, key) for key in ("bore_mm", "stroke_mm")}
    cylinders, name = int(_number(answers, "cylinders")), str(answers.get("name") or "my-engine")
    name = design_name(Path(f"{name.replace('/', '-')}.toml"))
    values = starting_values(layout, cylinders, numbers["bore_mm"], numbers["stroke_mm"])
    values |= _design_space(values)
    values |= {key: _number(answers, short) for short, key in _OWN.items() if answers.get(short)}
    values |= {"material.name": str(answers["material"])} if answers.get("material") else {}
    if answers.get("power_kW"):
        key = "intake" if answers.get("peak_pressure_MPa") else "peak"
        values |= _of_power(name, values, _number(answers, "power_kW"), f"engine.gas.{key}_pressure_MPa")
    text = template(name, values)
    parse_scene(text, name)
    words = ["designs", "new", f"{name}.toml", f"--layout={layout}", f"--cylinders={cylinders}"]
    words += [f"--{key.replace('_', '-')}={value:g}" for key, value in numbers.items()]
    return text, name, shlex.join(["cranktopo", *words])


def _design_space(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return a box that leaves room around the proposed web: 1.6 of its width, a fifth beyond its ends."""
    width, radius = values["web.width_mm"], values["throw.radius_mm"]
    beyond = round(0.5 * width + 0.2 * radius, 1)
    return {
        "envelope.shape": "box",
        "envelope.half_width_mm": round(0.8 * width, 1),
        "envelope.y_min_mm": -beyond,
        "envelope.y_max_mm": round(radius + beyond, 1),
    }


def _number(answers: Mapping[str, Any], key: str) -> float:
    value = answers.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise invalid(key, value, "must be a number")
    return value


def _of_power(name: str, values: Mapping[str, Any], power: float, key: str) -> dict[str, float]:
    """Return the pressure that gives the power, MPa, by bisection."""
    scene, (low, high) = parse_scene(template(name, values), name), _BETWEEN_MPA[key]
    least, most = _power(scene, key, low), _power(scene, key, high)
    if not least <= power <= most:
        raise invalid("power_kW", power, f"this engine has {least:.0f} to {most:.0f} kW by {key}")
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if _power(scene, key, middle) < power else (low, middle)
    return {key: float(f"{(low + high) / 2:.4g}")}


def _power(scene: Scene, key: str, pressure_MPa: float) -> float:
    assert scene.engine is not None
    assert scene.engine.gas is not None
    gas = scene.engine.gas.model_copy(update={key.rpartition(".")[2]: pressure_MPa})
    engine = scene.engine.model_copy(update={"gas": gas})
    try:
        found = analyse(scene.model_copy(update={"engine": engine}))
    except CranktopoError:
        return 0.0  # compression alone reaches the peak: nothing burns
    return power_kW(found.cycle.mean_work_J, engine) if found.cycle else 0.0


def read_upload(path: Path) -> tuple[str | None, str]:
    """Return the design that a dropped file is or gives, and its file name; no design for a pressure trace.

    Runs in a process of its own: the file is foreign.
    """
    if path.suffix.lower() == ".toml":
        text = read_text_file(path, f"'{path.name}'")
        parse_scene(text, path.name, path.parent, whole=True)
        return text, path.name
    if path.suffix.lower() == ".csv":
        read_text_file(path, f"'{path.name}'")  # the design that names it checks what it says
        return None, path.name
    from cranktopo.tasks.crank_import.stage import import_crank

    name = design_name(path.with_suffix(".toml"))
    file = path.parent / f"{name}-import" / f"{name}.toml"
    if not file.is_file():
        import_crank(path, out=file.parent)
    return changed_files(read_text_file(file, f"'{file}'"), file.parent), file.name
