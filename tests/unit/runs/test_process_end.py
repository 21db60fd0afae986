"""Processes end without a word: a solid that something still holds is told as leaked, in a hundred lines."""

from __future__ import annotations

import subprocess
import sys

import pytest

REFUSED = """
from manifold3d import Manifold
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import designs_folder, parse_scene

def refused(solid):
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    try:
        parse_scene(text.replace("schema_version = 1", "schema_version = true"))
    except CranktopoError as error:
        kept = error  # as a test or a notebook does: the error and this frame hold each other
    return str(kept)

assert "must be an integer" in refused(Manifold.cube((1, 1, 1)))
"""
COMMAND = """
import sys, threading
from manifold3d import Manifold
from cranktopo.app.launch import main

def hold(ready):
    solid = Manifold.cube((1, 1, 1))
    ready.set()
    threading.Event().wait()

ready = threading.Event()
threading.Thread(target=hold, args=(ready,), daemon=True).start()
ready.wait()
sys.argv = ["cranktopo", "--version"]
main()
"""


@pytest.mark.parametrize("code", [REFUSED, COMMAND], ids=["after a refused scene", "command"])
def test_nothing_is_told_at_the_end(code: str) -> None:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr == ""
