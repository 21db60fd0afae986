"""A crank that is not its own mirror image is told as such; a file that mirrors it is named."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from cranktopo.tasks.crank_import.crank_finder import find_crank
from cranktopo.tasks.crank_import.half_body import EXACT, alike_halves
from cranktopo.tasks.crank_import.hand import hand_words, mirrored_by_file
from cranktopo.tasks.importing.faces import Faces
from tests.physics.crank_import.test_crank_import import cylinder


def told(angles_deg: Sequence[float], products: Sequence[float] = (0.0, 0.0)) -> list[str]:
    """What is told of a crank of throws at these angles, and of one product of inertia of its two webs."""
    faces = [cylinder(20.0, (96.0 * number, 96.0 * number + 20.0)) for number in range(len(angles_deg) + 1)]
    for number, angle in enumerate(np.radians(angles_deg)):
        span = (96.0 * number + 40.0, 96.0 * number + 76.0)
        faces.append(cylinder(18.0, span, 40 * np.sin(angle), 40 * np.cos(angle)))
    crank = find_crank(Faces(tuple(faces), (), (), ()), "crank")
    bulks = []
    for half in crank.halves:
        bulk = np.ones(13)
        bulk[[1, 5, 6, 7, 10]] = 0.0
        bulk[[5, 7]] = products[half.toward < 0]
        bulks.append(bulk)
    return hand_words(crank, alike_halves(crank.halves, bulks, EXACT))


@pytest.mark.parametrize("angles", [[0], [0, 180, 180, 0], [0, 90, 270, 180], [0, 120, 240, 240, 120, 0]])
def test_own_mirror_images_are_not_told(angles: list[float]) -> None:
    """At a plane along the axis, or at their middle; there also with drillings mirrored in each throw."""
    assert told(angles) == []
    assert told(angles, (0.1, -0.1)) == []


def test_three_throws_have_a_hand() -> None:
    (line,) = told([0.0, 120.0, 240.0])
    assert "with throws at 0, 240, 120 instead of 0, 120, 240 deg, is another crank" in line


def test_a_drilling_aside_has_a_hand() -> None:
    """On one side in both webs, seen from the pin: turned about, not mirrored, into each other."""
    (line,) = told([0.0], (0.1, 0.1))
    assert "with webs or drillings mirrored, is another crank" in line


PLACED = """#1=DIRECTION('',(1.,0.,0.)); #2 = DIRECTION('',(0.,1.,0.));
#3=DIRECTION('',(0.,0.,{})); #4=CARTESIAN_POINT('',(0.,0.,0.));
#5=CARTESIAN_TRANSFORMATION_OPERATOR_3D('',#1,#2,#4,1.,#3);"""


def test_a_mirroring_placement_of_a_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "body.step").write_text(PLACED.format("-1."))
    (line,) = mirrored_by_file(tmp_path / "body.step")
    assert line.startswith("#5 of the file places a body as its mirror image")
    (tmp_path / "body.step").write_text(PLACED.format("1."))
    assert mirrored_by_file(tmp_path / "body.step") == []
