"""Two throws between bearings, with a main journal or a flying web between them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.crank_ends import SIDES
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.crank_throws import carried, throw_scenes
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.crank import crank_mass, end_mass
from cranktopo.engine.balance.free_forces import counterweights, rotating_force, turning_masses
from cranktopo.engine.balance.whole_engine import main_bearings
from cranktopo.tasks.shaft.assembly import shaft_matrix, shaft_stiffness
from tests.random_cranks import random_crank
from tests.step_volume import step_volume_mm3

FLYING = [{"number": 1, "length_mm": 0.0}, {"number": 3, "length_mm": 0.0}]


def mikron(masses: bool = True, **crank: Any) -> Scene:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    if not masses:
        del data["engine"]["masses"]
    return scene_from_dict({**data, "crank": crank}, "crank")


def test_every_is_the_default() -> None:
    assert mikron(bearings="every") == mikron()
    assert carried(mikron()) == (0, 1, 2, 3, 4)
    assert carried(mikron(bearings=[0, 2, 4])) == (0, 2, 4)


@pytest.mark.parametrize(
    ("crank", "message"),
    [
        ({"bearings": [0, 2]}, r"crank\.bearings = \[0, 2\]: must be numbers .* rising from 0 to 4"),
        ({"bearings": [0, 3, 1, 4]}, r"rising from 0 to 4"),
        (
            {"main_journal": FLYING},
            r"main_journal\[0\]\.length_mm = 0\.0: a journal in a bearing has a length",
        ),
    ],
)
def test_refused(crank: dict[str, Any], message: str) -> None:
    with pytest.raises(CranktopoError, match=message):
        mikron(**crank)


@pytest.mark.parametrize("more", [{}, {"main_journal": FLYING}])
def test_fewer_bearings_carry_the_same_force_and_moment(more: dict[str, Any]) -> None:
    """Of all angles: the sum of the loads, and that of place times load, are those of the rods and masses."""
    scene = mikron(bearings=[0, 2, 4], **more)
    masses = turning_masses(scene)
    loads = main_bearings(scene, masses).load_N
    assert len(loads) == 3
    if not more:
        every = mikron()
        all_masses = turning_masses(every)
        full = main_bearings(every, all_masses).load_N
        assert loads.sum(axis=0) == pytest.approx(full.sum(axis=0), abs=1e-6)
        moment, wanted = (m.layout.bearing_z_mm @ load for m, load in ((masses, loads), (all_masses, full)))
        assert moment == pytest.approx(wanted, abs=1e-4)
    free = rotating_force(masses)
    assert free.force.largest == pytest.approx(0.0, abs=1e-6)


def test_a_flying_web_joins_its_throws(tmp_path: Path) -> None:
    scene = mikron(bearings=[0, 2, 4], main_journal=FLYING)
    assert [throw.pitch_mm for throw in throw_scenes(scene)] == [94.0] * 4
    mass = crank_mass(scene)
    assert mass is not None
    with pytest.raises(CranktopoError, match="flying one, which is not modelled"):
        mesh_throw(throw_scenes(scene)[0], 8.0)


@pytest.mark.slow
def test_the_solid_of_a_crank_with_flying_webs(tmp_path: Path) -> None:
    scene = mikron(bearings=[0, 2, 4], main_journal=FLYING)
    volume = export_solid(scene, "crankshaft", tmp_path / "crank.step")
    mass = crank_mass(scene)
    assert mass is not None
    assert volume * scene.material.density_kg_m3 * 1e-9 == pytest.approx(mass.mass_kg, rel=1e-9)
    assert step_volume_mm3(tmp_path / "crank.step") == pytest.approx(volume, rel=1e-6)


def test_a_shaft_with_fewer_rigid_bearings_is_softer() -> None:
    """A throw that is stiff against shear across and soft in torsion, its pin off the axis."""
    rng = np.random.default_rng(3)
    modes = rng.normal(size=(6, 12))
    modes[:, 6:] = -modes[:, :6]
    throw = modes.T @ modes
    shaft = shaft_matrix(throw, (0.0, 180.0, 180.0, 0.0))
    every, fewer = (shaft_stiffness(shaft, "rigid", carried=places) for places in (None, (0, 2, 4)))
    assert fewer.end_to_end_Nm_per_rad < every.end_to_end_Nm_per_rad
    assert shaft_stiffness(shaft, "rigid", carried=range(5)) == every


@pytest.mark.parametrize("seed", [2, 11, 23])
def test_free_forces_are_those_of_the_crank_as_a_body(seed: int) -> None:
    """Without rods: the closed form of the crank's unbalance and couple, the sums over throws and ends."""
    data = random_crank(seed).model_dump(mode="json", exclude_none=True)
    del data["engine"]["masses"]
    scene = scene_from_dict(data, "crank")
    mass, masses = crank_mass(scene), turning_masses(scene)
    assert mass is not None
    free = rotating_force(masses)
    scale = mass.mass_kg * scene.throw.radius_mm * masses.w2 / 1000
    assert free.force.largest == pytest.approx(mass.unbalance_kg_mm * masses.w2 / 1000, abs=1e-9 * scale)
    length = masses.layout.length_mm / 1000
    assert free.moment.largest == pytest.approx(
        mass.couple_kg_mm2 * masses.w2 / 1e6, abs=1e-9 * scale * length
    )


def test_round_ends_leave_nothing_free() -> None:
    """A flange with twelve bolt holes is balanced: what its sum has left is rounding, told as nothing."""
    flange = {"kind": "flange", "diameter_mm": 90.0, "length_mm": 12.0}
    holes = {"bolts": 12, "bolt_circle_mm": 70.0, "bolt_diameter_mm": 8.0}
    scene = mikron(end=[{"side": side, "step": [flange | holes]} for side in ("free", "output")])
    masses = turning_masses(scene)
    assert [end_mass(scene, side).mass_kg > 0 for side in SIDES] == [True, True]
    free = rotating_force(masses)
    assert (free.force.largest, free.moment.largest) == (0.0, 0.0)
    assert {weight.shaft_unbalance_kg_mm for weight in counterweights(masses)} == {0.0}
    notched = {**flange, **holes, "bolts": 1}
    uneven = turning_masses(mikron(end=[{"side": "output", "step": [notched]}]))
    assert abs(uneven.journals[-1].unbalance_kg_mm) == pytest.approx(
        np.pi / 4 * 8**2 * 12 * 35 * 7.85e-6, rel=1e-9
    )
