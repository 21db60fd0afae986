"""The strength of the rod: the JSON object of `rod --json`."""

from __future__ import annotations

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.assumed import Assumption
from cranktopo.tasks.bolts.result import JointCheck
from cranktopo.tasks.rod.pin import PinCheck

_CLOSED_FORM = {"small end": "eye, worst"}
"""Section in closed form of a place by elements; by default that of its name."""


class RodMasses(Result):
    """Masses of the rod from its geometry; those of the ends are what the engine's forces use."""

    total_kg: float
    body_kg: float
    """Rod and cap without bush, shells and bolts."""
    below_split_kg: float
    """Cap with its shell and the heads of the bolts."""
    reciprocating_kg: float
    rotating_kg: float
    centre_from_big_end_mm: float
    centre_across_mm: float | None = UNLESS_NONE
    """Of an oblique split: distance from the rod's axis toward the side on which the split falls."""
    inertia_kg_mm2: float
    """About the centre of mass, for swinging."""


class RodSectionCheck(Result):
    """One place of the rod under the extremes of the cycle; stresses positive in tension."""

    section: str
    place_mm: float
    """Distance from the axis of the big end."""
    area_mm2: float
    push_N: float
    """Largest compression."""
    pull_N: float
    """Largest tension."""
    whip_MPa: float
    """Largest bending stress of the rod's own mass at speed; null where it is not in the section."""
    max_MPa: float
    min_MPa: float
    yield_safety: float
    fatigue_safety: float


class Buckling(Result):
    """The shank as a strut in one plane, by Navier and Rankine."""

    plane: str
    """`motion`: hinged at both pins; `pins`: held at both eyes."""
    length_mm: float
    """Buckling length."""
    slenderness: float
    euler_N: float
    rankine_N: float
    """Load at which the stress below reaches the yield strength."""
    stress_MPa: float
    """Compression with the allowance for buckling, under the largest push."""
    yield_safety: float


class FreeDimension(Result):
    """A dimension of the rod that the search was free to change."""

    name: str
    start_mm: float
    value_mm: float
    low_mm: float
    high_mm: float


class LighterRod(Result):
    """A rod that was searched: of two values the first is that of the design's own rod."""

    start_kg: float
    result_kg: float
    smallest_yield_safety: tuple[float, float]
    """Of all sections and struts."""
    smallest_fatigue_safety: tuple[float, float]
    elements_yield_safety: tuple[float, float] | None = UNLESS_NONE
    """Smallest of all places by finite elements, with `--fea`."""
    elements_fatigue_safety: tuple[float, float] | None = UNLESS_NONE
    """Smallest of all places by finite elements, with `--fea`."""
    small_end_ovalisation_um: tuple[float, float]
    """Largest change of the bore's diameter that is judged, in closed form under the pull."""
    big_end_ovalisation_um: tuple[float, float]
    elements_small_end_ovalisation_um: tuple[float, float] | None = UNLESS_NONE
    """By finite elements, with `--fea`; where rigid pins touch under pull or push."""
    elements_big_end_ovalisation_um: tuple[float, float] | None = UNLESS_NONE
    result_without_limits_kg: float | None = UNLESS_NONE
    """Mass that the same search finds without limits of ovalisation, where there are any; in closed form."""
    rods_by_elements: int | None = UNLESS_NONE
    """Rods that elements have judged until the search was settled, beside the own one, with `--fea`."""
    speed_rpm: float
    """Highest speed, of the next two."""
    crankpin_pull_N: tuple[float, float]
    """Largest radial force on the crankpin away from the crank."""
    rotating_unbalance_kg_mm: tuple[float, float]
    """The rod's part of the unbalance of a throw."""
    dimensions: tuple[FreeDimension, ...]


class RodPlace(Result):
    """One place of the rod by finite elements, from sharp inner edges away; von Mises stress with the sign of
    the first invariant. With an oblique split each point is judged for the worse way to mount the rod."""

    place: str
    point_mm: tuple[float, float, float]
    """Point of the largest von Mises stress: across the rod, from the axis of the big end, along the pins."""
    max_MPa: float
    """Highest stress of the cycle there."""
    min_MPa: float
    """Lowest stress of the cycle there."""
    error_percent: float | None
    """Change of the largest von Mises stress from a mesh 1.5 times coarser; null where that has none here."""
    yield_safety: float
    fatigue_safety: float
    """Least of the place."""
    fatigue_error_percent: float | None
    """Change of it from a mesh 1.5 times coarser; null where that has none here."""
    fatigue_point_mm: tuple[float, float, float]
    amplitude_MPa: float
    """At the point of least fatigue safety: von Mises stress of half the range of the stress tensor."""
    mean_MPa: float
    """At the point of least fatigue safety: first invariant of the tensor midway, at most its von Mises
    stress."""
    gradient_per_mm: float
    """Related gradient of the amplitude at the point of least fatigue safety."""


class EyeShape(Result):
    """Change of an eye's bore under the largest push or pull; by elements mean over its width."""

    eye: str
    load: str
    force_N: float
    """Force on the bore along the rod."""
    contact_deg: float
    """Angle from the middle of the pressed half to where the pressure ends."""
    across_um: float
    """Change of the diameter across the rod."""
    along_um: float
    """Change of the diameter along the rod."""
    ovalisation_um: float
    """The larger of both, without its sign; of an oblique split that of all diameters, in closed form of the
    big end alone."""
    judged: bool
    """True where a limit is for this load: not for a push by the cosine, which opens a bore by more than any
    clearance, so that the pin leaves the flanks that the cosine presses."""
    permitted_um: float | None
    """Largest permitted ovalisation; null without a limit, and where it is not judged."""


class SharpEdge(Result):
    """The largest stress near sharp inner edges, where it follows from the mesh."""

    point_mm: tuple[float, float, float]
    von_mises_MPa: float


class RodPreload(Result):
    """Preload of each bolt of the cap, and the least pressure that it leaves between rod and cap."""

    mean_N: float
    """Middle of what tightening may leave: it is in the stresses throughout the cycle."""
    largest_N: float
    least_N: float
    """After settling."""
    least_pressure_MPa: float
    """Over the cycle on the edges of the split and in its holes, with the least preload. Negative where the
    split opens: there rod and cap are not the one body that elements make of them."""
    point_mm: tuple[float, float, float]
    """Point of the least pressure."""


class RodElements(Result):
    """The rod by finite elements under pressure in both eyes, inertia, press fit and preload: a quarter, or a
    half where the split is oblique."""

    contact: bool
    """Pressure of the pins where they touch as rigid ones, in place of the cosine over half of each bore."""
    element_size_mm: float
    nodes: int
    residual: float
    """Largest force that is left on nodes and supports, over all of a unit load."""
    volume_error_percent: float
    """Volume of the mesh against that of the rod."""
    edge_distance_mm: float
    """Distance from sharp inner edges, and from heads, nuts and threads of bolts, from which stresses are
    judged."""
    preload: RodPreload | None = UNLESS_NONE
    """Null without bolts."""
    yield_safety: float
    """Least of all places."""
    fatigue_safety: float
    """Least of all places."""
    places: tuple[RodPlace, ...]
    eyes: tuple[EyeShape, ...]
    at_sharp_edges: SharpEdge | None
    """Null where no inner edge is sharp."""


class Passage(Result):
    """The big end without its cap on its way through the cylinder."""

    width_mm: float
    """Square to the rod's axis."""
    over_corners_mm: float
    """Diameter of the circle around that width and the width along the crankpin."""
    bore_mm: float
    """Bore of the cylinder."""
    passes: bool
    """True where the circle is smaller than the bore."""


class SplitForce(Result):
    """Force between cap and rod in one state of the cycle."""

    parting_N: float
    """Along the bolts, positive parts the joint."""
    shear_N: float
    """Along the joint face."""
    speed_rpm: float
    crank_angle_deg: float
    """From firing top dead centre."""


class ObliqueSplit(Result):
    """The joint of an oblique split over the cycle, with the rod mounted the worse way round."""

    angle_deg: float
    """From the plane square to the rod's axis."""
    parting: SplitForce
    """Point of the cycle with the largest force along the bolts."""
    shear: SplitForce
    """Point of the cycle with the largest force along the joint face."""
    friction: float
    """Coefficient in the joint."""
    sliding: SplitForce | None
    """Point at which friction of the clamped joint misses most, or has least to spare; null without bolts."""
    sliding_safety: float | None
    """Least of friction over shear; null without bolts."""
    left_for_shape_N: float | None
    """Largest shear beyond friction, for serrations, a shoulder or dowels; null without bolts."""


class RodStrength(Result):
    """The rod of a design over the cycle at speed and overspeed."""

    schema_version: int = 1
    design: str
    shank: str
    speeds_rpm: tuple[float, ...]
    method: str
    """Method of the fatigue safeties."""
    masses: RodMasses
    push_N: float
    """Largest force of the piston pin on the rod toward the crank."""
    push_deg: float
    pull_N: float
    """Largest force of the piston pin on the rod away from the crank."""
    pull_deg: float
    bush_pressure_MPa: float
    held_deg: float
    """Angle from the crown of the small end to where the shank holds it."""
    sections: tuple[RodSectionCheck, ...]
    buckling: tuple[Buckling, ...]
    eyes: tuple[EyeShape, ...]
    """Change of both bores in closed form, pressed by the cosine."""
    pin: PinCheck | None
    bolt: JointCheck | None
    assumed: tuple[Assumption, ...]
    """Diameter of the parts that its bolts clamp, where the design leaves it to the boss."""
    strength_remarks: tuple[str, ...] | None = UNLESS_NONE
    """Limits of what the strengths of the material hold for, such as the section of the rod."""
    passage: Passage
    oblique_split: ObliqueSplit | None = UNLESS_NONE
    """Of a split that is not square."""
    lighter: LighterRod | None = UNLESS_NONE
    """Dimensions that `--lighter` changed; the strength is then that of the lighter rod."""
    elements: RodElements | None = UNLESS_NONE
    """With `--fea`."""

    def section_of(self, place: str) -> RodSectionCheck:
        """Return the section in closed form that stands for a place by elements."""
        name = _CLOSED_FORM.get(place, place)
        return next(section for section in self.sections if section.section == name)
