"""Two works at once: SciPy and JAX leave the interpreter while they compute.

Each computes what it computes alone, so that the numbers do not depend on it.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

First = TypeVar("First")
Second = TypeVar("Second")


def side_by_side(first: Callable[[], First], second: Callable[[], Second]) -> tuple[First, Second]:
    """The results of two functions without arguments, computed in two threads.

    Raises:
        Exception: what the first, or else the second, raises, when both have ended.
    """
    with ThreadPoolExecutor(1) as pool:
        other = pool.submit(second)
        result = first()
        return result, other.result()
