"""The rod by finite elements against closed forms: bar, thick ring, beam, and the engine's own forces."""

import math

import numpy as np
import pytest

from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.rod_body import rod_mass, section
from cranktopo.engine.rod_forces import rod_motions
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.tetrahedra.cad_mesh import generate
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.sharp_edges import from_sharp_edges_mm, near_sharp_edges
from cranktopo.numerics.tetrahedra.stress import nodal_stress, outer_surface, surface_stress
from cranktopo.numerics.tetrahedra.surface_loads import face_shares, faces_where, pressure_force
from cranktopo.tasks.rod.contact import contact_deg, cosine, strips
from cranktopo.tasks.rod.element_stress import PLACES, cycle_loads, element_stress, place_of, unit_stress
from cranktopo.tasks.rod.elements import eye_shapes
from cranktopo.tasks.rod.unit_fields import contact_pressures, rod_model, solve_rod
from cranktopo.tasks.rod.unit_loads import ACROSS, ALONG, PRESSED, bore_of
from tests.physics.rod.face_values import at_faces

LOADS = (*ALONG, *ACROSS)
RING_MM = 10.0, 20.0
WIDTH_MM = 4.0


def solved(model, force, planes):
    """Displacements of a body whose nodes on planes (axis, mm) stay in them."""
    held = [3 * np.flatnonzero(np.abs(model.nodes_mm[axis] - at) < 1e-9) + axis for axis, at in planes]
    return model.equations.solver(np.concatenate(held))(force[:, None]).T


def meshed(build, size):
    with cad_session("body") as gmsh:
        build(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        for option, value in (("MeshSizeMax", size), ("MeshSizeFromCurvature", 24)):
            gmsh.option.setNumber(f"Mesh.{option}", value)
        return assemble(generate(gmsh, True, stresses=True, regular=False), 210e3, 0.3)


def test_a_bar_under_pressure_at_its_end():
    """Quadratic elements hold even stress exactly."""
    model = meshed(lambda occ: occ.addBox(0, 0, 0, 6, 30, 4), 5.0)
    end = faces_where(model, lambda p: np.abs(p[1] - 30) < 1e-9)
    force = pressure_force(model, end, np.full(end.dx.shape, 50.0))
    assert force.reshape(-1, 3).sum(axis=0) == pytest.approx([0, -50.0 * 24, 0], abs=1e-8)
    assert face_shares(model, end).sum() == pytest.approx(1.0)
    moved = solved(model, force, [(0, 0.0), (1, 0.0), (2, 0.0)])
    stress = nodal_stress(model, moved, 210e3, 0.3).nodal_MPa[0]
    assert stress[:, 1] == pytest.approx(np.full(len(stress), -50.0), abs=1e-5)
    assert np.abs(np.delete(stress, 1, axis=1)).max() < 1e-5


@pytest.fixture(scope="module")
def ring():
    """A quarter of a thick ring."""

    def build(occ):
        inner, outer = (occ.addCylinder(0, 0, 0, 0, 0, WIDTH_MM, r, angle=math.pi / 2) for r in RING_MM)
        occ.cut([(3, outer)], [(3, inner)])

    return meshed(build, 2.0)


@pytest.mark.parametrize("wave", [0, 2])
def test_a_thick_ring_under_pressure(ring, wave):
    """Lame for even pressure; for cos 2 theta Michell's stress function with four boundary conditions."""
    a, b = RING_MM
    bore = faces_where(ring, lambda p: np.abs(np.hypot(p[0], p[1]) - a) < 1e-6)
    x, y, _ = np.asarray(bore.global_coordinates())
    pressure = np.cos(wave * np.arctan2(y, x))
    moved = solved(ring, pressure_force(ring, bore, pressure), [(0, 0.0), (1, 0.0), (2, 0.0)])
    surface = outer_surface(ring, ring.mesh.dofs.element_dofs, ((0, 0.0), (1, 0.0), (2, 0.0)))
    found = surface_stress(ring, surface, nodal_stress(ring, moved, 210e3, 0.3)).stress_MPa[0]
    at_x, at_y, _ = surface.points_mm
    for radius, hoop in zip(RING_MM, hoop_MPa(a, b, wave), strict=True):
        on = np.abs(np.hypot(at_x, at_y) - radius) < 1e-4
        angle = np.arctan2(at_y[on], at_x[on])
        sine, cosine = np.sin(angle), np.cos(angle)
        xx, yy, xy = found[on][:, (0, 1, 3)].T
        around = xx * sine**2 + yy * cosine**2 - 2 * xy * sine * cosine
        wanted = np.cos(wave * angle)
        assert (around * wanted).sum() / (wanted**2).sum() == pytest.approx(hoop, rel=0.01)


def hoop_MPa(a, b, wave):
    """Hoop stress at theta = 0 at both faces, of 1 MPa times cos(wave theta) on the bore."""
    if not wave:
        outer = 2 * a**2 / (b**2 - a**2)
        return outer + 1, outer
    radial = [[-2, 0, -6 / r**4, -4 / r**2] for r in (a, b)]
    shear = [[2, 6 * r**2, -6 / r**4, -2 / r**2] for r in (a, b)]
    A, B, C, _ = np.linalg.solve([*radial, *shear], [-1.0, 0.0, 0.0, 0.0])
    return tuple(2 * A + 12 * B * r**2 + 6 * C / r**4 for r in (a, b))


SCENE = load_scene("mikron-iiic-rod")
SCENE = SCENE.model_copy(update={"material": SCENE.rod.material})
MASS = rod_mass(SCENE.rod, 166.0, SCENE.material)


@pytest.fixture(scope="module")
def fields():
    return solve_rod(SCENE, rod_model(SCENE, 6.0), {})


@pytest.fixture(scope="module")
def stresses(fields):
    found = unit_stress(fields)
    return found.surface, found.stress


def of(name, factor=1.0):
    return np.where(np.array(LOADS) == name, factor, 0.0)


def along_MPa(stresses, factors, y_mm):
    """Places across and stresses along the rod on its outer faces near a section."""
    surface, found = stresses
    near = np.abs(surface.points_mm[1] - y_mm) < 1.5
    return surface.points_mm[0, near], np.einsum("f,fnc->nc", factors, found.stress_MPa[:, near])[:, 1]


@pytest.mark.parametrize(("load", "sign"), [("push", -1), ("pull", 1)])
def test_the_shank_has_force_over_area(stresses, load, sign):
    """Between the eyes a force runs through, wherever the bores carry it."""
    factors = of(f"small {load}", 1e4) + of(f"big {load}", 1e4)
    _, found = along_MPa(stresses, factors, 83.0)
    area = section(SCENE.rod, 166.0, np.array([83.0])).area_mm2[0]
    assert found.mean() == pytest.approx(sign * 1e4 / area, rel=0.01)


def test_the_whip_bends_as_a_beam(stresses):
    """The moment of the rod's mass on both pins, bolts with it, over the section's modulus."""
    y = 83.0
    x, found = along_MPa(stresses, of("small whip", 700.0) + of("big whip", 1000.0), y)
    kg, at = MASS.y_kg, MASS.y_mm
    load = kg * (1000.0 + (700.0 - 1000.0) * at / 166.0)
    load[-5:-3] = 0.0  # bush and shells are beyond the bores; the last three are the bolts
    beyond = at > y
    moment = (load * at).sum() / 166.0 * (166.0 - y) - (load * (at - y))[beyond].sum()
    bent = moment * x / section(SCENE.rod, 166.0, np.array([y])).swing_mm4[0]
    slope = np.polyfit(bent, found, 1)[0]
    assert abs(slope) == pytest.approx(1.0, abs=0.03)


def test_the_whip_stretches_one_side_and_presses_the_other(fields):
    found = element_stress(fields, of("big whip", 1000.0)[None], "lsa", 0.0)
    assert np.abs(found.high_MPa[0]).max() > 1.0
    assert found.high_MPa[1] == pytest.approx(-found.high_MPa[0], abs=1e-9)


def test_section_forces_over_the_cycle(fields, stresses):
    """In the states of largest push and of largest pull, with the inertia of what lies beyond."""
    motion = rod_motions(SCENE)[1]
    states = cycle_loads(fields, MASS, [motion], 0.0)
    every = len(motion.angle_deg) // len(states)
    for state in (int(states[:, 0].argmax()), int(states[:, 1].argmax())):
        for place in (60.0, 110.0):
            area = section(SCENE.rod, 166.0, np.array([place])).area_mm2[0]
            _, found = along_MPa(stresses, np.where(whips(), 0.0, states[state]), place)
            force = motion.section_force_N(MASS, 166.0, place)[every * state]
            assert -found.mean() * area == pytest.approx(force, rel=0.015)


def whips():
    return np.array([name in ACROSS for name in LOADS])


def test_the_big_end_carries_what_the_engine_says(fields):
    """Of the engine's own split masses; shells ride on the crankpin, and the parts across are small."""
    for motion in rod_motions(SCENE):
        states = cycle_loads(fields, MASS, [motion], 0.0)
        every = len(motion.angle_deg) // len(states)
        carried = states[:, 2] - states[:, 3]
        whole = motion.section_force_N(MASS, 166.0, -1e9) + SCENE.rod.shells_kg * motion.big_along_m_s2
        assert carried == pytest.approx(whole[::every], abs=0.012 * np.abs(whole).max())
        assert states[:, 0] * states[:, 1] == pytest.approx(0.0)


def test_nothing_is_left_on_nodes_and_supports(fields):
    assert fields.residual < 1e-6
    assert sum(fields.inertia_kg) == pytest.approx(
        MASS.total_kg - MASS.y_kg[-5] - SCENE.rod.shells_kg, rel=1e-3
    )


@pytest.mark.parametrize(("eye", "side"), PRESSED)
def test_eyes_carry_by_the_cosine(fields, eye, side):
    """1 N over the whole rod, and the second wave of p = cos psi over half a bore: 2/3 over pi/2 of it."""
    bore = bore_of(SCENE, fields.model, eye)
    x, y, _ = bore.unit(side, cosine).reshape(-1, 3).T
    assert 4 * y.sum() == pytest.approx(side)
    angle = np.arctan2(fields.model.nodes_mm[0], side * (fields.model.nodes_mm[1] - bore.y_mm))
    outward = x * np.sin(angle) + side * y * np.cos(angle)
    assert outward[angle > math.pi / 2 + 0.2] == pytest.approx(0.0, abs=1e-12)
    assert 4 * (outward * np.cos(2 * angle)).sum() == pytest.approx(4 / 3 / math.pi, rel=0.01)


@pytest.mark.slow
def test_a_rigid_pin_touches_where_it_presses(fields):
    """Signorini's conditions in a state solved anew: no pressure across a gap, no gap under pressure."""
    pressures = contact_pressures(SCENE, fields.model)
    touched = solve_rod(SCENE, fields.model, pressures)
    for number, (eye, side) in enumerate(PRESSED):
        bore, pressure = bore_of(SCENE, fields.model, eye), pressures[eye, side]
        factors = np.zeros(len(LOADS))
        factors[[number, (number + 2) % 4]] = 1e4  # a push is carried by a push, a pull by a pull
        moved = (factors @ touched.displacement_mm).reshape(-1, 3)
        at_x, at_y, _ = at_faces(bore.faces, moved)
        x, y, _ = np.asarray(bore.faces.global_coordinates()) / bore.radius_mm
        y = y - bore.y_mm / bore.radius_mm
        angle, outward = np.arctan2(x, side * y), at_x * x + at_y * y
        weights = np.stack([strip(angle) * bore.faces.dx for strip in strips(alike=True)])
        weights /= weights.sum(axis=(1, 2), keepdims=True)
        bulged, pin = ((weights * field).sum(axis=(1, 2)) for field in (outward, np.cos(angle)))
        middles = (np.arange(len(pin)) + 0.5) * math.pi / 2 / len(pin)
        pressed = pressure(middles) > 0
        gap = bulged - pin * (bulged * pin)[pressed].sum() / (pin**2)[pressed].sum()
        assert np.abs(gap[pressed]).max() < 1e-4 * np.abs(bulged).max()
        assert (gap[~pressed] > 0).all()
        assert (pressure(middles) >= 0).all()
    assert contact_deg(pressures["small", -1]) < 80 < contact_deg(cosine)


def test_a_press_fit_by_lame(fields, stresses):
    """At the crown of the small end, where its shank stiffens it less than elsewhere."""
    surface, found = stresses
    bore, outer = SCENE.rod.small_end_bore_mm, SCENE.rod.small_end_diameter_mm
    crown = (np.abs(surface.points_mm[0]) < 1e-9) & (np.abs(surface.points_mm[1] - 166 - bore / 2) < 1e-6)
    hoop = found.stress_MPa[LOADS.index("press fit"), crown, 0].mean()
    assert hoop == pytest.approx((outer**2 + bore**2) / (outer**2 - bore**2), rel=0.1)


def test_bores_become_oval_as_their_nodes_move(fields):
    """Along the rod the diameter is that between the two lines of nodes on the mirror plane."""
    factors = of("small push", 3e4) + of("big push", 2.9e4)
    shapes = {(shape.eye, shape.load): shape for shape in eye_shapes(fields, factors[None])}
    moved = (factors @ fields.displacement_mm).reshape(-1, 3)
    x, y, _ = fields.model.nodes_mm
    for eye, centre, radius in (("small end", 166.0, 12.0), ("big end", 0.0, 23.0)):
        top, bottom = (
            moved[(np.abs(x) < 1e-9) & (np.abs(y - centre - side * radius) < 1e-6), 1].mean()
            for side in (1, -1)
        )
        assert shapes[eye, "push"].along_um == pytest.approx(1000 * (top - bottom), rel=0.04)
        assert shapes[eye, "push"].across_um > 0 > shapes[eye, "push"].along_um


def test_places_of_points(fields):
    points = {
        "small end": (0.0, 185.0, 0.0),
        "eye to shank": (6.0, 140.0, 0.0),
        "mid-shank": (5.0, 83.0, 0.0),
        "shank to big end": (12.0, 35.0, 0.0),
        "big end": (30.0, 10.0, 0.0),
        "cap": (0.0, -30.0, 0.0),
    }
    found = place_of(fields, np.array(list(points.values())).T)
    assert [PLACES[number] for number in found] == list(points)


def test_distance_from_sharp_edges(stresses):
    """The boss meets the big end's ring in a sharp inner edge below the split, beside the bolt's hole."""
    surface, _ = stresses
    away = from_sharp_edges_mm(surface)
    assert away.min() == 0.0
    assert near_sharp_edges(surface)[away == 0.0].all()
    nearest = surface.points_mm[:, away == 0.0]
    meets = nearest[:, np.abs(nearest[1] + 16.0) < 1e-6]
    assert (np.abs(np.hypot(*meets[:2]) - 32.5) < 0.03).sum() > 3
    assert (away[np.abs(surface.points_mm[1] - 83.0) < 20] > 30).all()


@pytest.mark.parametrize("key", ["rod.small_end_diameter_mm", "rod.big_end_width_mm"])
@pytest.mark.slow
def test_more_material_is_less_oval(fields, key):
    eye = "small" if "small" in key else "big"
    roomy = {"throw.crankpin.length_mm": 40.0}
    changed = with_values(SCENE, {**roomy, key: getattr(SCENE.rod, key.split(".")[1]) + 4.0})
    factors = of(f"{eye} push", 3e4)[None]
    before, after = (
        next(shape for shape in eye_shapes(one, factors) if shape.eye.startswith(eye))
        for one in (fields, solve_rod(changed, rod_model(changed, 6.0), {}))
    )
    assert after.across_um < 0.95 * before.across_um
