"""Scene tables of the whole crank: its throws, main journals of their own, and its two ends."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from cranktopo.base.table import Length, LengthOrZero, SceneTable
from cranktopo.throw.crank_end import CrankEnd
from cranktopo.throw.journal import Journal

EVERY = "every"
"""Value of `crank.bearings` for a bearing on each main journal."""


class CrankJournal(SceneTable):
    """A main journal that differs from `[throw.main_journal]` in the keys that are given.

    An outer one that is named here has its full length.
    """

    number: int = Field(ge=0, le=48, examples=[0])
    """Its number from the free end: 0 is before throw 1, 1 behind it, and so on."""
    outer_diameter_mm: Length | None = Field(default=None, examples=[42.0])
    """Outer diameter."""
    bore_diameter_mm: LengthOrZero | None = Field(default=None, examples=[24.0])
    """Diameter of the axial bore; 0 = solid."""
    length_mm: LengthOrZero | None = Field(default=None, examples=[44.0])
    """Full length between the webs; 0 between two throws = none: their webs are one flying web."""
    fillet_mm: LengthOrZero | None = Field(default=None, examples=[2.5])
    """Radius of its fillets to the webs; 0 = sharp."""

    def applied_to(self, journal: Journal) -> Journal:
        """Return the journal with the keys that are given here; a flying web has neither bore nor fillet."""
        flying = self.length_mm == 0
        keys = self.model_dump(exclude={"number"}, exclude_none=True)
        keys |= {"bore_diameter_mm": 0.0} if flying else {}
        sharp = {"fillet_mm": 0.0, "fillet_axial_mm": None, "recess_mm": None}
        return journal.model_copy(update=keys | (sharp if flying or self.fillet_mm == 0 else {}))


def _numbers(value: Any) -> Any:
    return () if value == EVERY else value


class Crank(SceneTable):
    """The whole crank. What is not given is the throw repeated, with half main journals at both ends."""

    throws: tuple[str, ...] = Field(default=(), max_length=48, examples=[("throw", "throw-2.toml")])
    """The throws from the free end: `throw` is that of this design; the name of another design is its
    crankpin, webs and drillings on the main journals of this one. Names are relative to this file. By default
    all are `throw`. Their angles are those of `[engine]`."""
    bearings: Annotated[tuple[int, ...], BeforeValidator(_numbers)] = Field(
        default=(), max_length=49, examples=[(0, 2, 4)]
    )
    """Numbers of the main journals that sit in a bearing, 0 before throw 1, the first and the last one among
    them; without it, or as `every`, all do."""
    main_journal: tuple[CrankJournal, ...] = Field(default=(), max_length=49)
    end: tuple[CrankEnd, ...] = Field(default=(), max_length=2)

    @property
    def uniform(self) -> bool:
        """Tell whether all throws are that of the design, between its main journals."""
        return not self.main_journal and all(name == OWN_THROW for name in self.throws)

    def end_on(self, side: Side) -> CrankEnd | None:
        """Return the end on a side; None where none is given."""
        return next((end for end in self.end if end.side == side), None)


Side = Literal["free", "output"]
OWN_THROW = "throw"
"""Name of the design's own throw in `crank.throws`."""
