"""The references that the pages get from the code: nothing of it is left out."""

from __future__ import annotations

import re
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import click
import pytest

import cranktopo
from cranktopo.app.main import COMMANDS, cli
from cranktopo.base.errors import ExitCode
from cranktopo.design.reference import scene_reference

DOCS = Path(__file__).resolve().parents[2] / "docs"


@pytest.fixture(scope="module")
def hooks() -> Any:
    pytest.importorskip("mkdocs", reason="the packages of the extra 'docs' are not installed")
    spec = spec_from_file_location("hooks", DOCS / "hooks.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
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
