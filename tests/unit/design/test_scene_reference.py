"""The reference of all keys and the template made of it."""

from __future__ import annotations

import re
import tomllib
from typing import Any

import pytest

from cranktopo.base.units import stem_and_unit
from cranktopo.design.loading import builtin_designs, designs_folder, parse_scene
from cranktopo.design.reference import scene_reference, template
from cranktopo.tasks.designs.beginning import begun

TEMPLATE = template("mine")
BLOCKS = TEMPLATE.split("\n\n")
OFF = [block for block in BLOCKS if re.search(r"(?m)^#\[", block)]


def switched_on(block: str) -> str:
    """The block with one `#` taken off each line that is no explanation."""
    return re.sub(r"(?m)^#(?! )", "", block)


def table_of(block: str) -> str:
    found = re.search(r"(?m)^#*\[+([\w.]+)\]", block)
    return found[1] if found else ""


def keys_in(data: dict[str, Any], path: str = "") -> set[str]:
    """Dotted paths of every value of a TOML document."""
    found: set[str] = set()
    for name, value in data.items():
        below = f"{path}.{name}" if path else name
        inner = value if isinstance(value, list) else [value]
        tables = [item for item in inner if isinstance(item, dict)]
        found |= set().union(*(keys_in(table, below) for table in tables)) if tables else {below}
    return found


def test_every_key_and_table_has_a_meaning() -> None:
    for table in scene_reference():
        assert table.meaning, table.path
        for key in table.keys:
            assert len(key.meaning) > 5, f"{table.path}.{key.name}"
            assert key.meaning.endswith("."), f"{table.path}.{key.name}"


def test_every_required_key_has_an_example() -> None:
    missing = [k.name for table in scene_reference() for k in table.keys if k.required and k.example is None]
    assert not missing


def test_a_key_that_ends_in_a_unit_has_it() -> None:
    assert stem_and_unit("bearing_spring_N_per_mm")[1] == "N/mm"
    assert stem_and_unit("max_torque_Nm")[1] == "N m"
    known = {key.name: key.unit for table in scene_reference() for key in table.keys}
    assert known["density_kg_m3"] == "kg/m³"
    assert not known["volume_fraction"]
    assert {
        name for name, unit in known.items() if not unit and re.search(r"_[A-Z]|_(mm|kg|deg)", name)
    } == set()


def test_every_key_of_the_built_in_designs_is_in_the_reference() -> None:
    known = {f"{t.path}.{k.name}".lstrip(".") for t in scene_reference() for k in t.keys}
    for name in builtin_designs():
        text = (designs_folder() / f"{name}.toml").read_text(encoding="utf-8")
        assert keys_in(tomllib.loads(text)) <= known, name


def test_template_is_a_valid_design_of_that_name() -> None:
    scene = parse_scene(TEMPLATE)
    assert scene.name == "mine"
    assert scene.engine is None


@pytest.mark.parametrize("layout", [None, "in-line"])
def test_every_line_that_is_off_is_toml_when_it_is_switched_on(layout: Any) -> None:
    """A key with neither default nor example stood there as null, which no TOML has."""
    text = begun("mine", layout, 6, 320.0, 480.0).text if layout else TEMPLATE
    off = re.findall(r"(?m)^#+(\w+ = .*)$", text)
    assert len(off) > 100
    for line in off:
        assert tomllib.loads(line), line


def test_template_has_every_key() -> None:
    lines = set(re.findall(r"(?m)^#*(\w+) = ", TEMPLATE))
    assert {key.name for table in scene_reference() for key in table.keys} == lines


@pytest.mark.parametrize("number", range(len(OFF)), ids=[table_of(block) for block in OFF])
def test_a_table_that_is_off_works_when_it_is_switched_on(number: int) -> None:
    """With the tables that it belongs to, gas and masses with the engine, and those that it must have."""
    above = [block for block in OFF if table_of(OFF[number]).startswith(table_of(block) + ".")]
    must_have = {"fatigue.spectrum": "fatigue.spectrum.step"}.get(table_of(OFF[number]))
    below = [block for block in OFF if table_of(block) == must_have]
    text = TEMPLATE
    for block in (*above, OFF[number], *below):
        text = text.replace(block, switched_on(block))
    if table_of(OFF[number]) == "engine.gas.map":  # in place of one peak for all speeds
        gas, found, more = text.partition("[[engine.gas.map]]")
        text = re.sub(r"(?m)^peak_(pressure_MPa|angle_deg) = .*\n", "", gas) + found + more
    scene = parse_scene(text)
    assert scene != parse_scene(TEMPLATE)


def test_defaults_that_are_switched_on_change_nothing() -> None:
    """Every optional key whose line shows its default, all at once, in the tables that are on."""
    without = {k.name for t in scene_reference() for k in t.keys if k.default is None}
    on = [block for block in BLOCKS[1:] if block not in OFF]
    text = "\n\n".join(
        re.sub(
            r"(?m)^#(\w+)(?= = )",
            lambda m: m[0] if m[1] in without else m[1],
            re.split(r"(?m)^# Instead", b)[0],
        )
        for b in on
    )
    assert text.count("\n#") < TEMPLATE.count("\n#")
    assert parse_scene(text) == parse_scene(TEMPLATE)


@pytest.mark.parametrize("outline", ["rectangle", "ellipse", "tapered", "profile"])
def test_another_outline_works_in_place_of_the_first(outline: str) -> None:
    (web,) = (block for block in BLOCKS if table_of(block) == "web")
    common, *choices = re.split(r"(?m)^# Instead of outline.*$", web)
    head = common[: common.index("# Slot-shaped")]
    (chosen,) = (choice for choice in choices if f'"{outline}"' in choice)
    scene = parse_scene(TEMPLATE.replace(web, head + switched_on(chosen).strip()))
    assert scene.web.outline == outline
