"""Keep of a long computation: a checkpoint that is whole or absent, and every design.

The new file replaces the old one by a rename, so a process killed at any moment leaves one of the two. The
arrays carry the hash of all of them, which is verified on loading.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.files import from_json, json_text, unwritable
from cranktopo.base.seals import read_arrays, write_arrays

SCHEMA_VERSION = 1
_HINT, _AGAIN = "Start a new run of the design.", "Run `cranktopo optimise` again."
_STATE = "__state__"
_FOLDER, _PREFIX = "density", "iteration-"


def save_iteration(run: Path, iteration: int, x: NDArray[np.float64], beta: float) -> None:
    """Save the design of one iteration, each variable in [0, 1], in half precision and compressed.

    The filter averages the rounding (2.4e-4 at most) over its neighbours, so that the surface moves by
    less than a micrometre; the checkpoint keeps every bit.
    """
    path = _path(run, iteration)
    try:
        path.parent.mkdir(exist_ok=True)
    except OSError as error:
        raise unwritable(path, error) from None
    write_arrays(path, {"x": x.astype(np.float16), "beta": np.array(beta)}, compressed=True)


def load_iteration(run: Path, iteration: int) -> tuple[NDArray[np.float64], float]:
    """Return the design variables and the projection steepness of one iteration; raises CranktopoError."""
    path, saved = _path(run, iteration), saved_iterations(run)
    if iteration not in saved:
        held = f"holds iterations {saved[0]} to {saved[-1]}" if saved else "holds no density of any iteration"
        raise CranktopoError(
            f"run '{run}': no density of iteration {iteration}; it {held}.",
            hint="Give one of these." if saved else _AGAIN,
        )
    content = read_arrays(path, f"'{path}'", _AGAIN)
    try:
        x, beta = content["x"].astype(np.float64), float(content["beta"])
    except (KeyError, ValueError, TypeError):
        x, beta = np.zeros(0), 0.0
    if not (x.ndim == 3 and (abs(x - 0.5) <= 0.5).all() and 0 < beta < np.inf):
        raise CranktopoError(f"'{path}': corrupted, holds no design.", hint=_AGAIN)
    return x, beta


def saved_iterations(run: Path) -> list[int]:
    """Return the numbers of the iterations whose design a run keeps, ascending."""
    names = (path.stem.removeprefix(_PREFIX) for path in (run / _FOLDER).glob(f"{_PREFIX}*.npz"))
    return sorted(int(name) for name in names if name.isdecimal())


def _path(run: Path, iteration: int) -> Path:
    return run / _FOLDER / f"{_PREFIX}{iteration:04d}.npz"


@dataclass(frozen=True)
class Checkpoint:
    """Saved state: arrays by name, bit for bit, and a state of plain values."""

    arrays: dict[str, NDArray[Any]]
    state: dict[str, Any]


def save_checkpoint(path: Path, arrays: Mapping[str, NDArray[Any]], state: Mapping[str, Any]) -> None:
    """Save arrays, bit for bit, and a plain finite state; the previous file stays until this is complete."""
    text = json_text({"schema_version": SCHEMA_VERSION, "state": dict(state)}, path.name)
    content = {name: np.asarray(array, order="C") for name, array in arrays.items()}
    content[_STATE] = np.frombuffer(text.encode("utf-8"), dtype=np.uint8)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(path, error) from None
    write_arrays(path, content)


def load_checkpoint(path: Path) -> Checkpoint:
    """Load and verify a checkpoint; raises CranktopoError for one missing, damaged or of another version."""
    if not path.exists():
        raise _bad(path, "missing: the run stopped before its first checkpoint")
    content = read_arrays(path, f"checkpoint '{path}'", _HINT)
    if _STATE not in content:
        raise _bad(path, f"incomplete, {_STATE} missing")
    try:
        saved = from_json(content.pop(_STATE).tobytes().decode("utf-8"))
        version, state = saved["schema_version"], dict(saved["state"])
    except (ValueError, KeyError, TypeError):
        raise _bad(path, f"corrupted, {_STATE} cannot be read") from None
    if version != SCHEMA_VERSION:
        raise _bad(path, f"schema_version {quoted(version)}, this program reads {SCHEMA_VERSION}")
    return Checkpoint(arrays=content, state=state)


def _bad(path: Path, what: str) -> CranktopoError:
    return CranktopoError(f"checkpoint '{path}': {what}.", hint=_HINT)
