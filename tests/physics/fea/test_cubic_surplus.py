"""What cubic displacements would take off: the estimate beside a solution with them, on lopsided meshes."""

from __future__ import annotations

import pytest

from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.fea.evaluation_cases import mikron_with
from tests.studies.cubic_elements import both_orders

SIZE_MM = 9.0
HOLE = {"shape": "cylinder", "x_mm": 12.0, "y_mm": 24.0, "diameter_mm": 12.0}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fillet_mm", "pocket"),
    [
        pytest.param(2.5, [], id="round"),
        pytest.param(0.0, [HOLE], id="sharp, lopsided"),  # a minute: no mirror
    ],
)
def test_the_bound_is_more_than_what_cubic_displacements_take_off(
    fillet_mm: float, pocket: list[dict[str, object]]
) -> None:
    """Each function alone answers for 0.6 to 0.8 of what all of them do together; the bound is above both."""
    target = Target("mikron", mikron_with(fillet_mm=fillet_mm, pocket=pocket))
    found, truth = evaluate(target, SIZE_MM), both_orders(target, SIZE_MM)
    for kind, support in (("torsion", "free"), ("bending", "pinned")):
        both = truth[kind]
        value, bound = (getattr(found.fine, name)[support] for name in (kind, f"{kind}_error_percent"))
        assert value == pytest.approx(both.quadratic, rel=1e-9)
        taken_off = 100 * (both.quadratic / both.cubic - 1)
        assert 1.2 * taken_off < bound < 3.5 * taken_off, (kind, bound, taken_off)


def test_every_support_has_its_own_bound() -> None:
    found = evaluate(Target("mikron", mikron_with(fillet_mm=2.5)), SIZE_MM)
    fine, told = found.fine, found.result.as_json()["error_by_support_percent"]
    assert told["torsion"]["free"] == found.torsion_error_percent == fine.torsion_error_percent["free"]
    assert told["bending"]["pinned"] == found.bending_error_percent
    known = [value for kind in told.values() for value in kind.values() if value is not None]
    assert len(known) >= 4
    assert all(0.1 < value < 20 for value in known)
