"""Which optimisations begin on larger cells, and what these hand on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cranktopo.bodies.cells.domain import build_domain, centres_mm
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density import loop, stage
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.stage import Prepared, coarse_scene, first_state, interpolated, iterate, prepare
from cranktopo.tasks.density.state import CoarseStart, Record, State, Status, from_checkpoint, to_checkpoint
from tests.run_metrics import run_metrics

ROW = Record(1, 1.0, 1.0, (2.0, 3.0), 0.3, 0.5, 0.2, 9, 1.0)


def started(prepared: Prepared, problem: DensityProblem) -> State:
    return first_state(problem, prepared.scene, prepared.domain, prepared.cases)


def solved_by_nothing(problem: DensityProblem, state: State) -> State:
    """A step that leaves the design and settles at the fourth."""
    history = (*state.history, replace(ROW, iteration=len(state.history) + 1))
    status: Status = "converged" if len(history) == 4 else "running"
    beta = problem.schedule.projection_last
    return replace(state, history=history, status=status, beta=beta, initial_N_mm=(2.0, 3.0))


LARGE = "car-diesel", "industrial-gas"


@pytest.mark.parametrize(
    "name",
    ["mikron-iiic-plain", "opposed-piston", *(pytest.param(n, marks=pytest.mark.slow) for n in LARGE)],
)
def test_designs_at_their_own_resolution_start_uniform(name: str) -> None:
    scene = load_scene(name)
    assert coarse_scene(scene, build_domain(scene, scene.optimise.resolution_mm)) is None


@pytest.mark.parametrize(
    ("settings", "cell_mm"),
    [
        ({"resolution_mm": 1.0}, 2.0),
        ({"resolution_mm": 1.2}, None),  # the filter would span 1.25 cells
        ({"resolution_mm": 1.0, "filter_radius_mm": 2.9}, None),
        ({"resolution_mm": 1.0, "min_member_mm": 4.5}, 2.0),
        ({"resolution_mm": 1.0, "min_member_mm": 3.5}, None),
    ],
)
def test_fine_cells_start_on_cells_twice_as_large(
    mikron: Scene, settings: dict[str, float], cell_mm: float | None
) -> None:
    scene = mikron.with_optimise(**settings)
    coarser = coarse_scene(scene, build_domain(scene, settings["resolution_mm"]))
    assert (None if coarser is None else coarser.optimise.resolution_mm) == cell_mm


def test_the_filter_keeps_its_radius(mikron: Scene) -> None:
    scene = mikron.with_optimise(resolution_mm=1.0)
    coarser = coarse_scene(scene, build_domain(scene, 1.0))
    assert coarser is not None
    assert coarser.optimise.filter_radius_mm == 3.0


def test_linear_designs_are_interpolated_exactly(mikron: Scene) -> None:
    there, here = build_domain(mikron, 4.0), build_domain(mikron, 2.0)
    centres = [np.meshgrid(*centres_mm(domain), indexing="ij") for domain in (there, here)]
    known, wanted = (0.4 + 0.004 * x - 0.003 * y + 0.002 * z for x, y, z in centres)
    found = interpolated(known, np.ones(known.shape), there, here)
    # Beyond the outermost centres the nearest value holds.
    inside = (slice(1, -1),) * 3
    np.testing.assert_allclose(found[inside], wanted[inside], atol=1e-12)


def test_void_beside_the_design_space_does_not_thin_it(mikron: Scene) -> None:
    there, here = build_domain(mikron, 4.0), build_domain(mikron, 2.0)
    (first, last), (begin, end) = there.web_layers, here.web_layers
    design = there.design_fraction[:, :, first:last]
    found = interpolated(np.where(design > 0, 0.7, 0.1), design, there, here)
    designable = here.design_fraction[:, :, begin:end] > 0
    assert np.mean(np.abs(found[designable] - 0.7) < 1e-12) > 0.99


def test_a_whole_optimisation_is_handed_on(mikron: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stage, "_FINE_CELLS", 0)
    monkeypatch.setattr(loop, "step", solved_by_nothing)
    prepared = prepare(mikron.with_optimise(resolution_mm=2.25, filter_radius_mm=7.0))
    with double_precision():
        problem = build_problem(prepared.scene, prepared.domain, prepared.cases)
        state = started(prepared, problem)
        back = from_checkpoint(*to_checkpoint(state))
    assert state.coarse_start is not None
    assert (state.coarse_start.iterations, state.beta, state.history) == (4, 4.0, ())
    assert state.coarse_start.cell_mm == pytest.approx(4.5, rel=0.05)
    assert state.x.shape == problem.density_chain.design_fraction.shape
    assert state.initial_N_mm == (2.0, 3.0)
    assert back.coarse_start == state.coarse_start


def test_summary_tells_both() -> None:
    metrics = run_metrics(status="converged", iterations=13)
    assert metrics.ended == "converged after 13 iterations"
    metrics = run_metrics(coarse_start=CoarseStart(2.0, 12, 3.0))
    assert metrics.ended == "converged after 13 iterations, and 12 before on cells of 2 mm"


@pytest.mark.slow
@pytest.mark.parametrize(("process", "draft_deg"), [("free", 0.0), ("forged", None)])
@pytest.mark.parametrize("cell_mm", [0.75, 1.0])
def test_the_design_is_as_good(process: str, draft_deg: float | None, cell_mm: float) -> None:
    """Weighted compliance within 0.1 % of that from a uniform start, after 0.6 of the iterations."""
    scene = load_scene("mikron-iiic-plain").with_optimise(process=process, draft_deg=draft_deg)
    prepared = prepare(scene.with_optimise(resolution_mm=cell_mm, volume_fraction=0.3))
    with double_precision():
        problem = build_problem(prepared.scene, prepared.domain, prepared.cases)
        plain = iterate(problem, loop.init(problem))
        state = iterate(problem, started(prepared, problem))
    first = np.array(plain.initial_N_mm)
    objective, other = (float(np.mean(s.last.compliance_N_mm / first)) for s in (state, plain))
    assert objective < 1.001 * other
    assert len(state.history) < 0.6 * len(plain.history)
    assert (state.status, plain.status) == ("converged", "converged")
