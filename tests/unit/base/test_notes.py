"""Notes of long work: to the logger, to another listener, to nobody."""

from __future__ import annotations

import logging

import pytest

from cranktopo.base.notes import Pace, detail, duration_text, indented, note, pace_of, redirected, silent
from cranktopo.base.side_by_side import LazyFuture, side_by_side


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
        late = LazyFuture(lambda: note("third"))
        late.begin()
        detail("not for listeners")
    late.result()
    note("after")
    assert sorted(lines) == ["first", "second", "third"]


def test_a_pace_tells_the_part_and_the_time_left(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([0.0, 1.0, 4.0, 5.0, 8.0, 11.0])
    monkeypatch.setattr("cranktopo.base.notes.time.perf_counter", lambda: next(clock))
    lines: list[str] = []
    with redirected(lines.append):
        pace = Pace("fit", 4)
        for part in ("outline", "bevel", "groove", "pocket", "more"):
            pace.begin(part)
    assert lines == [
        "fit: [###---------] 2 of 4, bevel, about 12 s left",
        "fit: [#########---] 4 of 4, pocket, about 3 s left",
        "fit: [############] 5 of 5, more",
    ]


def test_short_work_has_no_line() -> None:
    lines: list[str] = []
    with redirected(lines.append):
        pace = Pace("fit", 1000, at_most=True)
        for _ in range(1000):
            pace.begin()
    assert lines == []
    assert [duration_text(seconds) for seconds in (40, 700, 12_000)] == ["40 s", "12 min", "3 h 20 min"]


def test_silent_work_still_tells_its_pace(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([0.0, 4.0])
    monkeypatch.setattr("cranktopo.base.notes.time.perf_counter", lambda: next(clock))
    lines: list[str] = []
    with redirected(lines.append), silent():
        note("not heard")
        Pace("mesh", 2).begin()
    assert lines == ["mesh: [------------] 1 of 2"]


def test_a_line_of_a_pace_is_read_again() -> None:
    """As the bench does, to show a bar: the share that is done, and the time left."""
    lines: list[str] = []
    with redirected(lines.append):
        pace = Pace("fit", 4, quiet_s=0.0)
        pace.begin("search")
        pace.begin("search")
        pace.begin(parts=8)
    assert [found and found[0] for found in map(pace_of, lines)] == [0.0, 1 / 4, 2 / 8]
    assert pace_of(lines[0]) == (0.0, "")
    assert pace_of("x: [####--------] 3 of at most 9, at most 12 min left") == (2 / 9, "at most 12 min")
    assert pace_of("x: [####--------] 3 of 9, unit loads, about 3 h 20 min left") == (
        2 / 9,
        "about 3 h 20 min",
    )
    assert pace_of("[##----------] 12 of 60 s: optimiser, cells 3 mm, about 9 s") == (0.2, "about 48 s")
    assert pace_of("[############] 9 of 7.5 s: optimiser, cells 3 mm") == (1.0, "about 0 s")
    assert pace_of("solving, 423,852 unknowns: 7 s so far") is None
