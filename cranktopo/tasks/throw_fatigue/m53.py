"""Crankshaft rule IACS UR M53: stress concentration factors, alternating stresses, acceptability.

Source: IACS, Unified Requirement M53, Calculation of crankshafts for internal combustion engines (Rev. 5,
2023), sections 1 to 6 and Appendix III for factors from finite elements.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.design.free_dimensions import M53_FILLET
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criterion import LAYERS, TREATMENT, SafetyMethod

RADIUS_EXPONENT = {"pin": 0.5231, "journal": 0.5568}
"""Concentration factors of bending fall by these powers of the fillet's radius (2.1.1 and 2.2.1)."""
LEAST_FACTOR = 1.15
"""Least acceptability factor."""


@dataclass(frozen=True)
class Dimensions:
    """A throw in the symbols of the rule, mm: attributes named after them.

    Attributes:
        pin, journal: diameters D, DG.
        pin_bore, journal_bore: DBH, DBG.
        pin_fillet, journal_fillet: RH, RG.
        throw: E.
        web_thickness, web_width: W, B.
        pin_recess, journal_recess: TH, TG.
    """

    pin: float
    journal: float
    throw: float
    web_thickness: float
    web_width: float
    pin_fillet: float
    journal_fillet: float
    pin_bore: float = 0.0
    journal_bore: float = 0.0
    pin_recess: float = 0.0
    journal_recess: float = 0.0

    @property
    def overlap(self) -> float:
        """Overlap s of pin and journal over the pin diameter."""
        return ((self.pin + self.journal) / 2 - self.throw) / self.pin

    @property
    def fillet_distance(self) -> float:
        """Distance of pin and journal fillet, sqrt(W^2 + S^2) with the overlap S in mm: Appendix V, 3 (1)."""
        return math.hypot(self.web_thickness, self.overlap * self.pin)


def dimensions(scene: Scene) -> Dimensions:
    """Return a scene in the symbols of the rule; the web is as wide as half-way between its axes."""
    throw = scene.throw
    main, pin, radius = throw.main_journal, throw.crankpin, throw.radius_mm
    return Dimensions(
        pin=pin.outer_diameter_mm,
        journal=main.outer_diameter_mm,
        throw=radius,
        web_thickness=scene.web.thickness_mm,
        web_width=2 * float(scene.web.half_width_mm(radius, np.array([radius / 2]))[0]),
        pin_fillet=pin.fillet_mm,
        journal_fillet=main.fillet_mm,
        pin_bore=pin.bore_diameter_mm,
        journal_bore=main.bore_diameter_mm,
        pin_recess=pin.fillet.recess_mm,
        journal_recess=main.fillet.recess_mm,
    )


@dataclass(frozen=True)
class ConcentrationFactors:
    """Stress concentration factors: alpha in the pin fillet, beta in the journal fillet."""

    alpha_bending: float
    alpha_torsion: float
    beta_bending: float
    beta_shear: float
    beta_torsion: float


@dataclass(frozen=True)
class Nominal:
    """Alternating nominal stresses, MPa.

    Attributes:
        bending_MPa: bending of the web.
        shear_MPa: radial force over the web's section.
    """

    bending_MPa: float
    shear_MPa: float
    pin_torsion_MPa: float
    journal_torsion_MPa: float


@dataclass(frozen=True)
class RuleHardening:
    """A surface-treated fillet by IACS UR M53, Appendix V.

    Attributes:
        process: "nitrided" or "induction".
        surface_acceptability: strength of the treated surface over the equivalent stress there.
        below_acceptability: strength of the transition to the core over the equivalent stress there.
        transition_mm: depth of the transition: that of the layer, or 1.2 times the nitriding depth.
        depth_mm: depth of the one that decides; 0 at the surface.
    """

    process: str
    surface_acceptability: float
    below_acceptability: float
    transition_mm: float
    depth_mm: float


@dataclass(frozen=True)
class FilletCheck:
    """One fillet against the rule.

    Attributes:
        hardening: of a surface-treated fillet, whose stress and strength are those of the place that decides.
    """

    equivalent_MPa: float
    strength_MPa: float
    hardening: RuleHardening | None = None

    @property
    def acceptability(self) -> float:
        """Strength over equivalent stress; the rule asks for 1.15."""
        return self.strength_MPa / self.equivalent_MPa

    @property
    def accepted(self) -> bool:
        """True if the rule accepts it."""
        return self.acceptability >= LEAST_FACTOR


@dataclass(frozen=True)
class Ratio:
    """A ratio of a throw that the rule's polynomials depend on, and where they are valid."""

    name: str
    value: float
    low: float
    high: float

    @property
    def valid(self) -> bool:
        """True if it lies in the range of the polynomials."""
        return self.low - 1e-12 <= self.value <= self.high + 1e-12


def ratios(d: Dimensions) -> tuple[Ratio, ...]:
    """Return the ratios of a throw that the rule names, each with the range of its polynomials."""
    return (
        Ratio("pin fillet / pin diameter", d.pin_fillet / d.pin, *M53_FILLET),
        Ratio("journal fillet / pin diameter", d.journal_fillet / d.pin, *M53_FILLET),
        Ratio("overlap / pin diameter", d.overlap, -math.inf, 0.5),
        Ratio("web thickness / pin diameter", d.web_thickness / d.pin, 0.2, 0.8),
        Ratio("web width / pin diameter", d.web_width / d.pin, 1.1, 2.2),
        Ratio("journal bore / pin diameter", d.journal_bore / d.pin, 0.0, 0.8),
        Ratio("pin bore / pin diameter", d.pin_bore / d.pin, 0.0, 0.8),
    )


def outside_validity(d: Dimensions) -> tuple[str, ...]:
    """Return the ratios that lie outside the range of the rule's polynomials, with their range."""
    return tuple(
        f"{ratio.name} = {ratio.value:.3g} (valid {ratio.low:g} to {ratio.high:g})"
        for ratio in ratios(d)
        if not ratio.valid
    )


def concentration_factors(d: Dimensions) -> ConcentrationFactors:
    """Return the rule's polynomials; of little meaning outside their validity (`outside_validity`)."""
    s, w, b = max(d.overlap, -0.5), d.web_thickness / d.pin, d.web_width / d.pin
    bores = d.journal_bore / d.pin, d.pin_bore / d.pin
    rec = max(1 + (d.pin_recess + d.journal_recess) / d.pin * (1.8 + 3.2 * d.overlap), 1.0)
    pin, journal = d.pin_fillet / d.pin, d.journal_fillet / d.pin
    return ConcentrationFactors(
        _alpha_bending(s, w, b, pin, bores) * rec,
        _torsion(s, w, b, pin),
        _beta_bending(s, w, b, journal, bores) * rec,
        _beta_shear(s, w, b, journal, d.pin_bore / d.pin) * rec,
        _torsion(s, w, b, d.journal_fillet / d.journal),
    )


def fatigue_strength_MPa(diameter_mm: float, fillet_mm: float, ultimate_MPa: float, process: float) -> float:
    """Fatigue strength of a fillet.

    Args:
        fillet_mm: its radius; less than 2 mm counts as 2 mm.
        process: 1.05 drop forged, 1.0 free forged, 0.93 cast.
    """
    radius = max(fillet_mm, 2.0)
    size = 0.264 + 1.073 * diameter_mm**-0.2
    return (
        process
        * (0.42 * ultimate_MPa + 39.3)
        * (size + (785 - ultimate_MPa) / 4900 + 196 / ultimate_MPa * math.sqrt(1 / radius))
    )


def nominal_stresses(d: Dimensions, moment_Nmm: float, force_N: float, torque_Nmm: float) -> Nominal:
    """Nominal stresses of alternating section forces.

    Args:
        moment_Nmm: bending moment at the web's mid-plane.
        force_N: radial force through the web.
        torque_Nmm: torque through pin and journal.
    """

    def modulus(outer: float, bore: float) -> float:
        return math.pi / 16 * (outer**4 - bore**4) / outer

    return Nominal(
        moment_Nmm / (d.web_width * d.web_thickness**2 / 6),
        force_N / (d.web_width * d.web_thickness),
        torque_Nmm / modulus(d.pin, d.pin_bore),
        torque_Nmm / modulus(d.journal, d.journal_bore),
    )


def pin_equivalent_MPa(f: ConcentrationFactors, n: Nominal, additional_MPa: float) -> float:
    """Equivalent alternating stress in the pin fillet.

    Args:
        additional_MPa: additional bending stress from misalignment and vibration.
    """
    bending = f.alpha_bending * n.bending_MPa + additional_MPa
    return math.sqrt(bending**2 + 3 * (f.alpha_torsion * n.pin_torsion_MPa) ** 2)


def journal_equivalent_MPa(f: ConcentrationFactors, n: Nominal, additional_MPa: float) -> float:
    """Equivalent alternating stress in the journal fillet.

    Args:
        additional_MPa: additional bending stress from misalignment and vibration.
    """
    bending = f.beta_bending * n.bending_MPa + f.beta_shear * n.shear_MPa + additional_MPa
    return math.sqrt(bending**2 + 3 * (f.beta_torsion * n.journal_torsion_MPa) ** 2)


def _poly(x: float, *coefficients: float) -> float:
    return sum(c * x**i for i, c in enumerate(coefficients))


def _alpha_bending(s: float, w: float, b: float, r: float, bores: tuple[float, float]) -> float:
    sw = _poly(
        1 - s,
        _poly(w, -4.1883, 29.2004, -77.5925, 91.9454, -40.0416),
        _poly(w, 9.5440, -58.3480, 159.3415, -192.5846, 85.2916),
        _poly(w, -3.8399, 25.0444, -70.5571, 87.0328, -39.1832),
    )
    breadth = _poly(b, 0.6840, -0.0077, 0.1473)
    journal_bore = _poly(bores[0], 0.9993, 0.27, -1.0211, 0.5306)
    pin_bore = _poly(bores[1], 0.9978, 0.3145, -1.5241, 2.4147)
    radius = 0.2081 * r ** -RADIUS_EXPONENT["pin"]
    return 2.6914 * sw * 2.1790 * w**0.7171 * breadth * radius * journal_bore * pin_bore


def _torsion(s: float, w: float, b: float, r: float) -> float:
    return 0.8 * r ** (-0.322 + 0.1015 * (1 - s)) * _poly(b, 7.8955, -10.654, 5.3482, -0.857) * w**-0.145


def _beta_bending(s: float, w: float, b: float, r: float, bores: tuple[float, float]) -> float:
    sw = _poly(
        1 - s,
        _poly(w, -1.7625, 2.9821, -1.5276),
        _poly(w, 5.1169, -5.8089, 3.1391),
        _poly(w, -2.1567, 2.3297, -1.2952),
    )
    breadth = _poly(b, 0.5616, 0.1197, 0.1176)
    journal_bore = _poly(bores[0], 1.0012, -0.6441, 1.2265)
    pin_bore = _poly(bores[1], 1.0022, -0.1903, 0.0073)
    radius = 0.1908 * r ** -RADIUS_EXPONENT["journal"]
    return 2.7146 * sw * 2.2422 * w**0.7548 * breadth * radius * journal_bore * pin_bore


def _beta_shear(s: float, w: float, b: float, r: float, pin_bore: float) -> float:
    overlap = _poly(1 - s, 0.4368, 2.1630, -1.5212)
    hollow = _poly(pin_bore, 0.9937, -1.1949, 1.7373)
    return 3.0128 * overlap * w / (0.0637 + 0.9369 * w) * (b - 0.5) * 0.5331 * r**-0.2038 * hollow


def _check_round_fillets(scene: Scene) -> None:
    for key in ("main_journal", "crankpin"):
        fillet = getattr(scene.throw, key).fillet
        if not fillet.round:
            raise invalid(
                f"{scene.name}: throw.{key}.fillet_axial_mm",
                fillet.axial_mm,
                "method 'm53' takes factors and strength from the radius of a round fillet",
                "Take another --method, or leave the key out.",
            )


_LEAST_HV = {"nitrided": 600.0, "induction": 400.0}
"""Hardness of the surface from which Appendix V has a strength for it."""


def _check_treatment(scene: Scene) -> None:
    for fillet, one in scene.fatigue.hardened.items():
        if one.process == "rolled":
            raise CranktopoError(
                f"{scene.name}: fatigue.hardening: method 'm53' has no formula for rolled {fillet} fillets: "
                "their strength follows from tests (Appendix V, 6).",
                hint="Give fatigue.surface_treatment_factor with its source, or take --method lsa or fkm.",
            )
        least = _LEAST_HV[one.process]
        if one.surface_hardness_HV < least:
            raise invalid(
                f"{scene.name}: fatigue.hardening.surface_hardness_HV",
                one.surface_hardness_HV,
                f"method 'm53' has a strength of {one.process} surfaces from {least:g} HV on (Appendix V)",
                "Take --method lsa or fkm.",
            )


def _check(scene: Scene) -> None:
    _check_round_fillets(scene)
    _check_treatment(scene)


M53 = SafetyMethod(
    "m53",
    ("ultimate_MPa",),
    takes=(*TREATMENT, *LAYERS, "process_factor", "additional_stress_MPa", "m53_factors"),
    check=_check,
    includes="size, no mean stress, strength by the rule's formula; UR M53 asks for 1.15",
)
