"""The table of hardened fillets: what it takes, what it refuses in a line."""

from __future__ import annotations

from typing import Any

import pytest

from cranktopo import load_scene
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene

FATIGUE = ("fatigue_tension_MPa", "fatigue_bending_MPa")
GIVEN = {"process": "nitrided", "case_depth_mm": 0.4, "surface_hardness_HV": 700.0}


def scene(
    hardening: dict[str, Any] | None = None, material: dict[str, Any] | None = None, **fatigue: Any
) -> Scene:
    data = load_scene("mikron-iiic").model_dump(mode="json", exclude_none=True)
    table = {} if hardening is None else {"hardening": {**GIVEN, **hardening}}
    return scene_from_dict(
        {**data, "material": data["material"] | (material or {}), "fatigue": table | fatigue}
    )


def test_the_core_has_the_hardness_of_its_tensile_strength() -> None:
    settings = scene({}).fatigue
    pin, journal = settings.hardening_at("pin"), settings.hardening_at("journal")
    assert pin is journal
    assert pin is not None
    assert pin.core_HV(1100.0) == pytest.approx(342.2, abs=0.1)
    assert scene({"core_hardness_HV": 300.0}).fatigue.hardened["pin"].core_HV(1100.0) == 300.0


def test_pin_and_journal_may_differ() -> None:
    settings = scene({"fillets": "pin"}).fatigue
    assert set(settings.hardened) == {"pin"}
    other = {"process": "induction", "case_depth_mm": 2.0, "surface_hardness_HV": 600.0}
    both = scene({}, journal_hardening=other).fatigue
    assert {fillet: one.process for fillet, one in both.hardened.items()} == {
        "pin": "nitrided",
        "journal": "induction",
    }
    assert "pin fillets nitrided" in both.treatment
    assert "journal fillets induction" in both.treatment


def test_a_scene_without_the_table_is_stored_as_before() -> None:
    stored = load_scene("mikron-iiic").fatigue.model_dump()
    assert not any("hardening" in key for key in stored)
    settings = scene({"residual_stress_MPa": [[0.0, -400.0], [0.4, 0.0]]})
    again = scene_from_dict(settings.model_dump(mode="json", exclude_none=True))
    assert again.fatigue == settings.fatigue


@pytest.mark.parametrize(
    ("hardening", "others", "message"),
    [
        (
            {},
            {"surface_treatment_factor": 1.3},
            r"surface_treatment_factor and \[fatigue.hardening\] each give",
        ),
        (
            {"case_depth_mm": 4.6},
            {},
            r"case_depth_mm = 4.6: must be at most 4.5 mm, half of the wall of the pin",
        ),
        ({"surface_hardness_HV": 300.0}, {}, r"surface_hardness_HV = 300.0: must be more than 392.2 HV"),
        ({"surface_hardness_HV": 390.0}, {}, r"the nitriding depth is where 50 HV above it are left"),
        (
            {"process": "rolled", "surface_hardness_HV": 330.0},
            {},
            r"surface_hardness_HV = 330.0: must be at least 342.2 HV",
        ),
        ({"residual_stress_MPa": [[0.0, -400.0], [0.4, 0.0], [0.2, 0.0]]}, {}, "depths must increase"),
        ({"residual_stress_MPa": [[0.0, -400.0], [0.0, 0.0]]}, {}, "depths must increase"),
        ({"residual_stress_MPa": [[0.1, -400.0]]}, {}, "first point must lie at the surface"),
        ({"residual_stress_MPa": [[0.0, float("nan")]]}, {}, "finite"),
        ({"transition_hardness_HV": 340.0}, {}, "below an induction-hardened layer"),
        ({"process": "carburised"}, {}, "nitrided"),
        ({"depth_mm": 0.4}, {}, "depth_mm"),
    ],
)
def test_what_cannot_be_is_refused(hardening: dict[str, Any], others: dict[str, Any], message: str) -> None:
    with pytest.raises(CranktopoError, match=message) as caught:
        scene(hardening, **others)
    assert "\n" not in str(caught.value)


def test_hardness_needs_steel_and_a_core() -> None:
    with pytest.raises(
        CranktopoError, match=r"material.fkm_group = .GJS.: hardness stands for strength in steel"
    ):
        scene({}, {"fkm_group": "GJS"})
    with pytest.raises(CranktopoError, match="core_hardness_HV: is missing"):
        scene({}, dict.fromkeys(("ultimate_MPa", "yield_MPa", *FATIGUE), 200.0))
