"""A process that meshes still ends as it was told to: gmsh resets handlers when it starts."""

from __future__ import annotations

import os
import signal
import threading
from pathlib import Path

import pytest

from cranktopo.numerics.gmsh_session import cad_session


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGPIPE, signal.SIGHUP])
@pytest.mark.parametrize("in_thread", [False, True])
def test_handlers_outlive_a_session(number: signal.Signals, in_thread: bool) -> None:
    heard: list[int] = []
    before = signal.signal(number, lambda got, frame: heard.append(got))

    def session() -> None:
        with cad_session("signals"):
            os.kill(os.getpid(), number)

    try:
        if in_thread:
            thread = threading.Thread(target=session)
            thread.start()
            thread.join()
        else:
            session()
        os.kill(os.getpid(), number)
    finally:
        signal.signal(number, before)
    assert heard, "the handler was reset"
    assert set(heard) == {number}


def test_tests_open_gmsh_by_the_session_alone() -> None:
    """Otherwise SIGPIPE ends their process from then on, with all tests that follow."""
    tests = Path(__file__).parents[2]
    opening = "gmsh.initialize" + "("
    assert [file.name for file in tests.rglob("*.py") if opening in file.read_text(encoding="utf-8")] == []
