"""Ovalisation of both eyes in closed form: each is a ring whose radial sections reach through the whole rod.

Sections are those of the solid, fillets, bosses, flanges and holes of bolts included, as far from the axis as
the bore is wide: what lies deeper in the shank takes no part. Loads are pressures by the cosine over half of
the bore. The bush and the gap of the split take no part. A big end with an oblique split is a whole ring, as
its bosses stand obliquely; the small end is always half of one.

Permitted is what A. Kolchin, V. Demidov, Design of Automotive Engines (Mir, 1984), chapter 12 permit under
the pull, where the bore closes across the rod on its pin: half of the clearance of the diameters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.base.units import MM_PER_M, MPA_PER_GPA
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.rod import EYES, Eye, Rod
from cranktopo.design.rod_body import RodMass, fillet, width_mm
from cranktopo.design.rod_split import in_split
from cranktopo.design.schema import Scene
from cranktopo.engine.rod_forces import RodMotion
from cranktopo.tasks.rod.result import EyeShape
from cranktopo.tasks.rod.ring import ClosedRing, Ring

_ANGLES = np.linspace(0.0, np.pi, 181)
_AROUND = np.linspace(-np.pi, np.pi, 361)
DIAMETERS_RAD = np.radians(np.arange(0.0, 180.0, 5.0))
"""Directions of the diameters of a whole ring that are looked at, from the crown."""
_REACH = 2.0
"""Radius to which sections of the ring reach, over that of the bore."""
_GAUSS, _WEIGHTS = gauss_legendre(3)
_LEAST_SINE = 1e-9
_HALF_PRESSED_DEG = 90.0
_PERMITTED_SHARE = 0.5
"""Permitted ovalisation over the clearance of a bearing."""


def eye_shapes_of(scene: Scene, mass: RodMass, motions: Sequence[RodMotion]) -> tuple[EyeShape, ...]:
    """Return what the largest push and pull of either eye make of its bore; small end first.

    Args:
        scene: its material is that of the rod.
    """
    length = rod_of(scene)[1]
    return tuple(
        shape
        for eye in EYES
        for shape in _shapes(scene, eye, eye_ring(scene, eye), bore_forces_N(mass, length, motions, eye))
    )


def bore_forces_N(
    mass: RodMass, length_mm: float, motions: Sequence[RodMotion], eye: Eye
) -> tuple[float, float]:
    """Return the largest push and pull of the pin on the bore of an eye, along the rod."""
    beyond_mm = np.inf if eye == "small" else -np.inf
    forces = [motion.section_force_N(mass, length_mm, beyond_mm) for motion in motions]
    push, pull = max(float(f.max()) for f in forces), max(float(-f.min()) for f in forces)
    return max(push, 0.0), max(pull, 0.0)


def permitted_um(scene: Scene, eye: Eye) -> float | None:
    """Return what an eye's bore may change by; None without a limit."""
    rod, bearings = rod_of(scene)[0], scene.bearings
    if eye == "small":
        return rod.small_end_ovalisation_um
    if rod.big_end_ovalisation_um is not None or bearings is None:
        return rod.big_end_ovalisation_um
    clearance = bearings.big_end_clearance_mm or bearings.clearance_mm
    return _PERMITTED_SHARE * clearance * MM_PER_M


def eye_shape(
    scene: Scene,
    eye: Eye,
    load: str,
    force_N: float,
    contact_deg: float,
    across_um: float,
    along_um: float,
    oblique_um: float = 0.0,
) -> EyeShape:
    """Return the shape of a bore with its limit.

    Args:
        oblique_um: largest change of a diameter between across and along, where both sides differ.
    """
    judged = load == "pull" or contact_deg < _HALF_PRESSED_DEG
    return EyeShape(
        eye=f"{eye} end",
        load=load,
        force_N=force_N,
        contact_deg=contact_deg,
        across_um=across_um,
        along_um=along_um,
        ovalisation_um=max(abs(across_um), abs(along_um), abs(oblique_um)),
        judged=judged,
        permitted_um=permitted_um(scene, eye) if judged else None,
    )


def _shapes(scene: Scene, eye: Eye, ring: Ring, forces_N: tuple[float, float]) -> Iterator[EyeShape]:
    if isinstance(ring, ClosedRing):
        yield from _shapes_of_whole(scene, eye, ring, forces_N)
        return
    for load, force, pressed in zip(("push", "pull"), forces_N, (pushed_N(), pulled_N()), strict=True):
        across, along = (force * change * MM_PER_M for change in ring.opened_mm(*pressed))
        yield eye_shape(scene, eye, load, force, _HALF_PRESSED_DEG, across, along)


def _shapes_of_whole(
    scene: Scene, eye: Eye, ring: ClosedRing, forces_N: tuple[float, float]
) -> Iterator[EyeShape]:
    for load, force, middle in zip(("push", "pull"), forces_N, (np.pi, 0.0), strict=True):
        changes = force * MM_PER_M * ring.changes_mm(*cosine_N(ring.angle_rad, middle), DIAMETERS_RAD)
        along, across = float(changes[0]), float(changes[len(changes) // 2])
        most = float(np.abs(changes).max())
        yield eye_shape(scene, eye, load, force, _HALF_PRESSED_DEG, across, along, most)


def cosine_N(angle_rad: Array, middle_rad: float) -> tuple[Array, Array]:
    """Return what 1 N by the cosine about an angle adds up to from the first angle on, across and along."""
    across, along = np.zeros_like(angle_rad), np.zeros_like(angle_rad)
    for turn in (-2 * np.pi, 0.0, 2 * np.pi):
        off = np.clip(angle_rad - middle_rad - turn, -np.pi / 2, np.pi / 2)
        sine, cosine = np.sin(off), np.cos(off)
        across += sine**2 / np.pi
        along += (off + sine * cosine) / np.pi
    across, along = across - across[0], along - along[0]
    sine, cosine = np.sin(middle_rad), np.cos(middle_rad)
    return across * cosine + along * sine, along * cosine - across * sine


def pulled_N() -> tuple[Array, Array]:
    """Return what 1 N by the cosine toward the crown adds up to from there, across and along; half of it."""
    sine, cosine = np.sin(_ANGLES), np.cos(_ANGLES)
    beyond = np.pi / 2 < _ANGLES
    across = np.where(beyond, 1.0, sine**2) / np.pi
    return across, np.where(beyond, np.pi / 2, _ANGLES + sine * cosine) / np.pi


def pushed_N() -> tuple[Array, Array]:
    """Return the same of 1 N toward the shank."""
    sine, cosine = np.sin(_ANGLES), np.cos(_ANGLES)
    beyond = np.pi / 2 < _ANGLES
    along = np.pi / 2 - _ANGLES - sine * cosine
    return np.where(beyond, cosine**2, 0.0) / np.pi, np.where(beyond, along, 0.0) / np.pi


def eye_ring(scene: Scene, eye: Eye) -> Ring:
    """Return the ring of an eye, its crown away from the shank; the material is that of the scene.

    That of a big end with an oblique split is a whole one.
    """
    if eye == "big" and rod_of(scene)[0].split_angle_deg:
        return ClosedRing(*_ring(scene, eye, _AROUND))
    return Ring(*_ring(scene, eye, _ANGLES))


def _ring(scene: Scene, eye: Eye, angle_rad: Array) -> tuple[Array, Array, Array, Array, float, float]:
    """Angles, areas, radii of centroids and of neutral fibres, Young's modulus and Poisson's ratio."""
    rod, length = rod_of(scene)
    bore = (rod.small_end_bore_mm if eye == "small" else rod.big_end_bore_mm) / 2
    axis, away = (length, 1.0) if eye == "small" else (0.0, -1.0)
    across, along = np.sin(angle_rad), away * np.cos(angle_rad)
    marks = _marks(rod, length, eye, across, along)
    ends = np.sort(np.clip(np.stack([bore + 0 * across, *marks]), bore, marks[0]), axis=0)
    half, middle = (ends[1:] - ends[:-1]) / 2, (ends[1:] + ends[:-1]) / 2
    radius = middle + half * _GAUSS[:, None, None]
    area = half * _WEIGHTS[:, None, None] * width_mm(rod, length, across * radius, axis + along * radius)
    total = area.sum(axis=(0, 1))
    centroid, neutral = (area * radius).sum(axis=(0, 1)) / total, total / (area / radius).sum(axis=(0, 1))
    material = scene.material
    return angle_rad, total, centroid, neutral, material.E_GPa * MPA_PER_GPA, material.poisson


def _marks(rod: Rod, length: float, eye: Eye, across: Array, along: Array) -> list[Array]:
    """Radii at which the rod's width may jump along each ray from an eye's axis, that of the end first."""
    small = eye == "small"
    axis = length if small else 0.0
    bore = rod.small_end_bore_mm if small else rod.big_end_bore_mm
    outer = rod.small_end_diameter_mm if small else rod.big_end_diameter_mm
    taper = (rod.shank_small_mm - rod.shank_big_mm) / 2 / length
    inside = rod.shank_big_mm / 2 - rod.flange_mm
    lines = [(rod.shank_big_mm / 2, taper)]
    lines += {"I": [(inside, taper)], "H": [(rod.web_mm / 2, 0.0)]}.get(rod.shank, [])
    found = [np.full_like(across, max(_REACH * bore, outer) / 2), np.full_like(across, outer / 2)]
    found += _boss_marks(rod, axis, across, along)
    across = np.abs(across)
    found += [_ahead(base + slope * axis, across - slope * along) for base, slope in lines]
    arc = fillet(rod, length, small)
    if arc is not None:
        nearest = across * arc.x_mm + along * (arc.y_mm - axis)
        beside = arc.x_mm**2 + (arc.y_mm - axis) ** 2 - nearest**2
        found.append(nearest - np.sqrt(np.maximum(rod.shank_fillet_mm**2 - beside, 0.0)))
    return found


def _boss_marks(rod: Rod, axis: float, across: Array, along: Array) -> list[Array]:
    """Radii at which the rays meet faces of the bosses and walls of their holes."""
    u, v = in_split(rod, across, along)
    at_u, at_v = in_split(rod, np.array(0.0), np.array(axis))
    walls = [rod.boss_width_mm, *(rod.bolt_distance_mm + side * rod.bolt_hole_mm for side in (-1, 1))]
    found = [_ahead(side * wall / 2 - float(at_u), u) for wall in walls for side in (-1, 1)]
    return [*found, *(_ahead(end - float(at_v), v) for end in (-rod.boss_below_mm, rod.boss_above_mm))]


def _ahead(distance: float, speed: Array) -> Array:
    """Radius at which rays that come nearer to a line by `speed` meet it; infinite where they do not."""
    met = distance * speed > _LEAST_SINE
    return np.where(met, distance / np.where(met, speed, 1.0), np.inf)
