"""Cases of the keys of throw, webs and material."""

from __future__ import annotations

from tests.keys.bases import MATERIAL, PLANES, SECOND, drilled, journals, material, pocketed, weighted
from tests.keys.kinds import Other, Refused, Table
from tests.keys.scenes import builtin, throw, web

THROW_CASES: dict[tuple[str, str], Table] = {
    ("", ""): Table(
        lambda: builtin("mikron-iiic-plain"),
        "",
        "effects origins",
        {
            "schema_version": Refused(2, "schema_version"),
        },
    ),
    ("throw", ""): Table(throw, "throw", "body assumed", {"mirrored_web": "first"}),
    **{
        (f"throw.{name}", ""): Table(journals, f"throw.{name}", "body")
        for name in ("main_journal", "crankpin", "second_main_journal")
    },
    ("throw.drilling", ""): Table(drilled, "throw.drilling[0]", "body", {"web": "first"}, dear=True),
    **{
        (f"throw.drilling.{end}", ""): Table(drilled, f"throw.drilling[0].{end}", "body cells", dear=True)
        for end in ("from", "to")
    },
    ("web", ""): Table(throw, "web", "body"),
    **{
        ("web", one): Table(lambda one=one: throw(web=web(one)), "web", "body", {"outline": None})
        for one in ("obround", "rectangle", "ellipse", "tapered", "profile")
    },
    ("web.bevel", ""): Table(
        lambda: throw(web=web("obround", bevel=[{"face": "journal", "y_mm": 54.0, "depth_mm": 12.0}])),
        "web.bevel[0]",
        "body",
        {"face": Other("pin", also={"web.bevel[0].y_mm": -4.0})},
    ),
    ("web.pocket", "cylinder"): Table(
        lambda: pocketed(shape="cylinder", face="pin", x_mm=30.0, y_mm=24.0, diameter_mm=10.0, depth_mm=5.0),
        "web.pocket[0]",
        "body cells",
        {"face": "journal"},
    ),
    ("web.pocket", "side"): Table(
        lambda: pocketed(shape="side", y_mm=24.0, length_mm=20.0, height_mm=8.0, depth_mm=5.0),
        "web.pocket[0]",
        "body cells",
        {"floor_radius_mm": Other(1.0, {"web.pocket[0].corner_radius_mm": 2.0})},
    ),
    ("web.pocket", "box"): Table(
        lambda: pocketed(
            shape="box", face="pin", x_mm=30.0, y_mm=24.0, size_x_mm=10.0, size_y_mm=12.0, depth_mm=4.0
        ),
        "web.pocket[0]",
        "body cells",
        {"floor_radius_mm": Other(1.0, {"web.pocket[0].corner_radius_mm": 2.0})},
    ),
    ("web.counterweight", ""): Table(
        weighted,
        "web.counterweight",
        "body cells",
        {"face": Other("pin", {"web.counterweight.thickness_mm": 12.0})},
    ),
    ("web.counterweight.edge", ""): Table(
        lambda: weighted(edge={"width_mm": 6.0, "depth_mm": 5.0, "length_mm": 12.0}),
        "web.counterweight.edge",
        "body",
    ),
    ("web.counterweight.plug", ""): Table(
        lambda: weighted(
            plug=[
                {
                    "diameter_mm": 12.0,
                    "axis": "axial",
                    "y_mm": -50.0,
                    "length_mm": 12.0,
                    "density_kg_m3": 17500.0,
                }
            ]
        ),
        "web.counterweight.plug[0]",
        "body",
    ),
    ("web.counterweight.hole", ""): Table(
        lambda: weighted(hole=[{"diameter_mm": 8.0, "depth_mm": 12.0}]), "web.counterweight.hole[0]", "body"
    ),
    ("second_web", ""): Table(lambda: throw(second_web=dict(SECOND)), "second_web", "body"),
    **{
        ("second_web", one): Table(
            lambda one=one: throw(second_web=web(one)), "second_web", "body", {"outline": None}
        )
        for one in ("obround", "rectangle", "ellipse", "tapered", "profile")
    },
    ("material", ""): Table(
        material,
        "material",
        "strength body compliance origins",
        MATERIAL | {"fatigue_torsion_MPa": PLANES},
        dear=True,
    ),
}
