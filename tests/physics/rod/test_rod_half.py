"""Half of the rod by elements, as an oblique split needs it: against its quarter, and in equilibrium."""

import meshio
import numpy as np
import pytest
from scipy.spatial import cKDTree

from cranktopo.bodies.mesh.rod_mesh import mesh_rod
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.rod_body import rod_mass, section
from cranktopo.design.rod_split import in_rod
from cranktopo.engine.rod_forces import rod_motions
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.tasks.rod.contact import strips
from cranktopo.tasks.rod.element_stage import check_rod_elements
from cranktopo.tasks.rod.element_stress import PLACES, cycle_loads, element_stress, place_of, unit_stress
from cranktopo.tasks.rod.elements import eye_shapes
from cranktopo.tasks.rod.pictures import write_rod_vtu
from cranktopo.tasks.rod.unit_fields import contact_pressures, rod_model, solve_rod
from cranktopo.tasks.rod.unit_loads import ACROSS, ALONG, PRESSED, RodLoads, bore_of
from tests.physics.rod.face_values import at_faces

LOADS = (*ALONG, *ACROSS)
LENGTH_MM = 166.0
SQUARE = load_scene("mikron-iiic-rod")
SQUARE = SQUARE.model_copy(update={"material": SQUARE.rod.material})
OBLIQUE = with_values(SQUARE, {"rod.split_angle_deg": 45.0})
ELASTIC = SQUARE.material.E_GPa * 1e3, SQUARE.material.poisson
SIZE_MM = 9.0
IMAGE = [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]
"""Nodes of a tetrahedron whose first corners change places, as its mirror image needs it."""


def mirrored(mesh):
    """A quarter and its image x < 0 in one mesh."""
    image = mesh.points_mm * np.array([[-1.0], [1.0], [1.0]])
    both = np.hstack([mesh.points_mm, image])
    both[0, np.abs(both[0]) < 1e-9] = 0.0
    cells = np.hstack([mesh.cells, mesh.cells[IMAGE] + mesh.points_mm.shape[1]])
    _, first, place = np.unique(both.round(9), axis=1, return_index=True, return_inverse=True)
    return TetMesh(both[:, first], place.ravel()[cells], mirrored=False)


@pytest.fixture(scope="module")
def pair():
    """Unit loads of a square rod on a quarter, and on the half that this and its image are."""
    mesh = mesh_rod(SQUARE, SIZE_MM)
    return [solve_rod(SQUARE, assemble(one, *ELASTIC), {}) for one in (mesh, mirrored(mesh))]


@pytest.fixture(scope="module")
def oblique():
    return solve_rod(OBLIQUE, rod_model(OBLIQUE, 6.0), {})


def of(name, factor=1.0):
    return np.where(np.array(LOADS) == name, factor, 0.0)


VALUES = {
    "highest": lambda stress: stress.high_MPa,
    "lowest": lambda stress: stress.low_MPa,
    "amplitude": lambda stress: np.stack([one.amplitude_MPa for one in stress.swing]),
    "gradient": lambda stress: np.stack([one.gradient_per_mm for one in stress.swing]),
    "fatigue": lambda stress: stress.fatigue_safety,
}


@pytest.mark.slow
def test_the_half_of_a_square_rod_has_the_stresses_of_its_quarter(pair):
    """Nodes of the half on both sides over a cycle, but for those whose elements touch the other mirror."""
    mass = rod_mass(SQUARE.rod, LENGTH_MM, SQUARE.material)
    motion = rod_motions(SQUARE)[1]
    loads = [cycle_loads(one, mass, [motion], 5.0)[::15] for one in pair]
    assert loads[1] == pytest.approx(loads[0], rel=1e-6, abs=1e-6 * np.abs(loads[0]).max())
    quarter, half = (element_stress(one, states, "lsa", 2.0) for one, states in zip(pair, loads, strict=True))
    x, y, z = half.surface.points_mm
    away, node = cKDTree(quarter.surface.points_mm.T).query(np.stack([np.abs(x), y, z]).T)
    assert away.max() < 1e-6
    inside = np.abs(x) > SIZE_MM
    assert (inside & (x < 0)).sum() == (inside & (x > 0)).sum() > 1000
    for name, value in VALUES.items():
        wanted = value(quarter)[:, node]
        wanted = np.where(x < 0, wanted[::-1], wanted)  # the other way round, the sides change places
        found = value(half)
        assert found[:, inside] == pytest.approx(
            wanted[:, inside], rel=1e-5, abs=1e-5 * np.abs(wanted).max()
        ), name
    assert not np.allclose(half.high_MPa[0], half.high_MPa[1], rtol=0.01)
    for one, other in zip(*(eye_shapes(f, s) for f, s in zip(pair, loads, strict=True)), strict=True):
        assert one.across_um == pytest.approx(other.across_um, rel=1e-4)
        assert one.along_um == pytest.approx(other.along_um, rel=1e-4)
        assert other.ovalisation_um == pytest.approx(one.ovalisation_um, rel=0.02)


@pytest.mark.slow
def test_loads_of_an_oblique_rod_are_in_equilibrium(oblique):
    """Forces along x and y and the moment about the big end of every load, summed over the nodes."""
    (group,) = RodLoads(OBLIQUE, oblique.model, {}).groups()
    force = group.forces.reshape(-1, 3, len(LOADS))
    at = oblique.model.nodes_mm.T
    size = np.abs(force).sum(axis=(0, 1))
    moment = (at[:, :1] * force[:, 1] - at[:, 1:2] * force[:, 0]).sum(axis=0)
    assert np.abs(force[:, :2].sum(axis=0) / size).max() < 1e-12
    assert np.abs(moment / size / LENGTH_MM).max() < 1e-12
    assert oblique.residual < 1e-6
    mass = rod_mass(OBLIQUE.rod, LENGTH_MM, OBLIQUE.material)
    fitted = OBLIQUE.rod.shells_kg + mass.y_kg[-8]  # the bush; the last six are the bolts
    assert sum(oblique.inertia_kg) == pytest.approx(mass.total_kg - fitted, rel=1e-3)


@pytest.mark.slow
def test_a_mass_beside_the_axis_bends_the_shank(oblique):
    """A push that moves the whole rod evenly: a beam that both eyes hold across by a couple.

    What lies beyond the section has its mass on the axis. Bolts count in the middle of the cap's holes.
    """
    mass, rod, y = rod_mass(OBLIQUE.rod, LENGTH_MM, OBLIQUE.material), OBLIQUE.rod, 83.0
    bolts_y, bolts_kg = mass.y_mm[-6:], mass.y_kg[-6:]
    turn = np.radians(rod.split_angle_deg)
    body = mass.across_mm * mass.total_kg - bolts_y @ bolts_kg * np.tan(turn)
    bolts = bolts_kg.sum() * -rod.boss_below_mm / 2 * np.sin(turn)
    aside = (body + bolts) / sum(oblique.inertia_kg)
    unit = unit_stress(oblique)
    surface, found = unit.surface, unit.stress
    near = np.abs(surface.points_mm[1] - y) < 6.0
    stress = np.einsum("f,fnc->nc", of("small push", 1e4), found.stress_MPa[:, near])[:, 1]
    slope = np.polyfit(surface.points_mm[0, near], stress, 1)[0]
    # inertia toward the small end beside the axis: the small end is held toward +x
    moment = -1e4 * aside / LENGTH_MM * (LENGTH_MM - y)
    swing_mm4 = section(rod, LENGTH_MM, np.array([y])).swing_mm4[0]
    assert slope * swing_mm4 == pytest.approx(moment, rel=0.05)


@pytest.mark.slow
def test_its_surface_is_written_with_the_worse_way_to_mount_it(tmp_path, oblique):
    """Both halves, z >= 0 and z < 0, with the bosses' low side at positive x alone."""
    loads = of("big whip", 1000.0) + of("big push", 1e3)
    found = element_stress(oblique, loads[None], "lsa", 0.0)
    write_rod_vtu(tmp_path / "rod.vtu", found)
    written = meshio.read(tmp_path / "rod.vtu")
    x, y, z = written.points.T
    assert y[x > 0].min() < y[x < 0].min() - 3.0
    assert z.min() == pytest.approx(-z.max())
    largest = written.point_data["largest_von_mises_MPa"].reshape(2, -1)
    assert largest == pytest.approx(np.tile(found.largest_MPa.max(axis=0), (2, 1)))
    assert not np.allclose(found.largest_MPa[0], found.largest_MPa[1], rtol=0.01)


@pytest.mark.slow
def test_places_of_an_oblique_rod(oblique):
    """Bosses and cap turn with the split; what is left of the bosses' side above it is no cap."""
    rod = OBLIQUE.rod
    u = rod.boss_width_mm / 2 - 1.0
    x, y = in_rod(rod, np.array([u, -u, u, -u]), np.array([10.0, 10.0, -10.0, -10.0]))
    found = place_of(oblique, np.array([x, y, 0 * x]))
    assert [PLACES[number] for number in found] == ["big end", "big end", "cap", "cap"]
    points = np.array([[5.0, 83.0, 0.0], [0.0, 185.0, 0.0], [12.0, 35.0, 0.0]]).T
    assert [PLACES[n] for n in place_of(oblique, points)] == ["mid-shank", "small end", "shank to big end"]


@pytest.mark.slow
def test_a_rigid_pin_in_an_oblique_big_end_is_free_across():
    """No force across, no pressure over a gap, no gap under pressure, wherever the pin moves."""
    model = rod_model(OBLIQUE, 6.0)
    pressures = contact_pressures(OBLIQUE, model)
    touched = solve_rod(OBLIQUE, model, pressures)
    for number, (eye, side) in enumerate(PRESSED):
        bore, pressure = bore_of(OBLIQUE, model, eye), pressures[eye, side]
        force = bore.unit(side, pressure)
        assert abs(force[::3].sum()) < 1e-5
        factors = np.zeros(len(LOADS))
        factors[[number, (number + 2) % 4]] = 1e4
        moved = (factors @ touched.displacement_mm).reshape(-1, 3)
        at_x, at_y, _ = at_faces(bore.faces, moved)
        x, y, _ = np.asarray(bore.faces.global_coordinates()) / bore.radius_mm
        y = y - bore.y_mm / bore.radius_mm
        angle, outward = np.arctan2(x, side * y), at_x * x + at_y * y
        weights = np.stack([strip(angle) * bore.faces.dx for strip in strips(alike=False)])
        weights /= weights.sum(axis=(1, 2), keepdims=True)
        fields = (outward, np.cos(angle), np.sin(angle))
        bulged, *pin = ((weights * field).sum(axis=(1, 2)) for field in fields)
        middles = (np.arange(len(bulged)) + 0.5) * np.pi / len(bulged) - np.pi / 2
        pressed = pressure(middles) > 0
        motion = np.linalg.lstsq(np.stack(pin, axis=1)[pressed], bulged[pressed], rcond=None)[0]
        gap = bulged - motion @ np.stack(pin)
        assert np.abs(gap[pressed]).max() < 1e-3 * np.abs(bulged).max()
        assert (gap[~pressed] > 0).all()
    pulled = pressures["big", -1](np.linspace(-1.2, 1.2, 49))
    assert not np.allclose(pulled, pulled[::-1], rtol=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(("size_mm", "within"), [(4.0, 0.06), (2.0, 0.02)])
def test_a_split_that_is_hardly_oblique_has_the_safeties_of_a_square_one(size_mm, within):
    """Half and quarter on meshes of their own; both sides of a square rod are the same."""
    scene = load_scene("mikron-iiic-rod-i")
    square, half = (
        check_rod_elements(with_values(scene, {"rod.split_angle_deg": angle}), element_size_mm=size_mm)
        for angle in (0.0, 1e-3)
    )
    assert half.elements.nodes > 1.7 * square.elements.nodes
    for one, other in zip(square.elements.places, half.elements.places, strict=True):
        assert other.place == one.place
        assert other.yield_safety == pytest.approx(one.yield_safety, rel=within)
        assert other.fatigue_safety == pytest.approx(one.fatigue_safety, rel=within)
    for one, other in zip(square.elements.eyes, half.elements.eyes, strict=True):
        assert other.across_um == pytest.approx(one.across_um, rel=0.02)
        assert other.along_um == pytest.approx(one.along_um, rel=0.02)
