"""Scene table of what the workshop drawing says beside dimensions: fits, surfaces, title block."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from cranktopo.base.fit import FIT, HOLE
from cranktopo.base.table import SceneTable

_Fit = Annotated[str, Field(pattern=FIT)]
_Roughness = Annotated[float, Field(ge=0.01, le=100, allow_inf_nan=False)]
_Tolerance = Annotated[float, Field(ge=1e-4, le=10, allow_inf_nan=False)]
_Words = Annotated[str, Field(pattern=r"^[^\n]{0,60}$")]
_Note = Annotated[str, Field(pattern=r"^[^\n]{1,90}$")]


class Drawing(SceneTable):
    """Words and tolerances of workshop drawings beside their dimensions; it changes no result."""

    main_journal_fit: _Fit = Field(default="h6", examples=["h6"])
    """Tolerance of the main journals' diameter (ISO 286): position `f`, `g`, `h`, `js`, `k`, `m`, `n` or `p`
    and grade 4 to 10. Rolling bearings usually take `k6` or `m6`."""
    crankpin_fit: _Fit = Field(default="h6", examples=["h6"])
    """Tolerance of the crankpins' diameter."""
    journal_roughness_um: _Roughness = 0.4
    """Mean roughness Ra of journals."""
    fillet_roughness_um: _Roughness = 0.4
    """Ra of fillets."""
    bore_roughness_um: _Roughness = 3.2
    """Ra of bores and drillings."""
    surface_roughness_um: _Roughness = 6.3
    """Ra of all other surfaces."""
    hardness_HRC: float | None = Field(default=None, ge=20, le=70, examples=[54.0], allow_inf_nan=False)
    """Rockwell hardness of journals that are hardened; without it none are."""
    hardening_depth_mm: float | None = Field(
        default=None, ge=0.01, le=20, examples=[2.5], allow_inf_nan=False
    )
    """Depth of hardening on the finished journal; needs `hardness_HRC`."""
    run_out_mm: _Tolerance | None = Field(default=None, examples=[0.03])
    """Circular run-out of the main journals to the axis of the outer two; by default IT7 of the diameter."""
    parallelism_mm: _Tolerance | None = Field(default=None, examples=[0.01])
    """Parallelism of the crankpins to the crank axis; by default IT5 of their diameter."""
    cylindricity_mm: _Tolerance | None = Field(default=None, examples=[0.005])
    """Cylindricity of journals; by default IT4 of the diameter."""
    throw_radius_tolerance_mm: _Tolerance = 0.05
    """Tolerance of the throw radius, plus and minus."""
    throw_angle_tolerance_deg: float = Field(default=0.2, ge=0.001, le=5, allow_inf_nan=False)
    """Tolerance of the angles between throws, plus and minus."""
    rod_bore_fit: Annotated[str, Field(pattern=HOLE)] = "H6"
    """Tolerance of the bores of a connecting rod (ISO 286): position `H` and grade 4 to 10."""
    rod_bore_roughness_um: _Roughness = 0.8
    """Ra of these bores."""
    rod_length_tolerance_mm: _Tolerance = 0.05
    """Tolerance of the distance of both bores' axes, plus and minus."""
    balance_quality: float = Field(default=16.0, ge=0.1, le=4000, allow_inf_nan=False)
    """Balance quality grade G (ISO 21940-11), mm/s, at the highest speed of the engine."""
    general_tolerances: _Words = "ISO 2768-mK"
    """Standard and classes of what has no tolerance of its own."""
    title: _Words = ""
    """Title of the drawing; by default the design's name."""
    number: _Words = ""
    """Number of the drawing."""
    revision: _Words = ""
    """Its revision."""
    owner: _Words = ""
    """Legal owner."""
    drawn_by: _Words = ""
    """Name of whom it was made by."""
    approved_by: _Words = ""
    """Name of whom it was approved by."""
    notes: tuple[_Note, ...] = Field(default=(), max_length=12, examples=[("Magnetic particle test.",)])
    """Lines that are added to the notes."""


def surface_notes(drawing: Drawing) -> tuple[str, ...]:
    """Return the notes on general tolerances, surfaces and edges."""
    fillets, journals = drawing.fillet_roughness_um, drawing.journal_roughness_um
    ground = f"Journals and fillets ground, Ra {journals:g} µm;"
    if fillets != journals:
        ground = f"Journals ground, Ra {journals:g} µm, fillets Ra {fillets:g} µm;"
    return (
        f"General tolerances {drawing.general_tolerances} unless stated.",
        f"{ground} bores Ra {drawing.bore_roughness_um:g} µm;",
        f"all other surfaces as forged or milled, Ra {drawing.surface_roughness_um:g} µm.",
        "Break sharp edges 0.3 mm.",
    )
