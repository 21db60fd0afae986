"""Scenes and values that several tables of a kind are tried in."""

from __future__ import annotations

from typing import Any

from tests.keys.kinds import Other, Shown, Told
from tests.keys.scenes import Data, builtin, changed, throw, twin, web

SUPPORTS = Shown("physics/density/test_throw_stiffness.py::test_supports_order_the_stiffnesses")
BODY_STEP = Shown("physics/throw/test_whole_crank.py::test_a_body_from_cad_is_an_end")
LIFE = Shown("unit/fatigue/test_spectrum.py::test_one_speed_is_the_line_itself")
STEPS = Shown("unit/fatigue/test_spectrum.py::test_equal_steps_are_one_and_shares_are_relative")
SCATTER = Shown("unit/fatigue/test_scatter.py::test_all_three_by_random_draws")
PRINTED = Shown("cli/test_published.py::test_rows_of_the_json")
PRINTED_BOTH = Shown("cli/test_published.py::test_both_methods_beside_what_is_printed")
PLANES = Shown("unit/fatigue/test_critical_planes.py::test_the_strengths_themselves")
OWN_ROLLERS: Data = {
    "balancer.bearing[0].roller_bearing.displacement_mm": [0.001, 0.004, 0.01],
    "balancer.bearing[0].roller_bearing.reaction_N": [33.0, 172.0, 501.0],
}
ADDED_ROLLERS: Data = {
    "balancer.redesign.bearing[0].roller_bearing.displacement_mm": [0.001, 0.004, 0.01],
    "balancer.redesign.bearing[0].roller_bearing.reaction_N": [33.0, 172.0, 501.0],
}
HELD: Data = {
    **{key: builtin("car-diesel")[key] for key in ("throw", "web", "engine")},
    "web.counterweight.density_kg_m3": 8000.0,
}
ONE_BOLT: Data = {
    "bolted_joint[0].holds": "web.counterweight",
    "bolted_joint[0].max_force_N": None,
    "bolted_joint[0].bolts": 1,
    "bolted_joint[0].thread": "M5",
    "bolted_joint[0].grip_mm": 10.0,
    "bolted_joint[0].shank_mm": None,
}
"""One that holds the counterweight and is small enough to lie in it."""
IDLE = Told(300.0)
DISPLACEMENTS = Other(
    [0.001, 0.004, 0.02],
    {
        "supports.roller_bearing.displacement_mm": [0.001, 0.004, 0.01],
        "supports.roller_bearing.reaction_N": [33.0, 172.0, 501.0],
    },
)
REACTIONS = Other([33.0, 172.0, 600.0], DISPLACEMENTS.beside)
MAPPED: Data = {"engine.gas.map[0]": {"rpm": 1800.0, "file": "a.csv"}}
WHOLE_ROD: Data = {
    "engine.masses": {"piston_group_kg": 0.491, "rod_kg": 0.469, "rod_centre_from_big_end_mm": 50.8}
}
EVEN: Data = {
    "engine.cylinders": 4,
    "engine.firing_order": [1, 3, 4, 2],
    "engine.arrangement": {"throw_angles_deg": [0.0, 180.0, 180.0, 0.0]},
}
BROAD: Data = {
    "engine.cylinders": 3,
    "engine.firing_order": [1, 2, 3],
    "engine.arrangement": {"layout": "W", "bank_angles_deg": [0.0, 60.0, 120.0], "throw_angles_deg": [0.0]},
}
CURVE = [[40.0, 90.0], [100.0, 11.0]]
NEAR_LIMIT: Data = {"bearings.permitted_film_um": 1.9}
"""Near it are the big end and one main bearing of `mikron-iiic-plain`."""
FILM: Data = {
    "big_end_clearance_mm": 0.06,
    "viscosity_curve_mPas": CURVE,
    "oil": "ISO VG 68",
    "permitted_pressure_MPa": 200.0,
    "supply_pressure_MPa": Other(0.5, NEAR_LIMIT),
    "feed_hole_mm": Other(6.0, NEAR_LIMIT),
    "feed_hole_deg": Other(60.0, NEAR_LIMIT),
}
TRACE = {"engine.gas": {"indicator_csv": "a.csv"}}
SECOND = {"outline": "obround", "thickness_mm": 20.0, "width_mm": 56.0}
OIL = {"oil": "ISO VG 46", "clearance_mm": 0.05}
LIBRARY = "name"
BORE = {"throw.main_journal.bore_diameter_mm": 0.0, "throw.crankpin.bore_diameter_mm": 0.0}


def drilled() -> Data:
    return builtin("industrial-gas", envelope=None, effects=None, optimise=None, shape=None, bearings=None)


def journals() -> Data:
    own = {"outer_diameter_mm": 43.0, "bore_diameter_mm": 20.0, "length_mm": 42.0, "fillet_mm": 2.5}
    return changed(throw(web=web("obround", width_mm=60.0)), {"throw.second_main_journal": own})


def weighted(**more: Any) -> Data:
    heavy = {"outer_radius_mm": 66.0, "half_angle_deg": 60.0}
    return builtin(
        "car-diesel",
        engine=None,
        envelope=None,
        effects=None,
        optimise=None,
        shape=None,
        bearings=None,
        web={"thickness_mm": 18.0, "outline": "obround", "width_mm": 70.0, "counterweight": heavy | more},
    )


def pocketed(**pocket: Any) -> Data:
    data = web("obround", width_mm=80.0, pocket=[pocket])
    return changed(throw(web=data), BORE)


def crank_base(*steps: Data, **more: Any) -> Data:
    return builtin("mikron-iiic-crank", crank={"end": [{"side": "free", "step": list(steps)}], **more})


def round_step(kind: str, **more: Any) -> Data:
    return {"kind": kind, "diameter_mm": 36.0, "length_mm": 20.0, "bore_diameter_mm": 8.0, **more}


def zones(kind: str, **zone: Any) -> Data:
    return changed(builtin("mikron-iiic-plain"), {f"envelope.{kind}": [zone]})


def joint(**more: Any) -> Data:
    bolt = {"thread": "M10", "grip_mm": 40.0, "shank_mm": 20.0, "max_force_N": 5000.0}
    return throw(bolted_joint=[bolt | more])


def balancer_bolt() -> Data:
    data = builtin("balancer-shaft")
    data["balancer"]["weight"][0]["bolt"] = {"thread": "M10", "grip_mm": 40.0, "shank_mm": 20.0}
    return data


def redesign_bearing(**more: Any) -> Data:
    data = builtin("balancer-shaft")
    bearing = data["balancer"]["redesign"]["bearing"][0] | more
    data["balancer"]["redesign"]["bearing"][0] = {k: v for k, v in bearing.items() if v is not None}
    return data


def rod_base() -> Data:
    return changed(builtin("mikron-iiic-rod-i"), {"rod.bush_interference_um": 20.0})


def rod_material() -> Data:
    return changed(builtin("mikron-iiic-rod-i"), {"rod.material": {"name": "42CrMo4"}})


def balancer_material() -> Data:
    return changed(builtin("balancer-shaft"), {"balancer.material": {"name": "42CrMo4"}})


def material() -> Data:
    return throw(material={"name": "42CrMo4"}, fatigue={})


def roller(**more: Any) -> Data:
    return builtin(
        "mikron-iiic-plain", supports={"bending": "spring", "roller_bearing": {"name": "HK4520"} | more}
    )


def layered(process: str = "induction", **more: Any) -> Data:
    case = {"process": process, "case_depth_mm": 1.5, "surface_hardness_HV": 650.0, "core_hardness_HV": 320.0}
    return throw(material={"name": "42CrMo4"}, fatigue={"hardening": case | more})


def vee() -> Data:
    return twin()


BOLT: Data = {
    "thread": "M12",
    "strength_class": "12.9",
    "held_in": "nut",
    "shank_diameter_mm": 9.0,
    "engagement_mm": 12.0,
    "preload_N": 20000.0,
}
MATERIAL: Data = {"name": "34CrNiMo6", "fkm_group": "Forg_Steel", "yield_MPa": 700.0}
BOXER: Data = {
    "engine.arrangement.bank_angle_deg": 180.0,
    "engine.arrangement.throw_angles_deg": [0.0, 180.0],
}
RUBBER: Data = {
    "shaft.damper.kind": "rubber",
    "shaft.damper.damping_Nms_per_rad": None,
    "shaft.damper.stiffness_Nm_per_rad": 5e4,
    "shaft.damper.loss_factor": 0.15,
}
DISK: Data = {
    "mass_kg": 4.0,
    "diametral_inertia_kg_m2": 0.02,
    "stiffness_Nm_per_rad": 3e5,
    "overhang_mm": 30.0,
}
