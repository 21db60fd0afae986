"""How a flywheel and a pulley move that the ends of a shaft without mass carry."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.bodies.crank_ends import crank_end, end_length_mm, main_journal_places_mm
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY
from cranktopo.tasks.shaft.carried_parts import carried_motions
from cranktopo.tasks.shaft.cycle import shaft_cycle
from tests.physics.shaft.test_continuous_shaft import meshed, random_forces

SPRING_N_PER_MM = 3e4
DISK = {"inertia_kg_m2": 0.2, "mass_kg": 20.0, "overhang_mm": 30.0}


def test_they_lead_on_from_the_outer_journal() -> None:
    """One throw under its load: bearings yield along it, and its ends swing against it as those of a beam."""
    scene = with_values(load_scene("mikron-iiic-plain"), {"shaft.flywheel": DISK, "shaft.pulley": DISK})
    _, throw = meshed(scene, 20.0)
    forces = random_forces(1)
    rigid, soft = (shaft_cycle([throw], (0.0,), forces, k) for k in (None, SPRING_N_PER_MM))
    across_N, along_N = np.abs(forces.tangential_N[0]), np.abs(forces.radial_N[0])
    found = carried_motions(soft, scene)
    assert [one.part for one in found] == ["pulley", "flywheel"]
    assert found[0].offset_um != pytest.approx(found[1].offset_um, rel=0.1)
    for one, tilt in zip(found, np.abs(rigid.motion.reshape(2, 6, -1)), strict=True):
        aside = across_N / 2 / SPRING_N_PER_MM - tilt[RY] * 30.0
        upward = along_N / 2 / SPRING_N_PER_MM - tilt[RX] * 30.0
        assert one.offset_um == pytest.approx(1000 * np.hypot(aside, upward).max(), rel=1e-6)
        assert one.tilt_mrad == pytest.approx(1000 * np.hypot(tilt[RX], tilt[RY]).max(), rel=1e-6)


def test_only_parts_whose_mass_the_crank_carries() -> None:
    light = {"inertia_kg_m2": 0.1}
    coupling = {"inertia_kg_m2": 0.05, "stiffness_Nm_per_rad": 2e4}
    values = {
        "shaft.pulley": light,
        "shaft.flywheel": DISK,
        "shaft.coupling": coupling,
        "shaft.driven": light,
    }
    scene = with_values(load_scene("mikron-iiic-plain"), values)
    cycle = shaft_cycle([meshed(scene, 20.0)[1]], (0.0,), random_forces(1), None)
    assert [one.part for one in carried_motions(cycle, scene)] == ["flywheel"]


def test_the_steps_of_an_end_are_its_length() -> None:
    scene = load_scene("mikron-iiic-crank")
    for side, journal_mm in (("free", 0.0), ("output", main_journal_places_mm(scene)[-1])):
        assert end_length_mm(scene, side) > 0
        assert end_length_mm(scene, side) == pytest.approx(
            abs(crank_end(scene, side)[-1].z_mm[1] - journal_mm)
        )
