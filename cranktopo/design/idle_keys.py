"""Keys that a design gives and that change nothing beside its others: told when the design is read."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

from cranktopo.design.arrangement import Opposed
from cranktopo.design.bolt import BoltedJoint
from cranktopo.design.checks.bolts import bolts_of
from cranktopo.design.checks.roller_bearings import roller_bearings
from cranktopo.design.halves import difference
from cranktopo.design.material import Material, material_library
from cranktopo.design.plain_bearings import PlainBearings
from cranktopo.design.rod import Rod
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import Carried, ShaftTable

_Idle = tuple[str, str, str]
"""Path of a table, a key of it, and why that changes nothing."""
_OF_COMBUSTION = (
    "exhaust_pressure_MPa",
    "burn_duration_deg",
    "wiebe_shape",
    "polytropic_compression",
    "polytropic_expansion",
)
"""Keys of [engine.gas] that no measured trace needs: of the others, `compression_ratio` is compared with
it, a misfire takes its expansion to `exhaust_opening_deg`, and the dossier tells `intake_pressure_MPa`."""
_OF_ROD = ("rod_reciprocating_kg", "rod_rotating_kg", "rod_kg", "rod_centre_from_big_end_mm")
_OF_BUSH = ("bush_interference_um", "bush_E_GPa", "bush_density_kg_m3")
_DIES = ("forged", "cast")


def idle_keys(scene: Scene, given: dict[str, Any]) -> tuple[str, ...]:
    """Return one line for each key that changes nothing, `key: why`.

    Args:
        given: the tables of the design as they were written; only keys that stand in them are told.
    """
    return tuple(f"{table}.{key}: {why}" for table, key, why in _idle(scene) if _stands(given, table, key))


def without_idle_keys(scene: Scene, data: dict[str, Any]) -> dict[str, Any]:
    """Return the tables of a scene without keys that change nothing and that nobody needs to have given.

    A stored scene has every key, also those that a default, a library or `[rod]` filled in.
    """
    found = copy.deepcopy(data)
    for table, key, _ in _idle(scene):
        if _stands(found, table, key) and _taken_as_usual(scene, table, key):
            del _table(found, table)[key]
    return found


def _taken_as_usual(scene: Scene, table: str, key: str) -> bool:
    """Tell whether a key has its default, is of the library of materials, or was computed from `[rod]`."""
    if table == "engine.masses":
        return True
    model: Any = scene
    for name, place in _steps(table):
        model = getattr(model, name)
        model = model if place is None else model[place]
    known = material_library().get(model.name, {}) if isinstance(model, Material) else {}
    return bool(getattr(model, key) in (type(model).model_fields[key].default, known.get(key)))


def _table(data: Any, table: str) -> Any:
    """Return a table of plain data; None where it is not there."""
    for name, place in _steps(table):
        data = data.get(name) if isinstance(data, dict) else None
        if place is not None:
            data = data[place] if isinstance(data, list) else None
    return data


def _steps(table: str) -> Iterator[tuple[str, int | None]]:
    """Yield the parts of a path such as `bolted_joint[1]`, each with its place in a list."""
    for part in table.split("."):
        name, _, place = part.rstrip("]").partition("[")
        yield name, int(place) if place else None


def _stands(given: Any, table: str, key: str) -> bool:
    """Tell whether a table of a design, such as `bolted_joint[1]`, has a key."""
    found = _table(given, table)
    return isinstance(found, dict) and key in found


def _idle(scene: Scene) -> Iterator[_Idle]:
    yield from _of_webs(scene)
    yield from _of_engine(scene)
    if scene.shaft is not None:
        yield from _of_shaft(scene.shaft)
    if scene.bearings is not None:
        yield from _of_oil(scene.bearings)
    yield from _of_bolts(scene)
    if scene.rod is not None:
        yield from _of_rod(scene.rod)
    for part in ("rod", "balancer"):
        yield f"{part}.material", "fatigue_torsion_MPa", f"`{part}` judges by bending and tension alone"
    yield "balancer.material", "fkm_group", "`balancer` judges by local stress analysis"
    for number, notch in enumerate(scene.balancer.notch if scene.balancer else ()):
        if notch.kind == "hole":
            yield f"balancer.notch[{number}]", "radius_mm", "a hole has its diameter alone"
    yield from _of_rollers(scene)
    yield from _of_process(scene)
    if not difference(scene):
        yield "original", "second_file", "both halves of the throw are alike"
    if scene.goal is not None:
        for key in ("volume_fraction", "combine"):
            yield "optimise", key, "[goal] says what is optimised"


def _of_rollers(scene: Scene) -> Iterator[_Idle]:
    """Yield sizes of rollers of which neither a life nor a stiffness by laminae follows."""
    tilts = scene.supports.bearing_tilt_spring_Nm_per_rad is None and scene.bearings is None
    for table, bearing in roller_bearings(scene):
        if table != "supports.roller_bearing":
            why = "the life by ISO/TS 16281 is that of main bearings"
        elif None in bearing.sizes:
            why = "life and tilt by ISO/TS 16281 need all sizes of the rollers"
        elif bearing.dynamic_rating_kN is None and not tilts:
            why = "without dynamic_rating_kN only the tilt of the journal follows, which is given otherwise"
        else:
            continue
        for key in ("roller_diameter_mm", "pitch_diameter_mm", "clearance_mm"):
            yield table, key, why


def _of_webs(scene: Scene) -> Iterator[_Idle]:
    for name in ("web", "second_web"):
        web = getattr(scene, name)
        weight = web.counterweight if web is not None else None
        if weight is None or weight.thickness_mm is not None:
            continue
        if not any(plug.axis == "axial" for plug in weight.plug):
            yield f"{name}.counterweight", "face", "a counterweight as thick as its web ends with both faces"


def _of_engine(scene: Scene) -> Iterator[_Idle]:
    engine = scene.engine
    if engine is None:
        return
    if engine.gas is not None and not engine.gas.modelled:
        for key in _OF_COMBUSTION:
            yield "engine.gas", key, "belongs to the combustion model, and the pressure is measured"
    if engine.opposed is not None and engine.gas is None:
        for key in Opposed.model_fields:
            yield "engine.opposed", key, "it changes the pressure, which needs [engine.gas]"
    if scene.rod is not None:
        for key in _OF_ROD:
            yield "engine.masses", key, "[rod] gives the masses of the rod"


def _of_shaft(shaft: ShaftTable) -> Iterator[_Idle]:
    behind = ("driven", "propeller") if shaft.coupling else ()
    for name, part in shaft:
        if not isinstance(part, Carried):
            continue
        for key in ("mass_kg", "diametral_inertia_kg_m2", "overhang_mm"):
            if name in behind:
                yield f"shaft.{name}", key, "behind [shaft.coupling] the crankshaft does not carry it"
            elif part.mass_kg is None:
                yield f"shaft.{name}", key, "without mass_kg the part counts in torsion alone"


def _of_oil(bearings: PlainBearings) -> Iterator[_Idle]:
    if not bearings.takes_grade:
        one = bearings.viscosity_mPas is not None
        key = "viscosity_mPas" if one else "viscosity_curve_mPas"
        yield "bearings", "oil", f"{key} gives the viscosity"
        if one:
            yield "bearings", "temperature_C", f"{key} gives the viscosity in the film"
    if bearings.permitted_film_um is None and bearings.permitted_pressure_MPa is None:
        for key in ("supply_pressure_MPa", "feed_hole_mm", "feed_hole_deg"):
            yield "bearings", key, "only a film near a permitted one asks for its supply"
    elif bearings.groove_mm:
        yield "bearings", "feed_hole_deg", "groove_mm feeds the main bearings"


def _of_bolts(scene: Scene) -> Iterator[_Idle]:
    for path, bolt in bolts_of(scene):
        if not bolt.shank_mm:
            yield path, "shank_diameter_mm", "without shank_mm the whole grip has thread"
        if bolt.preload_N is not None:
            yield path, "utilisation", "preload_N is the largest preload"
        if isinstance(bolt, BoltedJoint) and bolt.holds is None:
            yield path, "bolts", "max_force_N is the force on one bolt"
    for number, weight in enumerate(scene.balancer.weight if scene.balancer else ()):
        if weight.bolt is None:
            yield f"balancer.weight[{number}]", "bolts", "without [balancer.weight.bolt] none is judged"


def _of_rod(rod: Rod) -> Iterator[_Idle]:
    if rod.shank == "plain":
        yield "rod", "flange_mm", "a plain shank has no flanges"
        yield "rod", "web_mm", "a plain shank is a rectangle"
    if not rod.split_angle_deg:
        yield "rod", "split_friction", "a square split carries no force across the bolts"
    if not rod.bush_thickness_mm:
        for key in _OF_BUSH:
            yield "rod", key, "without bush_thickness_mm there is no bush"


def _of_process(scene: Scene) -> Iterator[_Idle]:
    process = scene.optimise.process
    if process not in _DIES:
        for key, word in (("draft_deg", "draft"), ("parting", "parting")):
            yield "optimise", key, f"process = '{process}' has no {word}"
    if process != "milled":
        yield "optimise", "tool_radius_mm", f"process = '{process}' has no mill"
