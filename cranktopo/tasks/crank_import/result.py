"""Crank that `cranktopo import` found, as it prints it with `--json`."""

from __future__ import annotations

from cranktopo.base.result import Result


class ImportedSolid(Result):
    """A solid of the file."""

    name: str
    """Its name in the file."""
    size_mm: tuple[float, float, float]
    """Its box along the axes of the file."""
    volume_mm3: float
    """Its volume."""
    looks_like_a_crank: bool
    """Cylinders lie on two or more parallel axes."""


class ImportedThrow(Result):
    """A crankpin of the crank."""

    number: int
    """Number from the low end of the crank axis, 1 first."""
    angle_deg: float
    """Angle from the first throw as the design has it: `engine.arrangement.throw_angles_deg`."""
    radius_mm: float
    """Throw radius."""
    diameter_mm: float
    """Outer diameter of the crankpin."""
    bore_mm: float
    """Diameter of its bore; 0 = solid."""
    length_mm: float
    """Length of the crankpin between the webs."""
    middle_mm: float
    """Place of its middle along the crank axis."""


class ImportedJournal(Result):
    """A main journal of the crank."""

    number: int
    """Number from the low end of the crank axis, 1 first."""
    diameter_mm: float
    """Outer diameter."""
    bore_mm: float
    """Diameter of its bore; 0 = solid."""
    length_mm: float
    """Visible length: between the webs, or to the end of its cylinder."""
    middle_mm: float
    """Place of its middle along the crank axis."""


class ImportedHalf(Result):
    """A half throw that the crank has once or several times."""

    number: int
    """Its number in the names of the files."""
    body: str
    """STEP file of the half throw in the frame of a throw."""
    design: str
    """Design written for it."""
    webs: tuple[str, ...]
    """Webs of the crank that are alike, in words."""
    outline: str
    """Outline of the web in the design, in words."""
    outline_deviation_mm: float
    """Largest distance of the outlines of body and design, seen along the crank."""
    volume_mm3: float
    """Volume of the half throw in the file."""
    design_volume_mm3: float
    """Volume of the half throw of the design."""
    missing_mm3: float
    """Volume that the body has and the design lacks."""
    extra_mm3: float
    """Volume that the design has and the body lacks."""
    dimensions_mm: dict[str, float]
    """Dimensions of journals, fillets and web by their keys in the design; angles in deg."""
    unread: tuple[str, ...]
    """Parts of this half throw that the design does not say, in words."""


class CrankImport(Result):
    """A crank from CAD, recognised."""

    schema_version: int = 1
    """Version of these keys."""
    file: str
    """The file."""
    solids: tuple[ImportedSolid, ...]
    """Solids of the file."""
    solid: str
    """The one that was taken."""
    origin_mm: tuple[float, float, float]
    """A point on the crank axis, in the axes of the file."""
    axis: tuple[float, float, float]
    """Direction of the crank axis; its low end counts as the free end."""
    throws: tuple[ImportedThrow, ...]
    """Crankpins."""
    main_journals: tuple[ImportedJournal, ...]
    """Main journals."""
    halves: tuple[ImportedHalf, ...]
    """Distinct half throws, those of most webs first; the first is the design."""
    material: str
    """Material of the design: CAD does not tell it."""
    assumed: tuple[str, ...]
    """Assumptions where the faces leave something open, in words."""
    unread: tuple[str, ...]
    """Parts of the crank that are in no design, in words."""
    page: str
    """Page with body and design over each other."""
