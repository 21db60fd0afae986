"""The radius of rounded outlets from corners of triangles: of ideal roundings, and of the CAD kernel's."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo import load_scene
from cranktopo.bodies.solid.files import kernel_surface_of
from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.outlet_fit import outlet_radius_mm
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.outlet import DrillOutlet
from cranktopo.throw.drilling.table import drill_bores


def with_outlets(radius_mm: float) -> Scene:
    scene = load_scene("industrial-gas")
    (drilling,) = scene.throw.drilling
    return scene.with_drillings((drilling.model_copy(update={"outlet_radius_mm": radius_mm}),))


def rolled(radius_mm: float) -> np.ndarray:
    """Corners on a rounding, by hand: a drilling of 12 mm straight into a journal of 200 mm."""
    turn, arc = (one.ravel() for one in np.meshgrid(np.linspace(0, 6, 40), np.linspace(0.1, 0.9, 7)))
    wide = 6.0 + radius_mm
    ball = np.stack([wide * np.cos(turn), np.zeros_like(turn), wide * np.sin(turn)], axis=1)
    ball[:, 1] = np.sqrt((100.0 - radius_mm) ** 2 - ball[:, 0] ** 2)
    inward = -np.stack([np.cos(turn), np.zeros_like(turn), np.sin(turn)], axis=1)
    out = ball * [1, 1, 0] / (100.0 - radius_mm)
    way = (1 - arc)[:, None] * inward + arc[:, None] * out
    return np.asarray(ball + radius_mm * way / np.linalg.norm(way, axis=1)[:, None])


@pytest.mark.parametrize("radius_mm", [0.8, 2.0, 5.5])
def test_balls_that_roll_around_the_edge(radius_mm: float) -> None:
    out, back = (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)
    ends = (
        DrillOutlet((0.0, 100.0, 0.0), out, 0.0, 100.0, False, 0.0, "main_journal"),
        DrillOutlet((0.0, 20.0, 0.0), back, 0.0, 20.0, True, 0.0, "main_journal"),
    )
    bore = DrillBore.between("drilling", 6.0, ends, alone=False)
    assert outlet_radius_mm(bore, rolled(radius_mm)) == pytest.approx(radius_mm, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("radius_mm", [0.0, 2.0])
def test_roundings_of_the_kernel(radius_mm: float) -> None:
    scene = with_outlets(radius_mm)
    (bore,) = drill_bores(with_outlets(0.0))
    corners = kernel_surface_of(scene, "half").vertices_mm
    assert outlet_radius_mm(bore, corners) == pytest.approx(radius_mm, rel=0.01)
