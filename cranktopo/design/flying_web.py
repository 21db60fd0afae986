"""Flying webs of a crank: where no main journal is between two throws, both their webs, back to back."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.halves import WebName, halves
from cranktopo.design.schema import Scene


@dataclass(frozen=True)
class FlyingWeb:
    """A flying web with the half pin on either side.

    Attributes:
        name: of the crank, with the throws that it joins.
        near: half throw on the side of the free end, in its own frame, which is the mirror image.
        far: half throw behind it.
        turn_deg: far throw ahead of the near one, in the sense of rotation, from 0 to 360.
    """

    name: str
    near: Scene
    far: Scene
    turn_deg: float

    @property
    def length_mm(self) -> float:
        """Distance of the middles of both crankpins."""
        return (self.near.pitch_mm + self.far.pitch_mm) / 2

    @property
    def back_mm(self) -> float:
        """Place of the plane in which both webs meet, from the middle of the near crankpin."""
        return self.near.pitch_mm / 2


def flying_webs(scene: Scene) -> tuple[FlyingWeb, ...]:
    """Return each flying web of a crank that differs from those before; none without an engine."""
    if scene.engine is None or scene.crank is None:
        return ()
    throws, angles = throw_scenes(scene), scene.shaft_angles_deg
    found: dict[tuple[Scene, Scene, float], FlyingWeb] = {}
    for number, (one, other) in enumerate(pairwise(throws), 1):
        near, far = halves(one)[1], halves(other)[0]
        if far.throw.main_journal.length_mm == 0:
            turn = round((angles[number] - angles[number - 1]) % 360, 9)
            name = f"{scene.name}, flying web between throws {number} and {number + 1}"
            found.setdefault((near, far, turn), FlyingWeb(name, near, far, turn))
    return tuple(found.values())


def web_at_a_bearing(scene: Scene) -> WebName | None:
    """Return which web of a throw beside a flying one has a main journal; None of other throws."""
    journals = [half.throw.main_journal.length_mm > 0 for half in halves(scene)]
    return None if len(set(journals)) == 1 else ("first" if journals[0] else "second")
