"""Mistakes in a scene: every one of a file, with key path, value, range and next step."""

from __future__ import annotations

import gc
import math
import time
import tomllib
import weakref

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import designs_folder, load_scene, parse_scene
from cranktopo.engine.analysis import analyse
from cranktopo.tasks.loads.result import curve_columns

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")


def error_of(*changes: tuple[str, str]) -> str:
    text = MIKRON
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    with pytest.raises(CranktopoError) as caught:
        parse_scene(text, "my.toml")
    return str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("width_mm = 50.0", "width_mm = true", "web.width_mm = true: must be a finite number >= 0.05"),
        ("width_mm = 50.0", 'width_mm = "12"', "web.width_mm = '12': must be a finite number"),
        ("width_mm = 50.0", "width_mm = [50]", "web.width_mm = (50,): must be a finite number"),
        ("width_mm = 50.0", "width_mm = 1979-05-27", "must be a finite number"),
        ("width_mm = 50.0", f"width_mm = 1{'0' * 400}", "must be a finite number"),
        ("width_mm = 50.0", f"width_mm = 0x{'f' * 5000}", "a number of about 6021 digits: must be"),
        ("width_mm = 50.0", f"width_mm = {'9' * 5000}", "not valid TOML: a number has too many digits"),
        ("width_mm = 50.0", f"width_mm = {'[' * 5000}{']' * 5000}", "its arrays are too deep"),
        (
            "thickness_mm = 19.0",
            "thickness_mm = 1e-6",
            "thickness_mm = 1e-06: must be >= 0.05 and",
        ),
        (
            "radius_mm = 48.0",
            "radius_mm = 1e9",
            "throw.radius_mm = 1000000000.0: must be >= 0.05",
        ),
        ("radius_mm = 48.0", "radius_mm = inf", "throw.radius_mm = inf: must be a finite number >= 0.05"),
        ("volume_fraction = 0.3", "volume_fraction = 1e-12", "must be >= 0.01 and <= 0.99"),
        ("schema_version = 1", "schema_version = true", "schema_version = true: must be an integer"),
        ("cylinders = 4", "cylinders = 4.0", "engine.cylinders = 4.0: must be an integer >= 1 and <= 48"),
        ("[1, 3, 4, 2]", "[1, 3, 4.5, 2]", "engine.firing_order[2] = 4.5: must be an integer"),
        ("speed_rpm = 2100.0", "speed_rpm = 1e300", "engine.speed_rpm = 1e+300: must be >= 0 and <= 200000"),
        ('name = "31CrMoV9"', "name = [1]", "material.name = (1,): must be a valid string"),
        ('name = "31CrMoV9"', 'name = "31CrMoV8"', "Did you mean '31CrMoV9'?"),
        ('outline = "obround"', "outline = [1]", "web.outline = [1]: unknown choice. Valid: ellipse,"),
        ('outline = "obround"', "", "web.outline is missing. Valid: ellipse, obround"),
    ],
)
def test_values(old: str, new: str, message: str) -> None:
    """And no error keeps its callers' variables for ever, as a ValueError of a validator would."""

    class Variable: ...

    def caller() -> weakref.ref[Variable]:
        variable = Variable()
        assert message in error_of((old, new))
        return weakref.ref(variable)

    gc.disable()  # so that the youngest objects are all that there is to look at: thousands, not millions
    try:
        left = caller()
        gc.collect(0)
    finally:
        gc.enable()
    assert left() is None


@pytest.mark.parametrize(
    ("old", "new", "hint"),
    [
        ("outer_diameter_mm = 42.0", "diameter_mm = 42.0", "Did you mean 'outer_diameter_mm'?"),
        ("piston_group_kg", "rod_mass_kg", "Did you mean 'rod_kg'?"),
        ("piston_group_kg", "speed_rpm", "It belongs to [engine]."),
        ("piston_group_kg", "camshaft", "Valid: piston_group_kg, "),
        ("bore_mm", "bore_diameter_mm", "It belongs to [throw.crankpin] or [throw.main_journal]."),
        ("width_mm", "Width_mm", "Did you mean 'width_mm'?"),
    ],
)
def test_an_unknown_key_is_answered_by_what_is_meant(old: str, new: str, hint: str) -> None:
    assert hint in error_of((old, new))


def test_all_errors_of_a_file_are_listed() -> None:
    message = error_of(
        ("width_mm = 50.0", "witdh_mm = 50.0"),
        ("length_mm = 40.0", ""),
        ("speed_rpm = 2100.0", "speed_rpm = -1.0"),
        ("[supports]", "[suports]"),
    )
    assert message.splitlines() == [
        "my.toml: 4 errors.",
        "  unknown key web.witdh_mm. Did you mean 'width_mm'?",
        "  unknown key suports. Did you mean 'supports'?",
        "  throw.main_journal.length_mm is missing. Add length_mm to [throw.main_journal].",
        "  engine.speed_rpm = -1.0: must be >= 0 and <= 200000. Correct that value, or its unit.",
    ]


def test_a_file_of_another_kind_ends_the_list() -> None:
    with pytest.raises(CranktopoError) as caught:
        parse_scene("".join(f"key_{n} = {n}\n" for n in range(100)))
    lines = str(caught.value).splitlines()
    assert lines[0] == "scene: 104 errors."
    assert len(lines) == 22
    assert lines[-1] == "  and 84 more."


@pytest.mark.parametrize(
    ("name", "content", "kind"),
    [
        ("body.step", "x", "a STEP file"),
        ("body.STL", "x", "an STL file"),
        ("body", "ISO-10303-21;\nHEADER;", "a STEP file"),
        ("body", "solid x\n", "an STL file"),
    ],
)
def test_a_body_where_a_design_belongs(tmp_path, name: str, content: str, kind: str) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(CranktopoError, match=rf"is {kind}; a design is a TOML file.*--design DESIGN"):
        load_scene(str(tmp_path / name))


def test_an_iges_file_is_no_target_either(tmp_path) -> None:
    (tmp_path / "body.iges").touch()
    with pytest.raises(CranktopoError, match=r"is an IGES file; .* Export the body as STEP\."):
        load_scene(str(tmp_path / "body.iges"))


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("body.brep", r"is a BREP file; .* cranktopo import"),
        ("body.FCStd", r"is a FreeCAD file; .* Export the body as STEP\."),
    ],
)
def test_other_bodies_from_cad_are_named(tmp_path, name: str, words: str) -> None:
    (tmp_path / name).touch()
    with pytest.raises(CranktopoError, match=words):
        load_scene(str(tmp_path / name))


def test_the_line_that_is_no_toml_is_shown() -> None:
    message = error_of(("radius_mm = 48.0", "radius_mm = 48,0"))
    assert "not valid TOML" in message
    assert ": 'radius_mm = 48,0'" in message


def test_a_run_where_a_design_belongs(tmp_path) -> None:
    (tmp_path / "manifest.json").write_text("{}")
    with pytest.raises(CranktopoError, match=r"is a run, not a design.*cranktopo remodel.*cranktopo extract"):
        load_scene(str(tmp_path))


@pytest.mark.parametrize("scale", [1 / 40, 1.0, 2000 / 48], ids=["model engine", "aircraft", "ship"])
def test_engines_of_all_sizes_pass(scale: float) -> None:
    """Throws of 1.2, 48 and 2000 mm, everything in proportion, pistons of one speed."""

    def scaled(line: str) -> str:
        key, _, value = line.partition(" = ")
        number = value.split("#")[0].strip()
        powers = {"_mm": 1, "_kg": 3, "_rpm": -1}
        power = next((powers[unit] for unit in powers if key.endswith(unit)), None)
        return line if power is None else f"{key} = {float(number) * scale**power!r}"

    lines = [line for line in MIKRON.splitlines() if not line.startswith("fillet_mm")]
    scene = parse_scene("\n".join(scaled(line) for line in lines))
    assert math.isclose(scene.throw.radius_mm, 48 * scale)


ROD = "rod_reciprocating_kg = 0.1436\nrod_rotating_kg = 0.3254"


def test_a_whole_rod_is_split_by_its_centre_of_mass() -> None:
    """The two masses have the rod's mass and, about the big end, its first moment."""
    assert ROD in MIKRON
    whole = "rod_kg = 0.469\nrod_centre_from_big_end_mm = 50.0"
    engine = parse_scene(MIKRON.replace(ROD, whole)).engine
    assert engine is not None
    small, big = engine.rod_parts_kg
    assert math.isclose(small + big, 0.469)
    assert math.isclose(small * engine.rod_length_mm, 0.469 * 50.0)
    assert math.isclose(engine.reciprocating_kg, small + engine.masses.piston_group_kg)
    split = parse_scene(MIKRON.replace(ROD, f"rod_reciprocating_kg = {small!r}\nrod_rotating_kg = {big!r}"))
    whole_scene = parse_scene(MIKRON.replace(ROD, whole))
    curves = curve_columns(analyse(split))
    assert "radial_force_N" in curves
    for name, curve in curve_columns(analyse(whole_scene)).items():
        assert abs(curve - curves[name]).max() <= 1e-9 * abs(curve).max(), name


@pytest.mark.parametrize(
    ("masses", "message"),
    [
        ("rod_kg = 0.4", "rod_centre_from_big_end_mm is missing beside rod_kg"),
        ("rod_centre_from_big_end_mm = 50.0", "rod_kg is missing beside rod_centre_from_big_end_mm"),
        (
            f"{ROD}\nrod_kg = 0.4\nrod_centre_from_big_end_mm = 50.0",
            "its parts are both given",
        ),
        (
            "rod_kg = 0.4\nrod_centre_from_big_end_mm = 170.0",
            "must be smaller than engine.rod_length_mm",
        ),
    ],
)
def test_half_a_rod(masses: str, message: str) -> None:
    assert message in error_of((ROD, masses))


@pytest.mark.parametrize("key", ["a", '"b c"', "'d'", "e "], ids=str)
@pytest.mark.parametrize("form", ["{} = 1", "[{}]", "x = {{ {} = 1 }}", "x = 1\n[[{}]]"])
def test_a_key_of_many_parts_is_not_parsed(key: str, form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """One of 40 kB took 1.6 GB, growing with its square."""
    monkeypatch.setattr(tomllib, "loads", lambda text: pytest.fail("parsed"))
    line = 2 if "\n" in form else 1
    with pytest.raises(CranktopoError, match=f"not valid TOML: line {line} has a key of more than 30 parts"):
        parse_scene(form.format(".".join([key] * 20_000)))


def test_long_values_are_no_keys() -> None:
    began = time.process_time()
    for text in ("a" * 5_000_000, "1." * 20 + "0, " * 900_000, '"' * 1_000_000, "'\n" * 900_000, "a. " * 20):
        with pytest.raises(CranktopoError) as raised:
            parse_scene(f"name = {text}")
        assert "parts" not in raised.value.message
    assert time.process_time() - began < 20
