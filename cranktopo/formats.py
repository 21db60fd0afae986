"""What the program writes, by file ending; it loads nothing, so that command lines can offer it."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, get_args

from cranktopo.errors import CranktopoError, ExitCode

SurfaceFormat = Literal["stl", "3mf", "glb"]
SURFACES: tuple[SurfaceFormat, ...] = get_args(SurfaceFormat)
PLOTS = (".png", ".svg", ".pdf")


def check_plot_path(path: Path) -> None:
    """Check, before long work, that a plot can go there.

    Args:
        path: the file that the user asked for.

    Raises:
        CranktopoError: another ending, or no such folder.
    """
    if path.suffix.lower() not in PLOTS:
        raise CranktopoError(
            f"--plot '{path}': must end in .png, .svg or .pdf.",
            hint=f"Name it {path.stem or 'plot'}.png.",
            code=ExitCode.USAGE,
        )
    if not path.parent.is_dir():
        raise CranktopoError(f"--plot '{path}': its folder does not exist.", code=ExitCode.USAGE)
