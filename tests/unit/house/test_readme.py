"""The README is short, its links lead somewhere, its commands exist and are those that CI runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cranktopo.app.main import COMMANDS

ROOT = Path(__file__).resolve().parents[3]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
DOCUMENTS = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"]


def without_code(text: str) -> str:
    return re.sub(r"(?ms)^```.*?^```", "", text)


def anchors(page: Path) -> set[str]:
    titles = re.findall(r"(?m)^#+ (.*)$", without_code(page.read_text(encoding="utf-8")))
    return {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles}


def test_readme_is_at_most_200_lines() -> None:
    assert len(TEXT.splitlines()) <= 200


@pytest.mark.parametrize("name", DOCUMENTS)
def test_links_lead_somewhere(name: str) -> None:
    found = re.findall(r"\]\(([^)]*)\)", without_code((ROOT / name).read_text(encoding="utf-8")))
    assert found
    for target in found:
        if "://" in target:
            continue
        path, _, anchor = target.partition("#")
        page = ROOT / (path or name)
        assert page.is_file(), target
        assert not anchor or anchor in anchors(page), target


def test_readme_has_a_picture_and_leads_to_every_page_without_generated_parts() -> None:
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", TEXT)
    assert pictures
    assert all((ROOT / picture).stat().st_size > 10_000 for picture in pictures)
    pages = (ROOT / "docs" / "pages").glob("*.md")
    written = {page.name for page in pages if "<!-- generated:" not in page.read_text(encoding="utf-8")}
    linked = set(re.findall(r"docs/pages/([\w-]+\.md)", TEXT))
    assert written - linked == {"index.md"}


def test_commands_exist() -> None:
    used = set(re.findall(r"(?:^\$ |`|/bin/)cranktopo ([a-z]+)", TEXT, re.M))
    assert used <= set(COMMANDS)
    assert {"optimise", "loads", "plan", "shape", "compare", "export"} <= used


def test_ci_runs_the_commands_of_readme_and_contributing() -> None:
    lines = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    (tests,) = re.findall(r"(?m)^.*pytest -n 2.*$", TEXT)
    assert tests in lines
    contributing = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    steps = re.findall(r"(?m)^\.venv/bin/(?!python)\S.*$", contributing)
    assert len(steps) == 4
    assert [step for step in steps if not any(line.startswith(step) for line in lines)] == []
