"""A lighter rod whose safety a dearer judge decides: the search against a search of a grid, and its end.

The judge is the closed form with a small end that loses safety with the width of the shank below it, which
the closed form does not know. Finite elements find the same; they take minutes.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError, ExitCode, solver_error
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.tasks.rod import element_search
from cranktopo.tasks.rod.element_search import corrected_search
from cranktopo.tasks.rod.element_stage import RodOnElements
from cranktopo.tasks.rod.element_stress import PLACES
from cranktopo.tasks.rod.lighter import ovalisation_um, resized, rod_search
from cranktopo.tasks.rod.result import RodElements, RodPlace
from cranktopo.tasks.rod.stage import check_rod_strength

OWN = load_scene("mikron-iiic-rod-h")
FREE = ("shank_small_mm", "shank_width_mm")


def search():
    """Of two dimensions: all others stay."""
    found = rod_search(OWN, "lsa", 3.0)
    at = [found.names.index(name) for name in FREE]
    bounds = tuple(bound[at] for bound in found.bounds)
    return replace(found, names=FREE, start_mm=found.start_mm[at], bounds=bounds)


@dataclass(frozen=True)
class Told(RodOnElements):
    """A strength that differences tell the slopes of."""

    scene: Scene
    share_of_place: Callable[[Scene], Callable[[str], float]]

    def gradients(self, names, quantities):
        def logs(values):
            there = told(resized(self.scene, names, values), self.share_of_place)
            found = element_search.JudgedRod(self.scene, values, there).by_elements
            return np.log([found[one] for one in quantities])

        own = np.array([getattr(self.scene.rod, name) for name in names])
        return dict(zip(quantities, central_difference(logs, own, 1e-4), strict=True))


def told(scene, share_of_place):
    """A strength with elements that have a share of the closed form's safeties at each place."""
    strength = check_rod_strength(scene)
    places = tuple(
        RodPlace.model_construct(
            place=name,
            yield_safety=share_of_place(scene)(name) * strength.section_of(name).yield_safety,
            fatigue_safety=share_of_place(scene)(name) * strength.section_of(name).fatigue_safety,
        )
        for name in PLACES
    )
    elements = RodElements.model_construct(
        places=places,
        yield_safety=min(place.yield_safety for place in places),
        fatigue_safety=min(place.fatigue_safety for place in places),
        eyes=tuple(softer(eye) for eye in strength.eyes),
    )
    return Told(strength.model_copy(update={"elements": elements}), None, (), scene, share_of_place)


def softer(eye):
    """Elements find a fifth more than the closed form."""
    return eye.model_copy(update={"ovalisation_um": 1.2 * eye.ovalisation_um})


def narrow(scene):
    """The small end loses safety with the width of the shank, by no power of it."""
    return told(scene, shares_of_width)


def shares_of_width(scene):
    width = scene.rod.shank_width_mm / OWN.rod.shank_width_mm
    return lambda place: 0.2 + 0.8 * width if place == "small end" else 0.95


def safeties(found):
    return np.array([found.strength.elements.yield_safety, found.strength.elements.fatigue_safety])


@pytest.mark.slow
def test_the_lightest_rod_of_a_grid_is_found_where_the_closed_form_is_blind():
    """The grid asks the judge itself, 0.5 mm apart; the closed form alone would end at less safety.

    Nothing of it is lighter by more than what ends the search.
    """
    task, least = search(), safeties(narrow(OWN))
    scene, found = corrected_search(task, narrow)
    again = narrow(scene)
    assert (safeties(again) >= least).all()
    assert safeties(again) == pytest.approx(safeties(found))
    assert task.is_better(scene, again.strength)
    blind = task.rod_at(task.best())
    assert safeties(narrow(blind))[1] < 0.98 * least[1]
    masses = []
    for height in np.arange(12.0, 17.1, 0.5):
        for width in np.arange(6.1, 10.0, 0.5):
            tried = task.rod_at(np.array([height, width]) / task.start_mm)
            judged = narrow(tried)
            if task.is_better(tried, judged.strength) and (safeties(judged) >= least).all():
                masses.append(judged.strength.masses.total_kg)
    best = found.strength.masses.total_kg
    assert len(masses) > 20
    assert best < 1.003 * min(masses), "the search ends where the next rod would save less"
    assert blind.rod.shank_width_mm < scene.rod.shank_width_mm
    lighter = found.strength.lighter
    assert lighter.result_kg == pytest.approx(best)
    assert lighter.elements_fatigue_safety == pytest.approx((least[1], safeties(again)[1]))
    assert lighter.rods_by_elements <= 8


@pytest.mark.slow
def test_bores_keep_their_limits_by_the_judge():
    """It finds a fifth more than the closed form: a rod that keeps the limit by that alone is too soft."""
    limit_um = 42.5
    own = with_values(load_scene("mikron-iiic-rod-i"), {"rod.big_end_ovalisation_um": limit_um})
    whole, free = rod_search(own, "lsa", 3.0), ("big_end_diameter_mm", "shank_big_mm", "boss_above_mm")
    at = [whole.names.index(name) for name in free]
    bounds = tuple(bound[at] for bound in whole.bounds)
    task = replace(whole, names=free, start_mm=whole.start_mm[at], bounds=bounds)

    def judge(scene):
        return told(scene, lambda _: lambda _: 1.0)

    _, found = corrected_search(task, judge)
    lighter = found.strength.lighter
    closed, elements = lighter.big_end_ovalisation_um[1], lighter.elements_big_end_ovalisation_um[1]
    assert elements == pytest.approx(1.2 * closed)
    assert 0.98 * limit_um < elements <= limit_um
    blind = judge(task.rod_at(task.best())).strength
    assert ovalisation_um(blind.elements.eyes, "big") > 1.01 * limit_um


def test_a_judge_whom_no_lighter_rod_suits_ends_the_search(monkeypatch):
    """Every change of the rod costs half of the safety, and nothing gives it back."""
    monkeypatch.setattr(element_search, "_ROUNDS", 1)

    def strict(scene):
        return told(scene, lambda scene: lambda _: 1.0 if scene == OWN else 0.5)

    with pytest.raises(CranktopoError, match="no lighter rod of this shape at no less safety by elements"):
        corrected_search(search(), strict)


@pytest.mark.slow
def test_a_rod_that_has_no_mesh_is_left_out():
    """The search goes on nearer to the best one: it ends as light as without, or within a percent."""
    task, calls = search(), []

    def first_fails(scene):
        calls.append(scene)
        if len(calls) == 2:
            raise solver_error("mesh: an element is bent too much.", "Choose a smaller element size.")
        return narrow(scene)

    _, found = corrected_search(task, first_fails)
    _, without = corrected_search(task, narrow)
    lighter = found.strength.lighter
    assert lighter.result_kg == pytest.approx(without.strength.lighter.result_kg, rel=0.01)
    assert lighter.rods_by_elements == len(calls) - 2


@pytest.mark.parametrize(
    ("code", "rods"),
    [pytest.param(ExitCode.SOLVER, 2, marks=pytest.mark.slow), (ExitCode.INVALID_INPUT, 1)],
)
def test_an_error_of_every_rod_is_told(monkeypatch, code, rods):
    """That of the mesh after all were tried, any other at once."""
    monkeypatch.setattr(element_search, "_ROUNDS", 2)
    calls = []

    def failing(scene):
        calls.append(scene)
        if len(calls) > 1:
            raise CranktopoError("no mesh.", code=code)
        return narrow(scene)

    with pytest.raises(CranktopoError, match="no mesh"):
        corrected_search(search(), failing)
    assert len(calls) == 1 + rods
