"""The one error type that a user sees: what is wrong, where, what to do next; and missing packages."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from enum import IntEnum
from typing import Any


class ExitCode(IntEnum):
    """Process exit codes, documented in `cranktopo --help`."""

    DONE = 0
    INTERNAL = 1
    USAGE = 2
    INVALID_INPUT = 3
    SOLVER = 4
    NOT_CONVERGED = 5
    CRITERION_NOT_MET = 6
    MISSING_TOOL = 7
    INTERRUPTED = 130


class CranktopoError(Exception):
    """A mistake or limit that the user can act on.

    Args:
        message: what is wrong, with the key path and the value.
        hint: what to do next, one sentence.
        code: exit code of the process.
    """

    def __init__(self, message: str, *, hint: str = "", code: ExitCode = ExitCode.INVALID_INPUT) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint
        self.code = code

    def __str__(self) -> str:
        return f"{self.message} {self.hint}".strip()

    def as_json(self) -> dict[str, Any]:
        """Return the error as the object that `--json` prints."""
        return {"error": {"code": int(self.code), "message": self.message, "hint": self.hint}}


def invalid(key: str, value: object, allowed: str, hint: str = "") -> CranktopoError:
    """Return an invalid-input error in the common form: key path, value, allowed range, next step.

    Args:
        key: dotted path of the key, e.g. `throw.main_journal.bore_diameter_mm`.
        allowed: the allowed range, e.g. `must be > 0 and < 42 mm`.
    """
    return CranktopoError(f"{key} = {quoted(value)}: {allowed}.", hint=hint)


def solver_error(message: str, hint: str) -> CranktopoError:
    """Return the error of a solver, a mesher or a CAD kernel that finds no result."""
    return CranktopoError(message, hint=hint, code=ExitCode.SOLVER)


_NO_MEMORY = re.compile(
    "can't start new thread|failed to map segment|cannot allocate memory|RESOURCE_EXHAUSTED|bad_alloc",
    re.IGNORECASE,
)
"""As threads, the loader of libraries, the system, XLA and C++ say it."""


def lacks_memory(error: Exception) -> bool:
    """Tell whether an error says, in the words of any library, that memory could not be had."""
    return isinstance(error, MemoryError) or _NO_MEMORY.search(str(error)) is not None


def quoted(value: object, most: int = 120) -> str:
    """Return a value for a message: on one line, shortened in the middle to so many characters."""
    try:
        text = str(value).lower() if isinstance(value, bool) else repr(value)
    except ValueError:  # an integer of more digits than Python writes
        digits = f"about {value.bit_length() * 0.30103:.0f}" if isinstance(value, int) else "thousands of"
        text = f"a number of {digits} digits"
    return text if len(text) <= most else f"{text[: most - 30]} ... {text[-20:]}"


def suggest(word: str, valid: list[str]) -> str:
    """Return a did-you-mean sentence for a misspelt word, listing all choices when nothing is near."""
    near = get_close_matches(word, valid, n=1, cutoff=0.6)
    return f"Did you mean '{near[0]}'?" if near else f"Valid: {', '.join(sorted(valid))}."


_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+")


def decimal_comma(text: str) -> str:
    """Return what to write in place of a number with a decimal comma; empty where there is none."""
    found = _DECIMAL_COMMA.match(text.strip())
    return f"A decimal comma: write {found[0].replace(',', '.')}." if found else ""


EXTRAS = {
    "bench": "bench",
    "dxf": "drawing as DXF",
    "fatigue": "fatigue by method 'fkm'",
    "sweep": "sweep",
}
"""Uses that need the packages of an extra, by its name in pyproject.toml."""


def install_line(extra: str) -> str:
    """Return the line that installs an extra."""
    return f"pip install 'cranktopo[{extra}]'"


@contextmanager
def packages_of(extra: str) -> Iterator[None]:
    """Tell a user which line installs the extra, where an import of the block fails, by a CranktopoError."""
    try:
        yield
    except ImportError as error:
        if lacks_memory(error):
            raise
        raise CranktopoError(
            f"{EXTRAS[extra]}: a package cannot be loaded: {error}.",
            hint=f"Install it: {install_line(extra)}",
            code=ExitCode.MISSING_TOOL,
        ) from None
