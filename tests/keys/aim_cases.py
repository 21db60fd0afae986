"""Cases of the keys of design space, goal, optimisers, fatigue, drawing, published values."""

from __future__ import annotations

from tests.keys.bases import LIFE, PRINTED, PRINTED_BOTH, SCATTER, STEPS, layered, material, zones
from tests.keys.kinds import Other, Shown, Table, Told
from tests.keys.scenes import builtin, changed

AIM_CASES: dict[tuple[str, str], Table] = {
    ("envelope", ""): Table(lambda: builtin("mikron-iiic-plain"), "envelope", "cells"),
    ("envelope", "box"): Table(lambda: builtin("mikron-iiic-plain"), "envelope", "cells"),
    ("envelope", "cylinder"): Table(
        lambda: builtin("mikron-iiic-plain", envelope={"shape": "cylinder", "radius_mm": 82.0}),
        "envelope",
        "cells",
    ),
    ("envelope", "outline"): Table(
        lambda: builtin(
            "mikron-iiic-plain",
            envelope={
                "shape": "outline",
                "points_mm": [[-48.0, -34.0], [48.0, -34.0], [48.0, 82.0], [-48.0, 82.0]],
            },
        ),
        "envelope",
        "cells",
    ),
    ("envelope", "stl"): Table(
        lambda: builtin("mikron-iiic-plain", envelope={"shape": "stl", "file": "small.stl"}),
        "envelope",
        "cells",
        {"file": "large.stl"},
        dear=True,
    ),
    ("envelope.clearance", ""): Table(
        lambda: builtin("car-diesel"), "envelope.clearance", "cells loads", {"piston_skirt_mm": 27.0}
    ),
    **{
        (f"envelope.{kind}", shape): Table(
            lambda kind=kind, zone=zone: zones(kind, **zone),
            f"envelope.{kind}[0]",
            "cells",
            {"file": "zone-large.stl"},
            dear=shape == "body",
        )
        for kind in ("frozen", "removable")
        for shape, zone in {
            "": {"shape": "cylinder", "y_mm": 24.0, "x_mm": 30.0, "diameter_mm": 20.0},
            "box": {"shape": "box", "x_min_mm": -20.0, "x_max_mm": 20.0, "y_min_mm": 20.0, "y_max_mm": 30.0},
            "cylinder": {"shape": "cylinder", "y_mm": 24.0, "x_mm": 30.0, "diameter_mm": 20.0},
            "body": {"shape": "body", "file": "zone-small.stl"},
        }.items()
    },
    ("original", ""): Table(
        lambda: builtin("mikron-iiic-plain", original={"file": "original-small.stl"}),
        "original",
        "cells",
        {"file": "original-large.stl", "second_file": Told("original-large.stl")},
    ),
    ("goal", ""): Table(
        lambda: builtin("mikron-iiic-plain", goal={"minimise": "mass"}, optimise={}),
        "goal",
        "effects",
        {"maximise": Other("torsion", also={"goal.minimise": None})},
    ),
    ("goal.limits", ""): Table(
        lambda: builtin(
            "mikron-iiic-plain",
            goal={"minimise": "inertia", "limits": {}},
            bearings={"clearance_mm": 0.05},
            shaft={"flywheel": {"inertia_kg_m2": 0.1}},
        ),
        "goal.limits",
        "goal",
        {
            "inertia": Other("<= 90 %", {"goal.minimise": "mass"}),
            "mass": "<= 95 %",
            **dict.fromkeys(("torsion", "bending", "fatigue_safety"), ">= 95 %"),
        },
    ),
    ("effects", ""): Table(
        lambda: builtin("mikron-iiic-plain", effects={}),
        "effects",
        "effects",
        {
            "torsional_vibration": Other("off", {"shaft": {"flywheel": {"inertia_kg_m2": 0.1}}}),
            "bearing_compliance": Other("off", {"supports": {"bearing_spring_N_per_mm": 1e6}}),
        },
        dear=True,
    ),
    ("optimise", ""): Table(
        lambda: builtin("mikron-iiic-plain"),
        "optimise",
        "effects problem",
        {
            "combine": "worst",
            "method": "moving_asymptotes",
            "limits_by_evaluation": Other(False, {"optimise": {}, "goal": {"minimise": "mass"}}),
            "tool_radius_mm": Other(6.0, {"optimise": {"process": "milled"}}),
        },
        dear=True,
    ),
    ("optimise.weights", ""): Table(
        lambda: builtin("mikron-iiic-plain", effects={}), "optimise.weights", "effects problem", dear=True
    ),
    ("shape", ""): Table(
        lambda: builtin("mikron-iiic-plain"),
        "shape",
        "",
        {
            "tolerance_mm": Shown("cli/test_sensitivities.py::test_the_table_and_its_json"),
            "same_webs": Shown(
                "unit/shape/test_each_web_groups.py::test_webs_of_one_die_stay_together_and_take_no_others"
            ),
        },
    ),
    ("shape.free", ""): Table(
        lambda: builtin("car-diesel"),
        "shape.free",
        "shape",
        {
            "pin_fillet_mm": [1.6, 2.6],
            "journal_fillet_mm": [1.6, 2.6],
            "pin_bore_mm": [0.0, 12.0],
            "journal_bore_mm": [0.0, 12.0],
            "pin_fillet_axial_mm": Other([1.6, 2.6], also={"shape.free.pin_fillet_mm": [1.6, 2.6]}),
            "journal_fillet_axial_mm": Other([1.6, 2.6], also={"shape.free.journal_fillet_mm": [1.6, 2.6]}),
            "web_thickness_mm": [17.0, 19.0],
            "counterweight_radius_mm": [50.0, 67.0],
            "counterweight_angle_deg": [40.0, 75.0],
        },
    ),
    ("fatigue", ""): Table(
        material,
        "fatigue",
        "strength",
        {
            "surface_treatment_source": Other("rolled", {"fatigue.surface_treatment_factor": 1.2}),
            "m53_factors": Shown("unit/fatigue/test_governing_factors.py::test_the_scene_chooses"),
        },
    ),
    ("fatigue.hardening", ""): Table(
        layered, "fatigue.hardening", "strength", {"transition_hardness_HV": 300.0}
    ),
    ("fatigue.journal_hardening", ""): Table(
        lambda: changed(
            layered(),
            {
                "fatigue.journal_hardening": {
                    "process": "induction",
                    "case_depth_mm": 1.5,
                    "surface_hardness_HV": 650.0,
                    "core_hardness_HV": 320.0,
                },
                "fatigue.hardening.fillets": "pin",
            },
        ),
        "fatigue.journal_hardening",
        "strength",
        {"transition_hardness_HV": 300.0},
    ),
    ("fatigue.spectrum", ""): Table(
        lambda: builtin("mikron-iiic-plain", fatigue={"spectrum": {"step": [{"rpm": 2000.0, "share": 1.0}]}}),
        "fatigue.spectrum",
        "strength",
        dict.fromkeys(("slope", "knee_cycles", "permitted_damage"), LIFE),
    ),
    ("fatigue.spectrum.step", ""): Table(
        lambda: builtin("mikron-iiic-plain", fatigue={"spectrum": {"step": [{"rpm": 2000.0, "share": 1.0}]}}),
        "fatigue.spectrum.step[0]",
        "strength",
        dict.fromkeys(("rpm", "share"), STEPS),
    ),
    ("fatigue.scatter", ""): Table(
        lambda: builtin("mikron-iiic-plain", fatigue={"scatter": {}}),
        "fatigue.scatter",
        "strength",
        dict.fromkeys(("strength_percent", "load_percent", "fillet_radius_mm"), SCATTER),
    ),
    ("drawing", ""): Table(
        lambda: builtin("mikron-iiic-rod-i"),
        "drawing",
        "rod_sheet crank_sheet",
        {
            "main_journal_fit": "k6",
            "crankpin_fit": "k6",
            "rod_bore_fit": "H7",
            "hardening_depth_mm": Other(2.5, {"drawing.hardness_HRC": 54.0}),
        },
        dear=True,
    ),
    **{
        (table, ""): Table(
            lambda: builtin("opposed-piston"),
            path,
            "",
            dict.fromkeys(
                ("mass_kg", "torsional_stiffness_kNm_per_rad", "bending_stiffness_kN_per_mm", named), PRINTED
            ),
        )
        for table, path, named in (
            ("published", "published", "source"),
            ("published.variant", "published.variant[0]", "name"),
        )
    },
    **{
        (table, ""): Table(
            lambda: builtin("opposed-piston"),
            path,
            "",
            dict.fromkeys(("method", "printed_method", "safety"), PRINTED_BOTH),
        )
        for table, path in (
            ("published.fatigue", "published.fatigue[0]"),
            ("published.variant.fatigue", "published.variant[0].fatigue[0]"),
        )
    },
}
