"""Works at once: SciPy and JAX leave the interpreter while they compute.

Each computes what it computes alone, so that the numbers do not depend on it.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from contextvars import copy_context
from typing import Generic, TypeVar

First = TypeVar("First")
Second = TypeVar("Second")


class LazyFuture(Generic[First]):
    """A work that a thread does before its result is asked for."""

    def __init__(self, work: Callable[[], First]) -> None:
        self._work = work
        self._found: Future[First] | None = None

    def begin(self) -> Future[First]:
        """Begin, unless it has begun."""
        if self._found is None:
            with_one = ThreadPoolExecutor(1)
            self._found = with_one.submit(copy_context().run, self._work)
            with_one.shutdown(wait=False)
        return self._found

    def result(self) -> First:
        """Return what the work returns; raises what it raises."""
        return self.begin().result()


class OneBehind:
    """Works of a thread beside the caller, in their order, who is at most one ahead.

    What a work raises, the next call raises, or the end of the `with` block, which waits for the last one; a
    block that itself fails raises what it failed of.
    """

    def __init__(self) -> None:
        self._last: LazyFuture[None] | None = None

    def __enter__(self) -> OneBehind:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        with suppress(*([Exception] if kind else [])):
            self.wait()

    def begin(self, work: Callable[[], None]) -> None:
        """Begin a work once the one before it has ended."""
        self.wait()
        self._last = LazyFuture(work)
        self._last.begin()

    def wait(self) -> None:
        """Wait for the last work."""
        last, self._last = self._last, None
        if last is not None:
            last.result()


def side_by_side(first: Callable[[], First], second: Callable[[], Second]) -> tuple[First, Second]:
    """Return the results of two functions, computed in two threads; raises what one of them raises."""
    with ThreadPoolExecutor(1) as pool:
        other = pool.submit(copy_context().run, second)
        result = first()
        return result, other.result()


def in_halves(count: int, work: Callable[[slice], None]) -> None:
    """Do a work on the first and on the second half of so many things, in two threads."""
    middle = count // 2
    side_by_side(lambda: work(slice(0, middle)), lambda: work(slice(middle, count)))
