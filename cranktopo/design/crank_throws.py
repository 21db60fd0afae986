"""The throws of a crank one by one: each as the scene of a throw, between the main journals beside it."""

from __future__ import annotations

from functools import lru_cache
from math import asin, degrees, radians, sin
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.files import read_text_file
from cranktopo.design.crank import OWN_THROW, Crank, Side
from cranktopo.design.halves import halves
from cranktopo.design.messages import explain
from cranktopo.design.schema import Scene
from cranktopo.design.toml_text import parse_toml
from cranktopo.runs.stored import told_where_changed
from cranktopo.throw.journal import Journal

_OTHERS_KEYS = ("crankpin", "second_crankpin_length_mm", "drilling")
"""Keys of [throw] that a crank takes from another design."""
_TAKEN_BY = (
    "Taken by loads, plan, balance and film, by vibration with shaft.throw_stiffness_Nm_per_rad, by export "
    "to .step and .stl of throw, crankshaft and web and to a drawing; without this key the pin is straight."
)


def throw_scenes(scene: Scene) -> tuple[Scene, ...]:
    """Return the scene of every throw of the crank, cylinder 1 first; throws that are alike are one object.

    It is the design itself where all are alike, else it has the number of the first such throw in its name.

    Raises:
        CranktopoError: a file of `crank.throws` that cannot be read.
    """
    count = throw_count(scene)
    if scene.crank is None or scene.crank.uniform:
        return (scene,) * count
    return _different(scene, count, tuple(_stamp(name) for name in scene.crank.throws))


def throw_count(scene: Scene) -> int:
    """Return the number of throws: of the engine, else of the list of throws; one where nothing tells."""
    if scene.engine is not None:
        return scene.engine.throws
    return len(scene.crank.throws) or 1 if scene.crank else 1


def _stamp(name: str) -> tuple[str, int]:
    """A file may be changed while the program runs."""
    path = Path(name)
    return name, path.stat().st_mtime_ns if name != OWN_THROW and path.is_file() else 0


@lru_cache(maxsize=8)
def _different(scene: Scene, count: int, files: tuple[tuple[str, int], ...]) -> tuple[Scene, ...]:
    crank = scene.crank or Crank()
    names = crank.throws or (OWN_THROW,) * count
    others = {name: _other(name) for name in dict.fromkeys(names) if name != OWN_THROW}
    different: list[Scene] = []
    every = []
    for index, name in enumerate(names):
        throw = _throw(scene, crank, index, others.get(name), name)
        alike = (one for one in different if throw.model_copy(update={"name": one.name}) == one)
        every.append(next(alike, throw))
        different += [throw] if every[-1] is throw else []
    return tuple(every)


def _throw(scene: Scene, crank: Crank, index: int, other: Scene | None, name: str) -> Scene:
    """The scene of one throw; the crank's main journals replace those of another design."""
    near, far = (_journal(scene, crank, index + side, side) for side in (0, 1))
    update: dict[str, Any] = {"main_journal": near, "second_main_journal_length_mm": None}
    update["second_main_journal"] = None if far == near else far
    webs: dict[str, Any] = {}
    if other is not None:
        _check_radius(scene, other, index, name)
        update |= {key: getattr(other.throw, key) for key in _OTHERS_KEYS}
        webs = {"web": other.web, "second_web": other.second_web}
    throw = scene.throw.model_copy(update=update)
    title = f"{scene.name}-throw-{index + 1}"
    return scene.model_copy(update={"throw": throw, "crank": None, "name": title, **webs})


def carried(scene: Scene) -> tuple[int, ...]:
    """Return the numbers of the main journals that sit in a bearing."""
    bearings = scene.crank.bearings if scene.crank else ()
    return bearings or tuple(range(throw_count(scene) + 1))


def half_turns_deg(scene: Scene) -> tuple[float, float]:
    """Return by how much both halves of a throw are ahead of its own angle, deg; none of a straight pin."""
    half = (scene.engine.arranged.pin_splay_deg or 0.0) / 2 if scene.engine else 0.0
    return -half, half


def is_split(scene: Scene) -> bool:
    """Tell whether the crankpins of a design are split."""
    return half_turns_deg(scene)[1] != 0.0


def straightened(scene: Scene) -> Scene:
    """Return the scene with straight pins: each of its half throws is one of a split pin, not turned."""
    engine = scene.engine
    if engine is None or not is_split(scene):
        return scene
    arranged = engine.arranged.model_copy(update={"pin_splay_deg": None})
    return scene.model_copy(update={"engine": engine.model_copy(update={"arrangement": arranged})})


def check_half_pins_overlap(scene: Scene) -> None:
    """Refuse half pins whose circles do not overlap: nothing would join the halves of their throw."""
    diameter = scene.throw.crankpin.outer_diameter_mm
    apart = 2 * scene.throw.radius_mm * abs(sin(radians(half_turns_deg(scene)[1])))
    if apart >= diameter:
        splay = degrees(2 * asin(min(1.0, diameter / (2 * scene.throw.radius_mm))))
        raise invalid(
            "engine.arrangement.pin_splay_deg",
            2 * half_turns_deg(scene)[1],
            f"must be within +-{splay:.4g} deg, where the half pins, ⌀{diameter:g}, still overlap",
            f"Their axes are {apart:.4g} mm apart. A web between them is not modelled: "
            "enlarge throw.crankpin.outer_diameter_mm, or splay them less.",
        )


def refuse_split_pins(
    scene: Scene, why: str = "split pins are not modelled here", instead: str = _TAKEN_BY
) -> None:
    """Refuse split pins, for what models a throw with a straight pin."""
    splay = scene.engine.arranged.pin_splay_deg if scene.engine else None
    if splay:
        raise invalid("engine.arrangement.pin_splay_deg", splay, why, instead)


def refuse_flying_web(scene: Scene) -> None:
    """Refuse a throw without a main journal on one side, for what needs a rigid section there."""
    if any(half.throw.main_journal.length_mm == 0 for half in halves(scene)):
        raise CranktopoError(
            f"{scene.name}: a web beside it is a flying one, which is not modelled here.",
            hint="`evaluate` tells its stiffness beside a throw at a bearing. Taken by loads, balance, "
            "export; vibration needs shaft.throw_stiffness_Nm_per_rad.",
        )


def _journal(scene: Scene, crank: Crank, number: int, side: int) -> Journal:
    """The main journal of a number, as the half throw on that side of a throw has it."""
    journal = halves(scene)[side].throw.main_journal
    own_journal = next((own for own in crank.main_journal if own.number == number), None)
    return journal if own_journal is None else own_journal.applied_to(journal)


def end_journal(scene: Scene, side: Side) -> Journal | None:
    """Return the main journal whose outer half belongs to the crank's end; None where the crank has no such.

    An end, or a main journal of its own, makes the outer main journal whole.
    """
    crank = scene.crank
    if crank is None:
        return None
    number = 0 if side == "free" else throw_count(scene)
    if crank.end_on(side) is None and all(own.number != number for own in crank.main_journal):
        return None
    return _journal(scene, crank, number, side == "output")


def _other(name: str) -> Scene:
    try:
        text = read_text_file(told_where_changed(Path(name)), f"crank.throws: '{name}'")
        return Scene.model_validate(parse_toml(text, name))
    except ValidationError as error:
        raise explain(error, name) from None


def _check_radius(scene: Scene, other: Scene, index: int, name: str) -> None:
    if other.throw.radius_mm != scene.throw.radius_mm:
        raise CranktopoError(
            f"crank.throws[{index}] = '{name}': its throw.radius_mm is {other.throw.radius_mm:g}, that of "
            f"the design {scene.throw.radius_mm:g} mm; all pistons of an engine have one stroke.",
            hint="Give both the same radius_mm.",
        )
