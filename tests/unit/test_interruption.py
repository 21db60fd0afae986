"""Ctrl-C during long work: at once where it can be, and never lost."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable

import pytest

from cranktopo.pipeline.interruption import interruptible


def swallowed_interrupt() -> None:
    """Ctrl-C while code runs that drops exceptions, as callbacks of compiled libraries do."""
    with contextlib.suppress(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


def test_interrupt_is_raised_at_once() -> None:
    with pytest.raises(KeyboardInterrupt), interruptible():
        signal.raise_signal(signal.SIGINT)
        pytest.fail("went on")


def test_swallowed_interrupt_is_raised_between_two_steps() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), interruptible() as check:
        for step in range(3):
            done.append(step)
            if step == 1:
                swallowed_interrupt()
            check()
    assert done == [0, 1]


def test_swallowed_interrupt_is_raised_at_the_end() -> None:
    with pytest.raises(KeyboardInterrupt), interruptible():
        swallowed_interrupt()


def test_inner_and_outer_work_both_learn_of_it() -> None:
    found = []
    with pytest.raises(KeyboardInterrupt), interruptible() as outer:
        with contextlib.suppress(KeyboardInterrupt), interruptible():
            swallowed_interrupt()
        found.append("inner ended")
        outer()
        found.append("outer went on")
    assert found == ["inner ended"]


def test_handler_is_as_before() -> None:
    before = signal.getsignal(signal.SIGINT)
    with interruptible() as check:
        assert signal.getsignal(signal.SIGINT) is not before
        check()
    assert signal.getsignal(signal.SIGINT) is before


def test_ignored_signal_stays_ignored() -> None:
    """A job in the background of a shell ignores Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with interruptible() as check:
            signal.raise_signal(signal.SIGINT)
            check()
    finally:
        signal.signal(signal.SIGINT, before)


def test_other_threads_work_without_a_handler() -> None:
    found: list[Callable[[], None]] = []

    def work() -> None:
        with interruptible() as check:
            found.append(check)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert len(found) == 1
