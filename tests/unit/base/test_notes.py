"""Notes of long work: to the logger, to another listener, to nobody."""

from __future__ import annotations

import logging

import pytest

from cranktopo.base.notes import detail, indented, note, redirected, silent
from cranktopo.base.side_by_side import Ahead, side_by_side


def test_notes_go_to_the_logger(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, logger="cranktopo"):
        note("one")
        detail("more")
        with indented():
            note("a part")
        with silent():
            note("nobody")
    assert caplog.messages == ["one", "  a part"]


def test_another_listener_hears_threads_as_well() -> None:
    lines: list[str] = []
    with redirected(lines.append):
        side_by_side(lambda: note("first"), lambda: note("second"))
        late = Ahead(lambda: note("third"))
        late.begin()
        detail("not for listeners")
    late.result()
    note("after")
    assert sorted(lines) == ["first", "second", "third"]
