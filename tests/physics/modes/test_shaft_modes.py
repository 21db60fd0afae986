"""Modes of whole cranks: against one meshed body, disks in closed form, themselves from the other end."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.loading import load_scene, parse_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.disk_error import TOO_HIGH_PERCENT, TOO_LOW_PERCENT, few_throws
from cranktopo.numerics.tetrahedra.rigid_motions import UX, UY, UZ
from cranktopo.numerics.turning_body import modes_at_rest
from cranktopo.tasks.modes.page import modes_page
from cranktopo.tasks.modes.reduced_throw import reduced_throw, section_shapes
from cranktopo.tasks.modes.result import ShaftModes
from cranktopo.tasks.modes.shaft_model import shaft_model
from cranktopo.tasks.modes.stage import STEPS, moving_kg, shaft_modes
from cranktopo.tasks.modes.text import modes_text
from cranktopo.tasks.shaft.assembly import Bearings
from cranktopo.tasks.shaft.loaded_throw import throw_body
from cranktopo.tasks.shaft.stage import evaluate_shaft
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.vibration.text import DISKS
from tests.studies.crank_modes import body_frequencies_Hz, crank_mesh, reduced_frequencies_Hz

pytestmark = pytest.mark.usefixtures("throws_made_once")

SIZE_MM = 24.0


def mikron(**shaft: Any) -> Scene:
    data = load_scene("mikron-iiic", whole=True).model_dump(mode="json", exclude_none=True)
    return scene_from_dict(data | ({"shaft": shaft} if shaft else {}))


def found(scene: Scene, bearings: Bearings = "rigid", **options: Any) -> ShaftModes:
    return shaft_modes(Target("mikron", scene), bearings, SIZE_MM, **options)


@pytest.fixture(scope="module")
def bare() -> ShaftModes:
    return found(mikron(), speeds_rpm=(700.0, 2800.0))


def uneven() -> Scene:
    """The Mikron with a thinner and longer main journal in the middle."""
    middle = {"number": 2, "outer_diameter_mm": 38.0, "bore_diameter_mm": 16.0, "length_mm": 50.0}
    data = load_scene("mikron-iiic", whole=True).model_dump(mode="json", exclude_none=True)
    return scene_from_dict(data | {"crank": {"main_journal": [middle]}}, whole=True)


@pytest.mark.slow
@pytest.mark.parametrize("design", ["mikron-iiic", "mikron-iiic-crank", "uneven"])
def test_a_crank_in_one_piece(design: str) -> None:
    """All of a crank as one mesh, free: ten modes within half a percent."""
    scene = uneven() if design == "uneven" else load_scene(design, whole=True)
    body = body_frequencies_Hz(crank_mesh(scene, 8.0), scene)
    assert reduced_frequencies_Hz(scene, 8.0, 1, 3) == pytest.approx(body, rel=5e-3)


def test_modes_of_the_mikron(bare: ShaftModes) -> None:
    assert (bare.rigid_motions, len(bare.modes)) == (2, 10)  # it turns, and moves along its axis
    first = bare.modes[0]
    assert first.kind == "torsion"
    assert first.disks_Hz == pytest.approx(first.frequency_Hz, rel=0.03)
    frequencies = [mode.frequency_Hz for mode in bare.modes]
    assert frequencies == sorted(frequencies)
    for mode in bare.modes:
        assert -1.0 < mode.last_step_percent < 1e-6  # more fields make a body softer
        assert sum(mode.shares_percent.model_dump().values()) == pytest.approx(100.0)
        assert -4.0 < mode.shares_percent.rest < 25.0


def short(throws: int) -> Scene:
    """Throws of the Mikron with a flywheel that counts in torsion alone."""
    data = load_scene("mikron-iiic", whole=True).model_dump(mode="json", exclude_unset=True)
    order = {1: [1], 2: [1, 2], 3: [1, 3, 2], 4: [1, 3, 4, 2]}[throws]
    data["engine"] |= {"cylinders": throws, "firing_order": order}
    return scene_from_dict(data | {"shaft": {"flywheel": {"inertia_kg_m2": 0.1}}}, whole=True)


def too_fast_percent(scene: Scene, size_mm: float = SIZE_MM) -> float:
    """By how much disks swing faster than the body in their first mode, or the one that has most of it."""
    found = shaft_modes(Target("short", scene), "rigid", size_mm)
    own = {mode.disks_Hz: mode.frequency_Hz for mode in found.modes if mode.disks_Hz}
    own |= {shared.disks_Hz: found.modes[shared.modes[0] - 1].frequency_Hz for shared in found.disks_shared}
    first = min(own)
    return 100 * (first / own[first] - 1)


def test_disks_of_one_throw_swing_too_fast() -> None:
    """Pulls at its crankpin bend it; the note of `vibration` told of frequencies too low alone."""
    scene = short(1)
    assert few_throws(scene)
    assert 4.0 < too_fast_percent(scene) < TOO_HIGH_PERCENT


def test_the_mass_of_a_flywheel_makes_disks_of_one_throw_too_slow() -> None:
    """It holds the end of the shaft; the same inertia without a mass leaves 1 %. The output tells both."""
    text = (Path(__file__).parents[2] / "data/single.toml").read_text(encoding="utf-8")
    carried = f"{text}mass_kg = 16.0\noverhang_mm = 30.0\n"
    found = [too_fast_percent(parse_scene(one), 16.0) for one in (text, carried)]
    assert found == pytest.approx([-0.8, -TOO_LOW_PERCENT], abs=0.3)
    assert f"{TOO_LOW_PERCENT} % too low to {TOO_HIGH_PERCENT} % too high" in DISKS


@pytest.mark.slow
def test_disks_of_few_throws_swing_too_fast() -> None:
    """The figures of docs/pages/vibration.md; of four throws and more it is less than a hundredth."""
    text = (Path(__file__).parents[2] / "data/v-twin.toml").read_text(encoding="utf-8")
    four = text.replace("cylinders = 2", "cylinders = 4").replace("[1, 2]", "[1, 3, 2, 4]")
    four = four.replace("[0.0]", "[0.0, 180.0]")
    vees = [parse_scene(one) for one in (text, f"{text}mass_kg = 2.5\noverhang_mm = 40.0\n", four)]
    assert [too_fast_percent(vee, 8.0) for vee in vees] == pytest.approx([23.5, 14.8, 2.8], abs=0.3)
    scenes = [short(throws) for throws in (1, 2, 3, 4)]
    found = [too_fast_percent(scene, 16.0) for scene in scenes]
    assert found == pytest.approx([5.6, 1.2, 0.8, 0.4], abs=0.15)
    assert [few_throws(scene) for scene in scenes] == [True, True, True, False]


def test_a_plane_crank_decouples(bare: ShaftModes) -> None:
    """All throws in one plane: bending in it goes with axial motion, bending across it with torsion."""
    for mode in bare.modes:
        shares = mode.shares_percent
        one, other = shares.torsion + shares.across, shares.in_plane + shares.axial
        assert min(abs(one), abs(other)) < 0.1


def test_two_heavy_disks() -> None:
    """Torsion between a pulley and a flywheel that outweigh the crank: sqrt(k (1 / J1 + 1 / J2))."""
    pulley, flywheel = 40.0, 60.0
    scene = mikron(pulley={"inertia_kg_m2": pulley}, flywheel={"inertia_kg_m2": flywheel})
    modes = found(scene, "rigid", speeds_rpm=(700.0, 2800.0))
    stiffness = evaluate_shaft(Target("mikron", scene), "rigid", SIZE_MM).stiffness.end_to_end_Nm_per_rad
    closed = math.sqrt(stiffness * (1 / pulley + 1 / flywheel)) / (2 * math.pi)
    first = modes.modes[0]
    assert first.kind == "torsion"
    assert first.frequency_Hz == pytest.approx(closed, rel=2e-2)  # its sections deform
    assert first.frequency_Hz < closed
    assert modes.torsion_only == ("pulley", "flywheel")


def test_a_ring_on_rubber_has_a_mode_of_its_own() -> None:
    """Beside a heavy hub the ring swings by itself: sqrt(k / J)."""
    ring, stiffness = 0.002, 5.0e3
    damper = {"kind": "rubber", "ring_inertia_kg_m2": ring, "hub_inertia_kg_m2": 30.0, "loss_factor": 0.1}
    modes = found(mikron(damper={**damper, "stiffness_Nm_per_rad": stiffness}), speeds_rpm=(700.0, 2800.0))
    closed = math.sqrt(stiffness / ring) / (2 * math.pi)
    nearest = min(modes.modes, key=lambda mode: abs(mode.frequency_Hz - closed))
    assert nearest.frequency_Hz == pytest.approx(closed, rel=1e-3)
    assert nearest.disks_Hz == pytest.approx(closed, rel=1e-3)


@pytest.mark.slow
def test_the_fluid_of_a_damper_is_told_and_what_it_would_change() -> None:
    """A fluid that holds ever more makes ring and hub one disk, which a pulley of both their inertias is."""
    damper = {"kind": "viscous", "ring_inertia_kg_m2": 0.01, "hub_inertia_kg_m2": 0.02}
    speeds = {"speeds_rpm": (700.0, 2800.0)}
    loose = found(mikron(damper={**damper, "damping_Nms_per_rad": 1e7}), **speeds)
    joined = found(mikron(pulley={"inertia_kg_m2": 0.03}), **speeds)
    by_disks = [mode.disks_Hz for mode in joined.modes if mode.disks_Hz is not None]
    assert loose.disks_with_fluid_Hz[: len(by_disks)] == pytest.approx(by_disks[:3], rel=1e-4)
    told = f"has the fluid: torsion by disks is at {loose.disks_with_fluid_Hz[0]:.1f}, "
    assert told in modes_text(loose)
    assert told in str(modes_page(loose, "today").sections[0])
    assert joined.disks_with_fluid_Hz == ()
    assert "fluid" not in modes_text(joined)


@pytest.mark.slow
def test_a_heavy_flywheel_bends_the_free_shaft() -> None:
    """With its mass it lowers bending modes, without it none; the further out, the more."""
    table = {"inertia_kg_m2": 0.05}
    speeds = {"speeds_rpm": (700.0, 2800.0)}
    light, heavy, far = (
        [m.frequency_Hz for m in found(mikron(flywheel={**table, **more}), "free", **speeds).modes]
        for more in ({}, {"mass_kg": 8.0}, {"mass_kg": 8.0, "overhang_mm": 60.0})
    )
    assert heavy[0] < light[0]
    assert far[0] < heavy[0]


@pytest.mark.slow
def test_from_the_other_end() -> None:
    """A pulley at the free end is a flywheel of the crank that is turned around, whirl and all."""
    disk = {"inertia_kg_m2": 0.08, "mass_kg": 9.0, "overhang_mm": 30.0}
    one, other = (
        found(mikron(**{name: disk}), speeds_rpm=(700.0, 2800.0)) for name in ("pulley", "flywheel")
    )
    for first, second in zip(one.modes, other.modes, strict=True):
        assert first.frequencies_Hz == pytest.approx(second.frequencies_Hz, rel=1e-6)
        assert first.whirl == pytest.approx(second.whirl, abs=1e-4)
        assert first.kind == second.kind


def test_a_disk_beyond_the_bearing_whirls() -> None:
    """Alike in every direction it circles; forward is faster than backward as bearings have it."""
    scene = mikron(flywheel={"inertia_kg_m2": 0.6, "mass_kg": 25.0, "overhang_mm": 80.0})
    modes = found(scene, speeds_rpm=np.linspace(300.0, 6000.0, 20).tolist())
    turn = modes.speeds_rpm[-1] / 60
    bending = [mode for mode in modes.modes if mode.kind.startswith("bending")][:2]
    seen = {round(mode.whirl[-1]): mode.frequencies_Hz[-1] + round(mode.whirl[-1]) * turn for mode in bending}
    assert set(seen) == {1, -1}
    rest = np.mean([mode.frequency_Hz for mode in bending])
    assert seen[-1] < 0.95 * rest < 1.05 * rest < seen[1]


def test_springs_lie_between_free_and_rigid(bare: ShaftModes) -> None:
    data = mikron().model_dump(mode="json", exclude_none=True)
    first = []
    for spring in (1e6, 1e9):
        data["supports"]["bearing_spring_N_per_mm"] = spring
        modes = found(scene_from_dict(data), "spring", speeds_rpm=(700.0, 2800.0)).modes
        first.append([mode.frequency_Hz for mode in modes])
    assert first[1] == pytest.approx([mode.frequency_Hz for mode in bare.modes], rel=2e-3)
    assert all(soft <= stiff for soft, stiff in zip(first[0], first[1], strict=True))


@pytest.mark.slow
def test_bending_in_the_plane_goes_with_motion_along_the_axis() -> None:
    """Held along its axis at every main journal a shaft has none of the modes in its plane below 3.8 kHz.

    With a flywheel of 20 kg the first of them is so much slower that order 6 meets it at 2,261 rpm; held
    along the axis it would be at 3,240, beyond the engine's 2,800 rpm.
    """
    bare = mikron()
    heavy = mikron(flywheel={"inertia_kg_m2": 0.2, "mass_kg": 20.0})
    throw = reduced_throw(
        throw_body(mesh_throw(bare, SIZE_MM), bare), bare, section_shapes(bare), STEPS, moving_kg(bare)
    )
    sections = range(len(bare.shaft_angles_deg) + 1)
    radial = [6 * section + motion for section in sections for motion in (UX, UY)]
    along = [6 * section + UZ for section in sections]

    def frequencies_Hz(scene: Scene, held: list[int]) -> list[float]:
        model = shaft_model([throw] * (len(sections) - 1), scene, "free", 0.0).held(held)
        modes = modes_at_rest(model.body)
        return [float(one) for one in modes.frequency_Hz[modes.rigid : modes.rigid + 10]]

    free, held = frequencies_Hz(bare, radial), frequencies_Hz(bare, radial + along)
    for shared in held[:4]:  # torsion and bending across the throws
        assert min(abs(one / shared - 1) for one in free) < 1e-3
    lost = [one for one in free if one < 3900.0 and min(abs(one / other - 1) for other in held) > 0.02]
    assert lost == pytest.approx([1150.4, 1368.9, 2746.4, 2767.8], rel=1e-3)
    first, stiff = frequencies_Hz(heavy, radial)[0], frequencies_Hz(heavy, radial + along)[1]
    assert (60 * first / 6, 60 * stiff / 6) == pytest.approx((2261.0, 3240.0), rel=1e-3)
