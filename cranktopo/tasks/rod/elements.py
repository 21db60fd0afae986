"""The rod by finite elements: stresses and safeties by place, ovalisation of both eyes, the mesh's error."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.notes import Pace, note
from cranktopo.base.units import MM_PER_M
from cranktopo.bodies.mesh.rod_mesh import default_rod_element_mm, rod_volume_mm3
from cranktopo.design.rod import EYES, Eye
from cranktopo.design.schema import Scene
from cranktopo.engine.rod_forces import RodMotion
from cranktopo.numerics.tetrahedra.mesh import RATIO
from cranktopo.numerics.tetrahedra.surface_loads import from_faces
from cranktopo.tasks.bolts.joint import largest_preload_N
from cranktopo.tasks.rod.bolt_load import at_split, preload_N, split_stress
from cranktopo.tasks.rod.contact import contact_deg, cosine
from cranktopo.tasks.rod.element_stress import (
    ElementStress,
    WorstPoint,
    cycle_states,
    element_stress,
    image_cycles,
)
from cranktopo.tasks.rod.ovalisation import DIAMETERS_RAD, eye_shape
from cranktopo.tasks.rod.result import EyeShape, RodElements, RodPlace, RodPreload, SharpEdge
from cranktopo.tasks.rod.unit_fields import RodFields, contact_pressures, rod_model, solve_rod
from cranktopo.tasks.rod.unit_loads import (
    ALONG,
    PRELOAD,
    PRESSED,
    SHAPING,
    Pressures,
    bore_of,
    copies,
    is_quarter,
    rod_material,
)

_EDGE_ELEMENTS = 2.0
"""Elements of the default size around sharp inner edges in which nothing is judged: they spoil them."""
_NEAR_SPLIT = 0.5
"""Distance from the split of nodes that are at it, in elements."""
_HARMONICS = 12
"""Waves around a bore that its shape is told by."""
_STEPS = ("coarse mesh", "fine mesh")


def rod_elements(
    scene: Scene,
    motions: Sequence[RodMotion],
    method: str,
    element_size_mm: float | None = None,
    *,
    contact: bool = False,
    least_preload_N: float = 0.0,
) -> tuple[RodElements, ElementStress]:
    """Return the rod of a scene by finite elements on two meshes, and the stresses on the finer one.

    Args:
        scene: its material is that of the rod.
        contact: pressure where rigid pins touch, found on the coarse mesh, in place of the cosine.
        least_preload_N: of each bolt of the cap, at which the split is looked at; strength has the mean.

    Raises:
        CranktopoError: no valid mesh, or a failed solve.
    """
    usual = default_rod_element_mm(scene)
    size, away = element_size_mm or usual, _EDGE_ELEMENTS * usual
    pace = Pace(f"{scene.name}: rod by elements", len(_STEPS))
    found = []
    pressures: Pressures | None = None
    for step, one in zip(_STEPS, (RATIO * size, size), strict=True):
        pace.begin(step)
        note(f"{scene.name}: rod on elements of {one:.3g} mm")
        model = rod_model(scene, one)
        if pressures is None:
            pressures = contact_pressures(scene, model) if contact else {}
        fields = solve_rod(scene, model, pressures)
        loads = cycle_states(fields, motions)
        found.append(element_stress(fields, loads, method, away))
    coarse, fine = found
    result = _elements_result(coarse, fine, loads, size)
    return result.model_copy(update={"preload": _preload(fine, loads, least_preload_N, size)}), fine


def _preload(stress: ElementStress, loads: Array, least_N: float, size: float) -> RodPreload | None:
    """The preload, and the least pressure between rod and cap over the cycle; None without bolts."""
    rod = stress.fields.rod
    if rod.bolt is None:
        return None
    points = stress.surface.points_mm
    near = np.flatnonzero(at_split(rod, points, _NEAR_SPLIT * size) & stress.judged)
    across = split_stress(rod, stress.unit.stress.stress_MPa[:, near])
    least = np.where(PRELOAD, least_N, loads)
    cycles = np.stack([states @ across for states in image_cycles(least)])
    _, _, worst = np.unravel_index(int(cycles.argmax()), cycles.shape)
    x, y, z = (float(place) for place in points[:, near[worst]])
    return RodPreload(
        mean_N=preload_N(rod),
        largest_N=largest_preload_N(rod.bolt),
        least_N=least_N,
        least_pressure_MPa=float(-cycles.max()),
        point_mm=(x, y, z),
    )


def _elements_result(coarse: ElementStress, fine: ElementStress, loads: Array, size: float) -> RodElements:
    fields, sharp = fine.fields, fine.at_sharp_edges()
    limit = rod_material(fields.scene).yield_MPa or np.nan
    before = {name: (stress, fatigue) for name, stress, fatigue in coarse.worst()}
    places = tuple(
        _place(name, stress, fatigue, before.get(name), limit) for name, stress, fatigue in fine.worst()
    )
    return RodElements(
        contact=bool(fields.pressures),
        element_size_mm=size,
        nodes=fields.model.nodes_mm.shape[1],
        residual=fields.residual,
        volume_error_percent=100
        * fields.model.volume_error(copies(fields.model), rod_volume_mm3(fields.scene)),
        edge_distance_mm=fine.edge_distance_mm,
        yield_safety=min(place.yield_safety for place in places),
        fatigue_safety=min(place.fatigue_safety for place in places),
        places=places,
        eyes=eye_shapes(fields, loads),
        at_sharp_edges=None
        if sharp is None
        else SharpEdge(point_mm=sharp.point_mm, von_mises_MPa=sharp.largest_MPa),
    )


def _place(
    name: str,
    stress: WorstPoint,
    fatigue: WorstPoint,
    coarse: tuple[WorstPoint, WorstPoint] | None,
    yield_MPa: float,
) -> RodPlace:
    """Result of a place; the other mesh's points of largest stress and of least safety beside it."""
    change, safety_change = None, None
    if coarse is not None:
        change = 100 * abs(coarse[0].largest_MPa / stress.largest_MPa - 1)
        safety_change = 100 * abs(coarse[1].fatigue_safety / fatigue.fatigue_safety - 1)
    return RodPlace(
        place=name,
        point_mm=stress.point_mm,
        max_MPa=stress.high_MPa,
        min_MPa=stress.low_MPa,
        error_percent=change,
        yield_safety=yield_MPa / stress.largest_MPa,
        fatigue_safety=fatigue.fatigue_safety,
        fatigue_error_percent=safety_change,
        fatigue_point_mm=fatigue.point_mm,
        amplitude_MPa=fatigue.amplitude_MPa,
        mean_MPa=fatigue.mean_MPa,
        gradient_per_mm=fatigue.gradient_per_mm,
    )


def eye_shapes(fields: RodFields, loads: Array) -> tuple[EyeShape, ...]:
    """Return what the largest push and pull of either eye make of its bore."""
    found, rows = [], {eye: diameter_rows(fields, eye) for eye in EYES}
    for number, (eye, side) in enumerate(PRESSED):
        state = int(loads[:, number].argmax())
        across, along, oblique = _diameters_um(fields, loads[state], rows[eye])
        load, force = ALONG[number].split()[1], float(loads[state, number])
        pressed = contact_deg(fields.pressures.get((eye, side), cosine))
        found.append(eye_shape(fields.scene, eye, load, force, pressed, across, along, oblique))
    return tuple(found)


def _diameters_um(fields: RodFields, loads: Array, rows: Array) -> tuple[float, float, float]:
    """Return the changes of a bore's diameter across and along the rod.

    The third is the largest of all directions, on a half; a quarter has none.
    """
    moved = loads[SHAPING] @ fields.displacement_mm[SHAPING]
    changes = MM_PER_M * rows @ moved
    most = 0.0 if is_quarter(fields.model) else float(np.abs(changes).max())
    return float(changes[0]), float(changes[1]), most


def diameter_rows(fields: RodFields, eye: Eye) -> Array:
    """Return what displacements change a bore's diameters by, (directions, unknowns), by waves around it.

    Across and along the rod, then in directions between both on a half; mean over the bore's width.
    """
    bore = bore_of(fields.scene, fields.model, eye)
    x, y, _ = np.asarray(bore.faces.global_coordinates()).reshape(3, -1)
    angle, quarter = np.arctan2(x, y - bore.y_mm), is_quarter(fields.model)
    root = np.sqrt(bore.faces.dx.ravel())
    directions = np.concatenate([[np.pi / 2, 0.0], [] if quarter else DIAMETERS_RAD])
    # odd waves move a bore and leave its diameters
    ends = sum(_waves(directions + turn, quarter) for turn in (0.0, np.pi))
    waves = root[:, None] * _waves(angle, quarter)
    fit = ends @ np.linalg.solve(waves.T @ waves, waves.T) * root  # (directions, points)
    outward = np.stack([fit * np.sin(angle), fit * np.cos(angle), 0 * fit], axis=-1)
    return from_faces(fields.model, bore.faces, outward)


def _waves(angle_rad: Array, alike: bool) -> Array:
    """Waves around a bore at angles (n,), those of both signs of x alone where both sides are alike."""
    around = np.outer(angle_rad, np.arange(_HARMONICS + 1))
    return np.cos(around) if alike else np.hstack([np.cos(around), np.sin(around[:, 1:])])
