"""Cases of the keys of crank, bearings, forging, rod, balancer shaft and bolts."""

from __future__ import annotations

from tests.keys.bases import (
    ADDED_ROLLERS,
    BODY_STEP,
    BOLT,
    FILM,
    HELD,
    IDLE,
    MATERIAL,
    ONE_BOLT,
    OWN_ROLLERS,
    balancer_bolt,
    balancer_material,
    crank_base,
    joint,
    redesign_bearing,
    rod_base,
    rod_material,
    round_step,
)
from tests.keys.kinds import Other, Table, Told
from tests.keys.scenes import builtin, changed, throw

SIZES_OF_ROLLERS = {
    "roller_diameter_mm": Told(2.0),
    "pitch_diameter_mm": Told(55.0),
    "clearance_mm": Told(0.01),
}
"""Of a life that only main bearings have."""

PART_CASES: dict[tuple[str, str], Table] = {
    ("crank", ""): Table(
        lambda: builtin("mikron-iiic-crank"),
        "crank",
        "crank balance",
        {
            "throws": ["throw", "thick.toml", "throw", "throw"],
        },
    ),
    ("crank.main_journal", ""): Table(
        lambda: crank_base(round_step("cylinder"), main_journal=[{"number": 1, "length_mm": 44.0}]),
        "crank.main_journal[0]",
        "crank crank_sheet",
        {
            "outer_diameter_mm": 40.0,
            "bore_diameter_mm": 20.0,
            "fillet_mm": 2.0,
        },
    ),
    ("crank.end", ""): Table(lambda: crank_base(round_step("cylinder")), "crank.end[0]", "crank"),
    ("crank.end.step", ""): Table(
        lambda: crank_base(round_step("cylinder")), "crank.end[0].step[0]", "crank"
    ),
    **{
        ("crank.end.step", kind): Table(
            lambda kind=kind, more=more: crank_base(round_step(kind, **more)),
            "crank.end[0].step[0]",
            "crank crank_sheet",
            {
                "first_bolt_deg": 20.0,
                "thread": "M36x2",
                "fit": "m6",
                "roughness_um": 0.6,
                "run_out_mm": 0.01,
            },
            dear=kind != "cone",
        )
        for kind, more in {
            "cylinder": {},
            "cone": {"outer_end_diameter_mm": 30.0},
            "flange": {"bolts": 6, "bolt_circle_mm": 22.0, "bolt_diameter_mm": 4.0},
            "keyway": {"width_mm": 8.0, "depth_mm": 4.0},
            "gear_seat": {},
            "thread": {"thread": "M36x1.5"},
        }.items()
    },
    ("crank.end.step", "body"): Table(
        lambda: crank_base(round_step("cylinder")),
        "crank.end[0].step[0]",
        "crank",
        {
            "length_mm": BODY_STEP,
            "file": BODY_STEP,
        },
    ),
    ("bearings", ""): Table(
        lambda: builtin("mikron-iiic-plain", bearings={"clearance_mm": 0.05}),
        "bearings",
        "film",
        FILM,
        dear=True,
    ),
    ("forging", ""): Table(lambda: throw(forging={"allowance_mm": 2.0}), "forging", "raw_sheet", dear=True),
    ("rod", ""): Table(
        rod_base,
        "rod",
        "rod",
        {
            "big_end_bore_mm": 45.0,
            "bolt_distance_mm": 58.5,
            "split_friction": Other(0.2, {"rod.split_angle_deg": 20.0}),
        },
        dear=True,
    ),
    ("rod.material", ""): Table(
        rod_material,
        "rod.material",
        "rod rod_sheet origins",
        MATERIAL | {"fatigue_torsion_MPa": IDLE},
        dear=True,
    ),
    ("rod.bolt", ""): Table(
        rod_base,
        "rod.bolt",
        "bolts rod",
        BOLT
        | {
            "thread": "M8",
            "held_in": Other("nut", also={"rod.bolt.grip_mm": 47.2}),
            "shank_diameter_mm": Other(7.0, {"rod.bolt.shank_mm": 8.0}),
        },
    ),
    ("rod.pin", ""): Table(rod_base, "rod.pin", "rod"),
    ("balancer", ""): Table(lambda: builtin("balancer-shaft"), "balancer", "balancer"),
    ("balancer.material", ""): Table(
        balancer_material,
        "balancer.material",
        "balancer balancer_sheet origins",
        MATERIAL | {"fatigue_torsion_MPa": IDLE, "fkm_group": Told("Forg_Steel")},
    ),
    ("balancer.gear", ""): Table(
        lambda: builtin("balancer-shaft"), "balancer.gear", "balancer", {"z_mm": 20.0}
    ),
    ("balancer.step", ""): Table(
        lambda: builtin("balancer-shaft"),
        "balancer.step[0]",
        "balancer redesign",
        {"free_diameter_mm": [44.0, 46.0], "free_bore_mm": [0.0, 20.0]},
    ),
    ("balancer.weight", ""): Table(balancer_bolt, "balancer.weight[0]", "balancer bolts"),
    ("balancer.weight.bolt", ""): Table(
        balancer_bolt, "balancer.weight[0].bolt", "bolts", BOLT | {"hole_diameter_mm": 11.5}
    ),
    ("balancer.bearing", ""): Table(
        lambda: builtin("balancer-shaft"),
        "balancer.bearing[0]",
        "balancer redesign",
        {"free_z_mm": [28.0, 36.0]},
    ),
    ("balancer.bearing.roller_bearing", ""): Table(
        lambda: builtin("balancer-shaft"),
        "balancer.bearing[0].roller_bearing",
        "balancer origins",
        {
            "name": "HK6020",
            "kind": Other(
                "thrust",
                {"balancer.bearing[2].roller_bearing": None, "balancer.bearing[2].spring_N_per_mm": 1e6},
            ),
            "displacement_mm": Other([0.001, 0.004, 0.02], OWN_ROLLERS),
            "reaction_N": Other([33.0, 172.0, 600.0], OWN_ROLLERS),
            **SIZES_OF_ROLLERS,
        },
    ),
    ("balancer.notch", ""): Table(
        lambda: builtin("balancer-shaft"),
        "balancer.notch[0]",
        "balancer",
        {"kind": Other("hole", also={"balancer.notch[0].diameter_mm": 10.0}), "diameter_mm": 22.0},
    ),
    ("balancer.probe", ""): Table(
        lambda: builtin("balancer-shaft"), "balancer.probe[0]", "balancer", {"z_mm": 260.0}
    ),
    ("balancer.speed", ""): Table(
        lambda: changed(
            builtin("balancer-shaft"),
            {"balancer.speed": [{"at_rpm": 2000.0, "share": 0.5}, {"at_rpm": 1000.0, "share": 0.5}]},
        ),
        "balancer.speed[0]",
        "balancer",
    ),
    ("balancer.redesign", ""): Table(
        lambda: builtin("balancer-shaft"), "balancer.redesign", "redesign", dear=True
    ),
    ("balancer.redesign.bearing", ""): Table(
        redesign_bearing,
        "balancer.redesign.bearing[0]",
        "redesign",
        {
            "z_mm": Other(282.0, {"balancer.redesign.bearing[0].free_z_mm": None}),
            "spring_N_per_mm": 1e5,
            "free_z_mm": [276.0, 284.0],
        },
        dear=True,
    ),
    ("balancer.redesign.bearing.roller_bearing", ""): Table(
        lambda: redesign_bearing(roller_bearing={"name": "HK4520"}, spring_N_per_mm=None),
        "balancer.redesign.bearing[0].roller_bearing",
        "redesign origins",
        {
            "name": "HK6020",
            "kind": Other("thrust", {"balancer.redesign.deflection_mm": 0.045}),
            "displacement_mm": Other([0.001, 0.004, 0.02], ADDED_ROLLERS),
            "reaction_N": Other([33.0, 172.0, 600.0], ADDED_ROLLERS),
            **SIZES_OF_ROLLERS,
        },
        dear=True,
    ),
    ("bolted_joint", ""): Table(
        joint,
        "bolted_joint[0]",
        "bolts",
        BOLT
        | {
            "hole_diameter_mm": 11.5,
            "holds": Other("web.counterweight", HELD, {"bolted_joint[0].max_force_N": None}),
            "bolts": Told(3),
            "places_mm": Other([[0.0, 0.0]], HELD | ONE_BOLT),
        },
    ),
}
