"""The work of one step of the loop: remove a little, extract, re-model, evaluate."""

from __future__ import annotations

import time
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from manifold3d import Manifold

from cranktopo.base.companion import Companion
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import json_file_text, write_text
from cranktopo.base.frames import X, Y, Z
from cranktopo.base.notes import note, silent
from cranktopo.base.result import Result
from cranktopo.bodies.prisms import snapped_to_mirror_plane, web_region, with_bolted
from cranktopo.bodies.seat import warn_of_cut_seat
from cranktopo.bodies.solid.files import coarse_facet_mm, export_solid, surface_of
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.engine.plan.simulated import Feature
from cranktopo.numerics.surfaces.files import as_stored, read_stl, write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, manifold_fault, mesh_of, solid_of
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.runs.directories import RunStore, open_run, status_of
from cranktopo.runs.kind import result_file
from cranktopo.runs.stored import unchanged, unchanged_result, write_recorded
from cranktopo.tasks.density import stage
from cranktopo.tasks.extraction.release import shaped_undercuts
from cranktopo.tasks.importing.imported_body import half_throw_of, half_throw_surface, read_half_throw
from cranktopo.tasks.importing.original import original_file
from cranktopo.tasks.iterate.result import LoopStep, Settings, step_of
from cranktopo.tasks.optimise.result import RunMetrics
from cranktopo.tasks.optimise.stage import optimise_design, resume_optimisation
from cranktopo.tasks.refit.fit import FIT_LIBRARIES, fit_web
from cranktopo.tasks.refit.process import fit_limits
from cranktopo.tasks.refit.shape_error import web_overlap
from cranktopo.tasks.throw_fea.evaluation import Evaluation, evaluate
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.throw.envelope import StlEnvelope

_RAYS = 61
_OUTSIDE = 1.02
_BEYOND_MM = 1.0

WEB = "web_only.stl"
HALF = "web"
_ENVELOPE, _OPTIMISE = "envelope.stl", "optimise"
"""In the folder of a step: its web as the envelope of the next one, and the run of its own optimisation."""
_X_AXIS = (1.0, 0.0, 0.0)
_SIMPLIFY_MM = (2e-3, 4e-3, 1e-3, 8e-3)
"""Distances by which simplification may move the surface, from attempt to attempt."""


class Solids(NamedTuple):
    """Surfaces of the half throw and of the web alone, mm, as their files hold them."""

    half: SurfaceMesh
    web: SurfaceMesh


def write_solids(scene: Scene, folder: Path, started: datetime | None = None) -> Solids:
    """Write web.step and web.stl (half throw, exact solid) and the web alone.

    `started` dates the STEP file, so that a loop that is resumed writes the same bytes; by default it is now.
    """
    facet = coarse_facet_mm(scene)
    warn_of_cut_seat(scene)
    export_solid(scene, "half", folder / f"{HALF}.step", started=started)
    return _written(surface_of(scene, "half", facet), surface_of(scene, "web", facet), folder)


def write_original(path: Path, scene: Scene, folder: Path) -> Solids:
    """Write the half throw of a body from CAD and its web as the solids of a step."""
    surface = half_throw_surface(path, scene)
    return _written(surface, mesh_of(web_region(solid_of(surface, str(path)), scene)), folder)


def _written(half: SurfaceMesh, web: SurfaceMesh, folder: Path) -> Solids:
    write_stl(folder / f"{HALF}.stl", half)
    write_stl(folder / WEB, web)
    return Solids(as_stored(half), as_stored(web))


def read_solids(folder: Path) -> Solids:
    """Return the solids of a step that an earlier go of the loop wrote."""
    half, web = (unchanged(folder / name) for name in (f"{HALF}.stl", WEB))
    return Solids(read_stl(half), read_stl(web))


def write_envelope(web: SurfaceMesh, folder: Path) -> Path:
    """Write the web of a step as an envelope that is exactly its own mirror image; return its path."""
    path = folder / _ENVELOPE
    write_stl(path, _symmetric(solid_of(web, f"web of {folder.name}")))
    return path


def _symmetric(body: Manifold) -> SurfaceMesh:
    """Return the surface of the side x >= 0 and its mirror image.

    It is simplified before it is mirrored, else it is lopsided. Points that are put on x = 0 may leave a
    crack without width there: then it is simplified otherwise.
    """
    for tolerance_mm in _SIMPLIFY_MM:
        half = (
            body.trim_by_plane(_X_AXIS, 0.0)
            .warp_batch(snapped_to_mirror_plane)
            .simplify(tolerance_mm)
            .warp_batch(snapped_to_mirror_plane)
        )
        mesh = mesh_of(half + half.mirror(_X_AXIS))
        if not manifold_fault(mesh):
            break
    return mesh


def transition_mm(web: SurfaceMesh, scene: Scene) -> float:
    """Return a web's minimum axial thickness around its journals, on the half turned to the other one, mm.

    Rays parallel to the crank axis on a circle just outside each journal; what a force takes from one journal
    to the other crosses that half circle. It is 0 where a ray meets no material.
    """
    body = solid_of(web, "web")
    low, high = scene.web_z_mm[0] - _BEYOND_MM, scene.web_z_mm[1] + _BEYOND_MM
    throw = scene.throw
    angles = np.linspace(-np.pi / 2, np.pi / 2, _RAYS + 2)[1:-1]
    least = np.inf
    for journal, centre, side in ((throw.main_journal, 0.0, 1.0), (throw.crankpin, throw.radius_mm, -1.0)):
        radius = _OUTSIDE * journal.radius_mm
        for angle in angles:
            place = np.zeros(3)
            place[X], place[Y] = radius * np.sin(angle), centre + side * radius * np.cos(angle)
            if _in_other_bore(place, scene):
                continue
            hits = body.ray_cast((place[X], place[Y], low), (place[X], place[Y], high))
            cuts = np.array([hit.position[Z] for hit in hits]).reshape(-1, 2)
            least = min(least, float(np.diff(cuts).sum()))
    return least


def _in_other_bore(place: np.ndarray, scene: Scene) -> bool:
    """Tell whether a place lies in a bore of an overlapping journal, which is no fault of the web."""
    return any(
        np.hypot(place[X], place[Y] - centre) <= _OUTSIDE * journal.bore_radius_mm
        for journal, centre in scene.throw.journals
    )


_STEP_FILE = "step.json"
_STEP_FILES = ("web.toml", f"{HALF}.step", f"{HALF}.stl", WEB)
"""Beside it, of a step; the original web may have the surfaces alone."""
_OTHER_CELLS = 0.85
"""Cells of a second optimisation where the first one has no sound surface, over those of the loop."""
_MOST_KEPT = 0.98
"""Largest volume fraction of a step: a little goes even where the re-model lost more than planned."""


class StepWeb(NamedTuple):
    """A finished step, with its design and solids."""

    step: LoopStep
    scene: Scene
    solids: Solids

    def body(self) -> ShownBody:
        """Return the half throw as the page shows it."""
        name = f"step {self.step.number}" if self.step.number else "original web"
        mesh = with_bolted(self.solids.half, self.scene)
        return ShownBody(name, mesh, self.scene.web_z_mm, self.scene.pitch_mm / 2)


class _KeptStep(Result):
    """Content of step.json, of a finished step."""

    step: LoopStep
    scene: dict[str, Any]


def finished_step(folder: Path) -> StepWeb | None:
    """Return a step that an earlier go of the loop finished."""
    path = folder / _STEP_FILE
    if not path.is_file():
        return None
    kept = _KeptStep.read(unchanged_result(path))
    return StepWeb(kept.step, scene_from_dict(kept.scene, str(path)), read_solids(folder))


def _kept(web: StepWeb, folder: Path) -> StepWeb:
    """Write the file that says that a step is finished."""
    kept = _KeptStep(step=web.step, scene=web.scene.model_dump(mode="json"))
    beside = [name for name in _STEP_FILES if (folder / name).is_file()]
    write_recorded(folder / _STEP_FILE, json_file_text(kept.as_json(), _STEP_FILE), beside)
    return web


def original_web(run: RunStore, scene: Scene, settings: Settings) -> StepWeb:
    """Write and evaluate the original web, which is step 0."""
    note("evaluating the original web")
    folder = run.path / "original"
    folder.mkdir(exist_ok=True)
    file = original_file(scene)
    solids = write_original(file, scene, folder) if file else write_solids(scene, folder, run.started())
    step = step_of(0, _evaluated(scene, settings, file), transition_mm(solids.web, scene))
    return _kept(StepWeb(step, scene, solids), folder)


def make_step(
    run: RunStore, folder: Path, number: int, webs: Sequence[StepWeb], settings: Settings
) -> StepWeb:
    """Optimise in the last solid, extract, re-model, evaluate; step.json is written last."""
    began, design = time.monotonic(), webs[0].scene
    folder.mkdir(exist_ok=True)
    bounded, fraction = _bounded(folder, number, webs, settings)
    note(f"removing {100 * (1 - fraction):.0f} % of the envelope")
    with Companion(FIT_LIBRARIES) as beside:
        surface = _sound_surface(folder, bounded, beside)
        note("re-modelling")
        fitted = fit_web(surface, bounded, fit_limits(bounded, settings.limits), beside)
        near = beside.begin(web_overlap, fitted.scene, surface)
        scene = step_scene(design, fitted.scene, number)
        write_text(folder / "web.toml", toml_text(scene, f"Step {number} of the loop over {design.name}"))
        solids = write_solids(scene, folder, run.started())
        note("evaluating")
        found = _evaluated(scene, settings)
        thickness, removed = transition_mm(solids.web, scene), 100 * (1 - fraction)
        undercuts = shaped_undercuts(solids.half, scene)
        overlap = 100 * near()
    step = step_of(number, found, thickness, overlap, removed, time.monotonic() - began, undercuts)
    return _kept(StepWeb(step, scene, solids), folder)


def step_scene(design: Scene, fitted: Scene, number: int) -> Scene:
    """Return the design with the web of a step, and the ranges that this web leaves `shape`."""
    own = {"web": fitted.web, "shape": fitted.shape, "name": f"{design.name}-step-{number}"}
    return design.model_copy(update={**own, "published": None, "original": None})


def _bounded(folder: Path, number: int, webs: Sequence[StepWeb], settings: Settings) -> tuple[Scene, float]:
    """Return the design inside the last re-modelled solid, and the share of it that stays."""
    scene = webs[0].scene
    volume = _envelope_mm3(scene)
    share = scene.optimise.volume_fraction
    target = volume * share ** (number / settings.steps)
    if number > 1:
        volume = web_volume_mm3(webs[-1].scene)
        before = folder.parent / f"step-{number - 1:02d}"
        path = before / _ENVELOPE
        if status_of(folder / _OPTIMISE) is None:  # else its run has the hash of it
            write_envelope(webs[-1].solids.web, before)
        envelope = StlEnvelope(shape="stl", file=str(path.resolve()), symmetric=True)
        if own := scene.envelope:
            envelope = envelope.model_copy(update={"frozen": own.frozen, "removable": own.removable})
        scene = scene.model_copy(update={"envelope": envelope})
    fraction = min(target / volume, _MOST_KEPT)
    return scene.with_effect("bound", "off").with_optimise(volume_fraction=fraction), fraction


def _envelope_mm3(scene: Scene) -> float:
    """Return the designable volume of one web."""
    domain = stage.prepare(scene).domain
    return float((domain.design_fraction * domain.volume_mm3).sum()) / domain.symmetry_fraction / 2


def _sound_surface(folder: Path, scene: Scene, beside: Companion) -> SurfaceMesh:
    """Return the surface of an optimisation, on other cells where it is not sound on those of the loop."""
    try:
        return optimised_surface(folder / _OPTIMISE, scene, beside)
    except CranktopoError as error:
        if error.code != ExitCode.CRITERION_NOT_MET:
            raise
        cell = round(_OTHER_CELLS * scene.optimise.resolution_mm, 6)
        note(f"{error.message} Once more on cells of {cell:.4g} mm.")
        finer = scene.with_optimise(resolution_mm=cell)
        return optimised_surface(folder / f"{_OPTIMISE}-again", finer, beside)


def optimised_surface(folder: Path, scene: Scene, beside: Companion) -> SurfaceMesh:
    """Return the surface of the half throw of an optimisation, continued or read where it was begun or done.

    It is as its file holds it: a loop that is continued gives the same webs as one in a single go.
    """
    path, status = folder / "web.stl", status_of(folder)
    if status == "done":
        run = open_run(folder)
        run.require_same_inputs()
        refusal = RunMetrics.read(result_file(run)).refusal
        if refusal:
            raise _no_surface(folder, refusal)
        return read_half_throw(unchanged(path), scene)
    if status:
        done = resume_optimisation(str(folder), beside=beside)
    else:
        text = toml_text(scene, "One step of a loop")
        with silent():
            done = optimise_design(scene, folder, text, ["cranktopo", "iterate"], beside=beside)
    if done.half_throw is None:
        raise _no_surface(folder, done.metrics.refusal)
    return half_throw_of(done.half_throw, path, scene)


def _no_surface(folder: Path, refusal: str) -> CranktopoError:
    return CranktopoError(
        f"{folder}: the optimised web has no sound surface. {refusal}",
        hint="Run the loop on other cells: --resolution-mm.",
        code=ExitCode.CRITERION_NOT_MET,
    )


def _evaluated(scene: Scene, settings: Settings, file: Path | None = None) -> Evaluation:
    kept: tuple[Feature, ...] = ("bores", "fillets") if file else ()
    with silent():
        return evaluate(Target(scene.name, planned_scene(scene, kept), file), settings.element_size_mm)
