"""Files of an optimise run: history, density, surface, picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.domain.build import Domain
from cranktopo.errors import CranktopoError, ExitCode
from cranktopo.optimise.loop import Design
from cranktopo.optimise.state import Record
from cranktopo.report.picture import save_run_picture
from cranktopo.report.vtu import write_density_vtu
from cranktopo.scene import Scene
from cranktopo.store import RunStore
from cranktopo.surface.checked_surface import CheckedSurface, checked_surface
from cranktopo.triangles.surface_files import write_stl

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Outputs:
    """What was written.

    Attributes:
        files: name of each file in the run directory by what it holds.
        skin: the extracted surface, or None where the density has none worth writing.
        refusal: why there is none, one sentence; empty where there is one.
    """

    files: dict[str, str]
    skin: CheckedSurface | None
    refusal: str = ""


def history_rows(history: tuple[Record, ...], case_names: tuple[str, ...]) -> list[dict[str, Any]]:
    """Rows of history.csv: one per design, units in the column names.

    Args:
        history: records of the designs.
        case_names: load cases in the order of the compliances.
    """
    return [
        {
            "iteration": row.iteration,
            "beta": row.beta,
            "objective": row.objective,
            **{
                f"{name}_compliance_N_mm": value
                for name, value in zip(case_names, row.compliance_N_mm, strict=True)
            },
            "volume_fraction": row.volume_fraction,
            "greyness": row.greyness,
            "change": row.change,
            "cg_iterations": row.cg_iterations,
            "seconds": round(row.seconds, 4),
        }
        for row in history
    ]


def write_outputs(
    run: RunStore, scene: Scene, domain: Domain, design: Design, rows: list[dict[str, Any]]
) -> Outputs:
    """Write history.csv, density.vtu, and web.stl and result.png where the density has a surface.

    A design that is still grey, as after the first iterations, may have none: the rest is written, with
    the reason.

    Args:
        run: where to write.
        scene: the scene.
        domain: the cells.
        design: densities of the web's layers.
        rows: from `history_rows`.

    Raises:
        CranktopoError: a file cannot be written.
    """
    run.write_history(rows)
    _write_vtu(run, domain, design.physical)
    files = {"vtu": "density.vtu", "history": "history.csv"}
    for name in ("web.stl", "result.png"):  # of an earlier end of a resumed run
        (run.path / name).unlink(missing_ok=True)
    try:
        skin = checked_surface(scene, domain, design)
    except CranktopoError as error:
        if error.code != ExitCode.CRITERION_NOT_MET:
            raise
        return Outputs(files, None, str(error))
    write_stl(run.path / "web.stl", skin.surface.half_throw)
    title = f"{scene.name}, volume fraction {scene.optimise.volume_fraction:g}"
    save_run_picture(run.path / "result.png", skin.surface.half_throw, rows, title, scene.web_z_mm)
    return Outputs({"stl": "web.stl", **files, "picture": "result.png"}, skin)


def _write_vtu(run: RunStore, domain: Domain, density: Array) -> None:
    first, last = domain.web_layers
    physical = domain.fixed.copy()
    physical[:, :, first:last] += domain.design[:, :, first:last] * density
    write_density_vtu(
        run.path / "density.vtu",
        domain.grid.x_mm,
        domain.grid.y_mm,
        domain.grid.z_mm,
        {"density": physical, "designable_fraction": domain.design, "fixed_fraction": domain.fixed},
        (domain.fixed + domain.design) > 0,
    )
