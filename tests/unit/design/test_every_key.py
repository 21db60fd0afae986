"""Every key of every table does something: what is told changes, or the key is refused or told as idle.

Tables and keys are those of the schema: a new one fails until tests/keys/cases.py has a scene with it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.idle_keys import idle_keys
from cranktopo.design.loading import scene_from_dict, value_at
from cranktopo.design.reference import KeyReference, TableReference, scene_reference
from cranktopo.design.schema import Scene
from tests.keys.cases import TABLES
from tests.keys.kinds import Other, Refused, Shown, Table, Told
from tests.keys.packed import packed, reference_tables, tables_of
from tests.keys.readings import of_scene
from tests.keys.scenes import Data, changed, files, resolved

ROOT = Path(__file__).parents[3]
Read = Callable[[Data], dict[str, tuple[str, ...]]]


def variant_of(table: TableReference) -> tuple[str, str]:
    """The path of a table, and which of its choices it is."""
    chosen = (str(key.example) for key in table.keys if key.name == table.choice)
    return table.path, next(chosen, "") if table.choice else ""


@cache
def tables_of_schema() -> dict[tuple[str, str], TableReference]:
    """The tables of the schema that have keys; of the processes that collect tests one alone runs these."""
    return {variant_of(table): table for table in scene_reference() if table.keys}


PARAMETERS = [
    pytest.param(at, id=" ".join(filter(None, at)) or "top", marks=[pytest.mark.slow] * table.dear)
    for at, table in TABLES.items()
]


def test_every_table_has_a_scene() -> None:
    assert set(TABLES) == set(tables_of_schema())


def test_every_case_is_of_a_key() -> None:
    for at, table in TABLES.items():
        alike = [other.keys for place, other in tables_of_schema().items() if place[0] == at[0]]
        named = {key.name for keys in alike for key in keys}
        assert set(table.keys) <= named, at


def test_tests_that_show_a_key_exist() -> None:
    shown = {
        case.test for table in TABLES.values() for case in table.keys.values() if isinstance(case, Shown)
    }
    for place in shown:
        file, name = place.split("::")
        assert f"def {name}(" in (ROOT / "tests" / file).read_text(encoding="utf-8"), place


def test_packed_scenes_are_valid_and_have_the_tables() -> None:
    """All but what names a file, and a driven machine, which excludes a propeller."""
    found: set[str] = set()
    for data in packed():
        scene_from_dict(data, whole=True)
        found |= {path.replace("second_web.", "web.") for path in tables_of(data)}
    assert reference_tables() - found == {"original", "shaft.driven"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the files that scenes name."""
    path = tmp_path_factory.mktemp("named")
    files(path)
    return path


@pytest.mark.parametrize("at", PARAMETERS)
def test_every_key_of_a_table_acts(at: tuple[str, str], folder: Path) -> None:
    table, reference = TABLES[at], tables_of_schema()[at]
    base = table.scene()
    known: dict[str, tuple[str, ...]] = {}
    problems = [
        f"{key.name}: {problem}"
        for key in reference.keys
        if key.name != reference.choice and (problem := problem_of(key, table, base, folder, known))
    ]
    assert not problems, "\n".join(problems)


def problem_of(
    key: KeyReference, table: Table, base: Data, folder: Path, known: dict[str, tuple[str, ...]]
) -> str:
    """What is wrong with a key: empty where it acts, is refused or told as it should."""
    place = f"{table.place}.{key.name}".lstrip(".")
    case = table.keys.get(key.name) or Other(another(key, value_at(plain(loaded(base, folder)), place)))
    if isinstance(case, Shown):
        return ""
    if not isinstance(case, Other | Refused | Told):
        case = Other(case)
    before = changed(base, case.beside)
    after = changed(before, {place: case.value, **(case.also if isinstance(case, Other) else {})})
    try:
        scene = loaded(after, folder)
    except CranktopoError as error:
        as_said = isinstance(case, Refused) and case.words in str(error)
        return "" if as_said else f"{case.value!r} is refused: {error}"
    if isinstance(case, Refused):
        return f"{case.value!r} is not refused"
    told = any(line.startswith(f"{place}: ") for line in idle_keys(scene, after))
    if isinstance(case, Told):
        return "" if told else f"{case.value!r} is not told to change nothing"
    if told:
        return f"{case.value!r} is told to change nothing"
    for name in table.reads.split():
        read = of_scene(scene, name)
        if case.beside or name not in known:
            known_here = of_scene(loaded(before, folder), name)
            if not case.beside:
                known[name] = known_here
        else:
            known_here = known[name]
        if read[0].startswith("refused") or known_here[0].startswith("refused"):
            return f"{name}: {read[0]}; before: {known_here[0][:200]}"
        if read != known_here:
            return ""
    return f"{case.value!r} changes nothing that {table.reads} tell"


def loaded(data: Data, folder: Path) -> Scene:
    return scene_from_dict(resolved(data, folder), "case", whole=True)


def plain(scene: Scene) -> Data:
    found: Data = scene.model_dump(mode="json")
    return found


def another(key: KeyReference, now: Any) -> Any:
    """Another value of a key, by its kind, range and example."""
    if now in (None, [], ""):
        return key.example if key.example is not None else "some words"
    if key.kind.startswith("one of"):
        return next(one for one in json.loads(f"[{key.kind[7:]}]") if one != now)
    if key.kind == "number":
        most = re.fullmatch(r"\S+ to (\S+)", key.allowed)
        more = 1.1 * now or key.example or 1.0
        return more if most is None or more <= float(most[1]) else 0.9 * now
    by_kind: dict[str, Callable[[], Any]] = {
        "whole number": lambda: now + 1,
        "text": lambda: f"{now}x",
        "true or false": lambda: not now,
    }
    return by_kind.get(key.kind, lambda: key.example)()
