"""Parametric webs on coarse meshes, for the gradients of the shape optimiser."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.moved_mesh import MovedMesh
from cranktopo.tasks.refit.family import Layout, free_dimensions, with_free, with_part
from cranktopo.tasks.web_shape.mesh_model import MeshModel
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted_pocket import FittedBox, FittedCylinder
from cranktopo.throw.fitted_slot import FittedSlot

Array = NDArray[np.float64]
COARSE_MM, COARSE_FILLET = 14.0, 2.0
"""Element size, and that on a fillet over its radius: too coarse for numbers, enough for gradients."""
_OUTLINE = [-27.0, 76.0, 17.0, 29.0, 31.0, 28.0, 18.0]
_BEVELS = [50.0, 9.0, 1.0, -1.0, 8.0, -0.8]


def full_web() -> tuple[Scene, Layout, Array]:
    """Every kind of feature: a crowned and a hollow bevel, groove, box pocket, a pair of cylinder pockets."""
    bevels = FittedBevel("journal", hollow=True), FittedBevel("pin", hollow=True)
    pockets = FittedSlot(through=True), FittedBox("pin"), FittedCylinder("journal", pair=True)
    groove, box, cylinders = [5.0, 27.5, 0.3, 10.0], [18.0, 8.0, 4.0, 3.0], [20.0, 26.0, 5.0, 4.0]
    values = np.array([*_OUTLINE, *_BEVELS, *groove, *box, *cylinders])
    return load_scene("mikron-iiic-plain"), Layout(7, (*bevels, *pockets)), values


def die_web() -> tuple[Scene, Layout, Array]:
    """What a die gives that parts in x = 0: a crowned and a hollow bevel with draft, and a groove."""
    bevels = FittedBevel("journal", True, 5.0), FittedBevel("pin", True, 4.0)
    own = [52.0, 10.0, 0.4, -1.0, 8.0, -0.8]
    values = np.array([*_OUTLINE, *own, 5.0, 27.5, 0.3, 10.0])
    return load_scene("mikron-iiic-plain"), Layout(7, (*bevels, FittedSlot(through=True))), values


def drafted_web() -> tuple[Scene, Layout, Array]:
    """Pockets with draft and round corners from both faces, one of them a pair of cones, beside a bevel."""
    box, cones = FittedBox("pin", False, 5.0, 2.5), FittedCylinder("journal", pair=True, draft_deg=7.0)
    values = np.array([*_OUTLINE, *_BEVELS[:3], 18.5, 9.0, 6.5, 6.0, 17.0, 26.0, 5.0, 4.0])
    return load_scene("mikron-iiic-plain"), Layout(7, (FittedBevel("journal", True), box, cones)), values


def milled_web() -> tuple[Scene, Layout, Array]:
    """The same, the edges of both floors round: tubes and tori beside planes and cones."""
    scene, layout, values = drafted_web()
    bevel, box, cones = layout.parts
    box, cones = replace(box, floor_radius_mm=1.2), replace(cones, floor_radius_mm=1.5)
    return scene, replace(layout, parts=(bevel, box, cones)), values


def round_groove_web() -> tuple[Scene, Layout, Array]:
    """Bevels with draft over a groove whose floor has round edges."""
    scene, layout, values = die_web()
    *bevels, groove = layout.parts
    return scene, replace(layout, parts=(*bevels, replace(groove, floor_radius_mm=2.0))), values


def rounded_web() -> tuple[Scene, Layout, Array]:
    """The same with side pockets whose corners are round."""
    scene, layout, values = drafted_web()
    side = [27.0, 18.0, 7.5, 28.0, 1.0, 12.0]
    return scene, *with_part(layout, values, FittedSlot(corner_radius_mm=3.0), np.array(side))


def round_side_web() -> tuple[Scene, Layout, Array]:
    """The same, the edges of the floors of the side pockets round."""
    scene, layout, values = rounded_web()
    parts = (replace(p, floor_radius_mm=2.0) if isinstance(p, FittedSlot) else p for p in layout.parts)
    return scene, replace(layout, parts=tuple(parts)), values


def solid_web() -> tuple[Scene, Layout, Array]:
    """Overlapping solid journals, uneven bevels, side pockets that end inside the outline."""
    parts = FittedBevel("journal", hollow=True), FittedBevel("pin", hollow=True), FittedSlot()
    outline = [-42.0, 84.0, 26.0, 43.0, 44.0, 40.0, 22.0]
    values = np.array([*outline, 52.0, 8.0, 1.5, -8.0, 6.0, 0.5, 24.0, 30.0, 4.0, 37.0, -0.5, 8.0])
    return load_scene("opposed-piston"), Layout(7, parts), values


def free_throw() -> tuple[Scene, Layout, Array]:
    """Every kind of dimension of a throw with uneven fillets and bores, beside a web with every feature.

    The pin's fillets are ellipses, the main journal's are round and stay so.
    """
    scene, layout, values = full_web()
    data = scene.model_dump(mode="json", exclude_none=True)
    data["throw"]["crankpin"] |= {"fillet_mm": 3.5, "fillet_axial_mm": 4.5, "bore_diameter_mm": 20.0}
    fillets = {
        "pin_fillet_mm": [2.0, 5.0],
        "journal_fillet_mm": [2.0, 5.0],
        "pin_fillet_axial_mm": [2.5, 5.4],
    }
    bores = {"pin_bore_mm": [0.0, 26.0], "journal_bore_mm": [10.0, 30.0]}
    data["shape"] = {"free": {**fillets, **bores, "web_thickness_mm": [17.0, 24.0]}}
    uneven = scene_from_dict(data)
    return uneven, *with_free(layout, values, uneven, free_dimensions(uneven))


def check_gradients(model: MeshModel, values: Array, step: float, seed: int, rel: float) -> None:
    """Gradients along a random direction of all parameters are those of central differences."""
    found, direction = model.responses(values), np.random.default_rng(seed).standard_normal(len(values))
    above, below = (model.responses(values + sign * step * direction) for sign in (1, -1))
    for name, value in found.values.items():
        measured = (above.values[name] - below.values[name]) / (2 * step)
        assert found.gradients[name] @ direction == pytest.approx(measured, rel=rel, abs=1e-8 * abs(value))


def check_followed(moved: MovedMesh, values: Array, names: Mapping[int, str]) -> None:
    """Nodes follow the faces to second order, by each of some parameters, given by place and name."""
    step = 0.02
    motion = moved.velocities(moved.mesh, values)
    before = moved.distances_mm(moved.mesh.points_mm, values).max()
    assert before < 1e-6
    for i, name in names.items():
        changed = values + step * np.eye(len(values))[i]
        off = moved.distances_mm(moved.mesh.points_mm + step * motion[:, :, i], changed).max()
        unmoved = moved.distances_mm(moved.mesh.points_mm, changed).max()
        assert off < 2 * before + step**2, name
        assert unmoved > 20 * off, name


def check_same_change(
    scene: Scene, layout: Layout, both: tuple[Array, Array], size_mm: float, least: float, rel: float
) -> None:
    """A mesh there, moved here, and one here, moved there, tell the same change of the stiffnesses.

    Their own scatter cancels. Masses are exact on a new mesh.
    """
    meshes = [MeshModel(scene, layout, start, size_mm) for start in both]
    before, after = ([m.responses(v).values for m in meshes] for v in both)
    for name in ("torsion", "bending"):
        there, back = (new[name] / old[name] - 1 for old, new in zip(before, after, strict=True))
        assert abs(there) > least, name
        assert there == pytest.approx(back, rel=rel), name
    for name in ("mass", "inertia", "unbalance"):
        assert after[0][name] == pytest.approx(after[1][name], rel=1.5e-4), name
