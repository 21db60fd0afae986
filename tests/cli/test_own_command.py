"""A command of one's own: a folder with two files, and the command line and its help have it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from cranktopo.design.loading import load_scene

FILE = '''"""`cranktopo pitch`

Length of a throw along the crank.
"""

import click

from cranktopo.cli.options import designs


@click.command(name="pitch")
@click.argument("design", shell_complete=designs)
def command(design):
    """Print the length of a throw of DESIGN, mm.

    Example: cranktopo pitch mikron-iiic
    """
    from cranktopo.design.loading import load_scene

    click.echo(load_scene(design).pitch_mm)
'''
ROOT = Path(__file__).parents[2]


def linked(folder: Path, place: Path) -> Path:
    """Return a folder at a place that has all entries of another one, none of them changed."""
    place.mkdir()
    for entry in folder.iterdir():
        if entry.name != "__pycache__":
            (place / entry.name).symlink_to(entry)
    return place


def told(root: Path, *arguments: str) -> str:
    program = [sys.executable, "-m", "cranktopo", *arguments]
    env = os.environ | {"PYTHONPATH": str(root), "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run(program, cwd=root, capture_output=True, text=True, check=True, env=env).stdout


def test_two_new_files_add_a_command(tmp_path: Path) -> None:
    package = linked(ROOT / "cranktopo", tmp_path / "cranktopo")
    (tmp_path / "designs").symlink_to(ROOT / "designs")
    (package / "tasks").unlink()
    own = linked(ROOT / "cranktopo" / "tasks", package / "tasks") / "pitch"
    own.mkdir()
    (own / "__init__.py").write_text('"""Length of a throw."""\n', encoding="utf-8")
    (own / "command.py").write_text(FILE, encoding="utf-8")
    assert "Length of a throw along the crank." in told(tmp_path, "--help")
    assert "Example: cranktopo pitch mikron-iiic" in told(tmp_path, "pitch", "--help")
    expected = load_scene("mikron-iiic-plain").pitch_mm
    assert float(told(tmp_path, "pitch", "mikron-iiic-plain")) == expected
