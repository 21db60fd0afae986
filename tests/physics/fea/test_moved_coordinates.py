"""A body from CAD whose coordinates are off by rounding has web, halves and sides of the exact one."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo import load_scene
from cranktopo.base.notes import redirected
from cranktopo.bodies.solid.checked import NotCutError, check_parts
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.solid.step import step_solid
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.tasks.importing import imported_body
from cranktopo.tasks.importing.cad_body import REACH, between_planes, halves_apart, sides_alike
from cranktopo.tasks.importing.imported_body import mesh_file

_POINT = re.compile(r"(CARTESIAN_POINT\('[^']*',\()([^)]*)(\))")
_LOST = (0, 2, 3, 13)
"""Seeds at which a box in the planes of the web's faces found nothing."""
_QUICK = _LOST[::2]
_SEEDS = [seed if seed in _QUICK else pytest.param(seed, marks=pytest.mark.slow) for seed in range(24)]


def moved(text: str, seed: int, noise_mm: float = 5e-9) -> str:
    """Return a STEP file whose coordinates are off by a share of 1e-12 to 1e-10, or by a length."""
    random = np.random.default_rng(seed)
    share, length = (0.0, 1e-12, 1e-11, 1e-10)[seed % 4], 0.0 if seed % 4 else noise_mm

    def noisy(found: re.Match[str]) -> str:
        values = [float(value) for value in found[2].split(",")]
        off = [v * (1 + share * random.uniform(-1, 1)) + length * random.uniform(-1, 1) for v in values]
        return found[1] + ",".join(map(repr, off)) + found[3]

    return _POINT.sub(noisy, text)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene("mikron-iiic-plain")


@pytest.fixture(scope="module")
def moved_step(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """A function that writes the moved half throw, or another text, and returns its path."""
    folder = tmp_path_factory.mktemp("moved")
    export_solid(scene, "half", folder / "half.step")
    text = (folder / "half.step").read_text(encoding="ascii")

    def write(seed: int, noise_mm: float = 5e-9, of: str = text) -> Path:
        path = folder / f"moved-{seed}.step"
        path.write_text(moved(of, seed, noise_mm), encoding="ascii")
        return path

    return write


@pytest.mark.parametrize("seed", _SEEDS)
def test_the_web_is_that_of_the_exact_body(scene: Scene, moved_step: Callable[..., Path], seed: int) -> None:
    path = moved_step(seed)
    with cad_session("moved") as gmsh:
        found = imported_body._solid(gmsh, path, scene, align=False)
    assert found.web_mm3 == pytest.approx(web_volume_mm3(scene), rel=1e-8)


@pytest.mark.usefixtures("kernel_here", "fine_triangles")
def test_where_the_kernel_loses_a_part_triangles_tell_the_web(
    scene: Scene, moved_step: Callable[..., Path]
) -> None:
    """Noise beyond the kernel's own tolerance of 1e-7 mm: the part of the crankpin is lost."""
    lines: list[str] = []
    with redirected(lines.append):
        meshed = mesh_file(moved_step(12, 1e-6), scene, 15.0)
    assert any("cannot cut out its web exactly: its mass is that of triangles" in line for line in lines)
    assert meshed.web_volume_mm3 == pytest.approx(web_volume_mm3(scene), rel=1e-4)


def joined_throw(path: Path, pitch_mm: float, file: Path) -> str:
    """Return the STEP text of two half throws put together, whose faces still end in the middle."""
    with cad_session("joined") as gmsh:
        gmsh.option.setNumber("Geometry.OCCUnionUnify", 0)
        occ = gmsh.model.occ
        near = [step_solid(gmsh, path, "half")]
        far = occ.copy(near)
        occ.rotate(far, 0.0, 0.0, pitch_mm / 2, 0.0, 1.0, 0.0, np.pi)
        occ.fuse(near, far)
        occ.synchronize()
        gmsh.write(str(file))
    return file.read_text(encoding="ascii")


@pytest.mark.slow
def test_halves_and_sides_are_alike(
    scene: Scene, moved_step: Callable[..., Path], tmp_path: Path, capfd: Any
) -> None:
    del capfd  # the kernel prints as it writes
    half = tmp_path / "half.step"
    volume = export_solid(scene, "half", half)
    text = joined_throw(half, scene.pitch_mm, tmp_path / "joined.step")
    for seed in range(12):
        with cad_session("moved") as gmsh:
            occ = gmsh.model.occ
            body = [step_solid(gmsh, moved_step(seed, of=text), "throw")]
            assert halves_apart(occ, body, scene.pitch_mm) == ""
            near = between_planes(occ, body, -1.0, scene.pitch_mm / 2, REACH * scene.pitch_mm)
            assert occ.getMass(*near[0]) == pytest.approx(volume, rel=1e-7)
            assert sides_alike(occ, near, scene.pitch_mm) or seed % 4 == 0  # else the half is meshed whole


def test_parts_must_add_up() -> None:
    check_parts(99.9999, 100.0, 1e-5)
    with pytest.raises(NotCutError, match=r"its parts have 99\.90 mm3 together, the whole 100\.00 mm3"):
        check_parts(99.9, 100.0)
