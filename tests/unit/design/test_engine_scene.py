"""Engine and bearing tables of the scene: defaults, files, and clear refusals."""

import re
from pathlib import Path

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import designs_folder, load_scene, parse_scene

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text()
OPPOSED = (designs_folder() / "opposed-piston.toml").read_text()


def changed(old, new, text=MIKRON):
    assert old in text
    return text.replace(old, new)


REFUSED = [
    ("rod_length_mm = 166.0", "rod_length_mm = 40.0", r"engine\.rod_length_mm = 40\.0: must be longer"),
    (
        "firing_order = [1, 3, 4, 2]",
        "firing_order = [1, 3, 2]",
        r"engine\.firing_order = \[1, 3, 2\]: must name",
    ),
    ("firing_order = [1, 3, 4, 2]", "firing_order = [1, 3, 3, 2]", r"each of the 4 cylinders once"),
    ("firing_order = [1, 3, 4, 2]", "", r"engine\.firing_order = \[\]: must name each of the 4"),
    (
        "overspeed_rpm = 2800.0",
        "overspeed_rpm = 1800.0",
        r"engine\.overspeed_rpm = 1800\.0: must be at least",
    ),
    ("strokes = 4", "strokes = 3", r"engine\.strokes = 3"),
    ("peak_angle_deg = 11.0", "", r"neither an indicator diagram nor a peak"),
    ("peak_angle_deg = 11.0", "peak_angle_deg = -5.0", r"peak_angle_deg = -5\.0: must be > 0 and < 60"),
    ("compression_ratio = 8.0", "compression_ratio = 0.8", r"engine\.gas\.compression_ratio = 0\.8"),
    ("compression_ratio = 8.0", "compresion_ratio = 8.0", r"unknown key engine\.gas\.compresion_ratio"),
    (
        "compression_ratio = 8.0",
        "firing_deg = 360.0",
        r"engine\.gas\.firing_deg = 360\.0: is for a measured trace",
    ),
    ("compression_ratio = 8.0", "firing_deg = 721.0", r"engine\.gas\.firing_deg = 721\.0"),
    ("compression_ratio = 8.0", "indicator_csv = 'p.csv'", r"indicator_csv and a peak are both given"),
    ('bending = "pinned"', 'bending = "spring"', r"bearing_spring_N_per_mm = None: must be at least"),
    (
        'bending = "pinned"',
        'bending = "spring"\nbearing_spring_N_per_mm = 999.0',
        r"bearing_spring_N_per_mm = 999\.0: must be (>=|at least) 1000",
    ),
    (
        'bending = "pinned"',
        'bending = "spring"\nroller_bearing = {name = "AXW45"}',
        r"'AXW45': a thrust bearing has no radial",
    ),
    (
        'bending = "pinned"',
        'roller_bearing = {name = "HK4521"}',
        r"supports\.roller_bearing\.name = 'HK4521': not in the library.*HK4520",
    ),
    (
        'bending = "pinned"',
        "roller_bearing = {rollers = 9, displacement_mm = [1, 2, 3], reaction_N = [1, 3]}",
        r"reaction_N",
    ),
    (
        'bending = "pinned"',
        "roller_bearing = {rollers = 9, displacement_mm = [1, 3, 2], reaction_N = [1, 2, 3]}",
        r"displacement_mm = \[1\.0, 3\.0, 2\.0\]: must increase",
    ),
    (
        'bending = "pinned"',
        "bearing_clearance_mm = 0.05\nbearing_spring_N_per_mm = 1e6",
        r"bearing_spring_N_per_mm and bearing_clearance_mm each give",
    ),
]


@pytest.mark.parametrize(("old", "new", "message"), REFUSED)
def test_refused(old, new, message):
    with pytest.raises(CranktopoError) as error:
        parse_scene(changed(old, new))
    assert re.search(message, str(error.value))


def test_two_stroke_has_no_exhaust_pressure():
    text = changed("strokes = 4", "strokes = 2").replace(
        "compression_ratio = 8.0", "compression_ratio = 8.0\nexhaust_pressure_MPa = 0.1"
    )
    with pytest.raises(CranktopoError, match="a two-stroke engine has no exhaust stroke"):
        parse_scene(text)


def test_clearance_needs_an_engine():
    text = OPPOSED[: OPPOSED.index("[engine]")] + OPPOSED[OPPOSED.index("[envelope]") :]
    text = changed("bearing_spring_N_per_mm = 1.072e6", "bearing_clearance_mm = 0.05", text)
    with pytest.raises(CranktopoError, match=r"supports\.bearing_clearance_mm = 0\.05: needs an \[engine\]"):
        parse_scene(text)


def test_indicator_file_is_relative_to_the_design(tmp_path):
    text = changed("peak_pressure_MPa = 5.16\npeak_angle_deg = 11.0", 'indicator_csv = "data/p.csv"')
    design = tmp_path / "d.toml"
    design.write_text(text)
    assert Path(load_scene(str(design)).engine.gas.indicator_csv) == tmp_path.resolve() / "data" / "p.csv"


def test_defaults():
    engine = parse_scene(OPPOSED).engine
    assert (engine.strokes, engine.cycle_deg, engine.cylinders, engine.order) == (4, 720.0, 1, (1,))
    gas = parse_scene(MIKRON).engine.gas
    assert gas.exhaust_MPa == gas.ambient_pressure_MPa
    assert gas.intake_MPa == 0.08793


SIZES = [
    (
        "bore_mm = 95.0",
        "bore_mm = 9.5",
        r"engine\.bore_mm = 9\.5: must be >= 24 and <= 384 mm .*stroke of 96",
    ),
    ("bore_mm = 95.0", "bore_mm = 385.0", r"engine\.bore_mm = 385\.0: must be >= 24 and <= 384 mm"),
    (
        "speed_rpm = 2100.0",
        "speed_rpm = 16000.0\noverspeed_rpm = 16000.0",
        r"engine\.speed_rpm = 16000\.0: must be <= 15625 rpm .* 51\.2 m/s",
    ),
    (
        "speed_rpm = 2100.0",
        "speed_rpm = 2100.0\noverspeed_rpm = 16000.0",
        r"engine\.overspeed_rpm = 16000\.0: must be <= 15625 rpm",
    ),
    (
        "piston_group_kg = 0.491",
        "piston_group_kg = 491.0",
        r"engine\.masses\.piston_group_kg = 491\.0: must be 0, or >= 0\.00857 and <= 42\.9 kg for a bore of"
        r" 95 mm\. Is it in grams\? Write 0\.491 kg\.",
    ),
    ("rod_reciprocating_kg = 0.1436", "rod_reciprocating_kg = 143.6", r"in grams\? Write 0\.1436 kg"),
    ("rod_rotating_kg = 0.3254", "rod_rotating_kg = 325.4", r"rod_rotating_kg = 325\.4: must be 0, or"),
    ("rod_rotating_kg = 0.3254", "rod_rotating_kg = 3e-4", r"rod_rotating_kg = 0\.0003: .* Correct the mass"),
]


@pytest.mark.parametrize(("old", "new", "message"), SIZES)
def test_what_no_engine_of_such_a_stroke_has_is_refused(old, new, message):
    text = re.sub(r"(?m)^overspeed_rpm.*\n", "", MIKRON)
    with pytest.raises(CranktopoError) as error:
        parse_scene(changed(old, new, text))
    assert re.search(message, str(error.value))


def test_a_whole_rod_in_grams_is_refused():
    text = re.sub(r"(?m)^rod_(recip|rot).*\n", "", MIKRON)
    rod = "piston_group_kg = 0.491\nrod_centre_from_big_end_mm = 50.0\nrod_kg = "
    assert parse_scene(changed("piston_group_kg = 0.491", f"{rod}0.469", text))
    with pytest.raises(CranktopoError, match=r"rod_kg = 469\.0"):
        parse_scene(changed("piston_group_kg = 0.491", f"{rod}469.0", text))


def test_masses_may_be_none():
    text = re.sub(r"(?m)^(piston_group_kg|rod_r\w+_kg) = [\d.]+", r"\1 = 0", MIKRON)
    assert parse_scene(text).engine.reciprocating_kg == 0
