"""The pull of bolted counterweights and plugs on the mesh of their web, by hand and as in one piece."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Span
from cranktopo.base.units import KG_PER_TONNE, density_kg_per_mm3, density_tonne_per_mm3
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, mesh_throw
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.plan.planning import plan, plan_for_stress
from cranktopo.numerics.tetrahedra.elasticity import assemble, centrifugal_force
from cranktopo.tasks.shaft.loaded_throw import loaded_throw, throw_body
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_field
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.turning_load import turning_load
from tests.physics.fatigue.test_least_safety import single
from tests.unit.throw.counterweight_cases import PLAIN, THIN, roomy_scene, weighted

SIZE_MM, STEEL, TUNGSTEN = 14.0, 7850.0, 17500.0
PLUG: dict[str, Any] = {"axis": "axial", "x_mm": 18.0, "y_mm": -45.0, "diameter_mm": 14.0, "length_mm": 12.0}
PLUG |= {"density_kg_m3": TUNGSTEN}
PLUG_KG = TUNGSTEN * 1e-9 * math.pi * 7.0**2 * 12.0


def resultants(meshed: MeshedThrow, scene: Scene) -> tuple[Array, Array]:
    """Force and moment about the origin of what is fastened, both halves in x counted; kg mm, kg mm2."""
    model = assemble(meshed.mesh, 1.0, 0.3)
    span: Span = "whole" if meshed.whole else "symmetric"
    load = turning_load(model, scene, span, "even" if meshed.mesh.mirrored else "none")
    own = load - centrifugal_force(model, density_tonne_per_mm3(scene.material.density_kg_m3))
    forces, places = KG_PER_TONNE * own.reshape(-1, 3), model.nodes_mm.T
    force, moment = forces.sum(axis=0), np.cross(places, forces).sum(axis=0)
    if meshed.mesh.mirrored:
        force, moment = force * [0.0, 2.0, 0.0], moment * [2.0, 0.0, 0.0]
    return force, moment


def is_force_at(found: tuple[Array, Array], kg: float, place_mm: tuple[float, float, float]) -> None:
    force = np.array([kg * place_mm[0], kg * place_mm[1], 0.0])
    moment = np.cross(place_mm, force)
    assert found[0] == pytest.approx(force, abs=1e-9 * np.abs(force).max())
    assert found[1] == pytest.approx(moment, abs=1e-9 * np.abs(moment).max())


@pytest.mark.parametrize(("full", "quarter"), [(False, True), (False, False), (True, True)])
def test_a_bolted_counterweight_pulls_at_its_own_height(mikron: Scene, full: bool, quarter: bool) -> None:
    """One of half the web's thickness at its pin face; mass and unbalance are those it has in one piece."""
    scene = weighted(roomy_scene(mikron), {**THIN, "density_kg_m3": TUNGSTEN})
    solid, bare = weighted(scene, THIN), scene.model_copy(update={"web": mikron.web})
    kg = density_kg_per_mm3(TUNGSTEN) * (web_volume_mm3(solid) - web_volume_mm3(bare))
    own = [throw_balance(one).web_kg_mm[0] for one in (solid, bare)]
    kg_mm = TUNGSTEN / scene.material.density_kg_m3 * (own[0] - own[1])
    place = (0.0, kg_mm / kg, scene.web_z_mm[1] - THIN["thickness_mm"] / 2)  # type: ignore[operator]
    force, moment = resultants(mesh_throw(scene, SIZE_MM, full=full, quarter=quarter), scene)
    if full:  # the second web is the mirror image of the first: both pull at the middle of the pin
        is_force_at((force, moment), 2 * kg, (*place[:2], scene.pitch_mm / 2))
    else:
        is_force_at((force, moment), kg, place)


def test_a_plug_aside_pulls_where_it_is(mikron: Scene) -> None:
    """One that is flush with the journal face, off the plane of the throw."""
    scene = weighted(roomy_scene(mikron), {**THIN, **PLAIN, "plug": [PLUG]})
    high = scene.web_z_mm[1]
    found = resultants(mesh_throw(scene, SIZE_MM), scene)
    is_force_at(found, PLUG_KG, (18.0, -45.0, high - 6.0))


def test_what_is_one_piece_pulls_by_its_mesh_alone(mikron: Scene) -> None:
    scene = weighted(roomy_scene(mikron), PLAIN)
    force, moment = resultants(mesh_throw(scene, SIZE_MM), scene)
    assert not force.any()
    assert not moment.any()


def test_second_webs_have_pulls_of_their_own(mikron: Scene) -> None:
    """Only the second web has a counterweight bolted on: it pulls beyond the middle of the pin."""
    data = weighted(roomy_scene(mikron), PLAIN).model_dump(mode="json", exclude_none=True)
    far = {**data["web"], "counterweight": {**data["web"]["counterweight"], "density_kg_m3": TUNGSTEN}}
    scene = scene_from_dict({**data, "second_web": far}, whole=True)
    force, moment = resultants(mesh_throw(scene, SIZE_MM), scene)
    middle = scene.pitch_mm - sum(scene.web_z_mm) / 2
    assert force[1] < 0
    assert moment[0] == pytest.approx(-middle * force[1], rel=1e-9)


def test_bearings_of_a_shaft_carry_what_is_bolted_on() -> None:
    """Both sections of a throw have its unbalance, which `balance` and `loads` tell by closed forms."""
    counterweight = {"outer_radius_mm": 70.0, "half_angle_deg": 60.0, "density_kg_m3": TUNGSTEN}
    scene = single(counterweight=counterweight)
    throw = loaded_throw(throw_body(mesh_throw(scene, SIZE_MM), scene).blocks, scene)
    sections = throw.loads["centrifugal"]
    unbalance = throw_balance(scene).throw_unbalance_kg_mm / KG_PER_TONNE
    assert unbalance < 0
    assert sections[1] + sections[7] == pytest.approx(unbalance, rel=1e-2)


def test_the_plan_tells_the_pull_that_acts() -> None:
    """On meshes all of it; on cells without what is bolted on, as without it."""
    own = {"outer_radius_mm": 70.0, "half_angle_deg": 60.0}
    bolted, one_piece, bare = (
        single(counterweight=own | {"density_kg_m3": STEEL}),
        single(counterweight=own),
        single(),
    )
    on_mesh, on_cells = "centrifugal", "the mid-planes of the webs"
    stress = [plan_for_stress(scene)[on_mesh].estimate_percent for scene in (bolted, one_piece, bare)]
    assert stress[0] == pytest.approx(stress[1], rel=1e-2)
    assert stress[0] != pytest.approx(stress[2], rel=0.1)
    cells = [plan(scene)[on_mesh] for scene in (bolted, bare)]
    assert cells[0].estimate_percent == pytest.approx(cells[1].estimate_percent, rel=1e-9)
    assert on_cells in cells[0].reason
    assert "not on cells" in cells[0].reason
    assert "not on cells" not in cells[1].reason


@pytest.mark.slow
def test_a_counterweight_bolted_on_costs_as_much_safety_as_one_in_one_piece() -> None:
    """`pytest -m slow tests/physics/fea/test_turning_load.py`: of the web's own density, within 2 %."""
    own = {"outer_radius_mm": 70.0, "half_angle_deg": 60.0}
    bolted, one_piece, bare = (
        fatigue_field(Target("", scene), "lsa", fillet_fraction=0.5).critical.safety
        for scene in (
            single(counterweight=own | {"density_kg_m3": STEEL}),
            single(counterweight=own),
            single(),
        )
    )
    print(f"bolted {bolted:.4f}, one piece {one_piece:.4f}, bare {bare:.4f}")
    assert bolted == pytest.approx(one_piece, rel=0.02)
    assert abs(bare / one_piece - 1) > 0.02
