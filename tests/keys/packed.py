"""Valid scenes with many tables at once: all of the reference's between them, but those that name files."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.design.reference import scene_reference
from tests.hostile.featured_engines import featured_engine
from tests.keys.scenes import Data, builtin, changed, twin, web
from tests.random_cranks import random_crank
from tests.random_rods import random_rod_engine

_CASE = {
    "process": "induction",
    "case_depth_mm": 1.5,
    "surface_hardness_HV": 650.0,
    "core_hardness_HV": 320.0,
}
_STRESS = [[0.0, -400.0], [1.0, 0.0]]


def packed_in_line() -> Data:
    """Four cylinders with rod, bolts, bearings, ends, forging, shaft, balancers, zones, goal, hardening."""
    rod, shaft = builtin("mikron-iiic-rod-i")["rod"], builtin("balancer-shaft")["balancer"]
    shaft["weight"][0]["bolt"] = {"thread": "M10", "grip_mm": 40.0}
    shaft["redesign"]["bearing"].append({"z_mm": 210.0, "roller_bearing": {"name": "HK4520"}})
    shaft["speed"] = [{"at_rpm": 2000.0, "share": 0.5}, {"at_rpm": 1000.0, "share": 0.5}]
    balancers = [
        {"order": 2, "turns": turns, "gear": {"power_kW": 1.0, "pitch_radius_mm": 34.6}}
        for turns in ("with", "against")
    ]
    crank = builtin("mikron-iiic-crank")["crank"]
    crank["main_journal"] = [{"number": 1, "length_mm": 44.0}]
    data = builtin(
        "mikron-iiic-plain",
        rod=rod | {"material": {"name": "42CrMo4"}},
        balancer=shaft,
        crank=crank,
        bearings={"clearance_mm": 0.05, "oil": "ISO VG 68"},
        forging={"allowance_mm": 2.0},
        bolted_joint=[{"thread": "M8", "grip_mm": 30.0, "max_force_N": 4000.0}],
        shaft={"flywheel": {"inertia_kg_m2": 0.1}, "throw_stiffness_Nm_per_rad": 1.4e5},
        goal={"minimise": "mass", "limits": {"torsion": ">= 100 %", "unbalance": "<= 40 kg mm"}},
        fatigue={
            "hardening": _CASE | {"fillets": "pin", "residual_stress_MPa": _STRESS},
            "journal_hardening": dict(_CASE),
            "spectrum": {"step": [{"rpm": 2000.0, "share": 0.7}, {"rpm": 2600.0, "share": 0.3}]},
            "scatter": {"load_percent": 5.0},
        },
        drawing={"title": "Crank", "hardness_HRC": 54.0, "notes": ["Magnetic particle test."]},
        published=builtin("opposed-piston")["published"],
        shape={"same_webs": [[1, 8]], "free": {"pin_fillet_mm": [2.0, 3.5]}},
    )
    data["published"]["variant"][0]["fatigue"] = [{"method": "lsa", "safety": 1.1}]
    data["optimise"]["weights"] = {"bending": 1.0}
    data["envelope"]["clearance"] = {"piston_skirt_mm": 20.0, "crankcase_radius_mm": 95.0}
    disc = {"shape": "cylinder", "y_mm": 24.0, "diameter_mm": 8.0}
    data["envelope"]["frozen"] = [{**disc, "x_mm": 30.0}, {**disc, "x_mm": -30.0}]
    box = {"shape": "box", "x_min_mm": -45.0, "x_max_mm": 45.0, "y_min_mm": 60.0, "y_max_mm": 80.0}
    return changed(data, {"envelope.removable": [box], "engine.arrangement": {"balancer_shaft": balancers}})


def packed_v() -> Data:
    """A V-twin with two webs, counterweights, plugs, holes, drillings, and all that turns with it."""
    heavy: Data = {"outer_radius_mm": 62.0, "half_angle_deg": 60.0}
    edge = {"width_mm": 5.0, "depth_mm": 4.0, "length_mm": 10.0}
    plug = {"axis": "axial", "y_mm": -48.0, "diameter_mm": 10.0, "length_mm": 10.0, "density_kg_m3": 17500.0}
    first = {"thickness_mm": 22.0, "width_mm": 64.0}
    disk = {"inertia_kg_m2": 0.002, "stiffness_Nm_per_rad": 2e5, "mass_kg": 2.0, "overhang_mm": 20.0}
    damper = {"kind": "viscous", "ring_inertia_kg_m2": 0.003, "hub_inertia_kg_m2": 0.001}
    ends = {
        name: {"on": name, "angle_deg": angle, "place_mm": 6.0}
        for name, angle in (("main_journal", 180.0), ("crankpin", 0.0))
    }
    data = twin(
        pulley=dict(disk),
        damper=damper | {"damping_Nms_per_rad": 6.0},
        coupling={"inertia_kg_m2": 0.05, "stiffness_Nm_per_rad": 2e4},
        propeller={"inertia_kg_m2": 0.6},
    )
    data["web"] = web("obround", **first, counterweight=heavy | {"edge": edge, "plug": [plug]})
    hole = [{"diameter_mm": 6.0, "depth_mm": 8.0}]
    bevel = [{"face": "journal", "y_mm": 50.0, "depth_mm": 8.0}]
    data["second_web"] = web("obround", **first, counterweight=heavy | {"hole": hole}, bevel=bevel)
    drilling = {"diameter_mm": 5.0, "from": ends["main_journal"], "to": ends["crankpin"]}
    return changed(data, {"throw.drilling": [drilling], "supports": {"roller_bearing": {"name": "HK4520"}}})


def packed_pocketed() -> Data:
    """A throw with every kind of pocket, and a gas map."""
    box = {"size_x_mm": 6.0, "size_y_mm": 6.0, "depth_mm": 3.0}
    pockets = [
        {"shape": "cylinder", "y_mm": 24.0, "x_mm": 32.0, "diameter_mm": 5.0},
        {"shape": "side", "y_mm": 24.0, "length_mm": 16.0, "height_mm": 6.0, "depth_mm": 4.0},
        {"shape": "box", "face": "pin", "x_mm": -30.0, "y_mm": 2.0, **box},
    ]
    peaks = [{"rpm": rpm, "peak_pressure_MPa": 5.0, "peak_angle_deg": 11.0} for rpm in (1800.0, 2500.0)]
    data = builtin("mikron-iiic-plain", envelope=None, web=web("obround", width_mm=84.0, pocket=pockets))
    own = {"outer_diameter_mm": 43.0, "bore_diameter_mm": 20.0, "length_mm": 42.0, "fillet_mm": 2.5}
    other = {"lead_deg": -12.0, "radius_mm": 44.0}
    engine = {"engine.gas": {"map": peaks}, "engine.opposed": other}
    return changed(data, {**engine, "throw.second_main_journal": own})


def packed() -> list[Data]:
    """All of them."""
    return [packed_in_line(), packed_v(), packed_pocketed()]


def drawn(seed: int) -> Data:
    """A packed scene, or a random crank, engine or rod."""
    draw = np.random.default_rng((seed, 50))
    kinds: list[Any] = [
        *(lambda one=one: one() for one in (packed_in_line, packed_v, packed_pocketed)),
        lambda: random_crank(seed % 60).model_dump(mode="json", exclude_none=True),
        lambda: featured_engine(seed % 60),
        lambda: random_rod_engine(seed % 60),
    ]
    found: Data = kinds[int(draw.integers(len(kinds)))]()
    return found


def tables_of(data: Any, path: str = "") -> set[str]:
    """The paths of the tables of a scene, as the reference has them."""
    found = {path}
    for name, value in data.items():
        for one in value if isinstance(value, list) else [value]:
            if isinstance(one, dict):
                found |= tables_of(one, f"{path}.{name}" if path else name)
    return found


def reference_tables() -> set[str]:
    """The paths of all tables."""
    return {table.path for table in scene_reference()}
