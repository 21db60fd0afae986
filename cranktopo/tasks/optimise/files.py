"""Files of an optimise run: history, density, surface, picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from cranktopo.bodies.cells.domain import Domain
from cranktopo.design.goal.wanted import wanted
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.vtu import write_density_vtu
from cranktopo.runs.directories import RunStore
from cranktopo.tasks.density.loop import WebDensities
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.state import Record
from cranktopo.tasks.optimise.picture import save_run_picture

_SURFACE, _PICTURE, _DENSITY = "web.stl", "result.png", "density.vtu"


def history_rows(problem: DensityProblem, history: Sequence[Record]) -> list[dict[str, Any]]:
    """Rows of history.csv: one per design, units in the column names, compliances in N mm by load case.

    With a goal, its value and those of its limits are among them.
    """
    case_names, responses = problem.model.case_names, problem.statement.responses
    return [
        {
            "iteration": row.iteration,
            "beta": row.beta,
            "objective": row.objective,
            **{
                f"{name}_compliance_N_mm": value
                for name, value in zip(case_names, row.compliance_N_mm, strict=True)
            },
            **{
                column_name(response.name, response.unit): value
                for response, value in zip(responses, (*row.goals, *row.limits), strict=False)
            },
            "volume_fraction": row.volume_fraction,
            "greyness": row.greyness,
            "change": row.change,
            "cg_iterations": row.cg_iterations,
            "seconds": round(row.seconds, 4),
        }
        for row in history
    ]


def column_name(name: str, unit: str) -> str:
    """Machine name of a quantity: `torsion` in `N m/(rad kg)` is `torsion_Nm_per_rad_kg`."""
    plain = unit.replace("N m", "Nm").replace("/", "_per_").replace("(", "").replace(")", "")
    return f"{name} {plain}".strip().replace(" ", "_")


def write_run_files(
    run: RunStore,
    scene: Scene,
    domain: Domain,
    design: WebDensities,
    rows: Sequence[Mapping[str, Any]],
    half_throw: SurfaceMesh | None,
) -> dict[str, str]:
    """Write history.csv, density.vtu, and web.stl and result.png where there is a surface.

    Returns their names by what they hold.

    Raises:
        CranktopoError: a file cannot be written.
    """
    run.write_history(rows)
    _write_density(run, domain, design)
    files = {"vtu": _DENSITY, "history": "history.csv"}
    if half_throw is None:
        for name in (_SURFACE, _PICTURE):  # of an earlier end of a resumed run
            (run.path / name).unlink(missing_ok=True)
        return files
    write_stl(run.path / _SURFACE, half_throw)
    goal = wanted(scene)
    share = f"volume fraction {scene.optimise.volume_fraction:g}"
    title = f"{scene.name}, {share if goal is None else f'{goal.sense} {goal.quantity}'}"
    save_run_picture(run.path / _PICTURE, half_throw, rows, title, scene.web_z_mm)
    return {"stl": _SURFACE, **files, "picture": _PICTURE}


def _write_density(run: RunStore, domain: Domain, design: WebDensities) -> None:
    first, last = domain.web_layers
    physical = domain.passive_fraction.copy()
    physical[:, :, first:last] += domain.design_fraction[:, :, first:last] * design.physical
    write_density_vtu(
        run.path / _DENSITY,
        domain.grid.x_mm,
        domain.grid.y_mm,
        domain.grid.z_mm,
        {
            "density": physical,
            "designable_fraction": domain.design_fraction,
            "fixed_fraction": domain.passive_fraction,
        },
        (domain.passive_fraction + domain.design_fraction) > 0,
    )
