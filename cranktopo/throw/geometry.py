"""Scene tables of the journals and of the throw, with their checks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from pydantic import Field

from cranktopo.base.errors import invalid
from cranktopo.base.table import Length, SceneTable
from cranktopo.throw.drilling.table import Drilling
from cranktopo.throw.feature import Feature
from cranktopo.throw.journal import Journal


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
        """Refuse bores that meet in the web, through which both run."""
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
