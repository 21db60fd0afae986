"""Elliptical fillets: refused where they cannot be, gone with the fillets, named in drawing and messages."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.tasks.throw_fatigue.fillets import place
from cranktopo.tasks.throw_fatigue.needs import check_inputs
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.web_shape.start import scene_start
from cranktopo.throw.journal import FilletSection
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

MIKRON = load_scene("mikron-iiic-plain")


def mikron(free: dict[str, Any] | None = None, **journals: dict[str, Any]) -> Scene:
    data = MIKRON.model_dump(mode="json", exclude_none=True)
    for key, values in journals.items():
        data["throw"][key] |= values
    return scene_from_dict({**data, "shape": {"free": free or {}}})


@pytest.mark.parametrize("journal", ["main_journal", "crankpin"])
@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"fillet_axial_mm": 1.2}, r"must be >= 1.25 and <= 6.25 mm, 0.5 to 2.5 times fillet_mm = 2.5 mm"),
        ({"fillet_axial_mm": 6.3}, r"must be >= 1.25 and <= 6.25 mm"),
        ({"fillet_axial_mm": 3.0, "fillet_mm": 0.0}, "needs both semi-axes, and fillet_mm = 0"),
        ({"fillet_axial_mm": 5.0, "length_mm": 10.0}, r"smaller than half the journal's length \(5 mm\)"),
        ({"fillet_axial_mm": -1.0}, "must be >= 0.05"),
        ({"fillet_axial_mm": "wide"}, "must be a finite number"),
    ],
)
def test_an_ellipse_that_cannot_be_is_refused(journal: str, values: dict[str, Any], message: str) -> None:
    with pytest.raises(CranktopoError, match=rf"throw.{journal}.fillet_axial_mm = .*{message}"):
        mikron(**{journal: values})


def test_the_least_radius_is_at_the_end_of_the_longer_semi_axis() -> None:
    """Curvature of the parametrised ellipse, by hand: (b2 sin2 + a2 cos2)^1.5 / (a b)."""
    for radial, axial in ((2.5, 4.0), (4.0, 2.5), (3.7, 3.7)):
        t = np.linspace(0, np.pi / 2, 10001)
        radii = ((radial * np.sin(t)) ** 2 + (axial * np.cos(t)) ** 2) ** 1.5 / (radial * axial)
        section = FilletSection(radial, axial)
        assert section.least_radius_mm == pytest.approx(radii.min(), rel=1e-12)
        length = np.hypot(radial * np.sin(t), axial * np.cos(t)).mean() * np.pi / 2
        assert np.pi / 2 * section.mean_mm == pytest.approx(length, rel=0.02)
        assert np.abs(section.off_mm(-radial * np.cos(t), axial * np.sin(t))).max() < 1e-12
    assert FilletSection(3.7, 3.7).least_radius_mm == 3.7
    assert FilletSection(0.0, 0.0).least_radius_mm == 0.0


def test_a_drawing_names_both_semi_axes() -> None:
    assert str(FilletSection(2.5, 2.5)) == "R2.5"
    assert str(FilletSection(2.5, 4.0)) == "ellipse 2.5 radial x 4 axial"


def test_a_throw_without_fillets_has_no_ellipse_either() -> None:
    sharp = strip_features(mikron(crankpin={"fillet_axial_mm": 4.0}), "fillets")
    assert all(journal.fillet == FilletSection(0.0, 0.0) for journal, _ in sharp.throw.journals)
    assert "fillet_axial_mm" not in toml_text(sharp, "sharp")
    assert strip_features(sharp, "fillets") is sharp


def test_the_place_along_an_ellipse_is_that_of_the_stretched_circle() -> None:
    scene = mikron(main_journal={"fillet_axial_mm": 4.0})
    angle = np.radians(30.0)
    far = 21.0 + 2.5 * (1 - np.cos(angle))
    point = np.array([far, 0.0, scene.web_z_mm[0] - 4.0 + 4.0 * np.sin(angle)])
    found = place(scene, point)
    assert (found.fillet, found.around_deg) == ("journal", 90.0)
    assert found.along_deg == pytest.approx(30.0)
    assert place(scene, point - [0.0, 0.0, 0.1]).fillet == ""


def test_the_rule_refuses_an_ellipse_before_anything_is_solved() -> None:
    scene = mikron(crankpin={"fillet_axial_mm": 4.0})
    with pytest.raises(
        CranktopoError, match=r"throw.crankpin.fillet_axial_mm = 4.0: method 'm53'.*another --method"
    ):
        check_inputs(Target("flat", scene), "m53", "extremes")
    check_inputs(Target("flat", scene), "lsa", "extremes")
    check_inputs(Target("round", mikron(crankpin={"fillet_axial_mm": 2.5})), "m53", "extremes")


def test_a_search_begins_with_the_ellipse_of_its_start() -> None:
    """It is taken over where it is free and named where it is not; that of a round fillet follows it."""
    limits = ManufacturingLimits()
    flat, larger = mikron(crankpin={"fillet_axial_mm": 4.0}), mikron(crankpin={"fillet_mm": 3.0})
    both = {"pin_fillet_mm": [2.0, 5.0], "pin_fillet_axial_mm": [2.0, 5.0]}
    assert scene_start(mikron(both), limits, flat).sizes == {"pin_fillet_axial": 4.0}
    assert scene_start(mikron(both), limits, larger).sizes == {"pin_fillet": 3.0, "pin_fillet_axial": 3.0}
    radius_only = scene_start(mikron({"pin_fillet_mm": [2.0, 5.0]}), limits, larger)
    assert radius_only.sizes == {"pin_fillet": 3.0}
    assert not any("axial" in text for text in radius_only.left_out)
    lost = scene_start(MIKRON, limits, flat).left_out
    assert "pin_fillet_axial = 4 mm, 2.5 mm in the design" in lost
