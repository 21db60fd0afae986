"""Cranks as one meshed body with all unknowns beside `shaft`: motions, forces, stresses in all fillets."""

from __future__ import annotations

import pytest

from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.shaft.cycle import cycle_forces
from tests.studies.one_body import one_body
from tests.studies.one_body_shaft import (
    all_unknowns,
    by_throws,
    condensed,
    differences,
    few_states,
    fillets,
    stress_differences,
)

MOTIONS_PERCENT, STRESS_PERCENT = 1.0, 2.0


def two_throws() -> Scene:
    data = load_scene("mikron-iiic-plain", whole=True).model_dump(mode="json", exclude_unset=True)
    data["engine"] |= {"cylinders": 2, "firing_order": [1, 2]}
    return scene_from_dict(data, whole=True)


@pytest.mark.slow
@pytest.mark.parametrize("spring", [None, 1e6])
def test_two_throws_move_as_one_body(spring: float | None) -> None:
    """Within 1 %, where sections that stay rigid let pins move 1.7 to 2 % too little."""
    body = one_body(two_throws(), 12.0)
    forces, throws = few_states(cycle_forces(body.scene)), condensed(body)
    whole = all_unknowns(body).on_bearings(forces, spring)
    found, rigid = (
        differences(whole, by_throws(body, throws, forces, spring, warps=warps)) for warps in (True, False)
    )
    assert max(found.values()) < MOTIONS_PERCENT
    assert max(rigid.values()) > 1.5 * MOTIONS_PERCENT


@pytest.mark.slow
def test_a_crank_in_one_piece_has_the_same_stress_in_its_fillets() -> None:
    """Four throws: the largest stress of every fillet within 2 %, of rigid sections it is up to 5 % off."""
    body = one_body(load_scene("mikron-iiic", whole=True), 16.0, 1.0)
    forces, throws, on = few_states(cycle_forces(body.scene)), condensed(body), fillets(body)
    whole = all_unknowns(body).on_bearings(forces, None)
    stress = on.stress_MPa(whole.fields)

    def worst(*, warps: bool) -> float:
        found = by_throws(body, throws, forces, None, warps=warps)
        if warps:
            assert max(differences(whole, found).values()) < MOTIONS_PERCENT
        by_fillet = stress_differences(on, stress, on.stress_MPa(found.fields))
        return max(abs(change) for change, _ in by_fillet.values())

    assert worst(warps=True) < STRESS_PERCENT
    assert worst(warps=False) > STRESS_PERCENT
