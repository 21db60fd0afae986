"""Stress of the worst point in its surface: directions, and the mirror images of a model."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo.tasks.shaft_safety.worst_stress import stress_over_cycle
from cranktopo.tasks.throw_fatigue.stress_model import Image

AROUND_DEG, ALONG_DEG = 150.0, 30.0
TURN, RISE = math.radians(AROUND_DEG), math.radians(ALONG_DEG)
OUTWARD = np.array([math.sin(TURN), math.cos(TURN), 0.0])
AROUND = np.array([math.cos(TURN), -math.sin(TURN), 0.0])
NORMAL = math.cos(RISE) * OUTWARD + math.sin(RISE) * np.array([0.0, 0.0, 1.0])
ALONG = np.cross(NORMAL, AROUND)
STRESS = 90.0 * np.outer(ALONG, ALONG) - 40.0 * np.outer(AROUND, AROUND)
STRESS = STRESS + 25.0 * (np.outer(ALONG, AROUND) + np.outer(AROUND, ALONG))


def voigt(tensor: Any) -> Any:
    return np.array([tensor[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))])


def field(image: Image, around_deg: float | None) -> Any:
    """A model of one node that the image maps to a point of a fillet with stress `STRESS`."""
    mirror = np.diag([-1.0 if image.flip_x else 1.0, 1.0, -1.0 if image.flip_z else 1.0])
    own = voigt(mirror @ STRESS @ mirror) * image.signs[0]
    model = SimpleNamespace(
        judged=np.array([True, False]),
        images=(image,),
        stress=SimpleNamespace(stress_MPa=np.stack([own, own])[None]),
        surface=SimpleNamespace(normals=np.stack([mirror @ NORMAL] * 2)),
    )
    return SimpleNamespace(
        model=model, safety=np.array([[2.0, 1.0]]), critical=SimpleNamespace(around_deg=around_deg)
    )


@pytest.mark.parametrize("flip_x", [False, True])
@pytest.mark.parametrize("flip_z", [False, True])
@pytest.mark.parametrize("around_deg", [AROUND_DEG, None])
def test_components_are_those_of_the_point_whichever_image_it_is_of(
    flip_x: bool, flip_z: bool, around_deg: float | None
) -> None:
    """Stress of the mirrored model becomes that of the throw; a fillet's axes are those of any round face."""
    image = Image(flip_x, flip_z, np.array([-1.0]))
    found = stress_over_cycle(field(image, around_deg), np.array([[1.0], [-2.0]]), np.array([0.0, 1.0]))
    away = np.sign(np.dot(found.around, AROUND))
    assert np.abs(away * np.array(found.around) - AROUND).max() < 1e-6
    assert np.abs(np.abs(np.dot(found.along, ALONG)) - 1) < 1e-6
    assert found.along_MPa == (90.0, -180.0)
    assert found.around_MPa == (-40.0, 80.0)
    assert found.shear_MPa == (25.0, -50.0)
    assert found.signed_von_mises_MPa[0] == pytest.approx(
        math.sqrt(90**2 + 40**2 + 90 * 40 + 3 * 25**2), abs=1e-3
    )


def test_on_a_face_square_to_the_crank_axis_the_second_direction_is_across_the_throw() -> None:
    one = field(Image(False, False, np.array([1.0])), None)
    one.model.surface.normals[0] = [0.0, 0.0, -1.0]
    found = stress_over_cycle(one, np.array([[1.0]]), np.array([0.0]))
    assert np.abs(found.around) == pytest.approx([1.0, 0.0, 0.0])
    assert np.abs(found.along) == pytest.approx([0.0, 1.0, 0.0])
