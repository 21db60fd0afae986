"""Values that a scene leaves out and the program assumes: said by every command that uses it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.base.table import SceneTable
from cranktopo.base.units import plain_number
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.schema import Scene
from cranktopo.design.seat import seat_mm
from cranktopo.design.shaft import ROTORS, Rotor

THROW, LOADS, SUPPORTS, ENVELOPE, FATIGUE = "throw", "engine", "supports", "envelope", "fatigue"
GOAL, VIBRATION = "goal", "shaft"
"""Tables of the scene whose assumptions a command may ask for."""
SEAT = "seat"
"""No table: what a density optimisation keeps for a bolted counterweight."""
EVALUATED = (THROW, SUPPORTS)
"""Tables that the stiffnesses of a throw depend on."""
SHAFT = (THROW, "engine.strokes", "engine.cylinders", "engine.masses")
"""Tables and keys that a whole shaft on rigid or free bearings uses."""
CARRIED = tuple(f"{VIBRATION}.{part}" for part in ("damper", *ROTORS))
"""Parts of the shaft's table that a vibration without damping uses."""
_CONSEQUENCES = {
    "fillet_mm": "sharp",
    "bore_diameter_mm": "solid",
    "piston_group_kg": "no inertia force of the piston",
    "rod_reciprocating_kg": "no inertia force of the rod's upper end",
    "rod_rotating_kg": "no centrifugal force of the rod's big end",
    "loss_factor": "nothing damps that shaft's twist",
}
"""Meaning of a key's default, for keys whose number alone does not say it."""
_QUIET = {
    "m53_factors",
    "indicator_csv",
    "source",
    "name",
    "surface_treatment_source",
    "residual_scatter_MPa",
}
_OF_TRACE = {"firing_deg"}
"""Keys of [engine.gas] that count only where the pressure is measured."""
_WITH_INDICATOR = {"ambient_pressure_MPa"} | _OF_TRACE
"""Keys of [engine.gas] that count where the pressure is measured."""
_ROD_PARTS = {"rod_reciprocating_kg", "rod_rotating_kg"}
"""Keys of [engine.masses] that a rod given as a whole replaces."""


@dataclass(frozen=True)
class Assumption:
    """A key that the scene does not give, the value taken for it, and what that means."""

    key: str
    value: bool | float | int | str
    meaning: str

    def __str__(self) -> str:
        value = self.value if isinstance(self.value, str) else plain_number(self.value, 6)
        value = f'"{value}"' if " " in value else value
        return f"{self.key} = {value}" + (f" ({self.meaning})" if self.meaning else "")


def assumptions(scene: Scene, tables: Sequence[str]) -> tuple[Assumption, ...]:
    """Return the values that a scene as it was read does not give and a command nevertheless uses.

    A scene that was read back from a run has every key: ask before it is stored.
    """
    found: list[Assumption] = []
    for table in tables:
        value = getattr(scene, table, None)
        if table == GOAL:
            found += _limits(scene)
        elif isinstance(value, SceneTable):
            found += _left_out(value, table)
        if table == SEAT:
            found += _seat(scene)
        if table == THROW and scene.throw.mirrored_web:
            meaning = "the half beyond the crankpin is taken as its mirror image"
            found.append(Assumption("throw.mirrored_web", scene.throw.mirrored_web, meaning))
        if (
            table == LOADS
            and scene.engine
            and scene.engine.arranged.rod_offset_mm is None
            and scene.rod_offset_mm
        ):
            key, rods = "engine.arrangement.rod_offset_mm", scene.engine.rods_per_pin
            meaning = "half the pin's length" if rods == 2 else f"the pin's length over its {rods} rods"
            found.append(Assumption(key, scene.rod_offset_mm, meaning))
        if table == LOADS and scene.engine and scene.engine.arranged.pin_splay_deg:
            meaning = f"half pins overlap by {pin_overlap_mm(scene):.4g} mm; a web between them is left out"
            key = "engine.arrangement.pin_splay_deg"
            found.append(Assumption(key, scene.engine.arranged.pin_splay_deg, meaning))
        if table == LOADS and scene.engine and scene.engine.opposed:
            meaning = "loads, work, power and free forces are those of one crank of the two"
            found.append(Assumption("engine.opposed", "this crank alone", meaning))
        if table == LOADS and scene.engine and scene.has_master_rod:
            key, meaning = (
                "engine.arrangement.layout",
                "all rods of a pin are centred on it, none is articulated",
            )
            found.append(Assumption(key, scene.engine.arranged.layout, meaning))
    return tuple(found)


def pin_overlap_mm(scene: Scene) -> float:
    """Return by how much the half pins of a split pin overlap in a section across the shaft, mm."""
    half = abs(scene.engine.pin_deg(1)) if scene.engine else 0.0
    apart = 2 * scene.throw.radius_mm * math.sin(math.radians(half))
    return scene.throw.crankpin.outer_diameter_mm - apart


def stored_assumptions(entries: Iterable[Mapping[str, Any]]) -> tuple[Assumption, ...]:
    """Assumptions from the entries of `assumed` in a manifest; raises CranktopoError if damaged."""
    try:
        return tuple(Assumption(**entry) for entry in entries)
    except TypeError:
        raise CranktopoError("manifest.json: `assumed` is damaged.", hint="Start a new run.") from None


def filter_by_table(entries: Sequence[Assumption], tables: Sequence[str]) -> tuple[Assumption, ...]:
    """Return those assumptions that belong to some tables or keys of the scene, given by their paths."""
    return tuple(item for item in entries if any(f"{item.key}.".startswith(f"{table}.") for table in tables))


def assumed_text(entries: Sequence[Assumption]) -> str:
    """Return them in one line; empty when everything is given."""
    return f"assumed: {'; '.join(map(str, entries))}" if entries else ""


def _seat(scene: Scene) -> Iterator[Assumption]:
    """Yield that a bolted counterweight keeps its seat, which no key says."""
    layer = seat_mm(scene)
    if layer is not None:
        kept = f"{plain_number(layer, 3)} mm of the web along its inner face stay"
        meaning = f"{kept}, its own space stays empty"
        yield Assumption("envelope.frozen", "seat of web.counterweight", meaning)


def _limits(scene: Scene) -> Iterator[Assumption]:
    goal = goal_of(scene)
    for limit in goal.limits if goal is not None else ():
        if limit.assumed:
            signed = ", with its sign" if QUANTITIES[limit.quantity].signed else ""
            meaning = f"of the original web{signed}" if limit.percent else ""
            yield Assumption(f"goal.limits.{limit.quantity}", limit.condition, meaning)


def _left_out(table: SceneTable, path: str) -> Iterator[Assumption]:
    """Assumptions of a table and of the tables in it, in the order of the schema."""
    mapped = getattr(table, "map", ())
    measured = getattr(table, "indicator_csv", None) is not None or (mapped and all(at.file for at in mapped))
    unused = _QUIET | (_ROD_PARTS if getattr(table, "rod_kg", None) is not None else set())
    unused |= {"loss_factor"} if isinstance(table, Rotor) and not table.is_elastic else set()
    for name in type(table).model_fields:
        value, key = getattr(table, name), f"{path}.{name}"
        if isinstance(value, SceneTable):
            yield from _left_out(value, key)
        elif name in table.model_fields_set or name in unused or not isinstance(value, (int, float, str)):
            continue
        elif name in _WITH_INDICATOR if measured else name not in _OF_TRACE:
            yield Assumption(key, value, _CONSEQUENCES.get(name, "") if not value else "")
