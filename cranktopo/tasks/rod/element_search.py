"""A lighter rod at no less safety by finite elements: the closed form searches, elements correct it.

Each place by elements has a section of the closed form. The ratio of both safeties, and of the
ovalisation of a bore with a limit, is known for each rod that elements have judged. Between and beyond these
rods it is a product of powers of the dimensions, with the smallest exponents that meet all of them: the next
search knows what the last one has lost without a gradient of elements. Where a rod is no better than the best
so far all the same, the next one is nearer to that. One exponent is known before: the small end carries its
push over the width of the shank alone, not over its own.

Source: D. Echeverria, P. W. Hemker, Space mapping and defect correction, CMAM 5, 2005 (manifold mapping).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import as_path
from cranktopo.base.notes import note
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.rod import Eye
from cranktopo.design.schema import Scene
from cranktopo.runs.destination import check_folder
from cranktopo.tasks.rod.element_stage import RodOnElements, rod_on_elements, write_rod_folder
from cranktopo.tasks.rod.lighter import Limits, RodSearch, ovalisation_um, rod_search
from cranktopo.tasks.rod.result import EyeShape, LighterRod, RodElements, RodStrength

Judge = Callable[[Scene], RodOnElements]
"""Strength of a design's rod with that by elements."""
_ROUNDS = 8
"""Most rods that are judged by elements after the own one."""
_KEPT = 5e-3
"""Share by which safeties are kept above those of the own rod: rods come from below, and meshes differ."""
_SETTLED = 5e-3
"""Share of the mass that one rod saves beside the last one, below which the rounds end."""
_SHORTER, _LONGER, _NEAREST = 0.5, 2.0, 0.03
"""Reach of the next search over the distance of a rod that is no better, over the last reach; the least."""
_NOISE = 0.1
"""Share of the largest difference of rods below which directions have no slope: meshes differ, too."""

_CARRIED, _WIDTH = "small end", "shank_width_mm"
_SAFETIES = ("yield_safety", "fatigue_safety")
_MARGIN = "margin of ovalisation"
_Quantity = tuple[str, str]
"""A place or bore, and what is judged of it: one of `_SAFETIES`, or `_MARGIN`."""


def lighten_rod_by_elements(
    design: DesignLike,
    method: str = "lsa",
    element_size_mm: float | None = None,
    contact: bool = False,
    out: Path | str | None = None,
    least_wall_mm: float = 3.0,
) -> tuple[Scene, RodStrength]:
    """Return the design with a lighter rod at no less safety in closed form and by elements; its strength.

    By elements the smallest safety of all places against yield, and that for fatigue, are not below those of
    the own rod on elements of the same size; bores keep their permitted ovalisation.

    Args:
        out: folder for the files of `check_rod_elements`, of the lighter rod.

    Raises:
        CranktopoError: as `check_rod_elements`, or no lighter rod was found.
    """
    scene, out = as_scene(design), as_path(out)
    if out is not None:
        check_folder(out)
    search = rod_search(scene, method, least_wall_mm)
    lighter, found = corrected_search(
        search, lambda tried: rod_on_elements(tried, method, element_size_mm, contact)
    )
    if out is not None:
        write_rod_folder(out, scene.name, found)
    return lighter, found.strength


def corrected_search(search: RodSearch, judge: Judge) -> tuple[Scene, RodOnElements]:
    """Return the lightest rod that a judge finds no less safe than the own one, and how it judged it.

    A rod that the judge cannot mesh or solve is left out, and the next one is nearer to the best.

    Raises:
        CranktopoError: as the judge does of the own rod or of every other, or no lighter rod was found.
    """
    own = _JudgedRod(search.scene, np.ones(len(search.names)), judge(search.scene).strength)
    tried, best, found, reach, refused = [own], own, None, np.inf, None
    for number in range(1, _ROUNDS + 1):
        near = search.within(best.values, reach)
        lighter = search.rod_at(near.best(_limits(search.names, tried, best), best.values))
        values = search.values_of(lighter)
        try:
            answer = judge(lighter)
        except CranktopoError as error:
            refused = _of_the_mesh(error)
            note(f"{own.scene.name}: rod {number} is left out: {refused.message}")
            reach = _SHORTER * best.distance(values)
            continue
        last = _JudgedRod(lighter, values, answer.strength)
        tried.append(last)
        note(f"{own.scene.name}: rod {number} by elements, {_line(own, last)}")
        lost, least = _lost(search, own, last), np.inf if best is own else _lost(search, own, best)
        if (lost, last.kg) < (least, best.kg):
            settled = least == lost == 0 and last.kg > (1 - _SETTLED) * best.kg
            best, found, reach = last, answer, _LONGER * reach
        else:
            reach = _SHORTER * best.distance(values)
            settled = least == 0 and reach < _NEAREST
        if settled:
            break
    if refused is not None and len(tried) == 1:
        raise refused
    if found is None or _lost(search, own, best) > 0:
        raise search.no_lighter_rod(" by elements")
    closed_form = search.result_of(best.scene, best.strength)
    return best.scene, found.with_search(_with_elements(closed_form, own, best, len(tried) - 1))


def _of_the_mesh(error: CranktopoError) -> CranktopoError:
    """Return an error of a mesh or a solver, which says nothing of other rods; raise any other."""
    if error.code != ExitCode.SOLVER:
        raise error
    return error


def _lost(search: RodSearch, own: _JudgedRod, one: _JudgedRod) -> float:
    """Share of what is wanted by elements that a rod lacks; 0 of one that is lighter and lacks nothing."""
    lost = max(1 - one.least(kind) / required for kind, required in _required_values(own).items())
    return max(lost, 0.0) + (not search.is_better(one.scene, one.strength))


@dataclass(frozen=True, eq=False)
class _JudgedRod:
    """A rod that elements have judged, with its dimensions over those of the own one."""

    scene: Scene
    values: Array
    strength: RodStrength

    @property
    def kg(self) -> float:
        return self.strength.masses.total_kg

    @property
    def elements(self) -> RodElements:
        assert self.strength.elements is not None
        return self.strength.elements

    @property
    def safeties(self) -> tuple[float, float]:
        """Smallest against yield and for fatigue."""
        return self.elements.yield_safety, self.elements.fatigue_safety

    @cached_property
    def by_elements(self) -> dict[_Quantity, float]:
        """Both safeties of each place, and the margin of each bore that has a limit."""
        places = {(p.place, kind): getattr(p, kind) for p in self.elements.places for kind in _SAFETIES}
        return places | _margins(self.elements.eyes)

    def least(self, kind: str) -> float:
        """Return the least value of a kind; without any nothing is lost."""
        return min((value for (_, of), value in self.by_elements.items() if of == kind), default=np.inf)

    def distance(self, values: Array) -> float:
        """Largest change of a dimension to those of another rod."""
        return float(np.abs(self.values - values).max())

    def ratios(self) -> dict[_Quantity, float]:
        """Logarithm of each value by elements over that of the closed form."""
        closed = _closed_form(self.strength, self.by_elements)
        return {key: float(np.log(self.by_elements[key] / value)) for key, value in closed.items()}


def _closed_form(strength: RodStrength, keys: Iterable[_Quantity]) -> dict[_Quantity, float]:
    """Values of the closed form, as far as it has them."""
    margins = _margins(strength.eyes)
    safeties = {
        (place, kind): getattr(strength.section_of(place), kind) for place, kind in keys if kind in _SAFETIES
    }
    return safeties | {key: margins[key] for key in keys if key in margins}


def _margins(eyes: Sequence[EyeShape]) -> dict[_Quantity, float]:
    """Permitted ovalisation over that of each bore that has a limit, least of its loads."""
    found: dict[_Quantity, float] = {}
    for eye in eyes:
        if eye.permitted_um and eye.ovalisation_um:
            margin = eye.permitted_um / eye.ovalisation_um
            found[eye.eye, _MARGIN] = min(margin, found.get((eye.eye, _MARGIN), np.inf))
    return found


def _required_values(own: _JudgedRod) -> dict[str, float]:
    """Least value of each kind: safeties of the own rod, and the limits of the design."""
    return {**{kind: own.least(kind) for kind in _SAFETIES}, _MARGIN: 1.0}


def _limits(names: Sequence[str], tried: Sequence[_JudgedRod], at: _JudgedRod) -> Limits:
    """Return the limits by corrected safeties, exact at one rod: values that must stay below 0.

    The first rod that was tried is the own one.
    """
    known = [one.ratios() for one in tried]
    keys = [key for key in known[0] if all(key in one for one in known)]
    ratios = np.array([[one[key] for key in keys] for one in known])
    here, there = ratios[tried.index(at)], np.log(at.values)
    moves = np.log([one.values for one in tried]) - there
    # far and near rods count alike, but for those so near that the change of the mesh is in their slope
    scale = 1 / np.maximum(np.abs(moves).max(axis=1), _NEAREST)
    slopes = _known_slopes(names, keys)
    missed = ratios - here - moves @ slopes
    slopes += np.linalg.pinv(scale[:, None] * moves, _NOISE) @ (scale[:, None] * missed)
    required = _required_values(tried[0])
    least = np.array([required[kind] for _, kind in keys])

    def limits(values: Array, strength: RodStrength) -> Array:
        closed = _closed_form(strength, keys)
        ratio = here + (np.log(values) - there) @ slopes
        return np.asarray(1 + _KEPT - np.array([closed[key] for key in keys]) * np.exp(ratio) / least)

    return limits


def _known_slopes(names: Sequence[str], keys: Sequence[_Quantity]) -> Array:
    """Exponents of the dimensions in the ratios that are expected, (dimensions, quantities)."""
    slopes = np.zeros((len(names), len(keys)))
    if _WIDTH in names:
        carried = [place == _CARRIED and kind in _SAFETIES for place, kind in keys]
        slopes[list(names).index(_WIDTH)] = carried
    return slopes


def _line(own: _JudgedRod, one: _JudgedRod) -> str:
    (stress, fatigue), (own_stress, own_fatigue) = one.safeties, own.safeties
    return (
        f"{one.kg:.4f} kg: least safety {stress:.3f} against yield ({own_stress:.3f} before), "
        f"{fatigue:.3f} for fatigue ({own_fatigue:.3f} before)"
    )


def _with_elements(lighter: LighterRod, own: _JudgedRod, best: _JudgedRod, rods: int) -> LighterRod:
    against_yield, for_fatigue = zip(own.safeties, best.safeties, strict=True)
    return lighter.model_copy(
        update={
            "elements_yield_safety": against_yield,
            "elements_fatigue_safety": for_fatigue,
            "elements_small_end_ovalisation_um": _ovalisations(own, best, "small"),
            "elements_big_end_ovalisation_um": _ovalisations(own, best, "big"),
            "rods_by_elements": rods,
        }
    )


def _ovalisations(own: _JudgedRod, best: _JudgedRod, eye: Eye) -> tuple[float, float]:
    return ovalisation_um(own.elements.eyes, eye), ovalisation_um(best.elements.eyes, eye)
