"""The written reduced shaft, read by NumPy alone, against the program: frequencies, mass, stress."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import eigh

from cranktopo.base.units import density_tonne_per_mm3
from cranktopo.bodies.crank_ends import ends_volume_mm3
from cranktopo.design.crank_throws import carried
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_speed
from cranktopo.numerics.harmonic_balance import harmonics_of
from cranktopo.numerics.tetrahedra.elasticity import mass_matrix
from cranktopo.numerics.tetrahedra.stress import von_mises
from cranktopo.numerics.turning_body import modes_at_rest
from cranktopo.tasks.dynamics.moving_shaft import MovingShaft, moving_cycle
from cranktopo.tasks.export import reduced as written
from cranktopo.tasks.modes.shaft_model import shaft_model
from cranktopo.tasks.shaft.assembly import Bearings
from cranktopo.tasks.shaft.cycle import CycleForces, cycle_forces, load_shares, shaft_cycle, throw_states
from cranktopo.tasks.shaft.loaded_throw import LOADS
from cranktopo.tasks.throw_fatigue.shaft_stress import ShaftStress
from cranktopo.tasks.throw_fea.targets import Target

Array = NDArray[np.float64]
File = Mapping[str, NDArray[Any]]
COARSE, MODES = 2.0, 12
SPRING_N_PER_MM = 2.5e5
MOTIONS = ("ux", "uy", "uz", "rx", "ry", "rz")


def lopsided() -> Scene:
    """The Mikron with ends, a pulley on a spring, a flywheel and throws at odd angles, on springs."""
    data = load_scene("mikron-iiic-crank", whole=True).model_dump(mode="json", exclude_none=True)
    data["supports"] = {"bearing_spring_N_per_mm": SPRING_N_PER_MM, "bearing_tilt_spring_Nm_per_rad": 2e3}
    data["engine"]["arrangement"] = {"throw_angles_deg": [0.0, 90.0, 270.0, 180.0]}
    data["shaft"] = {
        "cylinder_damping_Nms_per_rad": 0.8,
        "throw_damping_Nms_per_rad": 1.5,
        "pulley": {"inertia_kg_m2": 0.004, "mass_kg": 1.2, "stiffness_Nm_per_rad": 2e4},
        "flywheel": {"inertia_kg_m2": 0.09, "mass_kg": 7.0, "stiffness_Nm_per_rad": 3e5, "overhang_mm": 30.0},
    }
    return scene_from_dict(data)


class Written:
    """A written file, and what the program made it of."""

    def __init__(self, scene: Scene, folder: Path) -> None:
        self.scene, path = scene, folder / "shaft.npz"
        with pytest.MonkeyPatch.context() as patched:
            for name in ("assembled", "fillet_stress"):
                patched.setattr(written, name, self._kept(name))
            self.told = written.export_reduced(Target("made", scene), path, COARSE)
        with np.load(path, allow_pickle=False) as file:
            self.file: File = dict(file)

    def _kept(self, name: str) -> Any:
        make = getattr(written, name)

        def kept(*arguments: Any) -> Any:
            setattr(self, f"_{name}", arguments[0])
            return make(*arguments)

        return kept

    @property
    def shaft(self) -> MovingShaft:
        found: MovingShaft = vars(self)["_assembled"]
        return found

    @property
    def stress(self) -> ShaftStress:
        found: ShaftStress = vars(self)["_fillet_stress"]
        return found


@pytest.fixture(scope="module", params=["mikron-iiic", "lopsided"])
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Written:
    scene = lopsided() if request.param == "lopsided" else load_scene(request.param, whole=True)
    return Written(scene, tmp_path_factory.mktemp("written"))


def rigid_motions(file: File) -> Array:
    """Six motions of the shaft as a whole, rotations about the first main journal, (n, 6)."""
    motion, z = file["coordinate_motion"], file["coordinate_z_mm"]
    found = np.stack([motion == name for name in MOTIONS], axis=1).astype(float)
    found[:, 3] -= z * (motion == "uy")
    found[:, 4] += z * (motion == "ux")
    return found


def supported(file: File, bearings: Bearings) -> tuple[Array, Array]:
    """Stiffness on bearings, and the free coordinates."""
    stiffness, rows = file["stiffness"].copy(), file["bearing_coordinates"]
    radial, tilting = rows[:, :2], rows[:, 2:]
    if bearings != "free":
        tilt = file["bearing_tilt_stiffness_Nmm_per_rad"]
        stiffness[tilting, tilting] += tilt[:, None]
    if bearings == "spring":
        stiffness[radial, radial] += file["bearing_stiffness_N_per_mm"][:, None]
    free = np.setdiff1d(np.arange(len(stiffness)), radial if bearings == "rigid" else [])
    return stiffness, free


def frequencies_Hz(file: File, bearings: Bearings) -> Array:
    stiffness, free = supported(file, bearings)
    scale = 1 / np.sqrt(np.diag(file["mass"])[free])
    scaled = [m[np.ix_(free, free)] * np.outer(scale, scale) for m in (stiffness, file["mass"])]
    squares = eigh(*scaled, eigvals_only=True)
    return np.asarray(np.sqrt(np.abs(squares)) / (2 * np.pi))


@pytest.mark.slow
def test_every_array_is_explained_in_the_file(made: Written) -> None:
    told = {line.partition(":")[0] for line in str(made.file["about"]).splitlines()[1:]}
    numbered = {name.rstrip("0123456789") for name in made.file}
    assert {name.rstrip("TK") for name in told} == numbered - {"about"}
    assert int(made.file["schema_version"]) == 1
    assert made.told.startswith(f"{len(made.file['coordinate_name'])} coordinates, stress at ")
    assert len(set(zip(made.file["coordinate_name"], made.file["coordinate_motion"], strict=True))) == len(
        made.file["stiffness"]
    )


@pytest.mark.slow
@pytest.mark.parametrize("bearings", ["free", "rigid", "spring"])
def test_natural_frequencies_are_those_of_the_program(made: Written, bearings: Bearings) -> None:
    """Of the reduction that `shaft --dynamic` meets its orders with, joined by itself."""
    if bearings == "spring" and made.scene.supports.bearing_spring_N_per_mm is None:
        assert np.isinf(made.file["bearing_stiffness_N_per_mm"]).all()
        return
    throws = [throw.reduced for throw in made.shaft.throws]
    rest = modes_at_rest(shaft_model(throws, made.scene, bearings, SPRING_N_PER_MM).body)
    found = frequencies_Hz(made.file, bearings)
    assert rest.rigid == {"free": 6, "rigid": 2, "spring": 2}[bearings]
    own = slice(rest.rigid, rest.rigid + MODES)
    assert found[own] == pytest.approx(rest.frequency_Hz[own], rel=1e-6)
    assert found[: rest.rigid] == pytest.approx(0, abs=1e-3 * found[rest.rigid])


@pytest.mark.slow
def test_the_shaft_as_a_whole_moves_without_force(made: Written) -> None:
    """Within 1e-9 of the largest stiffness against the motion, of every kind of coordinate by itself."""
    file, motions = made.file, rigid_motions(made.file)
    force, matrix = np.abs(file["stiffness"] @ motions), np.abs(file["stiffness"])
    for unit in np.unique(file["coordinate_unit"]):
        rows = file["coordinate_unit"] == unit
        most = (matrix[rows] @ np.abs(motions)).max(axis=0)
        assert (force[rows] <= 1e-9 * most).all(), unit


@pytest.mark.slow
def test_mass_is_that_of_the_crank_and_what_it_carries(made: Written) -> None:
    """Along the shaft without rods and pistons: of the mesh to 1e-6, which misses little of the crank."""
    file, shaft = made.file, made.scene.shaft
    along = rigid_motions(file)[:, 2]
    parts_kg = [part.mass_kg or 0.0 for part in (shaft.pulley, shaft.flywheel) if part] if shaft else []
    found_kg = 1e3 * float(along @ file["mass"] @ along) - sum(parts_kg)
    density = density_tonne_per_mm3(made.scene.material.density_kg_m3)
    body = made.stress.body
    throw_kg = (
        1e3
        * float(mass_matrix(body.model, density).sum())
        * body.meshed.copies
        * (2 if body.meshed.mesh.mirrored else 1)
    )
    ends_kg = 1e3 * density * ends_volume_mm3(made.scene)
    assert found_kg == pytest.approx(4 * throw_kg + ends_kg, rel=1e-6)
    assert found_kg == pytest.approx(float(file["crank_mass_kg"]), rel=1e-3)


def amounts() -> Array:
    """Number of unit loads on each throw, (throws, loads): another one on each, on each half of its pin."""
    found = np.random.default_rng(3).uniform(-1, 1, (4, len(LOADS))) * [4e4, 9e3, 5e3, 2e3, 0.0]
    found[:, LOADS.index("centrifugal")] = 280.0**2
    return np.asarray(found)


def solved(file: File) -> Array:
    """Coordinates of the file under `amounts`, the last section held in rotation and along the shaft."""
    bearings: Bearings = "rigid" if np.isinf(file["bearing_stiffness_N_per_mm"]).any() else "spring"
    stiffness, free = supported(file, bearings)
    last = file["coordinate_name"] == f"section {len(file['throw_kind']) + 1}"
    even = np.flatnonzero(last & np.isin(file["coordinate_motion"], ["uz", "rz"]))
    free = np.setdiff1d(free, even)
    load, q = np.einsum("tl,tln->n", amounts(), file["loads"]), np.zeros(len(stiffness))
    q[free] = np.linalg.solve(stiffness[np.ix_(free, free)], load[free])
    return q


def by_program(made: Written) -> Array:
    """Stress of the quasi-static shaft of the program at the nodes of the file, (throws, nodes, 6).

    Each image in its own mirrored axes, as the program judges it.
    """
    scene, throws = made.scene, [throw.still for throw in made.shaft.throws]
    share, moment = amounts()[:, :, None], throws[0].aside_moment_mm
    radial, tangential, *aside, _ = share.transpose(1, 0, 2)
    forces = CycleForces(np.zeros(1), radial, tangential, aside[0] * moment, aside[1] * moment, 280.0)
    angles, spring = scene.shaft_angles_deg, scene.supports.bearing_spring_N_per_mm
    tilt = 1e3 * (scene.supports.bearing_tilt_spring_Nm_per_rad or 0.0)
    cycle = shaft_cycle(throws, angles, forces, spring, carried(scene), tilt_Nmm_per_rad=tilt)
    model, found = made.stress.model, []
    for states in throw_states(throws, angles, forces, cycle):
        acting = np.zeros((made.stress.shares.shape[1], 1))
        acting[: 12 + len(LOADS)] = states[: 12 + len(LOADS)]
        (factors,) = made.stress.loads(acting)
        fields = model.stress.stress_MPa[:, model.on_fillet]
        found.append(
            np.concatenate([np.einsum("f,fnc->nc", factors * one.signs, fields) for one in model.images])
        )
    return np.stack(found)


@pytest.mark.slow
def test_stress_under_a_load_is_that_of_the_program(made: Written) -> None:
    """At every node of every fillet: the worst one is the same; the program condenses its loads."""
    file, expected = made.file, von_mises(by_program(made))
    q = solved(file)
    found = np.stack(
        [
            von_mises(np.einsum("u,upc->pc", file[f"throw_motion_{throw}"] @ q, file["fillet_stress_MPa_1"]))
            for throw in range(1, 5)
        ]
    )
    assert expected.max() > 20
    assert found.argmax() == expected.argmax()
    assert found.max() == pytest.approx(expected.max(), rel=1e-6)
    assert np.abs(found - expected).max() < 1e-6 * expected.max()


@pytest.mark.slow
def test_stress_goes_on_across_the_mirror_planes(made: Written) -> None:
    """Nodes in x = 0 are there from both sides, each with the components that its own side has."""
    file = made.file
    points = file["fillet_points_mm_1"]
    order = np.lexsort(np.round(points.T, 6))
    same = np.abs(np.diff(points[order], axis=0)).max(axis=1) < 1e-6
    one, other = order[:-1][same], order[1:][same]
    assert len(one) > 20
    tensors = np.einsum("u,upc->pc", file["throw_motion_2"] @ solved(file), file["fillet_stress_MPa_1"])
    steps = np.abs(tensors[one] - tensors[other]).max(axis=0)
    assert (steps < 0.5 * np.abs(tensors[one]).max(axis=0)).all()


@pytest.mark.slow
def test_no_force_acts_on_the_surface_of_a_fillet(made: Written) -> None:
    """Stress times the normal is small in every image: its tensor is turned as its points are."""
    file, model = made.file, made.stress.model
    normals = np.concatenate(
        [
            model.surface.normals[model.on_fillet] * [-1 if one.flip_x else 1, 1, -1 if one.flip_z else 1]
            for one in model.images
        ]
    )
    stress = np.einsum("u,upc->pc", file["throw_motion_3"] @ solved(file), file["fillet_stress_MPa_1"])
    tensor = stress[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    traction, size = np.einsum("pij,pj->pi", tensor, normals), von_mises(stress)
    corner = file["fillet_points_mm_1"] @ np.diag([1, 0, 1]) > [0, -1, made.scene.pitch_mm / 2]
    for side in np.unique(corner, axis=0):
        own = (corner == side).all(axis=1) & (size > np.median(size))
        assert np.median(np.linalg.norm(traction[own], axis=1) / size[own]) < 0.2, side


@pytest.mark.slow
def test_a_slow_vibration_is_that_of_the_program(made: Written) -> None:
    """All matrices together: harmonics of a cycle at 2,100 rpm, section by section."""
    forces = cycle_forces(at_speed(made.scene, 2100.0))
    expected = moving_cycle(made.shaft, forces)
    file, states, throws = made.file, forces.angle_deg.size, [one.still for one in made.shaft.throws]
    speed = float(file["rotation_about_z"]) * forces.angular_speed_rad_s
    share = np.stack([harmonics_of(load_shares(throw, forces, t)) for t, throw in enumerate(throws)])
    load = np.einsum("tlk,tln->kn", share, file["loads"])
    step = abs(speed) * 360 / (states * (forces.angle_deg[1] - forces.angle_deg[0]))
    last = file["coordinate_name"] == f"section {len(throws) + 1}"
    fixed = file["bearing_coordinates"][:, :2].ravel()
    stiffness, _ = supported(file, "rigid")
    for number in (1, 4, 9):
        f = number * step
        dynamic = (
            stiffness - speed**2 * file["softening"] - f**2 * file["mass"] + 1j * file["loss"]
        ) + 1j * f * (speed * file["gyroscopic"] + file["viscous"])
        held = fixed if made.shaft.turns_freely else [*fixed, *np.flatnonzero(last & _turns(file))]
        free = np.setdiff1d(np.arange(len(dynamic)), held)
        q = np.zeros(len(dynamic), complex)
        q[free] = np.linalg.solve(dynamic[np.ix_(free, free)], load[number, free])
        own = harmonics_of(expected.shaft.motion)[:, number]
        assert np.abs(q[: len(own)] - own).max() < 1e-6 * np.abs(own).max()


def _turns(file: File) -> NDArray[np.bool_]:
    return np.asarray(file["coordinate_motion"] == "rz")
