"""The least safety counts oil outlets and every edge with a radius, and names sharp inner edges."""

from __future__ import annotations

import logging

import numpy as np
import pytest
from skfem import MeshTet, MeshTet2

from cranktopo.design.loading import scene_from_dict
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.plan.planning import left_off, plan, plan_for_stress
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.sharp_edges import near_sharp_edges
from cranktopo.numerics.tetrahedra.stress import nodal_stress, outer_surface
from cranktopo.tasks.throw_fatigue.fillets import cut_outlet_nodes
from cranktopo.tasks.throw_fatigue.remarks import note_quality
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_field
from cranktopo.tasks.throw_fatigue.text import not_judged
from cranktopo.tasks.throw_fea.targets import Target
from tests.fast_twin import ENGINE
from tests.physics.fatigue.stepped_shaft import Shaft, shaft_mesh
from tests.physics.numerics.test_surface_stress import POISSON, YOUNGS, upright


def drilled() -> Scene:
    """A throw of a fast V-twin whose oil outlet, 5 mm wide and rounded by 0.6 mm, is the worst place."""
    journal = {"outer_diameter_mm": 48.0, "length_mm": 30.0, "fillet_mm": 4.0}
    pin = {"outer_diameter_mm": 44.0, "length_mm": 44.0, "fillet_mm": 4.0}
    drilling = {
        "diameter_mm": 5.0,
        "outlet_radius_mm": 0.6,
        "from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 5.0},
        "to": {"on": "crankpin", "angle_deg": 0.0, "place_mm": 11.0},
    }
    return scene_from_dict(
        {
            "name": "v-twin",
            "throw": {"radius_mm": 33.75, "main_journal": journal, "crankpin": pin, "drilling": [drilling]},
            "web": {
                "thickness_mm": 22.0,
                "outline": "obround",
                "width_mm": 64.0,
                "counterweight": {"outer_radius_mm": 75.0, "half_angle_deg": 80.0},
            },
            "material": {"name": "42CrMo4"},
            "fatigue": {"scatter": {"load_percent": 5.0, "fillet_radius_mm": 0.1}},
            "engine": ENGINE,
        },
        "v-twin",
    )


def at_place(place_mm: float) -> Scene:
    """The same with the outlet on the main journal so far from its middle."""
    data = drilled().model_dump(mode="json", by_alias=True, exclude_none=True)
    data["throw"]["drilling"][0]["from"]["place_mm"] = place_mm
    return scene_from_dict(data, "v-twin")


def test_an_outlet_across_the_section_where_the_model_ends_is_cut() -> None:
    """All around it, up to one and a half radii and its rounding; one farther from the middle is not."""
    angle = np.linspace(0.0, 2 * np.pi, 60)
    ring = np.stack([3.0 * np.cos(angle), np.full(60, -24.0), np.abs(3.0 * np.sin(angle))])
    pin = np.array([[0.0], [33.75 + 22.0], [41.0]])
    assert cut_outlet_nodes(at_place(0.0), ring).all()
    assert not cut_outlet_nodes(at_place(0.0), pin).any()
    assert not cut_outlet_nodes(at_place(6.0), ring + np.array([[0.0], [0.0], [6.0]])).any()


@pytest.mark.slow
def test_a_cut_outlet_decides_no_safety(caplog: pytest.LogCaptureFixture) -> None:
    """Its section is held rigid, which no shaft is: a marine six had 1.04 there and 2.28 off the middle."""
    field = fatigue_field(Target("cut", at_place(0.0)), "lsa", fillet_fraction=0.5)
    assert field.model.at_cut.any()
    assert not (field.model.judged & field.model.at_cut).any()
    assert field.safety[:, field.model.at_cut].min() < field.safety[:, field.model.at_cut].max()
    assert field.critical.place.startswith("oil outlet on the crankpin")
    with caplog.at_level(logging.INFO, logger="cranktopo.notes"):
        note_quality(field)
    assert "not judged" not in caplog.text, "results name it, quiet or not"
    (told,) = not_judged([field])
    assert "the oil outlet in the middle of the main journal is not judged" in told
    assert "It is judged from throw.drilling[0].from.place_mm = 4.9 on." in told


def outlet_safety(size: float) -> float:
    """The least safety on a mesh, at the outlet, below that of the fillets and at a place that is judged."""
    field = fatigue_field(Target("v-twin", drilled()), "lsa", fillet_fraction=size)
    assert field.critical.place.startswith("oil outlet on the crankpin")
    assert field.critical.safety < 0.99 * min(field.fillet_safety.values())
    assert field.critical.safety == field.safety[:, field.model.judged].min()
    assert field.at_outlet == field.critical
    assert field.at_sharp_edges is not None
    assert not field.model.judged.all()
    assert max(field.scatter, key=lambda part: field.scatter[part].failure_probability) == "elsewhere"
    return field.critical.safety


@pytest.mark.slow
def test_the_outlet_is_the_worst_place() -> None:
    assert outlet_safety(0.5) == pytest.approx(0.969, rel=0.03)


@pytest.mark.slow
def test_the_outlet_is_the_worst_place_on_two_meshes() -> None:
    assert outlet_safety(0.5) == pytest.approx(outlet_safety(0.34), rel=0.03)


@pytest.mark.slow
def test_the_outlet_is_the_worst_place_by_fkm_on_two_meshes() -> None:
    fields = [fatigue_field(Target("v-twin", drilled()), "fkm", fillet_fraction=size) for size in (0.5, 0.34)]
    for field in fields:
        assert field.critical.place.startswith("oil outlet on the crankpin")
        assert field.critical.safety < 0.95 * min(field.fillet_safety.values())
        assert field.critical.safety == field.safety[:, field.model.judged].min()
    coarse, fine = (field.critical.safety for field in fields)
    assert coarse == pytest.approx(fine, rel=0.01)
    assert fine == pytest.approx(1.327, rel=0.03)


@pytest.mark.slow
def test_the_outlet_is_told_beside_a_worse_fillet() -> None:
    """The least of the nodes around the outlet, beside a pin fillet of half the radius."""
    scene = with_values(drilled(), {"throw.crankpin.fillet_mm": 1.2})
    field = fatigue_field(Target("v-twin", scene), "lsa", fillet_fraction=0.5)
    assert field.critical.fillet is not None
    assert field.at_outlet is not None
    assert field.at_outlet.place.startswith("oil outlet on the crankpin")
    assert field.at_outlet.safety > field.critical.safety
    x, y, z = field.model.surface.points_mm
    near = (np.hypot(x, z - field.at_outlet.point_mm[2]) < 6.0) & (y > 33.75 + 20.0)
    away = near & field.model.judged & ~field.model.on_fillet
    assert field.at_outlet.safety == pytest.approx(field.safety[:, away].min(), rel=1e-12)


@pytest.mark.slow
def test_a_treatment_of_the_fillets_raises_nothing_else() -> None:
    scene = drilled()
    treated = scene.model_copy(
        update={"fatigue": scene.fatigue.model_copy(update={"surface_treatment_factor": 1.3})}
    )
    plain, hard = (fatigue_field(Target("", one), "lsa", fillet_fraction=0.5) for one in (scene, treated))
    assert hard.critical.safety == pytest.approx(plain.critical.safety, rel=1e-12)
    assert min(hard.fillet_safety.values()) > 1.15 * min(plain.fillet_safety.values())


def test_only_inner_edges_without_a_radius_are_sharp() -> None:
    """An L has one inner edge, along z at (1, 1); its outer edges are not singular."""
    box = MeshTet.init_tensor(*(np.linspace(0, size, 9) for size in (2.0, 2.0, 2.0)))
    middles = box.p[:, box.t].mean(axis=1)
    angle = box.remove_elements(np.flatnonzero((middles[0] > 1) & (middles[1] > 1)))
    model = assemble(upright(MeshTet2.from_mesh(angle)), YOUNGS, POISSON)
    found = nodal_stress(model, np.zeros((1, model.nodes_mm.size)), YOUNGS, POISSON)
    surface = outer_surface(model, found.elements, ((2, 0.0),))
    away = np.abs(surface.points_mm[:2] - 1).max(axis=0)
    sharp = near_sharp_edges(surface)
    assert sharp[away < 1e-9].all()
    assert away[sharp].max() == pytest.approx(2 * 0.25)


def test_a_fillet_is_not_sharp() -> None:
    model = assemble(shaft_mesh(Shaft(60, 40, 4), 12.0, 0.5), YOUNGS, POISSON)
    found = nodal_stress(model, np.zeros((1, model.nodes_mm.size)), YOUNGS, POISSON)
    assert not near_sharp_edges(outer_surface(model, found.elements, ((1, 0.0),))).any()


def test_fatigue_counts_every_load_above_the_threshold() -> None:
    """The weights of the optimiser's objective say nothing about stress."""
    scene = drilled()
    assert plan(scene)["centrifugal"].state == "off"
    assert "optimise.weights.centrifugal is 0" in left_off(scene, plan(scene))
    assert plan(scene)["centrifugal"].changes.endswith("stress and fatigue count it by its size")
    stress = plan_for_stress(scene)
    assert stress["centrifugal"].state == "on"
    assert "centrifugal" not in left_off(scene, stress)
    without = scene.with_effect("centrifugal", "off")
    assert "centrifugal 7" in left_off(without, plan_for_stress(without))
    assert "(set off in the scene)" in left_off(without, plan_for_stress(without))


def single(**web: object) -> Scene:
    """A stationary diesel of one cylinder, 90 x 75."""
    journal = {"outer_diameter_mm": 52.0, "length_mm": 32.0, "fillet_mm": 2.5}
    return scene_from_dict(
        {
            "name": "single",
            "throw": {
                "radius_mm": 37.5,
                "main_journal": journal,
                "crankpin": journal | {"outer_diameter_mm": 45.0},
            },
            "web": {"outline": "obround", "width_mm": 62.0, "thickness_mm": 20.0, **web},
            "material": {"name": "42CrMo4"},
            "engine": {
                "bore_mm": 90.0,
                "rod_length_mm": 130.0,
                "speed_rpm": 3000.0,
                "gas": {"peak_pressure_MPa": 8.0, "peak_angle_deg": 12.0, "compression_ratio": 18.0},
                "masses": {"piston_group_kg": 0.75, "rod_reciprocating_kg": 0.25, "rod_rotating_kg": 0.55},
            },
        }
    )


def test_a_counterweight_switches_no_centrifugal_load_off() -> None:
    """Its pull cancels that of pistons at dead centre, which the radial force has: alone it bends the web.

    By hand the moments in the middle of the web: half of the throw's own pull, and of the largest radial
    force, at the same lever.
    """
    for scene in (single(), single(counterweight={"outer_radius_mm": 76.44, "half_angle_deg": 80.0})):
        effect, cycle = plan_for_stress(scene)["centrifugal"], analyse(scene).cycle
        pull = throw_balance(scene).throw_unbalance_kg_mm / 1e3 * (3000 * np.pi / 30) ** 2
        assert cycle is not None
        assert effect.state == "on"
        assert effect.estimate_percent is not None
        by_hand = 100 * abs(pull) / cycle.extreme("web_force_N")[0].value
        assert effect.estimate_percent == pytest.approx(by_hand, rel=0.2)
