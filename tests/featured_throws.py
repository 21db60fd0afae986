"""Random throws with every feature of the family, the same for the same seed.

A feature is drawn up to a few times until the checks of the scene accept it beside the others, else left out.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.design.checks.scene import check_solid
from cranktopo.design.halves import halves
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from tests.random_throws import random_throw

TRIES = 8
Draw = np.random.Generator
Data = dict[str, Any]


def featured_throw(seed: int) -> Scene:
    """A throw with as many features as the seed draws and the checks accept; its webs may differ."""
    return scene_from_dict(_featured(np.random.default_rng((seed, 89)), seed), whole=True)


def featured_crank(seed: int) -> Scene:
    """A crank of four of these throws with ends, some of them with flying webs."""
    draw = np.random.default_rng((seed, 97))
    data = _featured(np.random.default_rng((seed, 89)), seed)
    radius = data["throw"]["radius_mm"]
    piston = 0.7e-6 * (2 * radius) ** 3
    data["engine"] = {
        "bore_mm": 2 * radius,
        "rod_length_mm": 3.6 * radius,
        "speed_rpm": 9.0 * 60 / (4e-3 * radius),
        "strokes": 4,
        "cylinders": 4,
        "firing_order": [1, 3, 4, 2],
        "gas": {"peak_pressure_MPa": 9.0, "peak_angle_deg": 10.0, "compression_ratio": 10.0},
        "masses": {
            "piston_group_kg": piston,
            "rod_reciprocating_kg": 0.3 * piston,
            "rod_rotating_kg": 0.7 * piston,
        },
    }
    main = data["throw"]["main_journal"]["outer_diameter_mm"]
    data["crank"] = {"end": [{"side": "free", "step": _free_end(draw, main)}]}
    data["crank"]["end"].append({"side": "output", "step": _output(draw, main)})
    if draw.random() < 0.4:
        with_flying = _with_flying_webs(data)
        data = with_flying if _holds(with_flying) else data
    return scene_from_dict(data, whole=True)


def _with_flying_webs(data: Data) -> Data:
    """The crank without main journals 1 and 3, nor pockets that the web on their other side would close."""
    flying = copy.deepcopy(data)
    journals = [{"number": number, "length_mm": 0.0} for number in (1, 3)]
    flying["crank"] |= {"bearings": [0, 2, 4], "main_journal": journals}
    for web in (flying[key] for key in ("web", "second_web") if key in flying):
        web["pocket"] = [pocket for pocket in web.get("pocket", []) if pocket.get("face") != "journal"]
    return flying


def features_of(scene: Scene) -> set[str]:
    """Names of what a throw has, by which a study counts what it saw."""
    throw, web = scene.throw, scene.web
    found = {f"outline {web.outline}"}
    for journal, _ in throw.journals:
        elliptical, recessed = journal.fillet_axial_mm is not None, journal.recess_mm is not None
        kind = "elliptical" if elliptical else "recessed" if recessed else "round"
        found |= {f"{kind} fillet"} if journal.fillet_mm else {"sharp journal"}
        found |= {"bore"} if journal.bore_diameter_mm else set()
    for bevel in web.bevel:
        found.add(f"bevel{', drafted' * bool(bevel.draft_deg)}{', crowned' * bool(bevel.crown_mm)}")
    for pocket in web.pocket:
        groove = pocket.shape == "side" and pocket.runs_out(*web.y_range_mm(throw.radius_mm))
        name = "groove" if groove else f"{pocket.shape} pocket"
        name += ", drafted" * bool(pocket.draft_deg)
        found.add(name + ", round floor" * bool(pocket.floor_radius_mm))
    if web.counterweight is not None:
        parts = web.counterweight.model_dump(exclude_none=True)
        found.add("counterweight" + ", bolted" * web.counterweight.bolted)
        found |= {f"counterweight's {name}" for name in ("edge", "fillet_mm", "corner_mm") if name in parts}
        found |= {f"counterweight's {name}" for name in ("plug", "hole") if parts[name]}
    for drilling in throw.drilling:
        found.add("drilling" + ", rounded" * bool(drilling.outlet_radius_mm))
    return found | ({"unlike webs"} if scene.second_web is not None else set())


def _featured(draw: Draw, seed: int) -> Data:
    data = random_throw(seed).model_dump(mode="json", exclude_none=True, by_alias=True)
    data["name"] = f"featured-{seed}"
    for share, feature in FEATURES:
        if draw.random() < share:
            data = _with(draw, data, feature)
    return data


def _with(draw: Draw, data: Data, feature: Callable[[Draw, Data], None]) -> Data:
    """The throw with a feature, or without where no try of it is accepted."""
    for _ in range(TRIES):
        changed = copy.deepcopy(data)
        feature(draw, changed)
        if _holds(changed):
            return changed
    return data


def _holds(data: Data) -> bool:
    try:
        scene = scene_from_dict(data, whole=True)
        for half in halves(scene):
            check_solid(half)
    except CranktopoError:
        return False
    return True


def _main(data: Data) -> float:
    return float(data["throw"]["main_journal"]["outer_diameter_mm"])


def _half_width(data: Data) -> float:
    """Half of the largest width of the web."""
    web = data["web"]
    own = [web[key] for key in ("main_radius_mm", "pin_radius_mm", "semi_axis_lateral_mm") if key in web]
    return float(max([*own, web.get("width_mm", 0.0) / 2, *web.get("half_widths_mm", [])]))


def _fillets(draw: Draw, data: Data) -> None:
    """Another fillet on each journal: round, elliptical or recessed."""
    for name in ("main_journal", "crankpin"):
        journal = data["throw"][name]
        journal["fillet_mm"] = journal["outer_diameter_mm"] * draw.uniform(0.03, 0.07)
        kind = draw.random()
        if kind < 0.25:
            journal["fillet_axial_mm"] = journal["fillet_mm"] * draw.uniform(0.6, 2.0)
        elif kind < 0.5:
            journal["recess_mm"] = journal["fillet_mm"] * draw.uniform(0.1, 0.5)


def _profile(draw: Draw, data: Data) -> None:
    """An outline by a spline, wide enough for most journals."""
    radius, half = data["throw"]["radius_mm"], _half_width(data)
    low, high = -1.12 * half, radius + 1.12 * half
    places = np.linspace(low, high, 7)
    shares = [0.0, *draw.uniform((0.8, 1.1, 1.1, 1.1, 0.8), (1.0, 1.3, 1.3, 1.3, 1.0)), 0.0]
    web = {"outline": "profile", "thickness_mm": data["web"]["thickness_mm"]}
    web |= {"stations_mm": places.tolist(), "half_widths_mm": [half * share for share in shares]}
    data["web"] = web | {"pocket": data["web"].get("pocket", [])}


def _bevel(draw: Draw, data: Data) -> None:
    radius, thickness, half = data["throw"]["radius_mm"], data["web"]["thickness_mm"], _half_width(data)
    face = str(draw.choice(["journal", "pin"]))
    inward = half * draw.uniform(0.1, 1.0)
    bevel = {"face": face, "y_mm": radius + half - inward if face == "journal" else inward - half}
    bevel["depth_mm"] = thickness * draw.uniform(0.2, 0.6)
    if draw.random() < 0.4:
        bevel["crown_mm"] = bevel["depth_mm"] * draw.uniform(-0.1, 0.2)
    if draw.random() < 0.3:
        bevel["draft_deg"] = draw.uniform(2.0, 10.0)
    data["web"].setdefault("bevel", []).append(bevel)


def _pocket(draw: Draw, data: Data) -> None:
    """A pocket of any shape but a side pocket, from any face."""
    radius, thickness, half = data["throw"]["radius_mm"], data["web"]["thickness_mm"], _half_width(data)
    place = {"x_mm": half * draw.uniform(-0.8, 0.8), "y_mm": draw.uniform(-0.6 * half, radius + 0.6 * half)}
    size, depth = half * draw.uniform(0.12, 0.35), thickness * draw.uniform(0.2, 0.6)
    shape = str(draw.choice(["cylinder", "box"]))
    pocket: Data = {"shape": shape, "face": str(draw.choice(["journal", "pin"])), "depth_mm": depth, **place}
    if shape == "cylinder":
        pocket["diameter_mm"] = size
    else:
        pocket |= {"size_x_mm": size, "size_y_mm": size * draw.uniform(0.6, 1.5)}
        pocket["corner_radius_mm"] = 0.0 if draw.random() < 0.3 else size * draw.uniform(0.1, 0.28)
    _open_walls(draw, pocket, size, depth)
    data["web"].setdefault("pocket", []).append(pocket)


def _side(draw: Draw, data: Data) -> None:
    """A side pocket, or a groove through both ends of the web."""
    radius, thickness, half = data["throw"]["radius_mm"], data["web"]["thickness_mm"], _half_width(data)
    groove = draw.random() < 0.4
    length = 3 * (radius + 2 * half) if groove else half * draw.uniform(0.3, 0.9)
    height, depth = thickness * draw.uniform(0.2, 0.45), half * draw.uniform(0.08, 0.35)
    pocket: Data = {"shape": "side", "y_mm": radius / 2 * draw.uniform(0.6, 1.4), "length_mm": length}
    pocket |= {"height_mm": height, "depth_mm": depth, "offset_mm": thickness * draw.uniform(-0.1, 0.1)}
    if not groove and draw.random() < 0.7:
        pocket["corner_radius_mm"] = height * draw.uniform(0.2, 0.48)
    _open_walls(draw, pocket, height, depth)
    data["web"].setdefault("pocket", []).append(pocket)


def _open_walls(draw: Draw, pocket: Data, size: float, depth: float) -> None:
    """Perhaps a draft, perhaps a round edge of the floor."""
    if draw.random() < 0.5:
        pocket["draft_deg"] = draw.uniform(2.0, 15.0)
    if draw.random() < 0.6:
        corner = pocket.get("corner_radius_mm") or size / 2
        pocket["floor_radius_mm"] = min(corner, depth) * draw.uniform(0.3, 0.95)


def _counterweight(draw: Draw, data: Data) -> None:
    thickness, half = data["web"]["thickness_mm"], _half_width(data)
    outer = half * draw.uniform(1.2, 1.8)
    weight: Data = {"outer_radius_mm": outer, "half_angle_deg": draw.uniform(45.0, 85.0)}
    if draw.random() < 0.3:
        weight |= {"thickness_mm": thickness * draw.uniform(0.6, 0.95)}
        weight |= {"face": str(draw.choice(["journal", "pin"]))}
    if draw.random() < 0.2:
        weight["density_kg_m3"] = 17500.0
    elif draw.random() < 0.5:
        weight["fillet_mm"] = outer * draw.uniform(0.02, 0.08)
    if draw.random() < 0.5:
        weight["corner_mm"] = outer * draw.uniform(0.02, 0.1)
    data["web"]["counterweight"] = weight


def _edge(draw: Draw, data: Data) -> None:
    weight, thickness = data["web"]["counterweight"], data["web"]["thickness_mm"]
    edge = {"flanks": str(draw.choice(["leading", "trailing", "both"]))}
    edge |= {"face": str(draw.choice(["journal", "pin", "both"]))}
    outer = weight["outer_radius_mm"]
    edge |= {"width_mm": outer * draw.uniform(0.03, 0.1), "depth_mm": thickness * draw.uniform(0.1, 0.35)}
    weight["edge"] = edge | {"length_mm": outer * draw.uniform(0.1, 0.4)}


def _holes(draw: Draw, data: Data) -> None:
    """Plugs or balancing holes in the counterweight."""
    weight, thickness = data["web"]["counterweight"], data["web"]["thickness_mm"]
    outer, diameter = weight["outer_radius_mm"], thickness * draw.uniform(0.2, 0.5)
    if draw.random() < 0.5:
        hole = {"diameter_mm": diameter, "angle_deg": draw.uniform(-30.0, 30.0)}
        weight["hole"] = [hole | {"depth_mm": outer * draw.uniform(0.08, 0.2)}]
        return
    axis = str(draw.choice(["axial", "radial"]))
    plug = {"axis": axis, "x_mm": outer * draw.uniform(-0.3, 0.3), "y_mm": -outer * draw.uniform(0.7, 0.85)}
    size = {"diameter_mm": diameter, "length_mm": thickness * 0.5}
    weight["plug"] = [plug | size | {"density_kg_m3": 17500.0}]


def _drilling(draw: Draw, data: Data) -> None:
    """From journal to journal through the web, or from the pin to its bore or across it."""
    throw, main = data["throw"], _main(data)
    diameter = main * draw.uniform(0.05, 0.1)
    pin_place = draw.uniform(0.0, 0.2) * throw["crankpin"]["length_mm"]
    start = {"on": "main_journal", "angle_deg": 180.0 + draw.choice([0.0, draw.uniform(-15, 15)])}
    start["place_mm"] = draw.uniform(0.0, 0.2) * throw["main_journal"]["length_mm"]
    end = {"on": "crankpin", "angle_deg": draw.choice([0.0, draw.uniform(-15, 15)]), "place_mm": pin_place}
    if draw.random() < 0.4:
        angle = draw.uniform(-90.0, 90.0)
        start = {"on": "crankpin", "angle_deg": angle, "place_mm": pin_place}
        bored = throw["crankpin"].get("bore_diameter_mm", 0.0) > 0
        end = {"on": "crankpin_bore" if bored else "crankpin", "place_mm": pin_place}
        end["angle_deg"] = angle if bored else angle + 180.0
    drilling = {"diameter_mm": diameter, "from": start, "to": end}
    drilling["outlet_radius_mm"] = 0.0 if draw.random() < 0.3 else diameter * draw.uniform(0.1, 0.4)
    throw.setdefault("drilling", []).append(drilling)


def _second_web(draw: Draw, data: Data) -> None:
    """The web beyond the crankpin thicker or thinner, without pockets."""
    web = copy.deepcopy(data["web"])
    web["thickness_mm"] *= draw.uniform(0.85, 1.2)
    data["second_web"] = web | {"pocket": []}


def _if_weight(feature: Callable[[Draw, Data], None]) -> Callable[[Draw, Data], None]:
    return lambda draw, data: feature(draw, data) if "counterweight" in data["web"] else None


FEATURES: tuple[tuple[float, Callable[[Draw, Data], None]], ...] = (
    (0.7, _fillets),
    (0.25, _profile),
    (0.5, _counterweight),
    (0.5, _if_weight(_edge)),
    (0.4, _if_weight(_holes)),
    (0.5, _bevel),
    (0.3, _bevel),
    (0.5, _drilling),
    (0.6, _side),
    (0.6, _pocket),
    (0.3, _pocket),
    (0.2, _second_web),
)
"""How often each feature is drawn, in the order in which they are added."""


def _free_end(draw: Draw, main: float) -> list[Data]:
    """Gear seat, keyway and thread with one bore."""
    bore = {"bore_diameter_mm": main * draw.uniform(0.1, 0.2)}
    seat = {"kind": "gear_seat", "diameter_mm": main * 0.86, "length_mm": main * 0.4}
    key = {"kind": "keyway", "diameter_mm": main * 0.67, "length_mm": main * 0.5}
    key |= {"width_mm": main * 0.14, "depth_mm": main * 0.08}
    thread = {"kind": "thread", "thread": "M24x1.5", "diameter_mm": main * 0.55, "length_mm": main * 0.33}
    return [step | bore for step in (seat, key, thread)]


def _output(draw: Draw, main: float) -> list[Data]:
    """A cylinder and a cone."""
    cylinder = {"kind": "cylinder", "diameter_mm": main * 0.95, "length_mm": main * draw.uniform(0.3, 0.6)}
    cone = {"kind": "cone", "diameter_mm": main * 0.95, "outer_end_diameter_mm": main * 0.8}
    return [cylinder, cone | {"length_mm": main * draw.uniform(0.6, 1.2)}]
