"""The shaft table of the scene: what is refused, and what is said where something is left out."""

from __future__ import annotations

import re

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.checks.engine import shaft_warnings, speed_range_rpm
from cranktopo.design.loading import designs_folder, parse_scene

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
RING = "ring_inertia_kg_m2 = 0.01, hub_inertia_kg_m2 = 0.002"

REFUSED = [
    ("flywheel = {}", r"shaft\.flywheel\.inertia_kg_m2 is missing"),
    ("flywheel = {inertia_kg_m2 = 0.0}", r"shaft\.flywheel\.inertia_kg_m2 = 0\.0: must be >= 1e-09 and <="),
    ("flywheel = {inertia_kg_mm2 = 3.0}", r"unknown key shaft\.flywheel\.inertia_kg_mm2.*'inertia_kg_m2'"),
    ("flywheel = {inertia_kg_m2 = 1.0, stiffness_Nm_per_rad = -2.0}", r"stiffness_Nm_per_rad = -2\.0: must"),
    ("coupling = {inertia_kg_m2 = 0.1}", r"shaft\.coupling\.stiffness_Nm_per_rad is missing"),
    ("throw_loss_factor = 3.0", r"shaft\.throw_loss_factor = 3\.0: must be >= 0 and <= 2"),
    ("cylinder_damping_Nms_per_rad = -1.0", r"cylinder_damping_Nms_per_rad = -1\.0: must be >= 0"),
    ("speed_min_rpm = 0.0", r"shaft\.speed_min_rpm = 0\.0: must be >= 1"),
    ("speed_min_rpm = 3000.0", r"shaft\.speed_min_rpm = 3000\.0: .*Give a value below 2800 rpm"),
    ("speed_max_rpm = 600.0", r"shaft\.speed_max_rpm = 600\.0: .*Give a value above 700 rpm"),
    (f"damper = {{kind = 'magnetic', {RING}}}", r"shaft\.damper\.kind = 'magnetic': must be 'rubber' or"),
    (f"damper = {{kind = 'rubber', {RING}}}", r"shaft\.damper\.stiffness_Nm_per_rad is missing for kind"),
    (f"damper = {{kind = 'viscous', {RING}}}", r"shaft\.damper\.damping_Nms_per_rad is missing for kind"),
    (
        f"damper = {{kind = 'viscous', damping_Nms_per_rad = 3.0, loss_factor = 0.1, {RING}}}",
        r"shaft\.damper\.loss_factor = 0\.1: belongs to no damper of kind = 'viscous'",
    ),
    (
        "driven = {inertia_kg_m2 = 1.0}\npropeller = {inertia_kg_m2 = 1.0}",
        r"shaft: driven and propeller are both given",
    ),
]


def with_shaft(table: str) -> str:
    return MIKRON.replace("[engine]\n", f"[shaft]\n{table}\n[engine]\n")


@pytest.mark.parametrize(("table", "message"), REFUSED)
def test_refused(table: str, message: str) -> None:
    with pytest.raises(CranktopoError) as error:
        parse_scene(with_shaft(table))
    assert re.search(message, str(error.value))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("propeller = {inertia_kg_m2 = 0.6}", ["shaft.flywheel is missing: the propeller alone"]),
        ("pulley = {inertia_kg_m2 = 0.01}", ["shaft.flywheel is missing: little or nothing holds"]),
        ("flywheel = {inertia_kg_m2 = 0.2}\nthrow_loss_factor = 0.0", ["shaft: no damping is given"]),
        (
            f"flywheel = {{inertia_kg_m2 = 0.2}}\nthrow_loss_factor = 0.0\n"
            f"damper = {{kind = 'viscous', damping_Nms_per_rad = 3.0, {RING}}}",
            [],
        ),
        ("flywheel = {inertia_kg_m2 = 0.2}\npropeller = {inertia_kg_m2 = 0.6}", []),
    ],
)
def test_warnings(table: str, said: list[str]) -> None:
    found = shaft_warnings(parse_scene(with_shaft(table)))
    assert [line[: len(start)] for line, start in zip(found, said, strict=True)] == said


def test_speeds_from_a_third_of_the_rated_to_the_highest() -> None:
    assert speed_range_rpm(parse_scene(with_shaft(""))) == (700.0, 2800.0)
    assert speed_range_rpm(parse_scene(with_shaft("speed_max_rpm = 2500.0"))) == (700.0, 2500.0)


def test_a_resonance_just_above_the_rated_speed_is_seen() -> None:
    """Of an engine without an overspeed 5 % above its speed count, as class rules ask."""
    own = "\n".join(line for line in with_shaft("").splitlines() if not line.startswith("overspeed_rpm"))
    assert speed_range_rpm(parse_scene(own)) == (700.0, 1.05 * 2100.0)
