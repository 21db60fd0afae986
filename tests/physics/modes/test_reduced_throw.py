"""A throw with its mass, reduced: against its mesh in one piece, its closed-form mass, and itself whole."""

from __future__ import annotations

import shutil
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.base.units import KG_PER_TONNE
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, mesh_throw
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.halves import halves
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.turning_body import modes_at_rest
from cranktopo.tasks.modes.reduced_throw import DEGREE, ReducedThrow, reduced_throw, section_shapes
from cranktopo.tasks.modes.shaft_model import shaft_model
from cranktopo.tasks.shaft.loaded_throw import ThrowBody, throw_body
from tests.physics.fea.calculix import free_frequencies_Hz
from tests.studies.crank_modes import body_frequencies_Hz
from tests.unit.throw.counterweight_cases import PLAIN, roomy_scene, weighted

Array = NDArray[np.float64]
SIZE_MM = 24.0
MOVING_KG = 3.0


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene("opposed-piston")


@pytest.fixture(scope="module")
def half(scene: Scene) -> MeshedThrow:
    return mesh_throw(scene, SIZE_MM)


@pytest.fixture(scope="module")
def whole(scene: Scene) -> MeshedThrow:
    return mesh_throw(scene, SIZE_MM, full=True)


@pytest.fixture(scope="module")
def half_body(scene: Scene, half: MeshedThrow) -> ThrowBody:
    return throw_body(half, scene)


@pytest.fixture(scope="module")
def whole_body(scene: Scene, whole: MeshedThrow) -> ThrowBody:
    return throw_body(whole, scene)


@pytest.fixture(scope="module")
def half_throw(scene: Scene, half_body: ThrowBody) -> ReducedThrow:
    """With its moving mass."""
    return reduced(half_body, scene, 1, MOVING_KG)


def reduced(body: ThrowBody, scene: Scene, steps: int = 1, moving_kg: float = 0.0) -> ReducedThrow:
    return reduced_throw(body, scene, section_shapes(scene), steps, moving_kg)


def frequencies_Hz(throw: ReducedThrow, scene: Scene, count: int = 10) -> Array:
    modes = modes_at_rest(shaft_model([throw], scene, "free", 0.0).body)
    assert modes.rigid == 6
    return modes.frequency_Hz[6 : 6 + count]


def rigid(throw: ReducedThrow, pitch_mm: float) -> Array:
    """Motions of the unknowns when the whole throw moves as a rigid body about its near section."""
    motion = np.zeros((len(throw.step_of), 6))
    motion[:6] = motion[6:12] = np.eye(6)
    motion[6, 4], motion[7, 3] = pitch_mm, -pitch_mm
    return motion


def test_the_throw_in_one_piece(scene: Scene, whole: MeshedThrow, whole_body: ThrowBody) -> None:
    """The same mesh by all its unknowns: a reduced body is never softer, and hardly stiffer."""
    exact = body_frequencies_Hz(whole.mesh, scene)
    static, one, two = (frequencies_Hz(reduced(whole_body, scene, steps), scene) for steps in (0, 1, 2))
    assert (two / exact).min() > 1 - 1e-6
    assert (two <= one * (1 + 1e-9)).all()
    assert (one <= static * (1 + 1e-9)).all()
    assert two[:7] / exact[:7] == pytest.approx(np.ones(7), abs=5e-3)
    assert static[6] > 1.5 * exact[6], "static fields alone are another body"


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
def test_the_throw_by_calculix(scene: Scene, tmp_path: Path) -> None:
    both = mesh_throw(scene, SIZE_MM, full=True, quarter=False)
    exact = free_frequencies_Hz(tmp_path, both.mesh, scene, 7)
    assert body_frequencies_Hz(both.mesh, scene, 7) == pytest.approx(exact, rel=3e-4)
    assert frequencies_Hz(reduced(throw_body(both, scene), scene, 2), scene, 7) == pytest.approx(
        exact, rel=5e-3
    )


def test_two_halves_are_the_whole(scene: Scene, half_throw: ReducedThrow, whole_body: ThrowBody) -> None:
    one, other = half_throw, reduced(whole_body, scene, 1, MOVING_KG)
    assert frequencies_Hz(one, scene) == pytest.approx(frequencies_Hz(other, scene), rel=3e-3)
    for near, far in zip(one.stations, other.stations, strict=True):
        assert near.z_mm == pytest.approx(far.z_mm, rel=5e-3)
        assert near.inertia == pytest.approx(far.inertia, rel=5e-3, abs=5e-3 * np.abs(far.inertia).max())


def test_both_lateral_halves_are_the_whole(scene: Scene, half: MeshedThrow, half_body: ThrowBody) -> None:
    """Even and odd motions of the half x >= 0 against a mesh of both sides, Coriolis force included."""
    both = mesh_throw(scene, SIZE_MM, quarter=False)
    assert half.mesh.mirrored
    assert not both.mesh.mirrored
    one, other = (reduced(body, scene, 0, MOVING_KG) for body in (half_body, throw_body(both, scene)))
    for name in ("stiffness", "mass", "coriolis", "lateral", "stiffening"):
        first, second = (getattr(throw.body, name)[:12, :12] for throw in (one, other))
        assert np.abs(first - second).max() < 3e-2 * np.abs(second).max(), name  # coarse meshes differ


def test_a_rigid_throw_has_its_mass(scene: Scene, half_throw: ReducedThrow) -> None:
    throw = half_throw
    motion = rigid(throw, scene.pitch_mm)
    body = throw.body.over(motion)
    balance = throw_balance(scene)
    moving = np.array([MOVING_KG, MOVING_KG, 0.0])
    assert np.abs(body.stiffness).max() < 1e-6 * np.abs(throw.body.stiffness).max()
    assert KG_PER_TONNE * np.diag(body.mass)[:3] == pytest.approx(balance.mass_kg + moving, rel=1e-3)
    own = balance.inertia_kg_mm2 + MOVING_KG * scene.throw.radius_mm**2
    assert KG_PER_TONNE * body.mass[5, 5] == pytest.approx(own, rel=2e-3)
    assert body.coriolis[1, 0] == pytest.approx(body.mass[0, 0], rel=1e-9)
    assert body.coriolis == pytest.approx(-body.coriolis.T)
    for station in throw.stations:
        at = np.eye(6)
        at[0, 4], at[1, 3] = station.z_mm, -station.z_mm
        assert station.motion @ motion == pytest.approx(at, abs=1e-6 * scene.pitch_mm)


def test_an_even_turn_strains_nothing(scene: Scene, half_body: ThrowBody, half_throw: ReducedThrow) -> None:
    """At any speed it neither rises nor falls: the centrifugal force of a turned throw turns with it."""
    alone = reduced(half_body, scene, 0)
    for throw, rounding in ((alone, 1e-9), (half_throw, 1e-3)):  # the pin of a mesh is not quite round
        turn = throw.body.over(rigid(throw, scene.pitch_mm)[:, [5]])
        assert turn.stiffening == pytest.approx(turn.lateral, rel=rounding)


def test_deformations_make_the_shaft_softer(scene: Scene, half_body: ThrowBody) -> None:
    shapes = [section_shapes(scene, degree) for degree in range(DEGREE + 1)]
    degrees = [frequencies_Hz(reduced_throw(half_body, scene, own, 1, 0.0), scene) for own in shapes]
    for stiffer, softer in pairwise(degrees):
        assert (softer <= stiffer * (1 + 1e-9)).all()


def test_halves_that_differ(scene: Scene) -> None:
    """A throw with two different webs, from its other end, has the same frequencies."""
    near = scene.web.model_dump(mode="json", exclude_none=True)
    far = near | {"thickness_mm": 0.7 * scene.web.thickness_mm}
    data = scene.model_dump(mode="json", exclude_none=True)
    one, other = (
        scene_from_dict(data | {"web": web, "second_web": second}, whole=True)
        for web, second in ((near, far), (far, near))
    )
    throws = [reduced(throw_body(mesh_throw(own, SIZE_MM), own), own) for own in (one, other)]
    found = [frequencies_Hz(throw, own, 6) for throw, own in zip(throws, (one, other), strict=True)]
    assert found[0] == pytest.approx(found[1], rel=1e-2)
    for side in (0, 1):
        first, second = throws[0].stations[side], throws[1].stations[1 - side]
        assert first.z_mm == pytest.approx(one.pitch_mm - second.z_mm, rel=1e-2)
        assert np.diag(first.inertia) == pytest.approx(np.diag(second.inertia), rel=4e-2)


def test_a_bolted_counterweight_counts_with_its_mass(mikron: Scene) -> None:
    scene = weighted(roomy_scene(mikron), {**PLAIN, "density_kg_m3": 17500.0})
    throw = reduced(throw_body(mesh_throw(scene, 8.0), scene), scene, 0)
    body, balance = throw.body.over(rigid(throw, scene.pitch_mm)), throw_balance(scene)
    assert sum(bolted_mass(half).volume for half in halves(scene)) > 0.2 * balance.mass_kg
    assert KG_PER_TONNE * np.diag(body.mass)[:3] == pytest.approx(np.full(3, balance.mass_kg), rel=2e-3)
    assert KG_PER_TONNE * body.mass[5, 5] == pytest.approx(balance.inertia_kg_mm2, rel=4e-3)
    unbalance = KG_PER_TONNE * body.mass[0, 5]
    assert unbalance == pytest.approx(-balance.throw_unbalance_kg_mm, rel=1e-2)
