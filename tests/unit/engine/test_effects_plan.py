"""The effects plan: states, reasons, costs, and estimates against what the loads and formulae give."""

import json
import math
from dataclasses import replace

import pytest
import trimesh

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.halves import may_mirror, web_asymmetry
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Weights
from cranktopo.engine.analysis import at_speed
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.plan.cost import Costing, CostRates
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.plan.simulated import apply_physics_plan, strip_features
from cranktopo.engine.states import extreme_states, load_cases
from cranktopo.engine.throw_compliance import fillet_length_saving_mm, throw_compliance
from cranktopo.throw.envelope import OutlineEnvelope
from cranktopo.throw.face_pocket import CylinderPocket
from cranktopo.throw.journal import Journal
from tests.unit.engine.plan_cases import MIKRON, OPPOSED, with_effects, with_part

INERTIA = frozenset({"reciprocating_inertia", "rotating_rod_mass"})


@pytest.mark.parametrize(
    "scene", [MIKRON, OPPOSED, with_part(MIKRON, "web"), MIKRON.model_copy(update={"engine": None})]
)
def test_bending_and_torsion_are_on(scene):
    decided = plan(scene)
    assert {"bending", "torsion"} <= decided.enabled
    assert [effect.name for effect in decided.effects] == [
        name for name in type(scene.effects).model_fields if name != "threshold"
    ]
    assert all(effect.reason and effect.changes for effect in decided.effects)


def test_default_scene():
    on = {"bending", "torsion", "reciprocating_inertia", "rotating_rod_mass"}
    on |= {"bores", "lateral_symmetry", "manufacturing_constraint", "fillets", "fatigue", "bound"}
    assert plan(MIKRON).enabled == on | {"tangential"}
    built_in = load_scene("mikron-iiic-plain")
    assert plan(built_in).enabled == on
    assert [case.name for case in load_cases(built_in, plan(built_in).enabled)] == ["bending", "torsion"]


def test_json_is_plain_data_with_the_contract_keys():
    for entry in json.loads(json.dumps(plan(MIKRON).as_json())):
        assert set(entry) == {"name", "state", "reason", "estimate_percent", "cost", "changes"}
        assert set(entry["cost"]) == {"solves", "cells", "seconds"}
        assert entry["state"] in ("on", "off")


def test_inertia_estimates_are_the_change_of_the_peak_force():
    """Rotating: m r w^2 over the peak force. Reciprocating: m r w^2 acc at the peak, within 2 % of it."""
    r_w2, decided = 0.048 * (2100 * math.pi / 30) ** 2, plan(MIKRON)
    peak = load_cases(MIKRON)[0].radial_N
    assert decided["rotating_rod_mass"].estimate_percent == pytest.approx(
        100 * 0.3254 * r_w2 / peak, rel=1e-6
    )
    lam = 48 / 166
    acceleration = math.cos(math.radians(10)) + lam * math.cos(math.radians(20))
    expected = 100 * (0.491 + 0.1436) * r_w2 * acceleration / peak
    assert decided["reciprocating_inertia"].estimate_percent == pytest.approx(expected, rel=0.05)


def test_inertia_goes_off_at_low_speed_and_the_load_follows():
    slow = at_speed(MIKRON, 300.0)
    decided = plan(slow)
    assert decided["rotating_rod_mass"].state == decided["reciprocating_inertia"].state == "off"
    full = load_cases(slow)[0].radial_N
    assert load_cases(slow, decided.enabled)[0].radial_N == pytest.approx(full, rel=0.02)
    assert load_cases(slow, decided.enabled)[0].radial_N > full


def test_threshold_decides():
    assert plan(with_effects(MIKRON, threshold=0.03))["rotating_rod_mass"].state == "off"
    assert plan(with_effects(MIKRON, threshold=0.30))["tangential"].state == "off"


def test_a_switch_in_the_scene_wins():
    decided = plan(with_effects(MIKRON, tangential="off", centrifugal="on"))
    assert decided["tangential"].state == "off"
    assert decided["tangential"].reason.startswith("set off in the scene; tangential force")
    given = with_part(MIKRON, "engine", gas=None, max_gas_force_N=32000.0, max_torque_Nm=600.0)
    cases = load_cases(given, decided.enabled)
    assert [case.kind for case in cases] == ["bending", "torsion", "centrifugal"]
    assert cases[2].speed_rpm == 2800.0
    pull = (0.491 + 0.1436) * (1 + 48 / 166) + 0.3254
    assert cases[2].radial_N == pytest.approx(-pull * 0.048 * (2800 * math.pi / 30) ** 2, rel=1e-9)


def test_centrifugal_needs_a_weight_and_grows_with_the_fourth_power_of_speed():
    weights = MIKRON.optimise.weights.model_copy(update={"centrifugal": 0.5})
    heavy = with_part(MIKRON, "optimise", weights=weights)
    slow = plan(with_part(heavy, "engine", overspeed_rpm=None))["centrifugal"]  # 2100 rpm
    assert slow.state == "off"
    assert "below the threshold" in slow.reason
    fast = plan(with_part(heavy, "engine", overspeed_rpm=4200.0))["centrifugal"]
    assert fast.state == "on"
    assert fast.estimate_percent == pytest.approx(16 * slow.estimate_percent, rel=1e-9)


@pytest.mark.parametrize(
    ("scene", "update", "message"),
    [
        (
            MIKRON,
            {"bearing_compliance": "on"},
            r"effects\.bearing_compliance = 'on': the scene gives neither",
        ),
        (
            OPPOSED,
            {"bearing_compliance": "on"},
            r"effects\.bearing_compliance = 'on': supports\.bending = 'pinned' has no spring",
        ),
        (
            MIKRON.model_copy(update={"engine": None}),
            {"fatigue": "on"},
            r"effects\.fatigue = 'on': unit loads",
        ),
        (
            with_part(OPPOSED, "supports", bending="spring"),
            {"bearing_compliance": "off"},
            r"effects\.bearing_compliance = 'off': a support is 'spring'",
        ),
        (
            MIKRON,
            {"bending": "off", "torsion": "off", "tangential": "off", "centrifugal": "off"},
            "no load case is on",
        ),
    ],
)
def test_impossible_switches_are_refused(scene, update, message):
    with pytest.raises(CranktopoError, match=message):
        plan(with_effects(scene, **update))


WEIGHTLESS = {"bending": 0.0, "torsion": 0.0, "tangential": 0.0, "centrifugal": 0.0}
REST = {"tangential": "off", "centrifugal": "off"}


@pytest.mark.parametrize(
    ("scene", "weights", "effects", "named"),
    [
        (MIKRON.model_copy(update={"engine": None}), {"tangential": 0.5}, {}, ["bending", "torsion"]),
        (MIKRON, {"centrifugal": 0.5}, {**REST, "bending": "on", "torsion": "off"}, ["bending"]),
        (MIKRON, {}, {"torsion": "on", "tangential": "on"}, ["torsion", "tangential"]),
        (MIKRON, {}, {}, list(WEIGHTLESS)),
    ],
    ids=["unit loads", "one", "two", "none"],
)
def test_load_cases_without_any_weight_are_refused(scene, weights, effects, named):
    """The objective of an optimisation is divided by the sum of the weights."""
    settings = scene.optimise.model_copy(update={"weights": Weights(**{**WEIGHTLESS, **weights})})
    scene = with_effects(scene.model_copy(update={"optimise": settings}), **effects)
    with pytest.raises(CranktopoError, match=r"optimise\.weights = .*must have a weight above 0") as told:
        plan(scene)
    assert str(dict.fromkeys(named, 0.0)) in str(told.value)
    enough = settings.model_copy(update={"weights": Weights(**{**WEIGHTLESS, "bending": 0.1})})
    bent = with_effects(scene.model_copy(update={"optimise": enough}), bending="on")
    assert plan(bent)["bending"].state == "on"


def test_bearing_estimate_is_springs_in_series():
    effect = plan(with_part(OPPOSED, "supports", bending="spring"))["bearing_compliance"]
    own = 1 / throw_compliance(strip_features(OPPOSED, "fillets")).bending_mm_per_N
    together = 1 / (1 / own + 1 / (2 * 1.072e6))
    assert effect.estimate_percent == pytest.approx(100 * (1 - together / own), rel=1e-12)
    assert effect.state == "on"
    assert effect.changes.startswith(f"reported bending stiffness +{100 * (own / together - 1):.2g} %")


def test_a_bearing_spring_counts_where_a_support_has_it() -> None:
    """The plan had it on with rigid supports, where the stiffness was the same with the effect off."""
    effect = plan(OPPOSED)["bearing_compliance"]
    assert OPPOSED.supports.bending == "pinned"
    assert (effect.state, effect.changes) == ("off", "nothing")
    assert effect.reason.startswith("supports.bending = 'pinned' has no spring in it")
    sprung = plan(with_part(OPPOSED, "supports", bending="spring"))["bearing_compliance"]
    assert effect.estimate_percent == sprung.estimate_percent, "its size is told all the same"
    assert plan(with_effects(OPPOSED, bearing_compliance="off"))["bearing_compliance"].state == "off"
    twisted = plan(with_part(OPPOSED, "supports", torsion="spring"))["bearing_compliance"]
    assert twisted.state == "on"
    assert twisted.changes.startswith("nothing")


def test_asymmetry_switches_the_mirror_off():
    pocket = CylinderPocket(shape="cylinder", x_mm=8.0, y_mm=24.0, diameter_mm=6.0)
    mirrored = pocket.model_copy(update={"x_mm": -8.0})
    assert web_asymmetry(with_part(MIKRON, "web", pocket=(pocket,))) == "web.pocket[0]"
    assert web_asymmetry(with_part(MIKRON, "web", pocket=(pocket, mirrored))) == ""
    points = ((-30.0, -30.0), (30.0, -30.0), (30.0, 80.0), (-20.0, 80.0))
    scene = MIKRON.model_copy(update={"envelope": OutlineEnvelope(shape="outline", points_mm=points)})
    decided = plan(scene)["lateral_symmetry"]
    assert decided.state == "off"
    assert decided.reason == "envelope.points_mm is not symmetric in x"
    with pytest.raises(CranktopoError, match="not symmetric in x"):
        plan(with_effects(scene, lateral_symmetry="on"))


def test_what_is_off_is_taken_out_of_the_simulated_scene():
    free = MIKRON.with_optimise(process="free")
    assert apply_physics_plan(free, plan(free)) is free
    assert apply_physics_plan(MIKRON, plan(MIKRON)).effects.manufacturing_constraint == "on"
    bare = with_effects(MIKRON, bores="off", fillets="off", fatigue="off", lateral_symmetry="off")
    throw = apply_physics_plan(bare, plan(bare)).throw
    for journal in (throw.main_journal, throw.crankpin):
        assert (journal.bore_diameter_mm, journal.fillet_mm) == (0.0, 0.0)
    pocket = CylinderPocket(shape="cylinder", x_mm=8.0, y_mm=24.0, diameter_mm=6.0)
    lopsided = with_part(MIKRON, "web", pocket=(pocket,))
    assert apply_physics_plan(lopsided, plan(lopsided)).effects.lateral_symmetry == "off"
    assert not may_mirror(bare, "")
    assert may_mirror(MIKRON, "")
    assert not may_mirror(MIKRON, "web.pocket[0]")


def test_bores_matter_by_stiffness_or_by_mass():
    """An oil hole hardly touches the stiffness, but the mass that it takes is pi d^2 / 4 times its length."""
    throw = MIKRON.throw
    holes = {
        name: getattr(throw, name).model_copy(update={"bore_diameter_mm": 8.0, "fillet_mm": 0.0})
        for name in ("main_journal", "crankpin")
    }
    scene = MIKRON.model_copy(update={"throw": throw.model_copy(update=holes)})
    effect = plan(scene)["bores"]
    length = throw.main_journal.length_mm + throw.crankpin.length_mm + 4 * MIKRON.web.thickness_mm
    removed = math.pi / 4 * 8.0**2 * length * MIKRON.material.density_kg_m3 * 1e-9
    mass = throw_balance(scene).mass_kg
    assert effect.estimate_percent == pytest.approx(100 * removed / mass, rel=1e-3)


def test_costs_scale_with_rates_cells_and_iterations():
    rates = CostRates(
        iterations=20, seconds_per_solve=0.0, seconds_per_cell_solve=1e-6, seconds_per_element=1e-4
    )
    double = replace(rates, seconds_per_cell_solve=2e-6, seconds_per_element=2e-4)
    base, twice = plan(MIKRON, rates), plan(MIKRON, double)
    for name in ("tangential", "lateral_symmetry", "fatigue", "bound"):
        assert twice[name].cost.seconds == pytest.approx(2 * base[name].cost.seconds)
    fine = plan(with_part(MIKRON, "optimise", resolution_mm=0.75), rates)
    assert fine["tangential"].cost.seconds == pytest.approx(8 * base["tangential"].cost.seconds, rel=0.05)
    lengths = plan(with_part(MIKRON, "optimise", min_member_mm=8.0), rates)["tangential"].cost
    assert (lengths.solves, lengths.seconds) == (2.0, 2 * base["tangential"].cost.seconds)
    each = plan(MIKRON, replace(rates, seconds_per_solve=0.5))
    more = {
        name: each[name].cost.seconds - base[name].cost.seconds for name in ("tangential", "lateral_symmetry")
    }
    assert more == pytest.approx({"tangential": 20 * 0.5, "lateral_symmetry": 0.0})
    # 96 x 116 x 57 mm in cells of 1.5 mm, one half of them saved by the mirror
    assert base["lateral_symmetry"].cost.cells == -(round(96 * 116 * 57 / 1.5**3) // 2)


@pytest.mark.parametrize(
    "envelope",
    [
        {"shape": "outline", "points_mm": [[-20, -10], [20, -10], [20, 40], [-20, 40]]},
        {"shape": "outline", "points_mm": [[-70, -60], [50, -50], [60, 90], [-60, 90]]},
        {"shape": "cylinder", "radius_mm": 60.0},
        {"shape": "stl"},
        {"shape": "stl", "file": "moved"},
        None,
    ],
    ids=["inside the throw", "lopsided outline", "cylinder", "surface", "surface gone", "none"],
)
def test_costs_are_those_of_the_grid_that_is_built(envelope, tmp_path):
    """The plan counts the cells before there is a grid; only a whole number of them is coarser."""
    data = MIKRON.model_dump(mode="json", exclude_none=True) | {"envelope": envelope}
    if envelope and envelope["shape"] == "stl":
        file = tmp_path / envelope.get("file", "space.stl")
        box = trimesh.creation.box(bounds=[[-50, -45, 0], [50, 95, 80]])
        if file.suffix:
            box.export(file)
        data["envelope"] = {"shape": "stl", "file": str(file), "symmetric": True}
    cell_mm = 4.0 if envelope == {"shape": "stl"} else 2.0  # many points inside or outside a surface are slow
    data["optimise"]["resolution_mm"] = cell_mm
    scene = scene_from_dict({key: value for key, value in data.items() if value is not None}, "test")
    target = "envelope" if envelope and "file" not in envelope else "web"
    grid = build_domain(scene, cell_mm, target=target, extent="half").grid
    body = math.prod(n - padding for n, padding in zip(grid.cells, grid.padding, strict=True))
    assert Costing(scene, CostRates(), mirrored=False).half_throw_cells == pytest.approx(body, rel=0.1)


def test_hollow_journals_and_fillets_in_torsion():
    """A long hollow shaft: compliance goes as 1 / (D^4 - d^4). Fillets: quadrature on a fine grid."""
    hollow = Journal(outer_diameter_mm=42.0, bore_diameter_mm=24.0, length_mm=1.0)
    long = MIKRON.throw.model_copy(
        update={
            "main_journal": hollow.model_copy(update={"length_mm": 1e7}),  # longer than any scene may have
            "crankpin": hollow,
        }
    )
    scene = MIKRON.model_copy(update={"throw": long})
    shear = 210e3 / 2.6
    exact = 1e7 / (shear * math.pi / 32 * (42**4 - 24**4))
    assert throw_compliance(scene).torsion_rad_per_Nmm == pytest.approx(exact, rel=1e-4)
    journal = Journal(outer_diameter_mm=42.0, bore_diameter_mm=24.0, length_mm=40.0, fillet_mm=2.5)
    n, f = 20000, 2.5
    z = [(k + 0.5) / n * f for k in range(n)]
    outer = [21 + f - math.sqrt(f**2 - (f - t) ** 2) for t in z]
    saving = 2 * sum(1 - (21**4 - 12**4) / (r**4 - 12**4) for r in outer) * f / n
    assert fillet_length_saving_mm(journal) == pytest.approx(saving, rel=1e-4)


def test_bending_of_a_straight_shaft():
    """A throw that is nearly all journal: two cantilevers of half the journal, F L^3 / 48 E I of a beam."""
    journal = Journal(outer_diameter_mm=42.0, length_mm=5000.0)
    pin = journal.model_copy(update={"length_mm": 0.01})  # shorter than any scene may have
    throw = MIKRON.throw.model_copy(update={"main_journal": journal, "crankpin": pin, "radius_mm": 0.01})
    web = MIKRON.web.model_copy(update={"thickness_mm": 1.0, "width_mm": 50000.0})
    scene = MIKRON.model_copy(update={"throw": throw, "web": web})
    inertia = math.pi / 64 * 42**4
    assert throw_compliance(scene).bending_mm_per_N == pytest.approx(
        5000.0**3 / (48 * 210e3 * inertia), rel=0.01
    )


def test_unit_loads_without_an_engine():
    scene = MIKRON.model_copy(update={"engine": None})
    cases = load_cases(scene, plan(scene).enabled)
    assert [(c.name, c.radial_N, c.torque_Nm) for c in cases] == [
        ("bending", 1000.0, 0.0),
        ("torsion", 0.0, 1.0),
    ]
    assert plan(scene)["tangential"].reason.startswith("unit loads cannot be compared")
    assert {plan(scene)[name].estimate_percent for name in ("bending", "torsion", "tangential")} == {None}


def test_given_peaks_are_taken_and_multiples_explained():
    bending, torsion = load_cases(OPPOSED)
    assert (bending.radial_N, torsion.torque_Nm) == (85730.0, 1412.0)
    states = {state.name: state for state in extreme_states(OPPOSED, INERTIA)}
    why = states["min_torque"].redundant
    assert why.startswith("-0.485 times max_torque")
    assert why.endswith("23.5 % of its compliance")  # (684.4 / 1412)^2
    assert "overspeed_inertia" not in states  # no masses given
    braking = with_part(OPPOSED, "engine", min_torque_Nm=-2000.0)
    assert load_cases(braking)[1].torque_Nm == -2000.0


def test_torsion_case_is_the_largest_torque_behind_any_throw():
    states = {s.name: s for s in extreme_states(MIKRON, INERTIA)}
    assert states["max_torque"].case.torque_Nm == pytest.approx(685.7, abs=0.1)
    assert states["overspeed_inertia"].redundant.startswith("-0.166 times max_radial")
    assert [case.name for case in load_cases(MIKRON)] == ["bending", "torsion"]


def test_fatigue_estimate_by_hand():
    """Opposed-piston: F / 2 x lever / (B W^2 / 6) and T / (pi D^3 / 16), half of each range."""
    bend = 85730 / 2 / 2 * (38 / 2 + 16 / 2) / (76 * 16**2 / 6)
    shear = (1412e3 + 684.4e3) / 2 / (math.pi * 56**3 / 16)
    percent = 100 * math.sqrt(bend**2 + 3 * shear**2) / 525
    assert plan(OPPOSED)["fatigue"].estimate_percent == pytest.approx(percent, rel=1e-9)
