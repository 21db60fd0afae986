"""The README: its contents list and its links lead somewhere, every command in it exists."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cranktopo.cli.main import COMMANDS

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
PROSE = re.sub(r"(?ms)^```.*?^```", "", TEXT)
TITLES = re.findall(r"(?m)^## (.*)$", PROSE)


def anchor(title: str) -> str:
    return re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")


def test_contents_name_every_section_in_order() -> None:
    listed = re.findall(r"(?m)^- \[(.*)\]\(#(.*)\)", PROSE)
    assert listed == [(title, anchor(title)) for title in TITLES if title != "Contents"]


def test_links_lead_somewhere() -> None:
    for target in re.findall(r"\]\(([^)]*)\)", PROSE):
        if target.startswith("#"):
            assert target[1:] in map(anchor, TITLES), target
        elif "://" not in target:
            assert (ROOT / target).is_file(), target


@pytest.mark.parametrize("module", sorted(set(re.findall(r"python -m (tests\.benchmarks\.\w+)", TEXT))))
def test_benchmarks_exist(module: str) -> None:
    path = ROOT / module.replace(".", "/")
    assert path.with_suffix(".py").is_file() or (path / "__main__.py").is_file()


def test_commands_exist() -> None:
    used = set(re.findall(r"(?:^\$ |`|/bin/)cranktopo ([a-z]+)", TEXT, re.M))
    misspelt_on_purpose = {"optimize"}
    assert used - misspelt_on_purpose <= set(COMMANDS)
    assert len(used) > 12


@pytest.mark.parametrize("path", sorted(set(re.findall(r"`((?:cranktopo|tests)/[\w/.]+)`", TEXT))))
def test_named_files_exist(path: str) -> None:
    assert (ROOT / path).exists()
