"""Holes of crank ends that no tool reaches, against the shells of the kernel's body."""

from __future__ import annotations

from itertools import accumulate, pairwise
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter

from cranktopo.bodies.crank_ends import EndPiece
from cranktopo.bodies.solid.crankshaft import _add_piece
from cranktopo.bodies.solid.shapes import fused
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.throw.crank_end import CrankEndStep, CylinderStep, EndStep
from cranktopo.throw.end_holes import closed_hole
from cranktopo.throw.journal import Journal
from tests.random_cranks import _step

_STEP: TypeAdapter[Any] = TypeAdapter(CrankEndStep)


def body_has_hollows(steps: list[EndStep]) -> bool:
    """More than one shell bounds the solid of an end of these steps."""
    places = pairwise(accumulate((step.length_mm for step in steps), initial=0.0))
    with cad_session("end") as gmsh:
        occ = gmsh.model.occ
        pieces = [
            _add_piece(occ, EndPiece(step, place, step.moments(), 0j, 0.0))
            for step, place in zip(steps, places, strict=True)
        ]
        ((_, tag),) = fused(occ, pieces)
        return len(occ.getSurfaceLoops(tag)[0]) > 1


def test_random_ends_against_the_kernel() -> None:
    """Some of them have hollows, some have none."""
    verdicts = []
    for seed in range(24):
        draw = np.random.default_rng((seed, 7))
        journal = CylinderStep(kind="cylinder", length_mm=20.0, diameter_mm=40.0)
        steps = [_STEP.validate_python(_step(draw, 40.0)) for _ in range(int(draw.integers(1, 5)))]
        found = closed_hole(Journal(outer_diameter_mm=40.0, length_mm=40.0), steps) is not None
        assert found == body_has_hollows([journal, *steps]), f"seed {seed}: {steps}"
        verdicts.append(found)
    assert 4 < sum(verdicts) < 20


def step(diameter: float, bore: float = 0.0, **more: float | str) -> EndStep:
    kind = "flange" if "bolts" in more else "cylinder"
    found: EndStep = _STEP.validate_python(
        {"kind": kind, "length_mm": 10.0, "diameter_mm": diameter, "bore_diameter_mm": bore, **more}
    )
    return found


FLANGE = {"bolts": 4, "bolt_circle_mm": 40.0, "bolt_diameter_mm": 6.0}


@pytest.mark.parametrize(
    ("steps", "journal_bore", "closed"),
    [
        ([step(30, 10), step(30)], 0.0, (0, "bore_diameter_mm")),
        ([step(30, 10), step(30)], 12.0, None),  # from the side of the journal
        ([step(30, 10), step(30, 4)], 0.0, None),  # a narrower bore reaches it
        ([step(30, 10), step(8)], 0.0, None),  # the next step leaves a ring of it
        ([step(50, 0, **FLANGE), step(60)], 0.0, None),  # the journal inside is slim
        ([step(60), step(50, 0, **FLANGE), step(60)], 0.0, (1, "bolt_diameter_mm")),
        ([step(60), step(50, 0, **FLANGE), step(50, 0, **FLANGE)], 0.0, None),
        ([step(60), step(50, 0, **FLANGE), step(30)], 0.0, None),
    ],
)
def test_closed_holes(steps: list[EndStep], journal_bore: float, closed: tuple[int, str] | None) -> None:
    journal = Journal(outer_diameter_mm=40.0, bore_diameter_mm=journal_bore, length_mm=40.0)
    found = closed_hole(journal, steps)
    assert (found and (found.step, found.key)) == closed
