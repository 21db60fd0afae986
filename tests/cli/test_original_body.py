"""A body from CAD as the original web: on the cells, in the loop's first step, and where it does not fit."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.base.progress import StageMemory
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.volume import half_throw_volume_mm3, web_volume_mm3
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.scene_files import input_files
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.files import read_stl
from cranktopo.tasks.density.stage import baseline_notice
from cranktopo.tasks.importing.imported_body import read_half_throw
from cranktopo.tasks.importing.original import check_original
from cranktopo.tasks.iterate.one_step import HALF, read_solids, write_original
from cranktopo.tasks.optimise import evaluated_goal
from cranktopo.tasks.optimise.evaluated_goal import EvaluatedGoal
from cranktopo.tasks.throw_fea.evaluation import Evaluation
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.throw_stiffness import Stiffness
from tests.physics.fea.evaluation_cases import LOPSIDED, mikron_with


@pytest.fixture(scope="module")
def body_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    written: dict[tuple[str, str], Path] = {}

    def write(scene: Scene, suffix: str = ".step") -> Path:
        key = scene.model_dump_json(), suffix
        if key not in written:
            written[key] = tmp_path_factory.mktemp("original") / f"body{suffix}"
            export_solid(scene, "half", written[key], 1.0)
        return written[key]

    return write


def naming(scene: Scene, path: Path) -> Scene:
    return scene_from_dict(
        scene.model_dump(mode="json", exclude_none=True) | {"original": {"file": str(path)}}
    )


def web_mm3(scene: Scene, **grid: Any) -> float:
    domain = build_domain(scene, 3.0, "web", **grid)
    return float((domain.web * domain.volume_mm3).sum()) / domain.symmetry_fraction / 2


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".step", ".stl"])
def test_cells_hold_the_web_of_the_body(suffix: str, body_of: Callable[..., Path], mikron: Scene) -> None:
    """A web 6 mm wider than the design's; the fillets lie outside the web."""
    wider = mikron_with(2.5, width_mm=56.0)
    scene = naming(mikron, body_of(wider, suffix))
    check_original(scene)
    assert web_mm3(scene, extent="half") == pytest.approx(web_volume_mm3(wider), rel=2e-3)
    assert web_mm3(mikron, extent="half") == pytest.approx(web_volume_mm3(mikron), rel=2e-3)
    assert "'body" in baseline_notice(scene)
    assert input_files(scene)["original.file"].name == f"body{suffix}"


@pytest.mark.usefixtures("kernel_here")
def test_the_first_step_of_a_loop_is_the_body(
    body_of: Callable[..., Path], mikron: Scene, tmp_path: Path
) -> None:
    wider = mikron_with(2.5, width_mm=56.0)
    path = body_of(wider)
    write_original(path, naming(mikron, path), tmp_path)
    assert read_solids(tmp_path).web.volume_mm3 == pytest.approx(web_volume_mm3(wider), rel=1e-3)
    half = read_stl(tmp_path / f"{HALF}.stl").vertices_mm
    assert (half[:, 2].min(), half[:, 2].max()) == (0.0, mikron.pitch_mm / 2)


@pytest.mark.slow
def test_a_goal_is_measured_against_the_body_without_its_fillets(
    body_of: Callable[..., Path], mikron: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The oracle is the closed form of the volume; with fillets it is 0.36 % more."""
    filleted, sharp = (mikron_with(fillet_mm, pocket=[LOPSIDED]) for fillet_mm in (2.5, 0.0))
    seen = list[float]()

    def evaluated(target: Target, **_: Any) -> Evaluation:
        assert target.file is not None
        assert target.scene.throw.crankpin.fillet_mm == 0
        seen.append(read_half_throw(target.file, target.scene).volume_mm3)
        fine = Stiffness({"free": 100e3}, {"pinned": 70e3}, 1234, 4.0, 1.0, 2.0)
        return Evaluation(target.name, 1.5, 0.6, 5000, 50, fine, "free", "pinned", 0.3, 0.4, 3.0)

    monkeypatch.setattr(evaluated_goal, "evaluate", evaluated)
    unused: Any = None
    case = EvaluatedGoal(unused, naming(mikron, body_of(filleted)), unused, unused, StageMemory())
    assert case.original()["torsion"] == 100e3
    assert seen == [pytest.approx(half_throw_volume_mm3(sharp), rel=3e-4)]
    assert half_throw_volume_mm3(filleted) > 1.003 * half_throw_volume_mm3(sharp)


@pytest.mark.usefixtures("kernel_here")
def test_a_body_elsewhere_is_refused(body_of: Callable[..., Path], mikron: Scene) -> None:
    throw = mikron.throw.model_copy(update={"radius_mm": 44.0})
    with pytest.raises(CranktopoError, match="does not lie where the throw is"):
        check_original(naming(mikron, body_of(mikron.model_copy(update={"throw": throw}))))


@pytest.mark.slow
def test_a_lopsided_body_needs_both_sides(body_of: Callable[..., Path], mikron: Scene) -> None:
    path = body_of(mikron_with(2.5, pocket=[LOPSIDED]))
    with pytest.raises(CranktopoError, match=r"original\.file.*the side x >= 0 only"):
        check_original(naming(mikron, path))
    both = mikron.model_copy(
        update={"effects": mikron.effects.model_copy(update={"lateral_symmetry": "off"})}
    )
    check_original(naming(both, path))


def test_a_file_that_is_gone_is_named(mikron: Scene, tmp_path: Path) -> None:
    with pytest.raises(CranktopoError, match="cannot be read: No such file"):
        check_original(naming(mikron, tmp_path / "gone.step"))
