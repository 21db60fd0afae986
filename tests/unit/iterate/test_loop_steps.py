"""Steps of the loop: thickness beside the journals, verdicts, the envelope of the next step."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from manifold3d import Manifold

from cranktopo.base.companion import Companion
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import pace_of, redirected
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.envelope_file import envelope_from_file, mirror_difference
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.goal.outcome import GoalWords
from cranktopo.design.loading import load_scene, parse_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.runs.directories import RunStore
from cranktopo.tasks.extraction.result import ShapedUndercuts
from cranktopo.tasks.iterate import loop, one_step
from cranktopo.tasks.iterate.one_step import (
    Solids,
    StepWeb,
    make_step,
    read_solids,
    step_scene,
    transition_mm,
    write_envelope,
    write_solids,
)
from cranktopo.tasks.iterate.result import LoopStep, ShapeOutcome, best_step, loop_settings, verdict
from cranktopo.tasks.iterate.shape_step import ShapeStep
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.envelope import StlEnvelope
from cranktopo.throw.manufacturing_limits import ProcessLimits
from tests.hostile.featured_engines import featured_engine
from tests.unit.extraction.surface_cases import scene_with
from tests.unit.refit.remodel_cases import WHOLE, known_scene


def block(*voids: Manifold) -> SurfaceMesh:
    body = Manifold.cube((60, 100, 19)).translate((-30, -26, 20))
    for void in voids:
        body -= void
    return mesh_of(body)


@pytest.mark.parametrize(
    ("void", "thickness"),
    [
        (Manifold.cube((1, 1, 1)).translate((100, 0, 0)), 19.0),
        (Manifold.cube((8, 8, 9)).translate((12, 12, 30)), 10.0),  # a pocket beside the main journal, x > 0
        (Manifold.cube((8, 8, 5)).translate((-20, 28, 20)), 14.0),  # beside the pin, x < 0, other face
        (Manifold.cube((60, 10, 9)).translate((-30, -26, 20)), 19.0),  # behind the main journal: no load path
        (Manifold.cylinder(60, 4, 4, 64).translate((0, 22, 0)), 0.0),  # a window
        (Manifold.cylinder(60, 12, 12, 64), 19.0),  # the journal's own bore
    ],
    ids=["whole", "pocket", "pin", "behind", "window", "bore"],
)
def test_thickness_beside_the_journals(void: Manifold, thickness: float) -> None:
    assert transition_mm(block(void), scene_with()) == pytest.approx(thickness, abs=1e-6)


def step(number: int, mass: float, torsion: float, bending: float, transition: float = 12.0) -> LoopStep:
    return LoopStep(
        number=number,
        throw_kg=mass,
        web_kg=mass / 3,
        torsion_Nm_per_rad=torsion,
        bending_N_per_mm=bending,
        torsion_error_percent=0.4,
        bending_error_percent=0.6,
        transition_mm=transition,
        overlap_percent=95.0,
        removed_percent=10.0,
        seconds=1.0,
    )


ORIGINAL = step(0, 1.6, 1600.0, 230.0)


def test_verdicts() -> None:
    heavy, better = step(1, 2.0, 2100.0, 300.0), step(2, 1.5, 1650.0, 240.0)
    assert verdict([ORIGINAL, heavy], 7.0) == "better"
    assert verdict([ORIGINAL, heavy, better], 7.0) == "better"
    assert verdict([ORIGINAL, heavy, better, step(3, 1.4, 1540.0, 231.0)], 7.0) == "no gain"
    assert verdict([ORIGINAL, heavy, better.model_copy(update={"transition_mm": 6.9})], 7.0) == "too thin"


def test_best_is_no_heavier_and_no_softer() -> None:
    heavy, soft = step(1, 1.7, 2000.0, 300.0), step(2, 1.2, 1500.0, 229.0)
    good, better = step(3, 1.55, 1650.0, 231.0), step(4, 1.5, 1640.0, 235.0)
    thin = step(5, 1.3, 1600.0, 235.0, 3.0)
    assert best_step([ORIGINAL, heavy, soft, good, better, thin], 7.0) == better
    assert best_step([ORIGINAL, heavy, soft], 7.0) is None
    share = better.percent_of(ORIGINAL)
    assert share["mass"] == pytest.approx(93.75)
    assert share["torsion_per_mass"] == pytest.approx(100 * (1640 / 1.5) / 1000)
    assert share["bending_per_mass"] == pytest.approx(100 * (235 / 1.5) / (230 / 1.6))


def undercuts(process: str, released: bool) -> ShapedUndercuts:
    volume, held = (0.0, None) if released else (51.0, "web.pocket[0]")
    return ShapedUndercuts(volume_mm3=volume, released=released, process=process, held_by=held)


def test_best_can_be_made() -> None:
    """A web that the die holds is never the best; one of a free process may be held, nobody asked."""
    good, better = step(1, 1.55, 1650.0, 231.0), step(2, 1.5, 1640.0, 235.0)
    held = better.model_copy(update={"undercuts": undercuts("forged", False)})
    assert best_step([ORIGINAL, good, held], 7.0) == good
    assert best_step([ORIGINAL, held], 7.0) is None
    for allowed in (undercuts("forged", True), undercuts("free", False)):
        kept = better.model_copy(update={"undercuts": allowed})
        assert best_step([ORIGINAL, good, kept], 7.0) == kept


class _FittedError(Exception):
    """Ends a step where its fit would begin."""


def test_a_step_is_fitted_within_what_its_process_allows(
    tmp_path: Path, mikron: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A lateral die opens pockets from the sides alone, with its draft; a mill needs its radius."""
    seen: list[ProcessLimits] = []

    def fit(surface: SurfaceMesh, scene: Scene, limits: ProcessLimits, beside: Companion) -> None:
        seen.append(limits)
        raise _FittedError

    monkeypatch.setattr(one_step, "optimised_surface", lambda folder, scene, beside: block())
    monkeypatch.setattr(one_step, "fit_web", fit)
    for asked in ({"process": "forged", "draft_deg": 4.0}, {"process": "milled", "tool_radius_mm": 8.0}):
        scene = mikron.with_optimise(**asked)
        web = StepWeb(ORIGINAL, scene, Solids(block(), block()))
        with pytest.raises(_FittedError):
            make_step(RunStore(tmp_path), tmp_path / asked["process"], 1, [web], loop_settings(scene))
    forged, milled = seen
    assert forged.opens == "sides"
    assert forged.min_draft_deg == 4.0
    assert milled.pocket_radius_mm == 8.0


def _unsound(folder: Path, code: ExitCode) -> CranktopoError:
    return CranktopoError(f"{folder.name}: the optimised web has no sound surface.", code=code)


@pytest.mark.parametrize(
    ("failures", "code", "folders"),
    [
        (0, ExitCode.CRITERION_NOT_MET, ["optimise"]),
        (1, ExitCode.CRITERION_NOT_MET, ["optimise", "optimise-again"]),
        (2, ExitCode.CRITERION_NOT_MET, ["optimise", "optimise-again"]),
        (1, ExitCode.SOLVER, ["optimise"]),
    ],
)
def test_a_step_without_a_sound_surface_is_optimised_on_other_cells(
    tmp_path: Path,
    mikron: Scene,
    monkeypatch: pytest.MonkeyPatch,
    failures: int,
    code: ExitCode,
    folders: list[str],
) -> None:
    """Once; what fails for another reason is not tried again."""
    tried: list[tuple[str, float]] = []

    def optimised(folder: Path, scene: Scene, beside: Companion) -> SurfaceMesh:
        tried.append((folder.name, scene.optimise.resolution_mm))
        if len(tried) <= failures:
            raise _unsound(folder, code)
        raise _FittedError

    monkeypatch.setattr(one_step, "optimised_surface", optimised)
    lost = failures == 2 or code == ExitCode.SOLVER
    with pytest.raises(CranktopoError if lost else _FittedError, match=folders[-1] if lost else None):
        make_step(
            RunStore(tmp_path),
            tmp_path / "step-01",
            1,
            [StepWeb(ORIGINAL, mikron, Solids(block(), block()))],
            loop_settings(mikron),
        )
    assert [name for name, _ in tried] == folders
    assert tried[-1][1] == pytest.approx(mikron.optimise.resolution_mm * 0.85 ** (len(tried) - 1))


def test_the_design_of_a_step_can_be_read_where_its_web_is_wider_than_a_free_counterweight() -> None:
    """`iterate car-diesel` wrote a step that nothing could read: its web holds the least of the range."""
    design = load_scene("car-diesel")
    web: dict[str, Any] = {
        "thickness_mm": 18.0,
        "outline": "tapered",
        "main_radius_mm": 48.0,
        "pin_radius_mm": 35.0,
    }
    web["counterweight"] = {"outer_radius_mm": 66.0, "half_angle_deg": 65.0}
    scene = step_scene(design, scene_with_web(design, web), 1)
    assert scene.shape.free.counterweight_radius_mm[0] > 48.0
    assert parse_scene(toml_text(scene, "step")).web == scene.web


def test_a_symmetric_mesh_is_the_box_it_shows(tmp_path: Path, mikron: Scene) -> None:
    box = trimesh.creation.box(bounds=[[-48, -34, 10], [48, 82, 45]])
    box.export(tmp_path / "box.stl")
    envelope = StlEnvelope(shape="stl", file=str(tmp_path / "box.stl"), symmetric=True)
    domain = build_domain(mikron.model_copy(update={"envelope": envelope}), 6.0)
    expected = build_domain(mikron, 6.0)
    assert domain.extent == "quarter"
    np.testing.assert_allclose(domain.design_fraction, expected.design_fraction, atol=1e-9)


def test_a_lopsided_mesh_said_to_be_symmetric_is_refused(tmp_path: Path, mikron: Scene) -> None:
    trimesh.creation.box(bounds=[[-48, -34, 10], [47, 82, 45]]).export(tmp_path / "box.stl")
    envelope = StlEnvelope(shape="stl", file=str(tmp_path / "box.stl"), symmetric=True)
    with pytest.raises(CranktopoError, match=r"envelope\.symmetric .* differ by"):
        build_domain(mikron.model_copy(update={"envelope": envelope}), 6.0)


@pytest.mark.slow
def test_the_envelope_of_a_fitted_web_is_its_own_mirror_image(tmp_path: Path, mikron: Scene) -> None:
    """Bevels, slots and holes: what is simplified after it was mirrored is not."""
    path = write_envelope(write_solids(known_scene(mikron, WHOLE), tmp_path).web, tmp_path)
    assert trimesh.load_mesh(path).is_watertight
    assert mirror_difference(envelope_from_file(path)) < 1e-9


@pytest.mark.slow
def test_an_envelope_with_a_crack_is_simplified_otherwise(
    tmp_path: Path, mikron: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    web = write_solids(known_scene(mikron, WHOLE), tmp_path).web
    usual = write_envelope(web, tmp_path).rename(tmp_path / "usual.stl")
    faults = ["touches itself", ""]
    monkeypatch.setattr(one_step, "manifold_fault", lambda mesh: faults.pop(0))
    path = write_envelope(web, tmp_path)
    assert not faults
    assert path.read_bytes() != usual.read_bytes()
    assert trimesh.load_mesh(path).is_watertight
    assert mirror_difference(envelope_from_file(path)) < 1e-9
    assert trimesh.load_mesh(path).volume == pytest.approx(trimesh.load_mesh(usual).volume, rel=1e-4)


def test_the_solid_of_a_step_is_the_next_envelope(tmp_path: Path, mikron: Scene) -> None:
    """Volume of the envelope on the grid against the closed form of the web."""
    path = write_envelope(write_solids(mikron, tmp_path).web, tmp_path)
    mesh = trimesh.load_mesh(path)
    assert mesh.is_watertight
    assert mirror_difference(envelope_from_file(path)) < 1e-9
    exact = web_volume_mm3(mikron)
    assert mesh.volume == pytest.approx(exact, rel=2e-3)
    envelope = StlEnvelope(shape="stl", file=str(path), symmetric=True)
    domain = build_domain(mikron.model_copy(update={"envelope": envelope}), 3.0)
    assert float(
        (domain.design_fraction * domain.volume_mm3).sum()
    ) / domain.symmetry_fraction / 2 == pytest.approx(exact, rel=4e-3)
    assert transition_mm(read_solids(tmp_path).web, mikron) == pytest.approx(19.0, abs=1e-4)


@pytest.mark.parametrize("name", ["car-diesel", pytest.param("industrial-gas", marks=pytest.mark.slow)])
def test_the_next_envelope_holds_the_counterweight(name: str, tmp_path: Path) -> None:
    """Its facets lie inside the rim, and its flanks are rounded to single precision."""
    scene = load_scene(name)
    path = write_envelope(write_solids(scene, tmp_path).web, tmp_path)
    inside = scene.model_copy(update={"envelope": StlEnvelope(shape="stl", file=str(path), symmetric=True)})
    assert build_domain(inside, 8.0).design_fraction.sum() > 0
    heavy = inside.web.counterweight
    assert heavy is not None
    wider = heavy.model_copy(update={"outer_radius_mm": 1.005 * heavy.outer_radius_mm})
    larger = inside.model_copy(update={"web": inside.web.model_copy(update={"counterweight": wider})})
    with pytest.raises(CranktopoError, match="reaches beyond the design space"):
        build_domain(larger, 8.0)


def test_the_next_envelope_holds_a_drilling_that_crosses_a_bore(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The web's solid has the bores as holes, in which no wall is around a drilling."""
    # Whether the envelope holds it is asked before the cells lose it, which takes longer.
    monkeypatch.setattr("cranktopo.bodies.cells.drilled._slabs", lambda *_: ())
    scene = scene_from_dict(featured_engine(35))
    path = write_envelope(write_solids(scene, tmp_path).web, tmp_path)
    inside = scene.model_copy(update={"envelope": StlEnvelope(shape="stl", file=str(path), symmetric=True)})
    bore = drill_bores(scene)[0].surface_mm(0.0)
    assert (np.hypot(*bore[:, :2].T) < scene.throw.main_journal.bore_radius_mm).any()
    assert build_domain(inside, 12.0).design_fraction.sum() > 0


def test_how_far_the_loop_is_counts_the_shape_optimisation(
    tmp_path: Path, mikron: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A bar of all parts, the shape the last of them, with the time left once a step has told its own."""
    told: list[str] = []

    def made(*given: Any) -> StepWeb:
        return StepWeb(step(given[2], 1.6 - 0.1 * given[2], 1600.0, 230.0), mikron, Solids(block(), block()))

    def handed_over(*given: Any) -> ShapeStep:
        return ShapeStep(None, ShapeOutcome(found=False, reason="", goal=GoalWords(minimise="mass")))

    first = StepWeb(ORIGINAL, mikron, Solids(block(), block()))
    stand_ins = {"original_web": lambda *given: first, "make_step": made, "shape_step": handed_over}
    stand_ins |= {"write_report": lambda *given: None, "bounds_for_result": lambda *given: None}
    for name, stand_in in stand_ins.items():
        monkeypatch.setattr(loop, name, stand_in)
    settings = replace(loop_settings(mikron), steps=2)
    with redirected(told.append):
        loop.start_loop(mikron, settings, tmp_path / "loop")
    assert [pace for line in told if (pace := pace_of(line))] == [
        (0.0, ""),
        (1 / 3, "about 2 s"),
        (2 / 3, "about 1 s"),
    ]
