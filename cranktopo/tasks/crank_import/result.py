"""Crank that `cranktopo import` found, as it prints it with `--json`."""

from __future__ import annotations

from cranktopo.base.result import Result


class ImportSource(Result):
    """The body that was read."""

    file: str
    """The file."""
    solid: str
    """The solid of it that was taken."""
    unit: str
    """Unit of its numbers: that of --unit, else `file` (the unit in the file), or mm where it has none."""
    faces: int
    """Number of its faces; of triangles, of the faces fitted to them."""
    triangles: int
    """Number of its triangles; 0 of a body with exact faces."""


class ImportedAxis(Result):
    """The crank axis in the axes of the file."""

    point_mm: tuple[float, float, float]
    """A point on it."""
    direction: tuple[float, float, float]
    """Its direction; the low end counts as the free end."""


class ImportedPin(Result):
    """A crankpin as a part."""

    z_mm: float
    """Place of its middle along the crank axis."""
    outer_diameter_mm: float
    """Outer diameter."""
    bore_diameter_mm: float
    """Diameter of its bore; 0 = solid."""
    length_mm: float
    """Length between the webs."""
    fillet_mm: float
    """Radius of its fillets; 0 = none found."""


class ImportedLack(Result):
    """A part of the crank that is in no design."""

    where: str
    """The crank, or the half throw."""
    what: str
    """The part, in words."""


class ImportDeviation(Result):
    """Distances of the outlines of bodies and designs, over all distinct half throws."""

    max: float
    """The largest."""
    rms: float
    """Root of the mean square, over points 0.25 mm apart along both outlines."""


class ImportFiles(Result):
    """Files that were written."""

    design: str
    """The design of the crank."""
    throws: tuple[str, ...]
    """Designs of the throws that differ from the first one's."""
    bodies: tuple[str, ...]
    """Bodies of the distinct half throws."""
    page: str
    """Page with body and design over each other."""
    picture: str
    """The same as a picture."""


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
    pin: ImportedPin
    """Its crankpin."""
    webs: tuple[int, ...]
    """Numbers of the distinct half throws of its webs, from the low end; a flying web is none."""
    same_as: int | None
    """Number of the first throw that is alike but for its main journals; null for the first of its kind."""


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
    z_mm: float
    """The same."""
    outer_diameter_mm: float
    """The same as `diameter_mm`."""
    bore_diameter_mm: float
    """The same as `bore_mm`."""
    fillet_mm: float
    """Radius of its fillets; 0 = none found."""


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
    deviations_mm: dict[str, float | None]
    """Of each dimension: root of the mean square distance of its faces from the corners of their triangles,
    at least the rounding in the design, which of exact faces is all; of outlines the largest distance; null
    where no face tells it."""
    unread: tuple[str, ...]
    """Parts of this half throw that the design does not say, in words."""


class CrankImport(Result):
    """A crank from CAD, recognised."""

    schema_version: int = 1
    """Version of these keys."""
    source: ImportSource
    """The body that was read."""
    file: str
    """The file."""
    solids: tuple[ImportedSolid, ...]
    """Solids of the file."""
    solid: str
    """The one that was taken."""
    origin_mm: tuple[float, float, float]
    """A point on the crank axis, in the axes of the file."""
    axis: ImportedAxis
    """The crank axis."""
    throws: tuple[ImportedThrow, ...]
    """Crankpins."""
    main_journals: tuple[ImportedJournal, ...]
    """Main journals."""
    halves: tuple[ImportedHalf, ...]
    """Distinct half throws, those of most webs first; the first is the design."""
    material: str
    """Material of the design, which a CAD file does not contain."""
    assumed: tuple[str, ...]
    """Assumptions where the faces leave something open, in words."""
    volume_mm3: float
    """Volume of the body."""
    design_volume_mm3: float | None
    """Volume of the crank of the designs, ends included; null where they are no whole crank."""
    volume_within: float
    """Share of the volume of the designs, and so of their mass, that the scatter of the corners of triangles
    over the whole surface may hide; 0 of exact faces."""
    deviation_mm: ImportDeviation
    """Distances of the outlines of bodies and designs."""
    unread: tuple[ImportedLack, ...]
    """Parts of the crank that are in no design."""
    page: str
    """Page with body and design over each other."""
    files: ImportFiles
    """Files that were written."""
