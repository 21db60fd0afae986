"""Work in a second process is the same work, and is done by the first one where the second is not there."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from math import inf

import numpy as np
import pytest

from cranktopo.base.companion import ALONE, Companion
from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.notes import note, redirected

_HERE = "tests.unit.base.test_companion"


def numbered(number: int) -> tuple[int, int, bool]:
    """Return the number, the process that computes, and whether a library is loaded that has work to do."""
    import sys

    note(f"work {number}")
    return number, os.getpid(), "wave" in sys.modules


def killed_but_in(process: int) -> int:
    """End every process but one, as a system without memory does."""
    if os.getpid() != process:
        os.kill(os.getpid(), signal.SIGKILL)
    return process


class Slow:
    """It takes half a second to be sent."""

    def __reduce__(self) -> tuple[type[int], tuple[()]]:
        time.sleep(0.5)
        return int, ()


_calls: list[object] = []


def counted(argument: object) -> int:
    _calls.append(argument)
    return len(_calls)


def refused(value: float) -> None:
    raise invalid("throw.radius_mm", value, "must be positive", "Enlarge it.")


def printed(array: np.ndarray) -> np.ndarray:
    print("native code prints", flush=True)
    return array + 1


@pytest.fixture
def two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cranktopo.base.companion.usable_cores", lambda: 2)
    monkeypatch.setattr("cranktopo.base.companion.container_memory_left_MiB", lambda: inf)


@pytest.fixture
def companion(two_cores: None) -> Iterator[Companion]:
    with Companion(["wave"]) as beside:
        yield beside


def test_works_are_done_in_their_order_by_one_other_process_with_its_libraries(companion: Companion) -> None:
    lines: list[str] = []
    with redirected(lines.append):
        works = [companion.begin(numbered, number) for number in range(3)]
    found = [work() for work in works]
    assert [number for number, _, _ in found] == [0, 1, 2]
    assert len({process for _, process, _ in found}) == 1
    assert found[0][1] != os.getpid()
    assert all(loaded for _, _, loaded in found)
    assert lines == ["work 0", "work 1", "work 2"]


def test_a_work_does_not_overtake_one_that_is_still_being_sent(companion: Companion) -> None:
    works = [companion.begin(counted, argument) for argument in (Slow(), 0)]
    assert [work() for work in works] == [1, 2]


def test_arrays_come_back_to_the_bit_and_prints_do_not_mix_with_them(companion: Companion) -> None:
    array = np.random.default_rng(0).random((200, 300))
    np.testing.assert_array_equal(companion.begin(printed, array)(), array + 1, strict=True)


def test_an_error_is_raised_as_the_work_raised_it_and_the_next_work_is_done(companion: Companion) -> None:
    failing, next_one = companion.begin(refused, -3.0), companion.begin(numbered, 1)
    with pytest.raises(CranktopoError, match=r"throw\.radius_mm.*-3"):
        failing()
    assert next_one()[1] != os.getpid()


def test_the_first_process_does_the_work_of_a_second_one_that_was_killed(companion: Companion) -> None:
    killed, next_one = companion.begin(killed_but_in, os.getpid()), companion.begin(numbered, 7)
    assert killed() == os.getpid()
    assert next_one()[:2] == (7, os.getpid())


def test_a_second_process_that_cannot_load_its_libraries_leaves_its_work(
    two_cores: None,
) -> None:
    with Companion([f"{_HERE}_that_is_not_there"]) as beside:
        assert beside.begin(numbered, 5)()[:2] == (5, os.getpid())


def test_the_end_of_the_block_ends_a_work_and_its_process_at_once(two_cores: None) -> None:
    began = time.monotonic()
    with Companion() as beside:
        other = beside.begin(numbered, 0)()[1]
        endless = beside.begin(time.sleep, 600)
    with pytest.raises(InterruptedError):
        endless()
    with pytest.raises(ProcessLookupError):
        os.kill(other, 0)
    assert time.monotonic() - began < 300


@pytest.mark.parametrize("missing", ["cores", "memory", "processes"])
def test_without_a_second_process_work_is_done_where_it_is_asked_for(
    missing: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr("cranktopo.base.companion.usable_cores", lambda: 1 if missing == "cores" else 2)
    monkeypatch.setattr(
        "cranktopo.base.companion.container_memory_left_MiB", lambda: 1400 if missing == "memory" else 1600
    )
    if missing == "processes":
        monkeypatch.setattr("cranktopo.base.companion.started", refuse)
    with Companion(["wave"]) as beside:
        assert beside.begin(numbered, 3)()[:2] == (3, os.getpid())
    assert ALONE.begin(numbered, 4)()[:2] == (4, os.getpid())
