"""A lighter rod at no less safety by finite elements: the closed form searches, elements correct it.

Each place by elements has a section of the closed form. The ratio of both safeties, and of the ovalisation of
a bore with a limit, is a product of powers of the dimensions that has the value and the slopes of the best
rod so far (`numerics/optimisers/model_management.py`). The own rod, which may be far from it, tells its value
alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import as_path_if_any
from cranktopo.base.notes import note
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.rod import Eye
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.numerics.optimisers.model_management import ManagedModels, managed_search
from cranktopo.runs.destination import check_folder
from cranktopo.tasks.rod.element_gradients import MARGIN, SAFETIES, Quantity
from cranktopo.tasks.rod.element_stage import RodOnElements, rod_on_elements, write_rod_folder
from cranktopo.tasks.rod.lighter import Limits, RodSearch, ovalisation_um, rod_search
from cranktopo.tasks.rod.result import EyeShape, LighterRod, RodElements, RodStrength

Judge = Callable[[Scene], RodOnElements]
"""Strength of a design's rod with that by elements."""
_ROUNDS = 8
"""Most rods that are judged by elements after the own one."""
_KEPT = 5e-3
"""Share by which safeties are kept above those of the own rod: rods come from below, and meshes differ."""
_SETTLED = 3e-3
"""Share of the mass that the next rod would save beside the best one, below which the rounds end."""
_SHORTER, _LONGER, _NEAREST = 0.5, 2.0, 0.03
"""Reach of the next search over the distance of a rod that is no better, over the last reach; the least."""
_NEAR = 1.5
"""Value over the required one from which no slope is found: the search is far from that limit."""
_NOISE = 0.1
"""Share of the largest ways of rods below which directions have no second derivative: meshes differ, too."""
_STEP = 1e-4
"""Step of differences of the closed form, of the logarithms of the dimensions."""


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
    scene, out = as_scene(design), as_path_if_any(out)
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
    own = JudgedRod(search.scene, np.ones(len(search.names)), judge(search.scene))
    models = _ClosedFormAndElements(search, judge, own)
    best = managed_search(models, own, np.inf, _ROUNDS)
    if models.refused is not None and len(models.tried) == 1:
        raise models.refused
    if best is own or models.lost(best) > 0:
        raise search.no_lighter_rod(" by elements")
    closed_form = search.result_of(best.scene, best.strength)
    return best.scene, best.judged.with_search(_with_elements(closed_form, own, best, len(models.tried) - 1))


class _ClosedFormAndElements(ManagedModels["JudgedRod", Scene]):
    """Rods in closed form and by elements.

    Attributes:
        tried: rods that were judged, the own one first.
        refused: why the last rod was not judged that could not be.
    """

    def __init__(self, search: RodSearch, judge: Judge, own: JudgedRod) -> None:
        self._search, self._judge, self._own = search, judge, own
        self.tried: list[JudgedRod] = [own]
        self.refused: CranktopoError | None = None
        self._slopes: dict[Quantity, Array] = {}
        self._rounds = 0

    def lost(self, one: JudgedRod) -> float:
        """Return the share of what is wanted that a rod lacks; 0 of a lighter one that lacks nothing."""
        required = _required_values(self._own).items()
        lost = max(1 - one.least(kind) / value for kind, value in required)
        return max(lost, 0.0) + (not self._search.is_better(one.scene, one.strength))

    def _least(self, best: JudgedRod) -> float:
        """Return the same of the best rod; the own one is no lighter than itself."""
        return np.inf if best is self._own else self.lost(best)

    @override
    def propose(self, best: JudgedRod, reach: float) -> Scene:
        self._rounds += 1
        if best is not self._own and not self._slopes:
            self._slopes = _ratio_slopes(self._search, self._own, best)
        near = self._search.within(best.values, reach)
        return self._search.rod_at(near.best(_limits(self.tried, best, self._slopes), best.values))

    @override
    def settled(self, best: JudgedRod, proposed: Scene) -> bool:
        return self._least(best) == 0 and self._search.kg_of(proposed) > (1 - _SETTLED) * best.kg

    @override
    def judge(self, proposed: Scene) -> JudgedRod | None:
        name, values = self._own.scene.name, self._search.values_of(proposed)
        try:
            answer = self._judge(proposed)
        except CranktopoError as error:
            self.refused = _of_the_mesh(error)
            note(f"{name}: rod {self._rounds} is left out: {self.refused.message}")
            return None
        self.tried.append(JudgedRod(proposed, values, answer))
        note(f"{name}: rod {self._rounds} by elements, {_line(self._own, self.tried[-1])}")
        return self.tried[-1]

    @override
    def is_better(self, best: JudgedRod, proposed: Scene, found: JudgedRod) -> bool:
        better = (self.lost(found), found.kg) < (self._least(best), best.kg)
        if better:
            self._slopes = {}
        return better

    @override
    def longer(self, reach: float) -> float:
        return _LONGER * reach

    @override
    def shorter(self, best: JudgedRod, proposed: Scene, reach: float) -> float:
        return _SHORTER * best.distance(self._search.values_of(proposed))

    @override
    def is_near(self, best: JudgedRod, reach: float) -> bool:
        return self._least(best) == 0 and reach < _NEAREST


def _of_the_mesh(error: CranktopoError) -> CranktopoError:
    """Return an error of a mesh or a solver, which says nothing of other rods; raise any other."""
    if error.code != ExitCode.SOLVER:
        raise error
    return error


@dataclass(frozen=True, eq=False)
class JudgedRod:
    """A rod that elements have judged, with its dimensions over those of the own one."""

    scene: Scene
    values: Array
    judged: RodOnElements

    @property
    def strength(self) -> RodStrength:
        """Return its strength, that by elements included."""
        return self.judged.strength

    @property
    def kg(self) -> float:
        """Return its mass."""
        return self.strength.masses.total_kg

    @property
    def elements(self) -> RodElements:
        """Return what elements found."""
        assert self.strength.elements is not None
        return self.strength.elements

    @property
    def safeties(self) -> tuple[float, float]:
        """Smallest against yield and for fatigue."""
        return self.elements.yield_safety, self.elements.fatigue_safety

    @cached_property
    def by_elements(self) -> dict[Quantity, float]:
        """Both safeties of each place, and the margin of each bore that has a limit."""
        places = {(p.place, kind): getattr(p, kind) for p in self.elements.places for kind in SAFETIES}
        return places | _margins(self.elements.eyes)

    def least(self, kind: str) -> float:
        """Return the least value of a kind; without any nothing is lost."""
        return min((value for (_, of), value in self.by_elements.items() if of == kind), default=np.inf)

    def distance(self, values: Array) -> float:
        """Largest change of a dimension to those of another rod."""
        return float(np.abs(self.values - values).max())

    def ratios(self) -> dict[Quantity, float]:
        """Logarithm of each value by elements over that of the closed form."""
        closed = _closed_form(self.strength, self.by_elements)
        return {key: float(np.log(self.by_elements[key] / value)) for key, value in closed.items()}


def _closed_form(strength: RodStrength, keys: Iterable[Quantity]) -> dict[Quantity, float]:
    """Values of the closed form, as far as it has them."""
    margins = _margins(strength.eyes)
    safeties = {
        (place, kind): getattr(strength.section_of(place), kind) for place, kind in keys if kind in SAFETIES
    }
    return safeties | {key: margins[key] for key in keys if key in margins}


def _margins(eyes: Sequence[EyeShape]) -> dict[Quantity, float]:
    """Permitted ovalisation over that of each bore that has a limit, least of its loads."""
    found: dict[Quantity, float] = {}
    for eye in eyes:
        if eye.permitted_um and eye.ovalisation_um:
            margin = eye.permitted_um / eye.ovalisation_um
            found[eye.eye, MARGIN] = min(margin, found.get((eye.eye, MARGIN), np.inf))
    return found


def _required_values(own: JudgedRod) -> dict[str, float]:
    """Least value of each kind: safeties of the own rod, and the limits of the design."""
    return {**{kind: own.least(kind) for kind in SAFETIES}, MARGIN: 1.0}


def _limits(tried: Sequence[JudgedRod], at: JudgedRod, exponents: Mapping[Quantity, Array]) -> Limits:
    """Return the limits by corrected safeties, exact at one rod: values that must stay below 0.

    The first rod that was tried is the own one; exponents are those of `_ratio_slopes`.
    """
    known, required = [one.ratios() for one in tried], _required_values(tried[0])
    keys = [key for key in known[0] if all(key in one for one in known)]
    all_ratios = np.array([[one[key] for key in keys] for one in known])
    ratios, least = all_ratios[tried.index(at)], np.array([required[kind] for _, kind in keys])
    there, none = np.log(at.values), np.zeros(len(at.values))
    slopes = np.array([exponents.get(key, none) for key in keys])
    others = [k for k, one in enumerate(tried) if one is not at]
    moves = np.log([tried[k].values for k in others]).reshape(-1, len(there)) - there
    bend = _bends(moves, all_ratios[others] - ratios - moves @ slopes.T)

    def limits(values: Array, strength: RodStrength) -> Array:
        closed, move = _closed_form(strength, keys), np.log(values) - there
        ratio = ratios + slopes @ move + bend(move)
        return np.asarray(1 + _KEPT - np.array([closed[key] for key in keys]) * np.exp(ratio) / least)

    return limits


def _bends(moves: Array, missed: Array) -> Callable[[Array], Array]:
    """Return the least quadratic terms that meet what other rods miss of a tangent, (quantities,) of a move.

    Far and near rods count alike, but for those so near that the change of the mesh is in what they miss.
    Source: M. J. D. Powell, Mathematical Programming 100, 2004 (least change of second derivatives).

    Args:
        moves: to the other rods, (rods, dimensions).
        missed: (rods, quantities).
    """
    scale = np.maximum(np.linalg.norm(moves, axis=1), _NEAREST)[:, None]
    ways = moves / scale
    weights = np.linalg.pinv((ways @ ways.T) ** 2, _NOISE) @ (missed / scale**2)
    return lambda move: (ways @ move) ** 2 @ weights


def _ratio_slopes(search: RodSearch, own: JudgedRod, at: JudgedRod) -> dict[Quantity, Array]:
    """Exponents of the dimensions in the ratios of one rod, (dimensions,), of what is near its limit."""
    required, ratios = _required_values(own), at.ratios()
    near = [key for key in own.ratios() if key in ratios and at.by_elements[key] < _NEAR * required[key[1]]]

    def closed(logs: Array) -> Array:
        found = _closed_form(search.strength_at(np.exp(logs)), near)
        return np.log([found[key] for key in near])

    by_closed = central_difference(closed, np.log(at.values), _STEP)
    by_elements, sizes_mm = at.judged.gradients(search.names, near), at.values * search.start_mm
    return {
        key: by_elements[key] * sizes_mm - exponents for key, exponents in zip(near, by_closed, strict=True)
    }


def _line(own: JudgedRod, one: JudgedRod) -> str:
    (stress, fatigue), (own_stress, own_fatigue) = one.safeties, own.safeties
    return (
        f"{one.kg:.4f} kg: least safety {stress:.3f} against yield ({own_stress:.3f} before), "
        f"{fatigue:.3f} for fatigue ({own_fatigue:.3f} before)"
    )


def _with_elements(lighter: LighterRod, own: JudgedRod, best: JudgedRod, rods: int) -> LighterRod:
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


def _ovalisations(own: JudgedRod, best: JudgedRod, eye: Eye) -> tuple[float, float]:
    return ovalisation_um(own.elements.eyes, eye), ovalisation_um(best.elements.eyes, eye)
