"""Packages that some commands alone need: the extras, and what is said where one is missing."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from cranktopo.base.errors import CranktopoError, ExitCode

EXTRAS = {"sweep": "sweep", "fatigue": "fatigue by method 'fkm'"}
"""What needs the packages of an extra, by its name in pyproject.toml."""


def install_line(extra: str) -> str:
    """Return the line that installs an extra."""
    return f"pip install 'cranktopo[{extra}]'"


@contextmanager
def packages_of(extra: str) -> Iterator[None]:
    """Tell a user which line installs the extra, where an import of the block fails.

    Raises:
        CranktopoError: a package is missing or cannot be loaded.
    """
    try:
        yield
    except ImportError as error:
        raise CranktopoError(
            f"{EXTRAS[extra]}: a package cannot be loaded: {error}.",
            hint=f"Install it: {install_line(extra)}",
            code=ExitCode.MISSING_TOOL,
        ) from None
