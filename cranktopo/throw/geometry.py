"""Scene tables of the journals and of the throw, with their checks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from pydantic import Field

from cranktopo.base.errors import invalid
from cranktopo.base.table import Length, LengthOrZero, SceneTable
from cranktopo.throw.drilling.table import Drilling
from cranktopo.throw.feature import ROUNDING_MM, Feature
from cranktopo.throw.fillet import ASPECT, FilletSection


class Journal(SceneTable):
    """A main journal or crankpin: a cylinder with an axial bore (0 = solid) and a fillet (0 = sharp)."""

    outer_diameter_mm: Length = Field(examples=[42.0])
    """Outer diameter."""
    bore_diameter_mm: LengthOrZero = 0.0
    """Diameter of the axial bore, which runs on through the web; 0 = solid."""
    length_mm: Length = Field(examples=[38.0])
    """Full length between the webs; the half throw has half of it."""
    fillet_mm: LengthOrZero = 0.0
    """Radius of the fillet to the web; 0 = sharp. Smaller than half the length."""
    fillet_axial_mm: Length | None = Field(default=None, examples=[4.0])
    """Makes the fillet an ellipse: its semi-axis along the crank, `fillet_mm` being that on the web's face;
    0.5 to 2.5 times `fillet_mm` and smaller than half the length. Left out, the fillet is round."""

    @property
    def radius_mm(self) -> float:
        """Outer radius, mm."""
        return self.outer_diameter_mm / 2

    @property
    def fillet(self) -> FilletSection:
        """Section of its fillets."""
        axial = self.fillet_mm if self.fillet_axial_mm is None else self.fillet_axial_mm
        return FilletSection(self.fillet_mm, axial)

    @property
    def bore_radius_mm(self) -> float:
        """Bore radius, mm (0 = solid)."""
        return self.bore_diameter_mm / 2

    def check(self, key: str) -> None:
        """Refuse dimensions that give no journal.

        Raises:
            CranktopoError: first inconsistency found.
        """
        if self.bore_diameter_mm >= self.outer_diameter_mm:
            raise invalid(
                f"{key}.bore_diameter_mm",
                self.bore_diameter_mm,
                f"must be smaller than {key}.outer_diameter_mm = {self.outer_diameter_mm:g} mm",
                "Use 0 for a solid journal.",
            )
        self._check_fillet(key)

    def _check_fillet(self, key: str) -> None:
        fillet, given = self.fillet, self.fillet_axial_mm is not None
        key = f"{key}.fillet_axial_mm" if given else f"{key}.fillet_mm"
        low, high = (share * fillet.radial_mm for share in ASPECT)
        if given and not fillet.radial_mm:
            raise invalid(
                key,
                fillet.axial_mm,
                "an ellipse needs both semi-axes, and fillet_mm = 0",
                "Give fillet_mm, too.",
            )
        if given and not low - ROUNDING_MM <= fillet.axial_mm <= high + ROUNDING_MM:
            raise invalid(
                key,
                fillet.axial_mm,
                f"must be >= {low:.4g} and <= {high:.4g} mm, {ASPECT[0]:g} to {ASPECT[1]:g} times "
                f"fillet_mm = {fillet.radial_mm:g} mm",
            )
        if fillet.axial_mm >= self.length_mm / 2:
            raise invalid(
                key,
                fillet.axial_mm,
                f"must be smaller than half the journal's length ({self.length_mm / 2:g} mm)",
            )


class ThrowTable(SceneTable):
    """Crank throw: radius and its two journals."""

    radius_mm: Length = Field(examples=[48.0])
    """Distance of the crankpin's axis from the crank axis: half the stroke."""
    main_journal: Journal
    """The main journal, centred on the crank axis."""
    crankpin: Journal
    """The crankpin, centred on the throw radius."""
    second_main_journal_length_mm: Length | None = Field(default=None, examples=[44.0])
    """Full length of the main journal beyond the second web, half of which is this throw's; by default that
    of `main_journal`."""
    second_crankpin_length_mm: Length | None = Field(default=None, examples=[38.0])
    """Twice the length of the crankpin from the cylinder's axis to the second web; by default the axis is in
    its middle, and it is `crankpin.length_mm`."""
    mirrored_web: Literal["first", "second"] | None = Field(default=None, examples=["first"])
    """The web of a throw with two different ones that this throw has twice: the half beyond the crankpin is
    taken as its mirror image. Written by `--web` of the optimisers; changes nothing but what is assumed."""
    drilling: tuple[Drilling, ...] = Field(default=(), max_length=8)

    @property
    def journals(self) -> tuple[tuple[Journal, float], tuple[Journal, float]]:
        """Main journal and crankpin, each with the place of its axis along the throw, mm."""
        return (self.main_journal, 0.0), (self.crankpin, self.radius_mm)

    def features(self) -> Iterator[tuple[str, Feature]]:
        """Yield each feature of journals and web together with its key path in the scene."""
        for index, drilling in enumerate(self.drilling):
            yield f"throw.drilling[{index}]", drilling

    def check_bores_apart(self) -> None:
        """Refuse bores that meet in the web, through which both run.

        Raises:
            CranktopoError: they do.
        """
        main, pin, radius = self.main_journal, self.crankpin, self.radius_mm
        if (
            main.bore_diameter_mm
            and pin.bore_diameter_mm
            and main.bore_radius_mm + pin.bore_radius_mm >= radius
        ):
            raise invalid(
                "throw.crankpin.bore_diameter_mm",
                pin.bore_diameter_mm,
                f"pin and main bores meet in the web; their radii must add up to less than {radius:g} mm",
            )
