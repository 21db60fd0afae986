"""Files of an optimise run: history, density, surface, picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.domain.build import Domain
from cranktopo.optimise.loop import Design
from cranktopo.optimise.state import Record
from cranktopo.report.picture import save_run_picture
from cranktopo.report.vtu import write_density_vtu
from cranktopo.scene import Scene
from cranktopo.store import RunStore
from cranktopo.surface import (
    GateReport,
    WebSurface,
    check_surface,
    extract_half_throw,
    slab_fields,
    write_stl,
)
from cranktopo.surface.release import Undercuts, undercuts

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Outputs:
    """What was written.

    Attributes:
        files: name of each file in the run directory by what it holds.
        surface: the extracted surface.
        gates: its checked properties.
        undercuts: what a die that parts in x = 0 could not release.
    """

    files: dict[str, str]
    surface: WebSurface
    gates: GateReport
    undercuts: Undercuts


def history_rows(history: tuple[Record, ...], case_names: tuple[str, ...]) -> list[dict[str, Any]]:
    """Rows of history.csv: one per design, units in the column names."""
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
    """Write history.csv, density.vtu, web.stl and result.png of a design.

    Args:
        run: where to write.
        scene: the scene.
        domain: the cells.
        design: densities of the web's layers.
        rows: from `history_rows`.

    Raises:
        CranktopoError: no closed surface with the design's volume, or a file cannot be written.
    """
    run.write_history(rows)
    _write_vtu(run, domain, design.physical)
    grid, usable, smooth = slab_fields(domain, design)
    surface = extract_half_throw(grid, scene, usable, smooth)
    gates = check_surface(surface)
    write_stl(run.path / "web.stl", surface.half_throw)
    title = f"{scene.name}, volume fraction {scene.optimise.volume_fraction:g}"
    save_run_picture(run.path / "result.png", surface.half_throw, rows, title, scene.web_z_mm)
    files = {
        "stl": "web.stl",
        "vtu": "density.vtu",
        "history": "history.csv",
        "picture": "result.png",
    }
    return Outputs(files, surface, gates, undercuts(surface.web, scene, float(grid.cell_mm.min()) / 2))


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
