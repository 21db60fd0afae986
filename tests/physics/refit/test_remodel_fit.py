"""The fit of a parametric web: gradients, known webs, limits kept, what the family cannot show."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.files import surface_of
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import mesh_of, solid_of
from cranktopo.tasks.refit.family import Layout, web_of
from cranktopo.tasks.refit.fit import fit_problem, fit_web, scene_with_web
from cranktopo.tasks.refit.parametric_web import ParametricWeb, part_rules
from cranktopo.tasks.refit.search import Fit, minimise_misfit, outline_guess, voxel_fill
from cranktopo.tasks.refit.select import Candidate, FitTask, fit_from, model_fill, residual_regions
from cranktopo.tasks.refit.shape_error import shape_error, surface_distance_mm, web_overlap
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted_pocket import FittedBox, FittedCylinder
from cranktopo.throw.fitted_slot import FittedSlot
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from cranktopo.throw.profile import ProfileWeb
from tests.unit.refit.remodel_cases import PARTS, PLAIN, WHOLE, body_of, known_scene, recovered, values_of

COARSE = ManufacturingLimits(cell_mm=2.0)
MORE = Layout(7, PARTS[:3])


@pytest.fixture(scope="module")
def body(mikron: Scene) -> Manifold:
    return body_of(known_scene(mikron, MORE))


@pytest.mark.slow
def test_voxel_fill_has_the_volume_of_the_web(mikron: Scene, body: Manifold) -> None:
    """Chords are exact in x; three lines per cell in y and z leave 1e-3."""
    start, end = mikron.web_z_mm
    region = body.trim_by_plane((0.0, 0.0, 1.0), start).trim_by_plane((0.0, 0.0, -1.0), -end)
    for cell in (2.0, 1.0):
        assert voxel_fill(body, mikron, cell).volume_mm3 == pytest.approx(region.volume(), rel=1e-3)


def test_voxel_fill_is_the_mean_of_both_sides(mikron: Scene) -> None:
    """A block with a notch on one side only: half filled there, and where the notch is."""
    start, end = mikron.web_z_mm
    block = Manifold.cube((40.0, 60.0, end - start)).translate((-20.0, 0.0, start))
    notch = Manifold.cube((6.0, 10.0, 40.0)).translate((10.0, 20.0, start))
    cells = voxel_fill(block - notch, mikron, 1.0)
    filled = {
        (x, y): cells.filled[np.argmin(abs(cells.x_mm - x)), np.argmin(abs(cells.y_mm - y)), 5]
        for x, y in ((12.5, 25.5), (12.5, 40.5), (30.5, 25.5), (5.5, 25.5))
    }
    assert filled == pytest.approx(
        {(12.5, 25.5): 0.5, (12.5, 40.5): 1.0, (30.5, 25.5): 0.0, (5.5, 25.5): 1.0}
    )


def test_gradients_are_those_of_finite_differences(mikron: Scene, body: Manifold) -> None:
    """All parameters of the family, away from the body they are fitted to."""
    values = values_of(WHOLE) + np.random.default_rng(3).normal(0, 0.7, len(WHOLE.names))
    fit = Fit(fit_problem(body, mikron, COARSE, 2.0), WHOLE)
    gradient = fit.misfit(values, 3.0)[1]()
    slopes = np.asarray(fit.web.gradients(values))
    step = 1e-5
    for i, name in enumerate(WHOLE.names):
        ahead, back = values.copy(), values.copy()
        ahead[i] += step
        back[i] -= step
        difference = (float(fit.misfit(ahead, 3.0)[0]) - float(fit.misfit(back, 3.0)[0])) / (2 * step)
        assert gradient[i] == pytest.approx(difference, rel=1e-4, abs=1e-8), name
        change = (np.asarray(fit.web.constraints(ahead)) - np.asarray(fit.web.constraints(back))) / (2 * step)
        assert slopes[:, i] == pytest.approx(change, rel=1e-4, abs=1e-6), name


@pytest.mark.slow
def test_known_web_is_recovered_from_cross_sections(mikron: Scene, body: Manifold) -> None:
    """Initial guesses are read from the body; lengths come back to 1 % or 0.06 mm on cells of 1.25 mm.

    Crowns and draft, which move the surface by hundredths of a millimetre, take the finer cells below.
    """
    limits = ManufacturingLimits()
    problem = fit_problem(body, mikron, limits, 1.25)
    guesses = (part.guess(problem.target, mikron, limits) for part in PARTS[:3])
    start = [outline_guess(problem, 7), *(guess for guess in guesses if guess is not None)]
    found, error = minimise_misfit(Fit(problem, MORE), np.concatenate(start), (2.5, 0.7))
    assert error < 2e-3
    for name, true, value in zip(MORE.names, values_of(MORE), found, strict=True):
        if not name.endswith(("crown", "draft", "bevel-pin.y")):
            assert value == pytest.approx(true, rel=1e-2, abs=0.06), name


def test_gradients_of_pockets_and_groove(mikron: Scene, body: Manifold) -> None:
    """The parts that the known web lacks, one on each face."""
    parts = (FittedBevel("pin"), FittedSlot(through=True), FittedBox("journal"), FittedCylinder("pin", True))
    layout = Layout(6, parts)
    values = [-25.0, 74.0, 21.0, 35.0, 36.0, 20.0, *(8.0, 12.0, 1.5), *(6.0, 30.0, 0.5, 11.0)]
    at = np.array([*values, *(23.0, 9.0, 7.0, 5.0), *(22.0, 25.0, 8.0, 4.0)])
    fit = Fit(fit_problem(body, mikron, COARSE, 2.0), layout)
    gradient = fit.misfit(at, 3.0)[1]()
    step = 1e-5
    for i, name in enumerate(layout.names):
        side = step * np.eye(len(at))[i]
        difference = (fit.misfit(at + side, 3.0)[0] - fit.misfit(at - side, 3.0)[0]) / (2 * step)
        assert gradient[i] == pytest.approx(difference, rel=1e-4, abs=1e-8), name


@pytest.mark.slow
def test_each_parameter_is_recovered_within_half_a_percent() -> None:
    """From a start scattered by 1 mm or degree, on cells of 0.5 mm."""
    for name, value, known in zip(WHOLE.names, recovered(0.5), values_of(WHOLE), strict=True):
        assert value == pytest.approx(known, rel=5e-3), name


@pytest.mark.parametrize(
    ("half_width", "stations"),
    [
        pytest.param(36.0, 8, marks=pytest.mark.slow),
        (44.0, 6),
        pytest.param(44.0, 8, marks=pytest.mark.slow),
    ],
)
def test_the_outline_of_a_square_body_does_not_fold_back(
    mikron: Scene, half_width: float, stations: int
) -> None:
    """Flat ends invite the first piece of the curve to dip below its own end; the scene refuses that."""
    start, end = mikron.web_z_mm
    square = Manifold.cube((2 * half_width, 106.0, end - start)).translate((-half_width, -29.0, start))
    problem = fit_problem(square, mikron, COARSE, 2.0)
    found = fit_from(problem, FitTask(Layout(stations), outline_guess(problem, stations), "outline"))
    assert found is not None
    assert found.overlap > 0.8
    web = scene_with_web(mikron, web_of(found.layout, found.values, mikron)).web
    assert web.outline == "profile"
    assert web.flank.derivatives(np.linspace(0, 1, 501))[0][..., 1].min() > -1e-9


@pytest.mark.slow
@pytest.mark.parametrize("fillet", [{}, {"fillet_mm": 8.0}], ids=["sharp", "rounded"])
def test_an_outline_is_found_beside_a_counterweight(fillet: dict[str, float]) -> None:
    """The rim of the sector cuts cells, which are not taken for the lower end of the outline."""
    data = load_scene("car-diesel").model_dump(mode="json", exclude_none=True)
    data["web"]["counterweight"] |= fillet
    scene = scene_from_dict(data)
    problem = fit_problem(solid_of(surface_of(scene, "half")), scene, ManufacturingLimits(), 2.0)
    guess = outline_guess(problem, 7)
    assert -40.0 < guess[0] < -28.0  # its own end, at -35, is inside the sector
    assert guess[1] == pytest.approx(79.0, abs=2.0)
    found = fit_from(problem, FitTask(Layout(7), guess, "outline"))
    assert found is not None
    assert found.overlap > 0.97


def test_pockets_keep_a_wall_between_each_other(mikron: Scene) -> None:
    """A slot over the middle of the thickness and a pocket from a face: apart in depth, or across, or not."""
    layout = Layout(7, (FittedSlot(), FittedBox("journal", True)))
    slot = [24.0, 24.0, 5.0, 31.0, 0.0, 3.0]

    def wall_mm(x: float, y: float, depth: float) -> float:
        values = np.array([*values_of(PLAIN), *slot, x, y, 6.0, 6.0, depth])
        points = _profile(mikron).flank.along(48)
        name, excess = part_rules(layout.parts, points, values[7:], mikron, ManufacturingLimits())[-1]
        assert name == "least wall between the side pocket and the box pocket of the journal face, 3 mm"
        return ManufacturingLimits().min_wall_mm - float(excess)

    opening = (_profile(mikron).flank.along(48)[:, 0].max() - 31.0) * np.tan(np.deg2rad(3.0))
    assert wall_mm(24.0, 24.0, 12.0) == pytest.approx(31.0 - 27.0, abs=0.03)  # further in
    assert wall_mm(32.0, 24.0, 3.0) == pytest.approx(9.5 - 2.5 - opening - 3.0, abs=0.03)  # above
    assert wall_mm(32.0, 45.0, 12.0) == pytest.approx(21.0 - 3.0 - 12.0 - opening, abs=0.03)  # beyond its end
    assert wall_mm(32.0, 24.0, 12.0) < 0  # into it


@pytest.mark.parametrize(
    ("parameter", "value", "broken"),
    [
        ("cylinder-through-pair.x", 4.0, "least wall between the cylinder pocket through the web"),
        ("bevel-journal.crown", 9.0, "the arc of the journal bevel does not turn back"),
        ("bevel-journal.depth", 26.0, "least wall under the edge of the crankpin, 3 mm"),
        ("bevel-pin.y", 32.0, "shoulder beside the fillet of the crankpin"),
        ("half_width_3", 22.0, "least wall between the cylinder pocket through the web and the outline"),
        ("half_width_5", 11.0, "least radius of the outline, 6 mm"),
        ("side.height", 14.0, "least wall beside the side pocket, 3 mm"),
        ("y_high", 65.0, "shoulder beside the fillet of the crankpin"),
    ],
)
def test_a_broken_rule_has_a_name(mikron: Scene, parameter: str, value: float, broken: str) -> None:
    web = ParametricWeb(WHOLE, mikron, ManufacturingLimits(), (np.zeros(0),) * 3)
    values = values_of(WHOLE)
    values[WHOLE.names.index(parameter)] = value
    names, excess = web.rule_names(values), web.constraints(values)
    assert len(names) == len(excess)
    assert any(name.startswith(broken) for name, over in zip(names, excess, strict=True) if over > 0)


def test_constraints_refuse_a_groove_whose_floor_a_bevel_takes_off(mikron: Scene) -> None:
    """What the fit may choose the scene accepts; without the last two terms, one per bevel, it would not."""
    layout, limits = Layout(7, (*PARTS[:2], FittedSlot(through=True))), ManufacturingLimits(0.5)
    points = _profile(mikron).flank.along(48)
    sound = []
    for floor, offset, height in product((15.0, 20.0, 24.0, 27.0, 31.0), np.linspace(-7, 7, 8), (3.0, 4.0)):
        values = np.array([*values_of(MORE)[:13], height, floor, offset, 3.0])
        rules = part_rules(layout.parts, points, values[7:], mikron, limits)
        terms = np.hstack([excess for _, excess in rules])
        web = web_of(layout, values, mikron)
        sound.append((terms[:-2].max() <= 0, terms[-2:].max() <= 0, _accepted(mikron, web)))
    assert (True, True, True) in sound
    assert (True, False, False) in sound
    assert (True, True, False) not in sound


def _accepted(scene: Scene, web: dict[str, Any]) -> bool:
    try:
        scene_with_web(scene, web)
    except CranktopoError:
        return False
    return True


def _profile(mikron: Scene) -> ProfileWeb:
    web = known_scene(mikron, PLAIN).web
    assert isinstance(web, ProfileWeb)
    return web


@pytest.mark.slow
def test_limits_are_kept_after_rounding(mikron: Scene, body: Manifold) -> None:
    """A wall, a radius and a draft that the body itself does not keep."""
    limits = ManufacturingLimits(cell_mm=2.0, min_wall_mm=5.0, min_radius_mm=22.0, min_draft_deg=20.0)
    true = values_of(MORE)
    problem = fit_problem(body, mikron, limits, 2.0)
    fit = Fit(problem, MORE)
    assert fit.web.constraints(true).max() > 0.1
    values, error = minimise_misfit(fit, true, (4.0, 2.0))
    assert np.isfinite(error)
    web = scene_with_web(mikron, web_of(MORE, values, mikron)).web
    assert web.outline == "profile"
    flank = web.flank
    assert np.abs(flank.curvature_per_mm(np.linspace(0, 1, 200))).max() <= 1 / 22.0
    points = flank.at(np.linspace(0, 1, 200)).reshape(-1, 2)
    for y in (0.0, 48.0):
        assert np.hypot(points[:, 0], points[:, 1] - y).min() >= 21 + 2.5 + 0.1
    (side,) = web.pocket
    assert side.shape == "side"
    assert side.draft_deg >= 20.0
    assert side.height_mm + 2 * side.depth_mm * side.slope + 2 * abs(side.offset_mm) <= 19 - 2 * 5.0
    assert all(bevel.depth_mm <= 19 - 5.0 for bevel in web.bevel)


def test_a_window_and_a_hollow_are_named_with_place_and_volume(mikron: Scene) -> None:
    """A rectangular window at |x| = 24 and a closed hollow at x = 0: neither is in the family."""
    start, _ = mikron.web_z_mm
    solid = body_of(known_scene(mikron, PLAIN))
    window = Manifold.cube((8.0, 14.0, 40.0)).translate((20.0, 17.0, 15.0))
    hollow = Manifold.cube((14.0, 10.0, 9.0)).translate((-7.0, 19.0, start + 6.0))
    holed = solid - window - window.mirror((1.0, 0.0, 0.0)) - hollow
    problem = fit_problem(holed, mikron, ManufacturingLimits(), 1.0)
    rest = residual_regions(problem, model_fill(problem, Candidate(PLAIN, values_of(PLAIN), 0.0, "known")))
    kinds = {item.kind: item for item in rest}
    assert sorted(kinds) == ["hollow", "window"]
    assert kinds["window"].volume_mm3 == pytest.approx(2 * 8 * 14 * 19, rel=0.05)
    assert kinds["window"].centre_mm == pytest.approx((24.0, 24.0, start + 9.5), abs=0.5)
    assert kinds["window"].pair
    assert kinds["hollow"].volume_mm3 == pytest.approx(14 * 10 * 9, rel=0.05)
    assert kinds["hollow"].centre_mm[1:] == pytest.approx((24.0, start + 10.5), abs=0.5)
    assert not kinds["hollow"].pair


DRILLING = {
    "diameter_mm": 8.0,
    "from": {"on": "main_journal", "angle_deg": 175.0, "place_mm": 3.0},
    "to": {"on": "crankpin", "angle_deg": 0.0, "place_mm": 3.0},
}


@pytest.mark.slow
def test_a_drilling_of_the_design_is_no_window_of_the_body(mikron: Scene) -> None:
    """The known web with a drilling lacks nothing of its own body; a window beside it is still told."""
    data = known_scene(mikron, PLAIN).model_dump(mode="json", exclude_none=True)
    data["throw"]["drilling"] = [DRILLING]
    data["throw"]["main_journal"]["bore_diameter_mm"] = data["throw"]["crankpin"]["bore_diameter_mm"] = 0.0
    scene = scene_from_dict(data, "drilled")
    body, known = body_of(scene), Candidate(PLAIN, values_of(PLAIN), 0.0, "known")
    problem = fit_problem(body, scene, COARSE, 2.0)
    assert residual_regions(problem, model_fill(problem, known)) == []
    window = Manifold.cube((8.0, 14.0, 40.0)).translate((20.0, 17.0, 15.0))
    holed = fit_problem(body - window - window.mirror((1.0, 0.0, 0.0)), scene, COARSE, 2.0)
    (found,) = residual_regions(holed, model_fill(holed, known))
    assert (found.kind, found.pair) == ("window", True)


def test_distance_of_a_ball_from_itself_shifted() -> None:
    """Moved by 1 mm: distances up to 1 mm, mean of |cos| = 1/2."""
    ball = Manifold.sphere(10.0, 160)
    mean, largest, _ = surface_distance_mm(mesh_of(ball), mesh_of(ball.translate((1.0, 0.0, 0.0))))
    assert mean == pytest.approx(0.5, rel=0.02)
    assert largest == pytest.approx(1.0, rel=0.01)


@pytest.mark.slow
def test_shape_error_of_a_web_against_itself_is_its_facets(mikron: Scene, body: Manifold) -> None:
    same = shape_error(known_scene(mikron, MORE), mesh_of(body))
    assert web_overlap(known_scene(mikron, MORE), mesh_of(body)) == same.web_iou
    assert same.web_iou == pytest.approx(1.0, abs=5e-4)
    assert same.max_distance_mm < 0.05


@pytest.mark.slow
def test_fit_chooses_features_and_stations_by_their_gain(mikron: Scene) -> None:
    """The whole selection on a known body: its features are found, no other is kept, overlap above 98 %."""
    scene = known_scene(mikron, MORE)
    fitted = fit_web(mesh_of(body_of(scene)), mikron, replace(ManufacturingLimits(), starts=2))
    kept = {trial.step for trial in fitted.trials if trial.kept}
    assert {"outline", "bevel-journal", "bevel-pin", "side"} <= kept
    assert len(kept) == 5  # and one number of stations
    assert not [item for item in fitted.residual_regions if item.kind != "material"]
    assert shape_error(fitted.scene, mesh_of(body_of(scene))).web_iou > 0.98
    assert fitted.scene.name == f"{mikron.name}-remodel"
