"""Densities drawn at random as optimisations reach them, in box envelopes and in re-modelled webs.

`python -m tests.hard.extractions FIRST COUNT` prints a line for each surface of so many optimisations.
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density.loop import WebDensities, final_design
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.stage import Prepared, optimise_density, prepare
from cranktopo.tasks.density.state import State
from cranktopo.tasks.extraction.checked_surface import CheckedSurface, checked_surface
from cranktopo.tasks.iterate.one_step import write_envelope, write_solids
from cranktopo.tasks.refit.family import Layout, station_shares, web_of
from cranktopo.tasks.refit.fit import fit_web, scene_with_web
from cranktopo.tasks.refit.parametric_web import reaches_mm
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.envelope import StlEnvelope
from cranktopo.throw.fitted_pocket import FittedCylinder
from cranktopo.throw.fitted_slot import FittedSlot
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

ENGINES = ("mikron-iiic-plain", "opposed-piston")
COARSEST_MM = {"mikron-iiic-plain": 4.5, "opposed-piston": 5.0}
"""Coarser cells are refused: a journal's wall needs two."""
CELLS_MM = (2.0, 2.5, 3.0, 3.5, 4.0, 5.0)
CELL_SHARES = (0.02, 0.02, 0.08, 0.13, 0.35, 0.40)
"""Few fine grids: each takes as long as several coarse ones."""
ITERATIONS = (12, 24)
"""A grey density and one that is projected to the end, both of one optimisation."""
DRAWN_WEBS, FITTED_WEBS = 5, 2
"""Re-modelled webs of each engine: with parameters drawn at random, and fitted to optimised webs."""
STATIONS = 7


@dataclass(frozen=True)
class Case:
    """One optimisation; its envelope is the box of the design or the re-modelled web of that number."""

    engine: str
    web: int | None
    process: str
    volume_fraction: float
    cell_mm: float


@dataclass(frozen=True)
class Result:
    """What became of a design of a case: its surface or its refusal."""

    case: Case
    iteration: int
    found: CheckedSurface | None
    refusal: str


def case(seed: int) -> Case:
    """Engines, envelopes and processes in turn, the rest drawn from the seed."""
    draw = np.random.default_rng(seed)
    engine, in_web = ENGINES[seed % 2], bool(seed // 2 % 2)
    cell = min(float(draw.choice(CELLS_MM, p=CELL_SHARES)), COARSEST_MM[engine])
    web = int(draw.integers(DRAWN_WEBS + FITTED_WEBS)) if in_web else None
    return Case(engine, web, ("free", "forged")[seed // 4 % 2], float(draw.uniform(0.1, 0.6)), cell)


def results(made: Case, folder: Path) -> Iterator[Result]:
    """Optimise and extract two designs; the folder keeps the envelopes."""
    scene = load_scene(made.engine)
    if made.web is not None:
        file = envelope_file(made.engine, made.web, folder)
        scene = scene.model_copy(
            update={"envelope": StlEnvelope(shape="stl", file=str(file), symmetric=True)}
        )
    with double_precision():
        prepared, designs = optimised(scene, made.process, made.volume_fraction, made.cell_mm)
        for iteration, design in designs.items():
            try:
                found = checked_surface(prepared.scene, prepared.domain, design)
                yield Result(made, iteration, found, "")
            except CranktopoError as error:
                yield Result(made, iteration, None, str(error))


def optimised(
    scene: Scene, process: str, volume_fraction: float, cell_mm: float
) -> tuple[Prepared, dict[int, WebDensities]]:
    """Designs of an optimisation by iteration; call inside `double_precision()`."""
    options = {"process": process, "volume_fraction": volume_fraction, "resolution_mm": cell_mm}
    prepared = prepare(scene.with_optimise(**options, draft_deg=0.0, max_iterations=ITERATIONS[-1]))
    designs = {}

    def keep(problem: DensityProblem, state: State) -> None:
        if state.last.iteration == ITERATIONS[0] or state.done:
            designs[state.last.iteration] = final_design(problem, state)

    optimise_density(prepared, progress=keep)
    return prepared, designs


@cache
def envelope_file(engine: str, number: int, folder: Path) -> Path:
    """A re-modelled web of an engine as the loop hands it to its next step."""
    place = folder / f"{engine}-{number}"
    place.mkdir()
    scene = drawn_web(engine, number) if number < DRAWN_WEBS else fitted_web(engine, number - DRAWN_WEBS)
    return write_envelope(write_solids(scene, place).web, place)


def fitted_web(engine: str, number: int) -> Scene:
    """The re-model of a forged web, on coarse cells."""
    with double_precision():
        prepared, designs = optimised(load_scene(engine), "forged", (0.45, 0.7)[number], 4.0)
        design = designs[max(designs)]
        surface = checked_surface(prepared.scene, prepared.domain, design).surface.half_throw
    limits = ManufacturingLimits(cell_mm=2.0, starts=1, max_stations=7, least_gain_percent=0.5)
    return fit_web(surface, load_scene(engine), limits).scene


def drawn_web(engine: str, number: int) -> Scene:
    """A web of the re-model's family, drawn until the throw takes it."""
    scene = load_scene(engine)
    draw = np.random.default_rng(1000 + number)
    while True:
        layout, values = _parameters(scene, draw)
        try:
            return scene_with_web(scene, web_of(layout, values, scene))
        except CranktopoError:
            continue


def _parameters(scene: Scene, draw: np.random.Generator) -> tuple[Layout, np.ndarray]:
    """An outline around both journals, and some of: bevels, a side pocket or groove, two holes."""
    reaches = reaches_mm(scene, ManufacturingLimits())
    low = min(y - reach for y, reach in reaches) - draw.uniform(0.5, 8.0)
    high = max(y + reach for y, reach in reaches) + draw.uniform(0.5, 8.0)
    places = low + (high - low) * station_shares(STATIONS)[1:-1]
    half_widths = np.max([np.sqrt(np.maximum(r**2 - (places - y) ** 2, 0)) for y, r in reaches], axis=0)
    values = [np.array([low, high]), half_widths + draw.uniform(1.0, 12.0, len(places))]
    thickness, radius = scene.web.thickness_mm, scene.throw.radius_mm
    parts: list[FittedBevel | FittedSlot | FittedCylinder] = []
    for face, (y, away) in (("journal", (radius, 1)), ("pin", (0.0, -1))):
        if draw.random() < 0.7:
            parts.append(FittedBevel(face))
            start, depth = y + away * draw.uniform(0, 5), thickness * draw.uniform(0.2, 0.7)
            values.append(np.array([start, depth, draw.uniform(0, 3)]))
    if draw.random() < 0.5:
        parts.append(FittedSlot())
        length = draw.choice([draw.uniform(10, 30), 1.5 * (high - low)])
        floor = half_widths.max() * draw.uniform(0.8, 1.1)
        height = thickness * draw.uniform(0.2, 0.5)
        values.append(np.array([radius / 2, length, height, floor, draw.uniform(-1, 1), draw.uniform(3, 20)]))
    if draw.random() < 0.5:
        parts.append(FittedCylinder("through", pair=True))
        values.append(np.array([draw.uniform(0.4, 0.6) * radius, radius / 2, draw.uniform(4, 9)]))
    return Layout(STATIONS, tuple(parts)), np.concatenate(values)


def way_of(result: Result) -> str:
    """How a surface was reached, for the count."""
    return "refused" if result.found is None else result.found.surface.fallback or "usual"


def line(seed: int, result: Result) -> str:
    """What a design was and what became of it."""
    made, found = result.case, result.found
    envelope = "box" if made.web is None else f"web {made.web}"
    text = (
        f"{seed:4d} {made.engine:14s} {envelope:6s} {made.process:6s} {made.volume_fraction:.3f} "
        f"{made.cell_mm:.1f} mm, iteration {result.iteration:2d}: "
    )
    if found is None:
        return text + result.refusal
    return text + f"{found.report.web_volume_error_percent:+.3f} %, {way_of(result)}"


if __name__ == "__main__":
    ways: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        for seed in range(int(sys.argv[1]), int(sys.argv[1]) + int(sys.argv[2])):
            for result in results(case(seed), Path(name)):
                print(line(seed, result), flush=True)
                ways[way_of(result)] += 1
    print(f"{ways.total()} surfaces: {dict(ways)}")
