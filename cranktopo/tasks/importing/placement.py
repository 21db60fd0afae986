"""Place of a body from CAD against the scene's journals, and the motion that puts it there.

Cross-sections tell: at the ends of both journals a body must show a round ring of the journal's diameter and
bore, centred on its axis. A body that does not fit is tried in the 24 attitudes of a cube; in each one the
centres of its end sections give the shift and the angle that are left. A body of exact faces is tried
first in the places that these tell (see `exact_motion`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import MM_PER_INCH, MM_PER_M
from cranktopo.design.crank_throws import throw_count
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.engine.plan.simulated import Feature
from cranktopo.tasks.importing.exact_motion import Motion
from cranktopo.throw.journal import Journal

if TYPE_CHECKING:
    from manifold3d import Manifold

_PLACE = 0.005
"""Allowed distance of a section's centre from its axis over the journal's diameter: 0.2 mm at 42 mm."""
_SIZE = 0.015
"""Allowed error of a diameter over the journal's: a circle of 32 facets has 0.3 % less."""
_ROUND = 0.03
"""Allowed error of the polar moment against that of a circle of the same area; a square has 4.7 %."""
_ENDS = (0.03, 0.95)
"""Heights of the sections between a journal's middle and its fillet."""
_EXTENT_MM = 0.05
_ZONE = 0.2
"""Allowed error of a journal's volume over it: drillings and collars err less, a millimetre of web more."""
_SQUARE_ANGLES = (0, 90, 180, 270)
_ROUNDS = 4
_SHAFT = 1.25
"""Length of a body over a throw's from which on it is a whole shaft."""
_SMALLER, _MORE = 2.0, 4
"""A throw's length over that of a body in another unit at least, and lengths of throws that ends may add."""
_END_FOR_END = 0.999
"""Cosine between a body's crank axis and its place reversed from which on it is turned end for end."""
_KEPT: tuple[Feature, ...] = ("fillets",)
_NEAR = (0.4, 0.9)
"""Sections of the main journal that tell its direction: above the end face even where that is tilted."""


@dataclass(frozen=True)
class CutRing:
    """A cross-section of one journal: centre, diameter of its largest contour and of the hole in that, mm.

    The polar moment is over that of a circle of the same area.

    Attributes:
        bored: the hole is round and about the same centre; else a drilling passes, or meets the bore.
    """

    centre_mm: Array
    outer_mm: float
    bore_mm: float
    polar_ratio: float
    bored: bool


@dataclass(frozen=True)
class Placement:
    """A rigid motion that puts a body where the scene's journals are: p -> matrix p + shift.

    Attributes:
        words: what is wrong with the body as it lies.
        exact: from faces, not from sections of triangles.
    """

    matrix: Array
    shift_mm: Array
    words: str
    exact: bool = False

    def moved(self, points_mm: Array) -> Array:
        """Return points (n, 3) after the motion."""
        return np.asarray(points_mm @ self.matrix.T + self.shift_mm)


def placed(
    body: Manifold,
    scene: Scene,
    name: str,
    align: bool,
    exact: Callable[[], Sequence[Motion]] = tuple,
) -> Placement | None:
    """Return the motion that puts a half throw in its place, if `align` asks; None where it lies right.

    Args:
        exact: motions that its faces tell, if it has any; asked for a body that lies elsewhere alone.

    Raises:
        CranktopoError: it lies elsewhere: what was found and, where another attitude fits, which one.
    """
    found = misfits(body, scene)
    if not found:
        return None
    where = _first_fit(body, scene, exact())
    if where is not None and align:
        return where
    fits, hint = "", _other_body(body, scene) or f"Is '{scene.name}' the design that it was made from?"
    if where is not None:
        fits, hint = (
            f" It {where.words}.",
            (
                "`evaluate`, `fatigue`, `compare`, `shaft` and `vibration` move it there with --align; "
                "`cranktopo import` writes it where it belongs."
            ),
        )
    raise CranktopoError(f"{name}: does not lie where the throw is: {found[0]}.{fits}", hint=hint)


def _first_fit(body: Manifold, scene: Scene, exact: Sequence[Motion]) -> Placement | None:
    """Return the first motion after which a body fits: one that its faces tell, else that of its sections."""
    for turn, shift in exact:
        if not misfits(body.transform(np.column_stack([turn, shift])), scene):
            return Placement(turn, shift, _words(turn, shift), exact=True)
    tried = (_settled(body, scene, matrix) for matrix in _attitudes())
    return next((motion for motion in tried if motion is not None), None)


def _other_body(body: Manifold, scene: Scene) -> str:
    """Return what a body of an unlike length is likely to be, and what to do; empty where its length fits."""
    box = np.array(body.bounding_box()).reshape(2, 3)
    found, throw = float(np.ptp(box, axis=0).max()), _longest_mm(scene)
    longest = (throw_count(scene) + _MORE) * throw
    for name, factor in (("metres", MM_PER_M), ("inches", MM_PER_INCH)):
        if _SMALLER * found < throw < _SHAFT * factor * found and factor * found < longest:
            what = f"It is {found:.4g} long, a throw of '{scene.name}' {throw:.4g} mm"
            shaft = ", a whole shaft, which `cranktopo import` reads" * (factor * found > _SHAFT * throw)
            return f"{what}: in {name} it would be {factor * found:.4g} mm{shaft}. Export it in mm."
    if found > _SHAFT * throw:
        return (
            f"It is {found:.4g} mm long, a throw of '{scene.name}' {throw:.4g} mm. A whole shaft is read by "
            "`cranktopo import`, which cuts its throws and writes a design of them."
        )
    return ""


def _longest_mm(scene: Scene) -> float:
    """Return the longest side of the box of a throw."""
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    weight = scene.web.counterweight
    return max(scene.pitch_mm, high - min(low, -weight.outer_radius_mm if weight else low))


def without_bores_left_out(body: Manifold, scene: Scene) -> tuple[Scene, str]:
    """Return the scene as the body has it, and a note where it lacks bores that the effects plan leaves out.

    Surfaces of runs are such bodies.
    """
    if not misfits(body, scene):
        return scene, ""
    # The throw alone: bodies that the scene names are not read while this one is.
    throw = planned_scene(scene.model_copy(update={"original": None, "envelope": None}), kept=_KEPT).throw
    plain = scene.model_copy(update={"throw": throw})
    if throw == scene.throw or misfits(body, plain):
        return scene, ""
    return plain, "without the bores of the journals: the effects plan leaves them out"


def misfits(body: Manifold, scene: Scene) -> list[str]:
    """Return all that does not fit the scene's journals, the plainest first."""
    body = _undrilled(body, scene)
    low, high = (float(value) for value in np.array(body.bounding_box())[[2, 5]])
    end = scene.pitch_mm / 2
    if abs(low) > _EXTENT_MM or abs(high - end) > _EXTENT_MM:
        return [f"reaches from z = {low:.3f} to {high:.3f} mm, the half throw from 0 to {end:g} mm"]
    return _ring_misfits(body, scene) or list(_zones(body, scene))


def ring_misfits(body: Manifold, scene: Scene) -> list[str]:
    """Return cross-sections of the journals that are not their rings, oil drillings aside."""
    return _ring_misfits(_undrilled(body, scene), scene)


def _ring_misfits(body: Manifold, scene: Scene) -> list[str]:
    return [line for name, journal, y, z in _places(scene) for line in _misfit(body, name, journal, y, z)]


def _undrilled(body: Manifold, scene: Scene) -> Manifold:
    """Return the body with the oil drillings closed in both journals: they are no fault of its rings."""
    if not scene.throw.drilling:
        return body
    from cranktopo.bodies.prisms import drillings, journal_halves

    plain = scene.with_drillings(())
    main, pin = journal_halves(plain)
    return body + ((main + pin) ^ drillings(scene))


def _places(scene: Scene) -> Iterator[tuple[str, Journal, float, float]]:
    """Return name, journal, its axis along the throw and height of every section that is looked at."""
    for (journal, y), name in zip(scene.throw.journals, ("main journal", "crankpin"), strict=True):
        reach = journal.length_mm / 2 - journal.fillet.axial_mm
        for share in _ENDS:
            height = share * reach
            yield name, journal, y, height if name == "main journal" else scene.pitch_mm / 2 - height


def _misfit(body: Manifold, name: str, journal: Journal, y: float, z: float) -> Iterator[str]:
    ring = ring_at(body, z)
    place, size = (share * journal.outer_diameter_mm for share in (_PLACE, _SIZE))
    at = f"{name} at z = {z:.2f} mm"
    if ring is None:
        yield f"{at}: no material"
        return
    if np.hypot(ring.centre_mm[0], ring.centre_mm[1] - y) > place:
        yield f"{at}: centre at ({ring.centre_mm[0]:.2f}, {ring.centre_mm[1]:.2f}) mm instead of (0, {y:g})"
    if abs(ring.outer_mm - journal.outer_diameter_mm) > size:
        yield f"{at}: diameter {ring.outer_mm:.2f} mm instead of {journal.outer_diameter_mm:g}"
    elif (ring.bored or journal.bore_diameter_mm) and abs(ring.bore_mm - journal.bore_diameter_mm) > size:
        yield f"{at}: bore {ring.bore_mm:.2f} mm instead of {journal.bore_diameter_mm:g}"
    elif abs(ring.polar_ratio - 1) > _ROUND:
        yield f"{at}: not round (polar moment {100 * (ring.polar_ratio - 1):+z.0f} % off a circle's)"


def _zones(body: Manifold, scene: Scene) -> Iterator[str]:
    """Tell journals with more or less material than they have between their middle and the web."""
    (first, last), end = scene.web_z_mm, scene.pitch_mm / 2
    main, pin = (journal for journal, _ in scene.throw.journals)
    low, high = body.trim_by_plane((0.0, 0.0, -1.0), -first), body.trim_by_plane((0.0, 0.0, 1.0), last)
    for name, journal, part, where in (
        ("main journal", main, low, f"z = 0 to {first:g}"),
        ("crankpin", pin, high, f"z = {last:g} to {end:g}"),
    ):
        area = math.pi / 4 * (journal.outer_diameter_mm**2 - journal.bore_diameter_mm**2)
        share = part.volume() / (area * journal.length_mm / 2) - 1
        if abs(share) > _ZONE:
            yield f"{name}, {where} mm: {100 * share:+z.0f} % of its material; the web lies elsewhere"


def ring_at(body: Manifold, z_mm: float) -> CutRing | None:
    """Return the largest contour of a cross-section and the largest hole in it; None without material."""
    contours = [np.asarray(contour) for contour in body.slice(z_mm).to_polygons()]
    measured = sorted((_moments(contour) for contour in contours), key=lambda m: -m[0])
    if not measured or measured[0][0] <= 0:
        return None
    area, centre, polar = measured[0]
    near = [
        (-size, middle, own)
        for size, middle, own in measured
        if size < 0 and np.hypot(*(middle - centre)) < math.sqrt(area)
    ]
    hole, middle, own = max(near, key=lambda one: one[0], default=(0.0, centre, 0.0))
    outer, bore = (2 * math.sqrt(size / math.pi) for size in (area, hole))
    on_axis = np.hypot(*(middle - centre)) < _PLACE * outer and abs(_over_circle(hole, own) - 1) < _ROUND
    return CutRing(centre, outer, bore, _over_circle(area, polar), bool(on_axis))


def _over_circle(area: float, polar: float) -> float:
    """Return the polar moment of a contour over that of a circle of its area; 1 of none."""
    return abs(polar) / (area**2 / (2 * math.pi)) if area else 1.0


def _moments(contour: Array) -> tuple[float, Array, float]:
    """Return area (negative for a hole), centroid and polar moment about it, of a polygon."""
    a, b = contour, np.roll(contour, -1, axis=0)
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    area = float(cross.sum() / 2)
    if area == 0:
        return 0.0, np.zeros(2), 0.0
    centre = ((a + b) * cross[:, None]).sum(axis=0) / (6 * area)
    second = float(((a**2 + a * b + b**2).sum(axis=1) * cross).sum() / 12)
    return area, centre, second - area * float(centre @ centre)


def _attitudes() -> list[Array]:
    """Return the 24 rotations of a cube, those about z first, then end for end, then the others."""
    found: list[Array] = []
    for tilt_y, tilt_x, turn in product((0, 180, 90, 270), (0, 90, 270), _SQUARE_ANGLES):
        matrix = np.rint(_about("z", turn) @ _about("y", tilt_y) @ _about("x", tilt_x))
        if not any(np.array_equal(matrix, other) for other in found):
            found.append(matrix)
    return found


def _about(axis: str, deg: float) -> Array:
    c, s = math.cos(math.radians(deg)), math.sin(math.radians(deg))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[i, j], matrix[j, i] = -s, s
    return matrix


def _settled(body: Manifold, scene: Scene, matrix: Array) -> Placement | None:
    """Return the motion with this attitude once shift, angle about z and tilt are taken from the sections."""
    rotation, shift = matrix, np.zeros(3)
    for _ in range(_ROUNDS):
        step = _correction(body.transform(np.column_stack([rotation, shift])), scene)
        if step is None:
            return None
        turn, move = step
        rotation, shift = turn @ rotation, turn @ shift + move
    if misfits(body.transform(np.column_stack([rotation, shift])), scene):
        return None
    return Placement(rotation, shift, _words(rotation, shift))


def _correction(body: Manifold, scene: Scene) -> tuple[Array, Array] | None:
    """Return a small rotation and shift that bring a body's end sections closer to where they should be."""
    low, high = (float(value) for value in np.array(body.bounding_box())[[2, 5]])
    main, pin = (j.length_mm / 2 - j.fillet.axial_mm for j, _ in scene.throw.journals)
    first, second = (ring_at(body, low + share * main) for share in _NEAR)
    far = ring_at(body, high - 0.5 * pin)
    if first is None or second is None or far is None:
        return None
    rise = (second.centre_mm - first.centre_mm) / ((_NEAR[1] - _NEAR[0]) * main)
    throw = far.centre_mm - second.centre_mm
    if np.hypot(*throw) < 0.5 * scene.throw.radius_mm or np.hypot(*rise) > 0.5:
        return None
    tilt = _about("x", math.degrees(math.atan(rise[1]))) @ _about("y", -math.degrees(math.atan(rise[0])))
    turn = _about("z", 90 - math.degrees(math.atan2(throw[1], throw[0]))) @ tilt
    turned = body.transform(np.column_stack([turn, np.zeros(3)]))
    bottom = float(np.array(turned.bounding_box())[2])
    ring = ring_at(turned, bottom + 0.5 * main)
    return None if ring is None else (turn, -np.array([*ring.centre_mm, bottom]))


def _words(rotation: Array, shift: Array) -> str:
    back = rotation.T  # of the body as it lies, against the body as it should lie
    angle = math.degrees(math.acos(max(-1.0, min(1.0, (np.trace(back) - 1) / 2))))
    place = -back @ shift
    words = []
    if angle > 0.05:
        axis = np.array([back[2, 1] - back[1, 2], back[0, 2] - back[2, 0], back[1, 0] - back[0, 1]])
        words.append(f"looks turned {_axis_words(rotation, axis, angle)}")
    if np.abs(place).max() > 0.005 and rotation[2, 2] > 0.5:
        amount = ", ".join(f"{round(value, 2) + 0.0:.2f}" for value in place)
        words.append(("and " if words else "looks ") + f"shifted by ({amount}) mm")
    return " ".join(words) or "fits as it is"


def _axis_words(rotation: Array, axis: Array, angle: float) -> str:
    if rotation[2, 2] < -_END_FOR_END:
        return "end for end"
    if abs(angle - 180) < 0.05:
        return "by 180 deg about z" if rotation[2, 2] > 0.5 else "by 180 deg"
    axis = axis / np.linalg.norm(axis)
    main = int(np.abs(axis).argmax())
    if abs(axis[main]) > 0.999:
        return f"by {math.copysign(angle, axis[main]):.4g} deg about {'xyz'[main]}"
    return f"by {angle:.4g} deg about ({axis[0]:.2f}, {axis[1]:.2f}, {axis[2]:.2f})"
