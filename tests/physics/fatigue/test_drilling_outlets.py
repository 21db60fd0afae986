"""Outlets of oil bores by IACS UR M53, its factors beside a bar with a cross hole."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.engine.histories import load_history
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.rigid_motions import plane_nodes
from cranktopo.tasks.throw_fatigue.m53 import FilletCheck, fatigue_strength_MPa
from cranktopo.tasks.throw_fatigue.m53_outlet import (
    check_outlets,
    outlet_equivalent_MPa,
    outlet_factors,
    pin_outlets,
)
from cranktopo.tasks.throw_fatigue.outlet_elements import element_outlet_factors
from cranktopo.tasks.throw_fatigue.rule_fillets import element_factors
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import unit_fields
from tests.physics.fatigue.cross_hole import DIAMETER_MM, outlet_peaks, peterson_bending, peterson_torsion
from tests.physics.fatigue.stepped_shaft import AXIAL, BENDING, TORSION
from tests.physics.fea.test_two_webs import scene_with
from tests.physics.throw.test_drillings import STRAIGHT, drilling, mikron
from tests.studies.outlet_throws import OUTLETS, by_elements, without_bore

ALL = frozenset({"bending", "torsion", "tangential", "reciprocating_inertia", "rotating_rod_mass"})


def test_factors_of_a_small_bore_are_those_of_a_plate() -> None:
    """A hole in a plate: 3 in tension, 4 in shear."""
    assert outlet_factors(0.0, 50.0) == (3.0, 4.0)
    bending, torsion = outlet_factors(5.0, 50.0)
    assert bending == pytest.approx(3 - 0.588 + 0.346)
    assert torsion == pytest.approx(4 - 0.6 + 0.3)


def test_equivalent_stress() -> None:
    bending, torsion = 80.0, 50.0
    by_rule = bending / 3 * (1 + 2 * math.sqrt(1 + 9 / 4 * (torsion / bending) ** 2))
    assert outlet_equivalent_MPa(bending, torsion) == pytest.approx(by_rule)
    assert outlet_equivalent_MPa(bending, 0.0) == pytest.approx(bending)
    assert outlet_equivalent_MPa(0.0, torsion) == pytest.approx(torsion)


def radial(angle: float):
    return mikron(drilling(("crankpin", angle, 2.0), ("crankpin_bore", angle, 2.0)))


def test_moment_over_the_cycle() -> None:
    """At 90 deg the tangential force alone bends the outlet, at 0 deg the radial one."""
    history = load_history(radial(0.0), "cycle", ALL)
    modulus = math.pi / 32 * (42**4 - 24**4) / 42
    for angle, force in ((0.0, history.radial_N), (90.0, history.tangential_N)):
        (outlet,) = check_outlets(radial(angle), "cycle", ALL, 0.0)
        assert outlet.angle_deg == pytest.approx(angle)
        assert outlet.bending_MPa == pytest.approx(55.0 / 2 * np.ptp(force) / 2 / modulus)
    between = check_outlets(radial(30.0), "cycle", ALL, 0.0)[0].bending_MPa
    mirrored = check_outlets(radial(-30.0), "cycle", ALL, 0.0)[0].bending_MPa
    both = 0.5 * history.tangential_N - math.cos(math.pi / 6) * history.radial_N
    assert between == pytest.approx(55.0 / 2 * np.ptp(both) / 2 / modulus)
    assert between != pytest.approx(mirrored, rel=1e-3)
    joined = check_outlets(radial(30.0), "extremes", ALL, 0.0)[0].bending_MPa
    assert joined >= max(between, mirrored)
    # At 90 deg the pin's own tangential force, not the torque that the other throws pass through.
    assert check_outlets(radial(90.0), "extremes", ALL, 0.0)[0].bending_MPa == pytest.approx(
        check_outlets(radial(90.0), "cycle", ALL, 0.0)[0].bending_MPa, rel=0.01
    )


def test_strength_takes_the_bore_and_no_credit_of_the_forging() -> None:
    scene = radial(40.0)
    scene = scene.model_copy(
        update={
            "fatigue": scene.fatigue.model_copy(
                update={"process_factor": 1.05, "surface_treatment_factor": 1.2}
            )
        }
    )
    (outlet,) = check_outlets(scene, "cycle", ALL, 4e5)
    assert outlet.check.strength_MPa == fatigue_strength_MPa(42.0, 2.5, scene.material.ultimate_MPa or 0, 1.0)
    assert outlet.torsion_MPa == pytest.approx(4e5 / (math.pi / 16 * (42**4 - 24**4) / 42))
    stress = outlet_equivalent_MPa(
        outlet.gamma_bending * outlet.bending_MPa, outlet.gamma_torsion * outlet.torsion_MPa
    )
    assert outlet.check == FilletCheck(stress, outlet.check.strength_MPa)
    assert not outlet.outside


def test_a_leaning_bore_is_outside_the_rule() -> None:
    (outlet,) = check_outlets(mikron(STRAIGHT), "cycle", ALL, 1e5)  # the other end is on the main journal
    assert "leans" in outlet.outside[0]
    assert not check_outlets(mikron(), "cycle", ALL, 1e5)
    wide = mikron(drilling(("crankpin", 0.0, 0.0), ("crankpin_bore", 0.0, 0.0), diameter=9.0))
    assert "oil bore / pin diameter = 0.214" in check_outlets(wide, "cycle", ALL, 1e5)[0].outside[0]


@pytest.mark.parametrize("ratio", [0.05, 0.1, 0.15, 0.2])
def test_factors_beside_tables(ratio: float) -> None:
    """The rule's bending factor lies within 6 % of Peterson's curve for the edge of the hole.

    In torsion the largest stress lies inside the hole, 20 % above that of the edge, and the rule takes that.
    """
    bending, torsion = outlet_factors(ratio, 1.0)
    assert bending == pytest.approx(peterson_bending(ratio), rel=0.06)
    assert peterson_torsion(ratio) < torsion < 1.25 * peterson_torsion(ratio)


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.1, 0.2])
def test_factors_beside_elements(ratio: float) -> None:
    """A bar with a cross hole, largest stress anywhere: `pytest -m slow` of this file.

    Its edge agrees with Peterson's curves.
    """
    peaks, (bending, torsion) = outlet_peaks(ratio * DIAMETER_MM), outlet_factors(ratio, 1.0)
    assert peaks[BENDING][0] == pytest.approx(peterson_bending(ratio), rel=0.04)
    assert peaks[TORSION][0] == pytest.approx(peterson_torsion(ratio), rel=0.02)
    assert bending == pytest.approx(peaks[BENDING][1], rel=0.1)
    assert torsion == pytest.approx(peaks[TORSION][1], rel=0.1)
    assert 3.0 < peaks[AXIAL][1] < 3.7


@pytest.mark.parametrize(
    ("mirrored", "whole"),
    [
        pytest.param(True, False, id="x >= 0-half", marks=pytest.mark.slow),
        pytest.param(False, False, id="all-half"),
        pytest.param(True, True, id="x >= 0-whole"),
        pytest.param(False, True, id="all-whole", marks=pytest.mark.slow),
    ],
)
def test_unit_moments_are_in_equilibrium(mirrored: bool, whole: bool) -> None:
    """Forces on the near section are the moment about x or y that the field is named after, on the far one of
    a whole throw the opposite."""
    scene = mikron()
    mesh = mesh_throw(scene, 14.0, quarter=mirrored, full=whole).mesh
    assert mesh.mirrored == mirrored
    model = assemble(mesh, 2.1e5, 0.3)
    fields = unit_fields(model, scene, mirrored, ("moment", "side_moment"), whole=whole)
    for z_mm, moment in ((0.0, 1.0), (scene.pitch_mm, -1.0))[: 1 + whole]:
        section = plane_nodes(model.nodes_mm, 2, z_mm)
        x, y, _ = model.nodes_mm[:, section]
        for field, about in zip(fields, (0, 1), strict=True):
            forces = (model.stiffness @ field.displacement_mm).reshape(-1, 3)[section]
            moments = float(y @ forces[:, 2]), float(-x @ forces[:, 2])
            assert (1 + mirrored) * moments[about] == pytest.approx(moment, rel=1e-6), field.kind
            if not mirrored:
                assert moments[1 - about] == pytest.approx(0.0, abs=1e-5), field.kind
            assert (field.sign_x, field.sign_z) == ((1, 1), (-1, 1))[about]


@pytest.mark.slow
def test_factors_of_elements_are_those_of_the_study_and_of_a_plate() -> None:
    """`pytest -m slow` of this file, minutes. At 30 deg half of the bending is across the crank's plane."""
    for outlet in OUTLETS[:2]:
        scene = outlet.scene()
        kinds = ("moment", "side_moment", "torsion") if outlet.angle_deg else ("moment", "torsion")
        model = solve_stresses(Target(outlet.throw, scene), kinds, 0.5, by_rule=True)
        (channel, mouth), *_ = pin_outlets(scene)
        found = element_outlet_factors(model, channel, mouth)
        assert found is not None
        _, by_plate = without_bore(outlet)
        assert found.gamma_torsion == pytest.approx(by_plate[1], rel=0.1)
        if not outlet.angle_deg:
            assert found.gamma_bending == pytest.approx(by_plate[0], rel=0.1)


@pytest.mark.slow
def test_factors_of_a_leaning_outlet_are_about_those_of_an_ellipse() -> None:
    """A plate with the elliptical hole in which the bore meets the pin, in the stresses that a throw without
    the bore has there (`without_bore` has them for radial ones): -0.667 and 0.103 of the nominal stress along
    and around in bending, a shear of 1.153 in torsion. Five minutes: `pytest -m slow` of this file.
    """
    scene = mikron(STRAIGHT)
    ((channel, mouth),) = pin_outlets(scene)
    model = solve_stresses(Target("leaning", scene), ("moment", "torsion"), 0.3, by_rule=True)
    found = element_outlet_factors(model, channel, mouth)
    longer = 1 / math.cos(math.radians(mouth.obliquity_deg))
    assert found is not None
    assert found.gamma_bending == pytest.approx(0.667 * (1 + 2 / longer) + 0.103, rel=0.15)
    assert found.gamma_torsion == pytest.approx(1.153 * (1 + longer) ** 2 / longer, rel=0.15)
    assert found.gamma_torsion > 1.2 * outlet_factors(5.0, 42.0)[1]  # a radial bore's would flatter


@pytest.mark.slow
def test_an_outlet_in_a_throw() -> None:
    """Elements with the bore and a plate's stresses without it agree, and tell why the rule does not.

    A minute: `pytest -m slow` of this file. `python -m tests.benchmarks.outlet_factors` has three throws.
    """
    outlet = OUTLETS[0]
    local, by_plate = without_bore(outlet)
    found = by_elements(outlet, 0.5)
    assert found == pytest.approx(by_plate, rel=0.1)
    assert local[0] < 0.85  # the outer side of a short pin carries less than a beam's
    bending, _ = outlet_factors(5.0, 60.0)
    assert bending * local[0] == pytest.approx(found[0], rel=0.12)
    assert bending > 1.1 * found[0]


@pytest.mark.slow
def test_a_bore_of_one_web_that_is_its_own_mirror_image_has_the_factors_of_one_of_both() -> None:
    """Radial in the middle of the pin: half of it in each half throw, or all of it in the whole one.

    Fillets and outlet agree within what they differ by from mesh to mesh.
    """
    bore = drilling(("crankpin", 0.0, 0.0), ("crankpin_bore", 0.0, 0.0), rounding=1.0)
    found = []
    for web in ("both", "first"):
        scene = scene_with({"drilling": [{**bore, "web": web}]})
        model = solve_stresses(Target(web, scene), ("moment", "bending", "torsion"), 0.3, by_rule=True)
        assert model.whole == (web == "first")
        (outlet,) = (element_outlet_factors(model, *one) for one in pin_outlets(scene))
        at = element_factors(model)
        fillets = [at.alpha_bending, at.alpha_torsion, at.beta_bending, at.beta_torsion]
        found.append([outlet.gamma_bending, outlet.gamma_torsion, *fillets])
    assert found[1] == pytest.approx(found[0], rel=0.03)
