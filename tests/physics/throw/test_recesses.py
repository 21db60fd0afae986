"""Recessed fillets as bodies, meshes and in the rule: volume, nodes in the groove, factors of UR M53."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.cells.layers import GridContent
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.bodies.solid.checked import solid_properties
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.tasks.throw_fatigue.fillets import fillet_nodes, place
from cranktopo.tasks.throw_fatigue.m53 import concentration_factors, dimensions
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.fea.evaluation_cases import mikron_with

FILLET_MM, RECESSES_MM = 2.0, (0.5, 0.8)


def recessed(main_mm: float, pin_mm: float, **more: Any) -> Scene:
    data = mikron_with().model_dump(mode="json", exclude_none=True)
    for key, recess in (("main_journal", main_mm), ("crankpin", pin_mm)):
        data["throw"][key] |= {"fillet_mm": FILLET_MM, **more} | ({"recess_mm": recess} if recess else {})
    return scene_from_dict(data)


def test_the_kernel_builds_the_volume_and_moments_of_the_closed_form() -> None:
    scene = recessed(*RECESSES_MM)
    with cad_session("half") as gmsh:
        half = solid_properties(gmsh.model.occ, add_half_throw(gmsh.model.occ, scene))
    balance, density = throw_balance(scene), density_kg_per_mm3(scene.material.density_kg_m3)
    assert half.volume_mm3 == pytest.approx(half_throw_volume_mm3(scene), rel=1e-7)
    assert half.volume_mm3 < half_throw_volume_mm3(recessed(0.0, 0.0)) - 400
    assert 2 * half.inertia_z_mm5 * density == pytest.approx(balance.inertia_kg_mm2, rel=1e-7)
    unbalance = 2 * half.volume_mm3 * half.centre_mm[1] * density
    assert unbalance == pytest.approx(balance.throw_unbalance_kg_mm, rel=1e-7)


def test_nodes_lie_on_the_arc_down_to_its_bottom_and_up_again() -> None:
    scene = recessed(*RECESSES_MM)
    points = mesh_throw(scene, 14.0, fillet_fraction=1.0).mesh.points_mm
    on = fillet_nodes(scene, "pin", points)
    x, y, z = points[:, on]
    face, recess = scene.web_z_mm[1], RECESSES_MM[1]
    across = 21.0 + FILLET_MM - np.hypot(x, y - 48.0)
    height = face + FILLET_MM - recess - z
    assert np.hypot(across, height) == pytest.approx(FILLET_MM, abs=1e-4)
    assert height.max() == pytest.approx(FILLET_MM, abs=0.01)
    assert z.min() == pytest.approx(face - recess, abs=0.01)
    assert across.min() == pytest.approx(-np.sqrt(recess * (2 * FILLET_MM - recess)), abs=1e-3)
    deepest = points[:, on][:, z.argmin()]
    assert place(scene, deepest).along_deg == pytest.approx(90.0, abs=5.0)


def test_the_rule_multiplies_its_factors_by_that_of_the_recesses() -> None:
    """UR M53, 3.2: f(recess) = 1 + (tH + tG)(1.8 + 3.2 s), both over the pin's diameter."""
    scene = recessed(*RECESSES_MM)
    size = dimensions(scene)
    factors, plain = concentration_factors(size), concentration_factors(dimensions(recessed(0.0, 0.0)))
    overlap = (42.0 - 48.0) / 42.0
    expected = max(1 + sum(RECESSES_MM) / 42.0 * (1.8 + 3.2 * overlap), 1.0)
    assert expected > 1.03
    for name in ("alpha_bending", "beta_bending", "beta_shear"):
        assert getattr(factors, name) / getattr(plain, name) == pytest.approx(expected, rel=1e-12)
    assert factors.alpha_torsion == plain.alpha_torsion


@pytest.mark.parametrize(
    ("main_mm", "pin_mm", "more", "message"),
    [
        (2.0, 0.0, {}, r"throw.main_journal.recess_mm = 2.0: must be smaller than .*fillet_mm = 2 mm"),
        (0.5, 0.5, {"fillet_axial_mm": 3.0}, "an ellipse .* has no recess"),
        (5.0, 5.0, {"fillet_mm": 6.0}, "must stay below half of the web's thickness"),
    ],
)
def test_what_gives_no_recess_is_refused(
    main_mm: float, pin_mm: float, more: dict[str, float], message: str
) -> None:
    with pytest.raises(CranktopoError, match=message):
        recessed(main_mm, pin_mm, **more)


@pytest.mark.parametrize("target", ["envelope", "web"])
def test_cells_have_neither_fillets_nor_recesses(target: GridContent) -> None:
    cells, sharp = (build_domain(scene, 3.0, target) for scene in (recessed(0.5, 0.8), mikron_with()))
    for kind in ("passive_fraction", "design_fraction", "web", "pin"):
        assert np.array_equal(getattr(cells, kind), getattr(sharp, kind)), kind


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mikron-iiic-plain", "car-diesel"])
def test_a_recess_takes_the_stiffness_that_its_fillet_gives(name: str) -> None:
    """So that cells and surfaces without both are as stiff as the throw with both, 0.2 to 0.4 of R deep."""
    fillet, recess = {"fillet_mm": FILLET_MM}, {"fillet_mm": FILLET_MM, "recess_mm": 0.6}
    sharp, round_, undercut = (stiffness(name, own) for own in ({"fillet_mm": 0.0}, fillet, recess))
    assert undercut == pytest.approx(sharp, rel=4e-3)
    assert (round_ > 1.009 * sharp).all()


def stiffness(name: str, changes: dict[str, float]) -> Array:
    """Torsion, free and held, and bending, pinned, of a built-in throw with other fillets."""
    data = load_scene(name).model_dump(mode="json", exclude_none=True)
    for key in ("main_journal", "crankpin"):
        data["throw"][key] |= changes
    found = evaluate(Target(name, scene_from_dict(data)), None).fine
    return np.array([found.torsion["free"], found.torsion["held"], found.bending["pinned"]])
