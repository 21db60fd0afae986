"""Bodies from CAD in the commands that designs go through: fillets found on them, shafts made of them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import redirected
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.tasks.importing.found_fillets import ring_of
from cranktopo.tasks.importing.imported_body import fillets_of_step, half_throw_surface, mesh_step_for_stress
from cranktopo.tasks.throw_fatigue.needs import check_inputs
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fea.targets import Target, simulated
from tests.physics.fea.evaluation_cases import LOPSIDED, mikron_with

Capture = pytest.CaptureFixture[str]


def with_fillets(main_mm: float, pin_mm: float, **web: Any) -> Scene:
    scene = mikron_with(2.5, **web)
    throw = scene.throw
    radii = (("main_journal", main_mm), ("crankpin", pin_mm))
    journals = {key: getattr(throw, key).model_copy(update={"fillet_mm": radius}) for key, radius in radii}
    return scene.model_copy(update={"throw": throw.model_copy(update=journals)})


@pytest.fixture(scope="module")
def step_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Scene, str], Path]:
    def write(scene: Scene, name: str) -> Path:
        path = tmp_path_factory.mktemp("bodies") / f"{name}.step"
        export_solid(scene, "half", path)
        return path

    return write


def radii_of(scene: Scene) -> tuple[float, float]:
    return scene.throw.main_journal.fillet_mm, scene.throw.crankpin.fillet_mm


def test_a_torus_is_known_by_its_points() -> None:
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(0.3, 1.9, 5), np.linspace(-1.0, 2.0, 7)))
    out = 23.0 + 2.5 * np.cos(u)
    points = np.stack([out * np.sin(v), 48.0 + out * np.cos(v), 41.5 + 2.5 * np.sin(u)], axis=1)
    found = ring_of(points, 48.0)
    assert found is not None
    assert (found.centre_radius_mm, found.centre_z_mm) == pytest.approx((23.0, 41.5), abs=1e-9)
    assert vars(found.section) == pytest.approx(
        {"radial_mm": 2.5, "axial_mm": 2.5, "recess_mm": 0.0}, abs=1e-9
    )
    assert found.section.round
    assert ring_of(points, 0.0) is None
    assert ring_of(points * [1.0, 1.0, 0.0], 48.0) is None


def test_an_ellipse_is_known_by_its_points() -> None:
    """Turned about the pin's axis; one whose axes are not along the crank and across is none."""
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(3.2, 4.6, 7), np.linspace(-1.0, 2.0, 7)))
    out, z = 23.0 + 2.5 * np.cos(u), 41.5 + 4.0 * np.sin(u)
    found = ring_of(np.stack([out * np.sin(v), 48.0 + out * np.cos(v), z], axis=1), 48.0)
    assert found is not None
    assert (found.centre_radius_mm, found.centre_z_mm) == pytest.approx((23.0, 41.5), abs=1e-6)
    assert vars(found.section) == pytest.approx(
        {"radial_mm": 2.5, "axial_mm": 4.0, "recess_mm": 0.0}, abs=1e-6
    )
    tilted = out + 0.3 * (z - 41.5)
    assert ring_of(np.stack([tilted * np.sin(v), 48.0 + tilted * np.cos(v), z], axis=1), 48.0) is None


@pytest.mark.slow
def test_elliptical_fillets_are_the_body_s(step_of: Callable[..., Path], mikron: Scene) -> None:
    round_, flat = with_fillets(3.25, 1.75), {"fillet_axial_mm": 3.0}
    pin = round_.throw.crankpin.model_copy(update=flat)
    scene = round_.model_copy(update={"throw": round_.throw.model_copy(update={"crankpin": pin})})
    found = fillets_of_step(step_of(scene, "flat"), mikron).throw
    assert (found.main_journal.fillet_mm, found.main_journal.fillet_axial_mm) == (3.25, None)
    assert vars(found.crankpin.fillet) == pytest.approx(
        {"radial_mm": 1.75, "axial_mm": 3.0, "recess_mm": 0.0}, abs=1e-6
    )


@pytest.mark.usefixtures("kernel_here")
def test_fillets_are_the_body_s_and_not_the_design_s(step_of: Callable[..., Path], mikron: Scene) -> None:
    path = step_of(with_fillets(3.25, 1.75), "other")
    assert radii_of(fillets_of_step(path, mikron)) == (3.25, 1.75)


@pytest.mark.slow
def test_fillets_that_another_program_rolled(mikron: Scene, tmp_path: Path) -> None:
    """Edges of a sharp body rounded by the kernel, not turned with the journals as this program does it."""
    path, rings = tmp_path / "rolled.step", ((0.0, mikron.web_z_mm[0]), (48.0, mikron.web_z_mm[1]))
    with cad_session("rolled") as gmsh:
        (body,) = add_half_throw(gmsh.model.occ, mikron_with(0.0))
        gmsh.model.occ.synchronize()
        edges = []
        for dim, tag in gmsh.model.getEntities(1):
            low, high = gmsh.model.getParametrizationBounds(dim, tag)
            points = gmsh.model.getValue(dim, tag, np.linspace(low[0], high[0], 9)).reshape(-1, 3)
            for y, z in rings:
                wanted = np.column_stack([np.full(9, 21.0), np.full(9, z)])
                found = np.column_stack([np.hypot(points[:, 0], points[:, 1] - y), points[:, 2]])
                edges += [tag] if np.allclose(found, wanted, atol=1e-6) else []
        gmsh.model.occ.fillet([body[1]], edges, [2.0])
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    assert radii_of(fillets_of_step(path, mikron)) == (2.0, 2.0)


@pytest.mark.usefixtures("kernel_here")
@pytest.mark.parametrize(
    ("main_mm", "pin_mm", "where"),
    [(0.0, 2.5, "main journal"), pytest.param(2.5, 0.0, "crankpin", marks=pytest.mark.slow)],
)
def test_a_sharp_body_is_refused(
    main_mm: float, pin_mm: float, where: str, step_of: Callable[..., Path], mikron: Scene
) -> None:
    path = step_of(with_fillets(main_mm, pin_mm), "sharp")
    with pytest.raises(CranktopoError, match=f"no fillet found at the {where}.*singular"):
        check_inputs(Target("sharp.step", mikron, path), "lsa", "extremes")


@pytest.mark.usefixtures("kernel_here")
def test_a_fillet_elsewhere_is_named(step_of: Callable[..., Path], mikron: Scene) -> None:
    """A design whose web begins 0.5 mm later than the body's: found is where the fillet ends."""
    journal = mikron.throw.main_journal.model_copy(update={"length_mm": 41.0})
    web = mikron.web.model_copy(update={"thickness_mm": 18.5})
    throw = mikron.throw.model_copy(update={"main_journal": journal})
    other = mikron.model_copy(update={"throw": throw, "web": web})
    path = step_of(mikron, "body")
    with pytest.raises(
        CranktopoError, match=r"z = 20\.5 mm: one of 2\.5 mm runs from 42 mm diameter to z = 20 mm"
    ):
        fillets_of_step(path, other)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("web", "mirrored"),
    [({}, True), ({"pocket": [LOPSIDED]}, False)],
)
def test_symmetric_bodies_are_halved(
    web: dict[str, Any], mirrored: bool, step_of: Callable[..., Path], mikron: Scene
) -> None:
    """The lopsided body's design says nothing of its hole: only the body can tell."""
    meshed, _ = mesh_step_for_stress(step_of(mikron_with(2.5, **web), "body"), mikron, 12.0, 2.0)
    assert meshed.mesh.mirrored is mirrored
    assert (meshed.mesh.points_mm[0].min() > -1e-6) == mirrored


@pytest.mark.slow
def test_stresses_of_a_body_are_those_of_its_design(step_of: Callable[..., Path], mikron: Scene) -> None:
    """Coarse and the same solid, meshed once from the design and once from its file."""
    scene = simulated(mikron, fillets=True)
    path = step_of(scene, "body")
    design, body = (solve_stresses(Target("body", scene, file), ("torsion",), 0.5) for file in (None, path))
    assert body.throw_kg == pytest.approx(design.throw_kg, rel=1e-9)
    for on in ("on_journal", "on_pin"):
        peaks = [np.abs(m.stress.stress_MPa[0][getattr(m, on)]).max() for m in (design, body)]
        assert peaks[1] == pytest.approx(peaks[0], rel=0.06)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["--design", "mikron-iiic-plain", "--method", "m53"],
            "method 'm53' needs the width and the outline",
        ),
        ([], "Add --design NAME"),
    ],
)
def test_what_fatigue_needs_of_a_body(
    arguments: list[str], message: str, step_of: Callable[..., Path], mikron: Scene, capsys: Capture
) -> None:
    assert main(["fatigue", str(step_of(mikron, "body")), *arguments]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_the_shaft_of_a_body_is_that_of_its_design(
    step_of: Callable[..., Path], mikron: Scene, capsys: Capture
) -> None:
    path = step_of(simulated(mikron), "body")
    found = []
    for arguments in (["mikron-iiic-plain"], [str(path), "--design", "mikron-iiic-plain"]):
        assert main(["shaft", *arguments, "--element-size-mm", "26", "--json", "--quiet"]) == 0
        found.append(json.loads(capsys.readouterr().out))
    design, body = found
    assert body["design"] == "body.step"
    assert body["mass_kg"] == pytest.approx(design["mass_kg"], rel=1e-6)
    stiffness = [data["torsion"]["end_to_end_Nm_per_rad"] for data in found]
    assert stiffness[1] == pytest.approx(stiffness[0], rel=0.02)
    assert body["natural_frequencies_Hz"] == pytest.approx(design["natural_frequencies_Hz"], rel=0.01)


@pytest.mark.usefixtures("kernel_here")
def test_the_surface_of_a_body_is_closed_and_ends_on_its_planes(
    step_of: Callable[..., Path], mikron: Scene
) -> None:
    """What a comparison shows of it, and where rays look for undercuts."""
    mesh = half_throw_surface(step_of(mikron, "body"), mikron)
    assert mesh.as_trimesh().is_watertight
    assert mesh.volume_mm3 == pytest.approx(half_throw_volume_mm3(mikron), rel=5e-4)
    z = mesh.vertices_mm[:, 2]
    assert (z.min(), z.max()) == (0.0, mikron.pitch_mm / 2)


@pytest.mark.usefixtures("kernel_here")
def test_a_step_of_two_parts_is_no_body(tmp_path: Path, mikron: Scene) -> None:
    path = tmp_path / "two.step"
    with cad_session("two") as gmsh:
        for x in (0, 50):
            gmsh.model.occ.addBox(x, 0, 0, 10, 10, 10)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    with pytest.raises(CranktopoError, match="2 solids"):
        fillets_of_step(path, mikron)


@pytest.mark.usefixtures("kernel_here")
def test_smaller_elements_are_taken_where_the_asked_ones_make_no_mesh(
    mikron: Scene, step_of: Callable[[Scene, str], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file is read again for every try, as gmsh stays locked after an error."""
    import gmsh

    real, tried, told = gmsh.model.mesh.generate, list[int](), list[str]()

    def generate(dimension: int) -> None:
        tried.append(dimension)
        if len(tried) <= 2:
            raise Exception("Invalid boundary mesh")
        real(dimension)

    monkeypatch.setattr(gmsh.model.mesh, "generate", generate)
    path = step_of(mikron_with(2.5), "body")
    with redirected(told.append):
        meshed, _ = mesh_step_for_stress(path, mikron, 15.0, 2.0)
    assert meshed.element_size_mm == pytest.approx(12.0)
    assert any("body.step: no mesh with elements of 15 mm; taken are 12 mm" in line for line in told)
