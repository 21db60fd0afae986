"""Works beside the caller: in their order, at most one behind, faults told."""

from __future__ import annotations

import threading

import pytest

from cranktopo.base.side_by_side import OneBehind


def test_the_caller_goes_on_while_a_work_is_done_and_waits_for_the_one_before() -> None:
    gate, done = threading.Event(), list[int]()
    with OneBehind() as behind:
        behind.begin(lambda: (gate.wait(10), done.append(1))[1])
        assert done == []
        gate.set()
        behind.begin(lambda: done.append(2))
        assert done[0] == 1
    assert done == [1, 2]


def test_what_a_work_raises_the_next_call_or_the_end_raises() -> None:
    def fail() -> None:
        raise OSError("disk full")

    with OneBehind() as behind:
        behind.begin(fail)
        with pytest.raises(OSError, match="disk full"):
            behind.begin(lambda: None)
    with pytest.raises(OSError, match="disk full"), OneBehind() as behind:
        behind.begin(fail)
