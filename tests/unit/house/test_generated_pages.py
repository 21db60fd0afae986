"""The references that the pages get from the code: nothing of it is left out."""

from __future__ import annotations

import json
import re
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import click
import pytest

import cranktopo
from cranktopo import sweep
from cranktopo.app.main import COMMANDS, cli, main
from cranktopo.base.errors import ExitCode
from cranktopo.base.units import stem_and_unit
from cranktopo.design.reference import scene_reference
from tests import sweep_cases

DOCS = Path(__file__).resolve().parents[3] / "docs"


@pytest.fixture(scope="module")
def hooks() -> Any:
    pytest.importorskip("mkdocs", reason="the packages of the extra 'docs' are not installed")
    spec = spec_from_file_location("hooks", DOCS / "hooks.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.path.insert(0, str(DOCS))  # mkdocs does so too
    spec.loader.exec_module(module)
    sys.path.remove(str(DOCS))
    return module


def test_scene_page_has_every_key_in_its_table(hooks: Any) -> None:
    page = hooks.scene_tables()
    for table in scene_reference():
        for key in table.keys:
            rows = re.findall(rf"(?m)^\| `{key.name}` \| (.*)$", page)
            assert any(key.meaning.replace("|", "\\|") in row for row in rows), f"{table.path}.{key.name}"
        assert not table.path or f"`[[{table.path}]]`" in page or f"`[{table.path}]`" in page


def test_command_page_has_every_command_and_option(hooks: Any) -> None:
    page, context = hooks.command_pages(), click.Context(cli)
    for name in COMMANDS:
        command = cli.get_command(context, name)
        assert command is not None
        part = re.split(r"(?m)^## ", page.partition(f"## cranktopo {name}\n")[2])[0]
        children = command.commands.values() if isinstance(command, click.Group) else [command]
        options = [
            p for child in children for p in child.params if isinstance(p, click.Option) and not p.hidden
        ]
        assert part, name
        assert all(max(option.opts, key=len) in part for option in options), name


def test_exit_codes_are_all_explained(hooks: Any) -> None:
    rows = re.findall(r"(?m)^\| (\d+) \| (.+) \|$", hooks.exit_codes())
    assert [int(code) for code, _ in rows] == sorted(ExitCode)


def test_python_page_has_every_public_name(hooks: Any) -> None:
    assert sorted(re.findall(r"::: cranktopo\.(\w+)", hooks.public_names())) == sorted(cranktopo.__all__)


def test_examples_page_has_the_code_and_the_picture_of_every_script(hooks: Any) -> None:
    page = hooks.examples()
    for script in (DOCS.parent / "examples").glob("*.py"):
        code = script.read_text(encoding="utf-8").split('"""\n', 1)[1].strip()
        assert f'title="examples/{script.name}"\n{code}\n```' in page
        assert f"(images/examples/{script.stem}." in page


def test_equations_become_mathml_and_code_stays(hooks: Any) -> None:
    class Page:
        meta: dict[str, Any] = {}  # noqa: RUF012

    text = hooks.on_page_markdown(
        "$a$ and `$HOME` and\n\n$$b$$\n\n```sh\necho $a $b\n```\n", Page(), None, None
    )
    assert "`$HOME`" in text
    assert "echo $a $b" in text
    html = hooks.on_page_content(text, Page(), None, None)
    assert html.count("<math") == 2
    assert "@@" not in html


def test_results_page_has_every_key_of_every_result(hooks: Any) -> None:
    page, roots = hooks.result_tables(), sys.modules["results"].ROOTS
    assert re.findall(r"(?m)^## .*? \{#(\w+)\}$", page) == list(roots)
    for name in roots:
        schema = sys.modules["results"].result_schema(name)
        for anchor, table in {name: schema, **schema["$defs"]}.items():
            part = re.split(r"(?m)^##", page.partition(f"{{#{anchor.lower()}}}\n")[2])[0]
            keys = table.get("properties", {})
            assert re.findall(r"(?m)^\| `(\w+)` \|", part) == list(keys), anchor
            assert all(f"| {stem_and_unit(key)[1]} |" in part for key in keys)
    assert set(re.findall(r"\]\(#(\w+)\)", page)) <= set(re.findall(r"\{#(\w+)\}", page))


KINDS = {"string": str, "number": (int, float), "integer": int, "boolean": bool, "null": type(None)}


def broken(value: Any, schema: dict[str, Any], defs: dict[str, Any], where: str = "") -> list[str]:
    """Return where a value differs from its schema, for the words that schemas of results use."""
    if "$ref" in schema:
        return broken(value, defs[schema["$ref"].rpartition("/")[2]], defs, where)
    if "anyOf" in schema:
        return [] if any(not broken(value, part, defs) for part in schema["anyOf"]) else [where]
    kind: Any = {**KINDS, "object": dict, "array": list}.get(schema.get("type", ""), object)
    if not isinstance(value, kind) or value not in schema.get("enum", [value]):
        return [where]
    parts: list[tuple[str, Any, Any]] = []
    if isinstance(value, list):
        parts = [(f"{where}[{n}]", item, schema["items"]) for n, item in enumerate(value)]
    if isinstance(value, dict):
        keys, more = (
            schema.get("properties", {}),
            schema.get("additionalProperties", "properties" not in schema),
        )
        if missing := [f"{where}.{key}" for key in schema.get("required", ()) if key not in value]:
            return missing
        if unknown := [f"{where}.{key}" for key in value if key not in keys and more is False]:
            return unknown
        parts = [
            (f"{where}.{k}", v, keys.get(k, more if isinstance(more, dict) else {})) for k, v in value.items()
        ]
    return [found for place, item, part in parts for found in broken(item, part, defs, place)]


def check_schema(hooks: Any, name: str, text: str) -> None:
    schema = json.loads(dict(hooks.schema_files())[f"schema/{name}.json"])
    data = json.loads(text)
    assert broken(data, schema, schema["$defs"]) == []
    assert broken({**data, "schema_version": "1"}, schema, schema["$defs"]) == [".schema_version"]
    del data["design"]
    assert broken(data, schema, schema["$defs"]) == [".design"]


@pytest.mark.parametrize(
    ("name", "command"),
    [("designs", ["designs", "list"]), ("runs", ["runs", "list", "--root", "empty"]), ("doctor", ["doctor"])],
)
def test_a_list_keeps_its_schema(hooks: Any, capsys: Any, name: str, command: list[str]) -> None:
    main([*command, "--json"])
    data, schema = json.loads(capsys.readouterr().out), sys.modules["results"].result_schema(name)
    assert broken(data, schema, schema["$defs"]) == []
    assert list(data) == list(schema["properties"])


@pytest.mark.slow
def test_a_sweep_keeps_its_schema(hooks: Any, tmp_path: Path) -> None:
    sweep(vary={"web.width_mm": [50, 3]}, out=tmp_path / "out", function=sweep_cases.empty, workers=1)
    check_schema(hooks, "sweep", (tmp_path / "out" / "sweep.json").read_text())


@pytest.mark.slow
def test_a_bound_keeps_its_schema(hooks: Any, capsys: Any) -> None:
    goal = ["--maximise", "torsion", "--limit", "bending none", "--resolution-mm", "4.5", "--quiet"]
    assert main(["bound", *goal, "--json"]) == ExitCode.DONE
    check_schema(hooks, "bound", capsys.readouterr().out)
