"""The design variables of every iteration of a run, small, so that any design can be looked at again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import read_npz, unwritable, write_npz

FOLDER = "density"
_PREFIX = "iteration-"
_HINT = "Run `cranktopo optimise` again."


def save_iteration(run: Path, iteration: int, x: NDArray[np.float64], beta: float) -> None:
    """Save the design of one iteration, in half precision and compressed; the checkpoint keeps every bit.

    The filter averages the rounding (2.4e-4 at most) over its neighbours, so that the surface moves by
    less than a micrometre.

    Args:
        x: design variables, each in [0, 1].

    Raises:
        CranktopoError: the file cannot be written.
    """
    path = _path(run, iteration)
    try:
        path.parent.mkdir(exist_ok=True)
    except OSError as error:
        raise unwritable(path, error) from None
    write_npz(path, {"x": x.astype(np.float16), "beta": np.array(beta)}, compressed=True)


def load_iteration(run: Path, iteration: int) -> tuple[NDArray[np.float64], float]:
    """Design variables and projection steepness of one iteration.

    Raises:
        CranktopoError: the run has no such iteration, or its file is damaged.
    """
    path, saved = _path(run, iteration), saved_iterations(run)
    if iteration not in saved:
        held = f"holds iterations {saved[0]} to {saved[-1]}" if saved else "holds no density of any iteration"
        raise CranktopoError(
            f"run '{run}': no density of iteration {iteration}; it {held}.",
            hint="Give one of these." if saved else "Run `cranktopo optimise` again.",
        )
    content = read_npz(path, f"'{path}'", _HINT)
    try:
        return content["x"].astype(np.float64), float(content["beta"])
    except (KeyError, ValueError, TypeError):
        raise CranktopoError(f"'{path}': corrupted, holds no design.", hint=_HINT) from None


def saved_iterations(run: Path) -> list[int]:
    """Numbers of the iterations whose design a run keeps, ascending."""
    names = (path.stem.removeprefix(_PREFIX) for path in (run / FOLDER).glob(f"{_PREFIX}*.npz"))
    return sorted(int(name) for name in names if name.isdecimal())


def _path(run: Path, iteration: int) -> Path:
    return run / FOLDER / f"{_PREFIX}{iteration:04d}.npz"
