"""Outlets of oil bores in the crankpin by the crankshaft rule IACS UR M53: the third place that it checks.

Source: IACS, Unified Requirement M53: moments at the outlet M53.2.1.1.2 and 2.1.2.2, stresses 2.1.4 and
2.2.3, factors M53.3.4, equivalent stress M53.5.2, strength M53.6. The factors are those of a radial bore; of
any other there are those of elements (`outlet_elements`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from cranktopo.design.material import M53Factors
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import HistoryKind, LoadHistory, rated_histories, tangential_range_N
from cranktopo.tasks.throw_fatigue.m53 import FilletCheck, fatigue_strength_MPa
from cranktopo.tasks.throw_fatigue.outlet_elements import OutletFactors, element_outlet_factors
from cranktopo.tasks.throw_fatigue.stress_model import StressModel
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.outlet import DrillOutlet
from cranktopo.throw.drilling.table import drill_bores

GoverningFactors = Literal["polynomials", "elements"]
_LARGEST_BORE = 0.2
"""Largest bore over the pin's diameter for which the factors are given."""
_RADIAL_DEG = 1.0
"""Lean from the normal up to which a bore counts as radial."""


@dataclass(frozen=True)
class OutletCheck:
    """One outlet of an oil bore in the crankpin against the rule.

    Attributes:
        key: of the drilling in the scene.
        angle_deg: about the pin's axis from the throw direction.
        gamma_bending, gamma_torsion: concentration factors.
        bending_MPa, torsion_MPa: nominal alternating stresses.
        check: equivalent alternating stress and fatigue strength.
        outside: what lies outside the validity of the factors, in words.
        elements: factors of finite elements; None before these are solved.
        sharp: the outlet has no rounding, so that its largest stress is that of an edge.
        m53_factors: set of factors that the scene lets govern.
        bore_mm: diameter of the bore.
        rounding_mm: radius of the outlet's rounding.
    """

    key: str
    angle_deg: float
    gamma_bending: float
    gamma_torsion: float
    bending_MPa: float
    torsion_MPa: float
    check: FilletCheck
    outside: tuple[str, ...]
    elements: OutletFactors | None = None
    sharp: bool = False
    m53_factors: M53Factors = "lower"
    bore_mm: float = 0.0
    rounding_mm: float = 0.0

    @property
    def by_elements(self) -> FilletCheck | None:
        """The outlet with the factors of elements."""
        if self.elements is None:
            return None
        stress = outlet_equivalent_MPa(
            self.elements.gamma_bending * self.bending_MPa, self.elements.gamma_torsion * self.torsion_MPa
        )
        return FilletCheck(stress, self.check.strength_MPa)

    @property
    def unproven(self) -> str:
        """Reason why the elements prove nothing here; empty where they do."""
        if self.elements is None:
            return "no elements are solved"
        if self.sharp:
            return "the outlet is sharp (outlet_radius_mm = 0)"
        return "" if self.elements.checks.within_limits else self.elements.checks.shortfall

    @property
    def waits_for_mesh(self) -> bool:
        """Tell whether elements of a finer mesh may judge it."""
        missed = self.elements is not None and not self.elements.checks.within_limits
        return self.judged is None and missed and not self.sharp and self.m53_factors != "polynomials"

    @property
    def governed_by(self) -> GoverningFactors | None:
        """The set of factors that governs, the lower one by default; None where none is valid or proven.

        As at fillets: elements that have less than valid polynomials and prove nothing leave the outlet open,
        unless the polynomials refuse it by themselves. Those of an edge without rounding say nothing at all.
        """
        found: dict[GoverningFactors, FilletCheck] = {}
        if not self.outside and (self.m53_factors != "elements" or self.elements is None):
            found["polynomials"] = self.check
        if self.by_elements and not self.unproven and self.m53_factors != "polynomials":
            found["elements"] = self.by_elements
        if not found or self.doubted:
            return None
        lower: GoverningFactors = min(found, key=lambda name: found[name].acceptability)
        return lower

    @property
    def doubted(self) -> bool:
        """Valid polynomials accept the outlet, and elements of a mesh that is too coarse have less."""
        found = self.by_elements
        if found is None or self.sharp or self.outside or self.m53_factors != "lower" or not self.unproven:
            return False
        return self.check.accepted and found.acceptability < self.check.acceptability

    @property
    def judged(self) -> FilletCheck | None:
        """The outlet with the factors that govern; None where it is not judged."""
        return {"polynomials": self.check, "elements": self.by_elements, None: None}[self.governed_by]

    @property
    def decisive_check(self) -> FilletCheck:
        """The outlet with the factors that govern; where none does, with those that are valid there."""
        return self.judged or (self.by_elements if self.outside else None) or self.check

    @property
    def not_judged(self) -> str:
        """Reason why the outlet is not judged, with what the elements say; empty where it is."""
        if self.judged is not None:
            return ""
        found = self.by_elements
        if found is None:
            return "; ".join(self.outside)
        why = self.unproven or "fatigue.m53_factors is 'polynomials'"
        return f"{'; '.join([*self.outside, why])} (Q {found.acceptability:.3f} by these elements)"

    @property
    def acceptability(self) -> float | None:
        """Strength over equivalent stress; None where the rule's factors are not valid."""
        return None if self.outside else self.check.acceptability

    @property
    def place(self) -> str:
        """Name in a table."""
        return f"outlet at {self.angle_deg:.0f} deg ({self.key})"


def outlet_factors(bore_mm: float, pin_mm: float) -> tuple[float, float]:
    """Concentration factors of a radial bore's outlet in bending and in torsion, UR M53.3.4."""
    d = bore_mm / pin_mm
    return 3 - 5.88 * d + 34.6 * d**2, 4 - 6 * d + 30 * d**2


def outlet_equivalent_MPa(bending_MPa: float, torsion_MPa: float) -> float:
    """Equivalent alternating stress of an outlet from both stresses with their factors, UR M53.5.2.

    The rule's form divides by the bending stress; this one is the same and holds where that is 0.
    """
    return (bending_MPa + 2 * math.sqrt(bending_MPa**2 + 9 / 4 * torsion_MPa**2)) / 3


def check_outlets(
    scene: Scene,
    kind: HistoryKind,
    enabled: frozenset[str],
    torque_Nmm: float,
    half: Scene | None = None,
    share: float = 0.5,
    model: StressModel | None = None,
) -> tuple[OutletCheck, ...]:
    """Return every outlet of an oil drilling on the crankpin; none where the scene has no drilling.

    Args:
        kind: the whole cycle, or its extremes joined, which bounds it.
        enabled: effects that are on; the tangential force always bends the pin here.
        torque_Nmm: alternating torque.
        half: the throw of two webs as on this side, where they differ; drillings of its first half count.
        share: of the force on the pin that the bearing on this side takes.
        model: unit stresses of that throw, for the factors of elements.

    Raises:
        CranktopoError: the scene does not tell the loads.
    """
    half = half or scene
    outlets = pin_outlets(half)
    if not outlets:
        return ()
    histories = rated_histories(scene, kind, enabled | {"tangential"})
    tangential = tangential_range_N(scene, enabled) if kind == "extremes" else None
    found = (
        _check(half, share, channel, mouth, (histories, tangential), torque_Nmm) for channel, mouth in outlets
    )
    if model is None:
        return tuple(found)
    return tuple(
        replace(one, elements=element_outlet_factors(model, *outlet))
        for one, outlet in zip(found, outlets, strict=True)
    )


def pin_outlets(half: Scene) -> list[tuple[DrillBore, DrillOutlet]]:
    """Return the drillings of a half throw with each of their outlets on the crankpin's surface."""
    return [
        (channel, mouth)
        for channel in drill_bores(half)
        for mouth in channel.outlets
        if mouth.journal == "crankpin" and not mouth.in_bore
    ]


def _check(
    scene: Scene,
    share: float,
    channel: DrillBore,
    mouth: DrillOutlet,
    loads: tuple[Sequence[LoadHistory], float | None],
    torque_Nmm: float,
) -> OutletCheck:
    pin, bore = scene.throw.crankpin, 2 * channel.radius_mm
    size = pin.outer_diameter_mm
    gamma = outlet_factors(bore, size)
    modulus = math.pi / 32 * (size**4 - pin.bore_diameter_mm**4) / size
    bending = _alternating_moment_Nmm(scene, share, mouth, *loads) / modulus
    torsion = torque_Nmm / (2 * modulus)
    settings = scene.fatigue
    # Factors of the process above 1, and treatments of the fillets, count in the fillets alone.
    strength = fatigue_strength_MPa(
        size, bore / 2, scene.material.ultimate_MPa or 0.0, min(settings.process_factor, 1.0)
    )
    stress = outlet_equivalent_MPa(gamma[0] * bending, gamma[1] * torsion)
    check = FilletCheck(stress, strength)
    angle = math.degrees(math.atan2(mouth.normal[0], mouth.normal[1]))
    return OutletCheck(
        channel.key,
        angle,
        *gamma,
        bending,
        torsion,
        check,
        _outside(bore / size, mouth),
        sharp=not mouth.rounding_mm,
        m53_factors=settings.m53_factors,
        bore_mm=bore,
        rounding_mm=mouth.rounding_mm,
    )


def unchecked_journal_outlets(scene: Scene) -> dict[str, str]:
    """Return the outlets on main journals thinner than the pin, and why the rule has no factors for them.

    Source: UR M53.1.6, which lets them pass by their form alone on a journal at least as thick as the pin.
    """
    pin, journal = scene.throw.crankpin.outer_diameter_mm, scene.throw.main_journal.outer_diameter_mm
    if journal >= pin:
        return {}
    why = f"the main journal ({journal:g} mm) is thinner than the crankpin ({pin:g} mm)"
    return {
        f"outlet on the main journal ({channel.key})": why
        for channel in drill_bores(scene)
        for mouth in channel.outlets
        if mouth.journal == "main_journal" and not mouth.in_bore
    }


def _alternating_moment_Nmm(
    scene: Scene,
    share: float,
    mouth: DrillOutlet,
    histories: Sequence[LoadHistory],
    tangential_N: float | None,
) -> float:
    """Alternating moment at the outlet: triangular diagrams of radial and tangential force.

    Over each web's own cycle at one speed, the largest of them, where no range of the tangential force is
    given; else of the ranges of both joined.
    """
    aside, along, _ = mouth.normal
    # Largest at the pin's middle: an outlet beyond it counts as there.
    lever = share * min(mouth.point_mm[2], scene.pitch_mm / 2)
    if tangential_N is None:
        bending = (one.tangential_N * aside - one.radial_N * along for one in histories)
        return lever * max(float(np.ptp(at)) for at in bending) / 2
    radial = max(float(np.ptp(one.radial_N)) for one in histories)
    return float(lever * (radial * abs(along) + tangential_N * abs(aside)) / 2)


def _outside(bore: float, mouth: DrillOutlet) -> tuple[str, ...]:
    found = []
    if bore > _LARGEST_BORE:
        found.append(f"oil bore / pin diameter = {bore:.3g} (valid 0 to {_LARGEST_BORE:g})")
    if mouth.obliquity_deg > _RADIAL_DEG:
        found.append(f"leans {mouth.obliquity_deg:.0f} deg (valid for a radial bore)")
    return tuple(found)
