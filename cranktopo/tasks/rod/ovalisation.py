"""Ovalisation of both eyes in closed form: each is a ring whose radial sections reach through the whole rod.

Sections are those of the solid, fillets, bosses, flanges and holes of bolts included, as far from the axis as
the bore is wide: what lies deeper in the shank takes no part. Loads are pressures by the cosine over half of
the bore. The bush and the split take no part.

Permitted is what A. Kolchin, V. Demidov, Design of Automotive Engines (Mir, 1984), chapter 12 permit under
the pull, where the bore closes across the rod on its pin: half of the clearance of the diameters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import MM_PER_M, MPA_PER_GPA
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.rod import EYES, Eye, Rod
from cranktopo.design.rod_body import RodMass, fillet, width_mm
from cranktopo.design.schema import Scene
from cranktopo.engine.rod_forces import RodMotion
from cranktopo.tasks.rod.result import EyeShape
from cranktopo.tasks.rod.ring import Ring

_ANGLES = np.linspace(0.0, np.pi, 181)
_REACH = 2.0
"""Radius to which sections of the ring reach, over that of the bore."""
_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(3)
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
) -> EyeShape:
    """Return the shape of a bore with its limit."""
    judged = load == "pull" or contact_deg < _HALF_PRESSED_DEG
    return EyeShape(
        eye=f"{eye} end",
        load=load,
        force_N=force_N,
        contact_deg=contact_deg,
        across_um=across_um,
        along_um=along_um,
        ovalisation_um=max(abs(across_um), abs(along_um)),
        judged=judged,
        permitted_um=permitted_um(scene, eye) if judged else None,
    )


def _shapes(scene: Scene, eye: Eye, ring: Ring, forces_N: tuple[float, float]) -> Iterator[EyeShape]:
    for load, force, pressed in zip(("push", "pull"), forces_N, (pushed_N(), pulled_N()), strict=True):
        across, along = (force * change * MM_PER_M for change in ring.opened_mm(*pressed))
        yield eye_shape(scene, eye, load, force, _HALF_PRESSED_DEG, across, along)


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
    """Return the ring of an eye, its crown away from the shank; the material is that of the scene."""
    rod, length = rod_of(scene)
    bore = (rod.small_end_bore_mm if eye == "small" else rod.big_end_bore_mm) / 2
    axis, away = (length, 1.0) if eye == "small" else (0.0, -1.0)
    across, along = np.sin(_ANGLES), away * np.cos(_ANGLES)
    marks = _marks(rod, length, eye, across, along)
    ends = np.sort(np.clip(np.stack([bore + 0 * across, *marks]), bore, marks[0]), axis=0)
    half, middle = (ends[1:] - ends[:-1]) / 2, (ends[1:] + ends[:-1]) / 2
    radius = middle + half * _GAUSS[:, None, None]
    area = half * _WEIGHTS[:, None, None] * width_mm(rod, length, across * radius, axis + along * radius)
    total = area.sum(axis=(0, 1))
    centroid, neutral = (area * radius).sum(axis=(0, 1)) / total, total / (area / radius).sum(axis=(0, 1))
    material = scene.material
    return Ring(_ANGLES, total, centroid, neutral, material.E_GPa * MPA_PER_GPA, material.poisson)


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
    walls = [rod.boss_width_mm, *(rod.bolt_distance_mm + side * rod.bolt_hole_mm for side in (-1, 1))]
    lines += [(wall / 2, 0.0) for wall in walls]
    found = [np.full_like(across, max(_REACH * bore, outer) / 2), np.full_like(across, outer / 2)]
    found += [_ahead(base + slope * axis, across - slope * along) for base, slope in lines]
    found += [_ahead(y - axis, along) for y in (-rod.boss_below_mm, rod.boss_above_mm)]
    arc = fillet(rod, length, small)
    if arc is not None:
        nearest = across * arc.x_mm + along * (arc.y_mm - axis)
        beside = arc.x_mm**2 + (arc.y_mm - axis) ** 2 - nearest**2
        found.append(nearest - np.sqrt(np.maximum(rod.shank_fillet_mm**2 - beside, 0.0)))
    return found


def _ahead(distance: float, speed: Array) -> Array:
    """Radius at which rays that come nearer to a line by `speed` meet it; infinite where they do not."""
    met = distance * speed > _LEAST_SINE
    return np.where(met, distance / np.where(met, speed, 1.0), np.inf)
