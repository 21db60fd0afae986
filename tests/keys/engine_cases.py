"""Cases of the keys of supports, engine and what turns with it."""

from __future__ import annotations

from tests.keys.bases import (
    BOXER,
    BROAD,
    DISK,
    DISPLACEMENTS,
    EVEN,
    MAPPED,
    REACTIONS,
    RUBBER,
    SUPPORTS,
    TRACE,
    WHOLE_ROD,
    roller,
    vee,
)
from tests.keys.kinds import Other, Refused, Shown, Table
from tests.keys.scenes import builtin, changed, twin

ENGINE_CASES: dict[tuple[str, str], Table] = {
    ("supports", ""): Table(
        lambda: builtin("mikron-iiic-plain"),
        "supports",
        "effects tilt",
        {
            "torsion": SUPPORTS,
            "bending": SUPPORTS,
        },
    ),
    ("supports.roller_bearing", ""): Table(
        roller,
        "supports.roller_bearing",
        "effects balance origins",
        {
            "name": "HK6020",
            "kind": Refused("thrust", "a thrust bearing has no radial stiffness"),
            "displacement_mm": DISPLACEMENTS,
            "reaction_N": REACTIONS,
            **dict.fromkeys(
                ("roller_diameter_mm", "pitch_diameter_mm"),
                Shown(
                    "physics/shaft/test_continuous_shaft.py::"
                    "test_rollers_live_under_the_forces_of_the_whole_shaft"
                ),
            ),
            "clearance_mm": Shown("physics/engine/test_roller_laminae.py::test_damage_of_a_cycle_adds_up"),
        },
        dear=True,
    ),
    ("engine", ""): Table(
        lambda: builtin("mikron-iiic-plain"),
        "engine",
        "loads balance",
        {
            "cylinders": Other(2, also={"engine.firing_order": [1, 2]}),
            "firing_order": [1, 2, 4, 3],
            "strokes": 2,
            "rotation": Shown(
                "cli/test_dossier_contents.py::"
                "test_every_value_of_the_gas_is_told_with_its_source_and_the_rated_power"
            ),
        },
    ),
    ("engine.gas", ""): Table(
        lambda: builtin("mikron-iiic-plain"),
        "engine.gas",
        "loads",
        {
            "indicator_csv": Other("b.csv", TRACE),
            "firing_deg": Other(10.0, TRACE),
        },
    ),
    ("engine.gas.map", ""): Table(
        lambda: changed(
            builtin("mikron-iiic-plain"),
            {
                "engine.gas.peak_pressure_MPa": None,
                "engine.gas.peak_angle_deg": None,
                "engine.gas.map": [
                    {"rpm": 1800.0, "peak_pressure_MPa": 5.0, "peak_angle_deg": 11.0},
                    {"rpm": 2500.0, "peak_pressure_MPa": 5.5, "peak_angle_deg": 11.0},
                ],
            },
        ),
        "engine.gas.map[0]",
        "loads",
        {"file": Other("b.csv", MAPPED)},
    ),
    ("engine.masses", ""): Table(
        lambda: builtin("mikron-iiic-plain"),
        "engine.masses",
        "loads",
        {
            "rod_kg": Other(0.5, WHOLE_ROD),
            "rod_centre_from_big_end_mm": Other(55.0, WHOLE_ROD),
        },
    ),
    ("engine.opposed", ""): Table(
        lambda: changed(builtin("mikron-iiic-plain"), {"engine.opposed": {"lead_deg": -15.0}}),
        "engine.opposed",
        "loads",
    ),
    ("engine.arrangement", ""): Table(
        vee,
        "engine.arrangement",
        "balance",
        {
            "layout": Other("boxer", also=BOXER),
            "bank_angles_deg": Other([0.0, 50.0, 110.0], BROAD),
            "throw_angles_deg": Other([0.0, 170.0, 170.0, 0.0], EVEN),
        },
    ),
    ("engine.arrangement.balancer_shaft", ""): Table(
        lambda: changed(
            builtin("mikron-iiic-plain"),
            {"engine.arrangement": {"balancer_shaft": [{"order": 2, "turns": "with"}]}},
        ),
        "engine.arrangement.balancer_shaft[0]",
        "balance",
        {
            "balances": Other("moment", also={"engine.arrangement.balancer_shaft[0].distance_mm": 200.0}),
            "distance_mm": Other(
                220.0,
                {
                    "engine.arrangement.balancer_shaft[0].balances": "moment",
                    "engine.arrangement.balancer_shaft[0].distance_mm": 200.0,
                },
            ),
            "z_mm": 30.0,
            "phase_deg": 90.0,
        },
    ),
    ("engine.arrangement.balancer_shaft.gear", ""): Table(
        lambda: changed(
            builtin("mikron-iiic-plain"),
            {
                "engine.arrangement": {
                    "balancer_shaft": [
                        {"order": 2, "turns": "with", "gear": {"power_kW": 1.0, "pitch_radius_mm": 34.6}}
                    ]
                }
            },
        ),
        "engine.arrangement.balancer_shaft[0].gear",
        "balance",
    ),
    ("shaft", ""): Table(
        twin,
        "shaft",
        "vibration",
        {
            "speed_min_rpm": 3900.0,
            "throw_stiffnesses_Nm_per_rad": Other(
                [300e3],
                {"shaft.throw_stiffness_Nm_per_rad": None, "shaft.throw_stiffnesses_Nm_per_rad": [297e3]},
            ),
        },
        dear=True,
    ),
    **{
        (f"shaft.{one}", ""): Table(
            lambda one=one: twin(
                **{one: {"inertia_kg_m2": 0.002, "stiffness_Nm_per_rad": 2e5, "mass_kg": 2.0}}
            ),
            f"shaft.{one}",
            "carried vibration",
            dict(DISK),
            dear=one != "flywheel",
        )
        for one in ("pulley", "flywheel", "driven", "propeller")
    },
    ("shaft.coupling", ""): Table(
        lambda: twin(coupling={"inertia_kg_m2": 0.05, "stiffness_Nm_per_rad": 2e4}),
        "shaft.coupling",
        "carried vibration",
    ),
    ("shaft.damper", ""): Table(
        lambda: twin(
            damper={
                "kind": "viscous",
                "ring_inertia_kg_m2": 0.003,
                "hub_inertia_kg_m2": 0.001,
                "damping_Nms_per_rad": 6.0,
                "mass_kg": 2.0,
            }
        ),
        "shaft.damper",
        "carried vibration",
        DISK | {"kind": Other("rubber", also=RUBBER), "loss_factor": Other(0.2, RUBBER)},
        dear=True,
    ),
}
