"""A throw against the crankshaft rule: concentration factors in closed form and from finite elements."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Literal, get_args

from cranktopo.base.errors import invalid
from cranktopo.base.notes import note
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.halves import WebName, difference, halves, judged_half, named_in_throw
from cranktopo.design.material import M53Factors
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.histories import HistoryKind, radial_amplitude_N, torque_amplitude_Nm
from cranktopo.engine.throw_compliance import web_lever_mm
from cranktopo.tasks.fatigue.criteria import check_method
from cranktopo.tasks.throw_fatigue.m53 import (
    LEAST_FACTOR,
    ConcentrationFactors,
    Dimensions,
    FilletCheck,
    Nominal,
    concentration_factors,
    dimensions,
    nominal_stresses,
    outside_validity,
)
from cranktopo.tasks.throw_fatigue.m53_material import process_remark, uncovered_material
from cranktopo.tasks.throw_fatigue.m53_outlet import (
    GoverningFactors,
    OutletCheck,
    check_outlets,
    pin_outlets,
    unchecked_journal_outlets,
)
from cranktopo.tasks.throw_fatigue.mesh_quality import RuleQuality
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.throw_fatigue.outlet_elements import off_plane
from cranktopo.tasks.throw_fatigue.result import AlternatingLoads
from cranktopo.tasks.throw_fatigue.rule_fillets import element_factors, fillet_checks
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import FieldKind

Verdict = Literal["not covered", "not accepted", "not judged", "accepted"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
"""Answers of the rule, the worst first."""
_FINER = 0.8
"""Size of the elements in fillets and outlets of a second mesh over that of the first."""


@dataclass(frozen=True)
class RuleCheck:
    """A throw against IACS UR M53.

    Attributes:
        size: the throw in the symbols of the rule, mm.
        outside: dimensions outside the validity of the rule's polynomials.
        scf_rule, scf_fem: concentration factors by polynomial and by finite elements.
        web: which one of two that differ; empty where they are alike.
        rule_checks, fem_checks: pin and journal fillet with either set of factors.
        m53_factors: set that the scene lets govern.
        journal_outlets: outlets on the main journal that the rule has no factors for, and why.
        not_covered: why the rule does not apply to the material; empty where it does.
        process_remark: where its factor K does not fit the way the crank is made; empty else.
    """

    name: str
    throw_kg: float
    size: Dimensions
    loads: AlternatingLoads
    outside: tuple[str, ...]
    scf_rule: ConcentrationFactors
    scf_fem: ConcentrationFactors
    nominal: Nominal
    rule_checks: dict[str, FilletCheck]
    fem_checks: dict[str, FilletCheck]
    quality: RuleQuality
    outlets: tuple[OutletCheck, ...] = ()
    web: str = ""
    m53_factors: M53Factors = "lower"
    journal_outlets: Mapping[str, str] = field(default_factory=dict)
    not_covered: str = ""
    process_remark: str = ""

    @property
    def governing(self) -> dict[str, GoverningFactors | None]:
        """The set of factors that governs at each fillet; None where the fillet is not judged.

        Elements whose mesh misses the rule's checks never govern. Where they have less than valid polynomials
        these do not prove the fillet either, unless they refuse it by themselves.
        """
        return {fillet: self._governing(fillet) for fillet in self.fem_checks}

    @property
    def governed(self) -> dict[str, GoverningFactors | None]:
        """The same of every place, outlets too."""
        return self.governing | {outlet.place: outlet.governed_by for outlet in self.outlets}

    def _governing(self, fillet: str) -> GoverningFactors | None:
        chosen = self._chosen(fillet)
        if chosen == "polynomials" or self.quality.within_limits:
            return chosen
        refused = not (self.outside or self.rule_checks[fillet].accepted)
        return "polynomials" if refused and self.m53_factors == "lower" else None

    def _chosen(self, fillet: str) -> GoverningFactors:
        """The set that the scene asks for, proven or not."""
        if self.m53_factors != "lower":
            return self.m53_factors
        by_rule, by_elements = self.rule_checks[fillet], self.fem_checks[fillet]
        lower = by_rule.acceptability < by_elements.acceptability
        return "polynomials" if lower and not self.outside else "elements"

    @property
    def places(self) -> dict[str, FilletCheck]:
        """Every place that is judged: fillets with the factors that govern, outlets that the rule covers."""
        sets = {"polynomials": self.rule_checks, "elements": self.fem_checks}
        fillets = {fillet: sets[name][fillet] for fillet, name in self.governing.items() if name is not None}
        outlets = ((outlet.place, outlet.judged) for outlet in self.outlets)
        return fillets | {place: found for place, found in outlets if found is not None}

    @property
    def not_judged(self) -> dict[str, str]:
        """Places that the rule does not judge, and why."""
        return self.unproven | self.uncovered

    @property
    def unproven(self) -> dict[str, str]:
        """Places that wait for elements of a mesh that keeps the rule's checks, with what these say."""
        fillets = {
            f"{fillet} fillet": f"{self.quality.shortfall} (Q {found.acceptability:.3f} by these elements)"
            for fillet, found in self._unproven_fillets.items()
        }
        return fillets | {outlet.place: outlet.not_judged for outlet in self.outlets if outlet.doubted}

    @property
    def waiting(self) -> dict[str, str]:
        """Places that are not judged and elements of a finer mesh may judge, and why."""
        return self.unproven | {one.place: one.not_judged for one in self.outlets if one.waits_for_mesh}

    @property
    def _unproven_fillets(self) -> dict[str, FilletCheck]:
        return {name: self.fem_checks[name] for name, by in self.governing.items() if by is None}

    @property
    def _unproven_checks(self) -> dict[str, FilletCheck]:
        outlets = ((outlet.place, outlet.by_elements) for outlet in self.outlets if outlet.doubted)
        return self._unproven_fillets | {place: found for place, found in outlets if found}

    @property
    def _answers(self) -> dict[str, FilletCheck]:
        """Every place with a number, proven or not."""
        return self.places | self._unproven_checks

    @property
    def uncovered(self) -> dict[str, str]:
        """Outlets that neither the rule's polynomials nor elements cover, and why."""
        open_ones = {
            outlet.place: outlet.not_judged
            for outlet in self.outlets
            if outlet.not_judged and not outlet.doubted
        }
        return open_ones | dict(self.journal_outlets)

    @property
    def least_place(self) -> str:
        """The place of least acceptability, places with unproven factors of elements among them."""
        answers = self._answers
        return min(answers, key=lambda place: answers[place].acceptability)

    @property
    def governing_place(self) -> str | None:
        """The place of least acceptability of all that are judged; None where none is."""
        places = self.places
        return min(places, key=lambda place: places[place].acceptability, default=None)

    def place_words(self, place: str) -> str:
        """Return a place with its set of factors, as in `pin fillet by polynomials`."""
        name = f"{place} fillet" if place in self.fem_checks else place
        return f"{name} by {self.governed.get(place) or 'elements that prove nothing'}"

    @property
    def safety(self) -> float:
        """Least acceptability factor, places with unproven factors of elements among them."""
        return min(check.acceptability for check in self._answers.values())

    @property
    def least_error_percent(self) -> float:
        """Jump of the stress between elements at the least place, %; 0 where polynomials have it."""
        place = self.least_place
        if self.governed[place] == "polynomials":
            return 0.0
        outlets = {one.place: one.elements for one in self.outlets}
        elements = outlets.get(place)
        return (elements.checks if elements else self.quality).jump_percent

    @property
    def judged_safety(self) -> float | None:
        """Least acceptability factor of all places that are judged; None where none is."""
        place = self.governing_place
        return None if place is None else self.places[place].acceptability

    @property
    def verdict(self) -> Verdict:
        """Answer of the rule: it accepts a throw only if it judges every fillet and outlet of an oil bore.

        Factors of elements count as judged where the mesh keeps the checks of Appendix III. Of a material
        that it does not cover it has no answer, whatever the numbers.
        """
        if self.not_covered:
            return "not covered"
        if self.safety < LEAST_FACTOR:  # even by elements that prove nothing
            return "not accepted"
        return "not judged" if self.not_judged else "accepted"

    @property
    def departures(self) -> tuple[str, ...]:
        """Fillets at which both valid sets differ, in words: by more than the elements' own error, or the
        scene has chosen the one that flatters."""
        if self.outside:
            return ()
        return tuple(
            f"{fillet} fillet: Q {rule.acceptability:.3f} by polynomials, {fem.acceptability:.3f} by "
            f"elements ({100 * (fem.acceptability / rule.acceptability - 1):+z.1f} %, element error "
            f"{self.quality.jump_percent:.1f} %): {_which_govern(self.governing[fillet])}"
            for (fillet, rule), fem in zip(self.rule_checks.items(), self.fem_checks.values(), strict=True)
            if abs(fem.acceptability / rule.acceptability - 1) > self.quality.jump_percent / 100
            or (
                fillet in self.places
                and self.places[fillet].acceptability > min(rule.acceptability, fem.acceptability)
            )
        )


def _which_govern(chosen: GoverningFactors | None) -> str:
    return f"{chosen} govern" if chosen else "neither governs"


def check_rule(
    target: Target,
    kind: HistoryKind = "extremes",
    fillet_fraction: float = RULE_FRACTION,
) -> tuple[RuleCheck, ...]:
    """Check a throw against the rule: once, or each of two different webs.

    Such a web is judged in a throw that has it twice, as Appendix III models one web, under the share of the
    radial force that its bearing takes. A drilling of its own is in one half of that throw, modelled whole: a
    second one beside it would relieve its outlet in bending.

    Raises:
        CranktopoError: missing tensile strength or loads, sharp fillets, or a failed solve.
    """
    near, far = halves(target.scene)
    share = far.pitch_mm / (near.pitch_mm + far.pitch_mm)
    sides: list[tuple[WebName | None, Scene, float]] = [("first", near, share), ("second", far, 1 - share)]
    if near is far:
        sides = [(None, near, 0.5)]
    found = [_proven(partial(_check, target, *side, kind), fillet_fraction) for side in sides]
    if target.file is not None:
        return tuple(found)
    throw_kg = throw_balance(target.scene).mass_kg  # the checks are of throws of two such webs
    return tuple(replace(check, throw_kg=throw_kg) for check in found)


def _proven(checked: Callable[[float], RuleCheck], fillet_fraction: float) -> RuleCheck:
    """Return the check of a web, by a finer mesh where that of the default size leaves a place open."""
    found = checked(fillet_fraction)
    if fillet_fraction != RULE_FRACTION or not found.waiting:
        return found
    finer = _FINER * fillet_fraction
    place, why = next(iter(found.waiting.items()))
    note(f"{found.name}, {place}: {why}; judged anew with a fillet fraction of {finer:.3f}")
    return checked(finer)


def _check(
    target: Target,
    side: WebName | None,
    half: Scene,
    share: float,
    kind: HistoryKind,
    fillet_fraction: float,
) -> RuleCheck:
    """Check one web, under the loads of the target's throw.

    Args:
        side: which web of a throw whose halves differ.
        half: the throw of two such webs, with every drilling of this half.
        share: of the radial force that the bearing beside this web takes.
    """
    throw, scene = target.scene, judged_half(half)
    web = f"{side} web" if side else ""
    name = f"{target.name}, {web}" if web else target.name
    target = replace(target, name=name, scene=scene)
    check_method(scene, "m53")
    enabled = load_kinds(throw, kind)[0]
    force, torque = radial_amplitude_N(throw, kind, enabled), torque_amplitude_Nm(throw, kind, enabled)
    size = dimensions(scene)
    _check_validity(scene, size)
    moment = force * share * web_lever_mm(scene)
    nominal = nominal_stresses(size, moment, force * share, torque * NMM_PER_NM)
    drilled = " of a throw that has this web twice, drilled in one half" if difference(scene) else ""
    note(f"{target.name}: four-point bending, three-point bending and torsion{drilled}")
    kinds: list[FieldKind] = ["moment", "bending", "torsion"]
    if any(off_plane(mouth) for _, mouth in pin_outlets(scene)):
        kinds.append("side_moment")
    model = solve_stresses(_held_by_rule(target), kinds, fillet_fraction, by_rule=True)
    scf_rule, scf_fem = concentration_factors(size), element_factors(model)
    outlets = check_outlets(throw, kind, enabled, torque * NMM_PER_NM, scene, share, model)

    def named(text: str) -> str:
        return named_in_throw(text, throw, side) if side else text

    return RuleCheck(
        target.name,
        model.throw_kg,
        size,
        AlternatingLoads(force, moment / NMM_PER_NM, torque),
        outside_validity(size),
        scf_rule,
        scf_fem,
        nominal,
        fillet_checks(scene, size, scf_rule, nominal),
        fillet_checks(scene, size, scf_fem, nominal),
        RuleQuality(**vars(model.quality)),
        tuple(replace(one, key=named(one.key)) for one in outlets),
        web,
        scene.fatigue.m53_factors,
        {named(place): why for place, why in unchecked_journal_outlets(scene).items()},
        uncovered_material(scene),
        process_remark(scene),
    )


def _check_validity(scene: Scene, size: Dimensions) -> None:
    """Refuse polynomials outside their validity, before anything is solved."""
    outside = outside_validity(size)
    if scene.fatigue.m53_factors == "polynomials" and outside:
        raise invalid(
            "fatigue.m53_factors",
            "polynomials",
            f"they are not valid here: {'; '.join(outside)}",
            "Take 'lower' or 'elements'.",
        )


def _held_by_rule(target: Target) -> Target:
    """The target on the bearings of Appendix III, which let the journals tilt, whatever the scene has."""
    supports = target.scene.supports.model_copy(update={"bending": "pinned", "torsion": "free"})
    return replace(target, scene=target.scene.model_copy(update={"supports": supports}))
