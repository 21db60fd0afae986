"""The fatigue of targets: the JSON object of `fatigue --json`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.assumed import Assumption
from cranktopo.engine.histories import HistoryKind
from cranktopo.tasks.throw_fatigue.m53 import ConcentrationFactors, Nominal, RuleHardening
from cranktopo.tasks.throw_fatigue.mesh_quality import JudgedQuality, Quality

JudgedAs = Literal["throw_alone", "continuous_shaft"]


class CriticalPoint(Result):
    """The point of least safety of a part of the surface."""

    place: str
    """Place in words."""
    fillet: str | None
    """The fillet, "journal" or "pin"; null off the fillets."""
    around_deg: float | None
    """Angle about the journal's or the pin's axis from the throw direction +y toward +x."""
    along_deg: float | None
    """Angle along the fillet's arc, 0 at the cylinder, 90 at the web's face."""
    web: str | None
    """The web, "first" or "second", of a throw with two different halves."""
    point_mm: tuple[float, float, float]
    """Coordinates x, y, z."""
    safety: float
    """Least safety."""
    amplitude_MPa: float
    """Half the range of the signed von Mises stress."""
    mean_MPa: float
    """Mean of the signed von Mises stress."""
    gradient_per_mm: float
    """Related stress gradient into the depth."""
    strength_MPa: float
    """Fully reversed strength of the point."""
    amplitude_share: float
    """Fraction of the used strength that the amplitude uses, 0 to 1; by critical planes that of the shear."""
    decided_by: str
    """The stress that uses up more of the strength: amplitude, or mean, normal or hydrostatic stress."""
    factors: dict[str, float]
    """Factors of the method, by their symbols."""
    states: tuple[str, str]
    """The two extreme load states."""
    depth_mm: float | None = UNLESS_NONE
    """Depth below the point that decides, 0 at the surface, on a fillet hardened by `[fatigue.hardening]`;
    its strength is then that of a surface as safe."""


class SurfaceTreatment(Result):
    """Treatment of the fillets' surface."""

    factor: float
    """Factor on the strength; 1 without a treatment."""
    source: str | None
    """Origin of the factor."""


class HardenedFillet(Result):
    """A hardened, nitrided or rolled fillet at its point of least safety."""

    process: str
    """Treatment: "nitrided", "induction" or "rolled"."""
    case_depth_mm: float
    """Depth of the treatment."""
    surface_hardness_HV: float
    """Hardness at the surface."""
    core_hardness_HV: float
    """Hardness of the core, given or from the tensile strength."""
    safety: float
    """Least safety over all depths."""
    safety_surface: float
    """Safety at the surface."""
    safety_below: float
    """Least safety below the surface; where the surface decides, from the depth of the treatment on."""
    depth_mm: float
    """Depth that decides; 0 at the surface."""
    hardness_HV: float
    """Hardness at that depth."""
    residual_stress_MPa: float
    """Residual stress at that depth, compression negative."""
    stress_share: float
    """Working stress at that depth over that at the surface."""
    untreated_safety: float
    """Safety of the point without the treatment."""
    gain: float
    """Safety over that without the treatment: the factor of the surface treatment that this is."""
    safety_high: float | None = UNLESS_NONE
    """Least safety over all depths at the other end of `residual_scatter_MPa`, which `safety` has to the safe
    side."""


class PointScatter(Result):
    """Probability of failure of a point by the scatter of `[fatigue.scatter]`, to first order."""

    failure_probability: float
    """Probability that the strength is exceeded."""
    reliability_index: float
    """Distance of the most likely failure from the mean, in standard deviations."""
    shares: dict[str, float]
    """Parts of "strength", "load" and "fillet_radius" in that distance; they sum to one."""


class PartLife(Result):
    """Life of a part of the surface by `[fatigue.spectrum]`."""

    life_hours: float | None
    """Hours until the permitted damage at the point and the throw that live shortest; null where no cycle
    exceeds the fatigue limit."""
    throw: str | None
    """That throw in words."""
    damage_shares: dict[str, float]
    """Part of each speed, in rpm, in the damage; they sum to one."""


class _TargetFatigue(Result):
    target: str
    """Name of the target."""
    throw_kg: float
    """Mass of one throw."""
    safety: float
    """Least safety of fillets, oil outlets, rounded edges and faces; by the rule, acceptability, that of
    unproven elements among it."""
    strength_remarks: tuple[str, ...] | None = UNLESS_NONE
    """Limits of what the strengths of the material hold for, such as the section of the crank."""
    left_off: str | None = UNLESS_NONE
    """Loads that the safety does not count although they are above the threshold, in words."""


class FieldFatigue(_TargetFatigue):
    """Safety of a target by a criterion of local stresses or of critical planes."""

    fillet_safety: dict[str, float]
    """Least safety of the journals' and of the pin's fillets."""
    web_safety: dict[str, float] | None = UNLESS_NONE
    """Least safety of the first and of the second web, where they differ."""
    largest_stress_MPa: float
    """Largest von Mises stress of fillets, oil outlets, rounded edges and faces over the load states."""
    critical: CriticalPoint
    """The point of least safety of fillets, oil outlets, rounded edges and faces."""
    at_outlet: CriticalPoint | None = UNLESS_NONE
    """The point of least safety at the outlets of oil bores, where there are any."""
    at_sharp_edges: CriticalPoint | None
    """The point of least safety at sharp inner edges, which the mesh decides; null without any."""
    not_judged: str | None = UNLESS_NONE
    """Outlets of oil bores that are not judged, and from which place on they are."""
    judged_as: JudgedAs
    """Body of that safety: a throw alone, or one in its shaft on all main bearings."""
    safety_as: dict[JudgedAs, float] | None = UNLESS_NONE
    """Least safety of the throw alone and in its shaft, where both were found: by `compare`, and where the
    plan alone has the effect `continuous_shaft` on."""
    load_states: int
    """Number of load states."""
    unit_loads: tuple[str, ...]
    """Unit loads that were solved."""
    quality: JudgedQuality
    """The mesh and its checks."""
    assumed: tuple[Assumption, ...]
    """Keys that the target does not give and its safety depends on."""
    surface_treatment: SurfaceTreatment
    """Treatment of the fillets' surface."""
    hardening: dict[str, HardenedFillet] | None = UNLESS_NONE
    """Fillets hardened by `[fatigue.hardening]`, "pin" and "journal"."""
    lives: dict[str, PartLife] | None = UNLESS_NONE
    """By `[fatigue.spectrum]`: the "pin" and "journal" fillets and "elsewhere"."""
    scatter: dict[str, PointScatter] | None = UNLESS_NONE
    """By `[fatigue.scatter]`: points of least safety of the "pin" and "journal" fillets and "elsewhere"."""


@dataclass(frozen=True)
class AlternatingLoads:
    """Half the range of the loads over the working cycle.

    Attributes:
        radial_N: on the pin, toward the crank axis.
        moment_Nm: bending moment at the web's mid-plane.
        torque_Nm: that the throw passes on.
    """

    radial_N: float
    moment_Nm: float
    torque_Nm: float


class RuleFactors(Result):
    """Concentration factors by the rule's polynomials and by finite elements."""

    closed_form: ConcentrationFactors
    """By the polynomials of the rule."""
    finite_elements: ConcentrationFactors
    """By finite elements, as Appendix III of the rule defines them."""


class FilletAcceptance(Result):
    """A fillet against the rule."""

    equivalent_MPa: float
    """Equivalent alternating stress."""
    strength_MPa: float
    """Fatigue strength."""
    acceptability: float
    """Strength over equivalent stress."""
    hardening: RuleHardening | None = UNLESS_NONE
    """Surface and transition of a fillet treated by `[fatigue.hardening]`, of which the worse counts."""


class RuleFillets(Result):
    """Pin and journal fillet against the rule with either set of factors."""

    closed_form: dict[str, FilletAcceptance]
    """With the factors of the polynomials."""
    finite_elements: dict[str, FilletAcceptance]
    """With the factors of finite elements."""


class OutletElementsAcceptance(Result):
    """An outlet of an oil bore with the concentration factors of finite elements."""

    gamma_bending: float
    """Concentration factor in bending, in the plane through the pin's axis and the outlet."""
    gamma_torsion: float
    """Concentration factor in torsion."""
    equivalent_MPa: float
    """Equivalent alternating stress."""
    acceptability: float
    """Strength over equivalent stress."""
    normal_percent: float
    """Surface-normal stress over the largest principal stress at the peak; the rule allows 3 %."""
    jump_percent: float
    """Jump between elements at the peak; the rule allows 5 %."""
    proven: bool
    """True if the mesh keeps both checks and the outlet is rounded."""


class OutletAcceptance(Result):
    """An outlet of an oil bore in the crankpin against the rule."""

    key: str
    """The drilling in the scene."""
    angle_deg: float
    """Angle about the pin's axis from the throw direction."""
    gamma_bending: float
    """Concentration factor in bending."""
    gamma_torsion: float
    """Concentration factor in torsion."""
    bending_MPa: float
    """Nominal alternating bending stress."""
    torsion_MPa: float
    """Nominal alternating torsional stress."""
    equivalent_MPa: float
    """Equivalent alternating stress with these factors, valid or not."""
    strength_MPa: float
    """Fatigue strength."""
    acceptability: float | None
    """Strength over equivalent stress; null where the rule's factors are not valid."""
    outside_validity: tuple[str, ...]
    """Ratios outside the validity of the factors."""
    elements: OutletElementsAcceptance | None
    """The same with the factors of finite elements; null where the model has no such bore."""
    governed_by: str | None
    """Factors that govern, "polynomials" or "elements"; null where the outlet is not judged."""


class RuleFatigue(_TargetFatigue):
    """A target, or one of its two different webs, against IACS UR M53."""

    accepted: bool
    """True if the rule judges and accepts both fillets and every outlet of an oil bore."""
    verdict: str
    """Answer of the rule: "accepted", "not accepted", "not judged" with an outlet beyond its factors, or "not
    covered" where the material is no steel."""
    governing_factors: dict[str, str | None]
    """Factors that govern at each fillet, "polynomials" or "elements", as `fatigue.m53_factors` has it; null
    where the fillet is not judged."""
    not_judged: dict[str, str]
    """Places that neither the rule's polynomials nor proven elements judge, and why."""
    not_covered: str | None = UNLESS_NONE
    """Reason why the rule does not cover the material."""
    process_remark: str | None = UNLESS_NONE
    """Remark where the factor K does not fit the way the crank is made."""
    least_acceptability: float
    """Acceptability factor that the rule requires."""
    alternating: AlternatingLoads
    """Alternating loads."""
    outside_validity: tuple[str, ...]
    """Ratios outside the validity of the rule's polynomials."""
    factors: RuleFactors
    """Concentration factors."""
    nominal: Nominal
    """Nominal alternating stresses."""
    fillets: RuleFillets
    """Both fillets against the rule."""
    outlets: tuple[OutletAcceptance, ...]
    """Outlets of oil bores in the crankpin."""
    quality: Quality
    """The mesh and its checks."""
    assumed: tuple[Assumption, ...]
    """Keys that the target does not give and its safety depends on."""
    surface_treatment: SurfaceTreatment
    """Treatment of the fillets' surface."""


class FatigueShare(Result):
    """A target in percent of the baseline."""

    target: str
    """Name of the target."""
    safety_percent: float
    """Its safety."""
    mass_percent: float
    """Mass of its throw."""


class FatigueResult(Result):
    """Fatigue of targets by one method."""

    schema_version: int = 1
    """Version of these keys."""
    method: str
    """Method as in `--method`."""
    loads: HistoryKind
    """Loads of a throw alone: their extremes joined ("extremes"), or every angle of the cycle ("cycle")."""
    baseline: str | None
    """Target that counts as 100 %."""
    mirrored_web: str | None = UNLESS_NONE
    """That throws whose halves differ count with one web twice, as that beside them has; null where none."""
    fatigue: tuple[FieldFatigue | RuleFatigue, ...]
    """One entry per target; by the rule, one per web where the two differ."""
    percent_of_baseline: tuple[FatigueShare, ...] | None
    """Targets in percent of the baseline, where there is one."""
