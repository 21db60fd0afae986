"""each-web.json: one web for all of a crank, and every distinct web its own, at the same limits."""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import Field

from cranktopo.base.result import UNLESS_NONE, FileName, Result
from cranktopo.design.assumed import Assumption
from cranktopo.design.goal.constraint import TOLERANCE
from cranktopo.design.goal.outcome import GoalWords
from cranktopo.tasks.web_shape.each_web.loaded_shaft import ShaftFigures


class GroupSearch(Result):
    """The search for the web of a group, in its last round."""

    webs: tuple[int, ...]
    """Numbers from the free end."""
    folder: FileName
    """Its run of `shape`, in the folder of this one."""
    required_in_shaft: float
    """Safety that each web must have in the shaft."""
    required: float
    """Safety that the search kept instead: under the loads of the shaft on a throw that stands alone."""
    reached: float
    """That of its web."""
    original_reached: float
    """That of the design's web."""
    throw_kg: float
    """Mass of a throw of two such webs."""
    original_throw_kg: float
    torsion_percent: float
    """Torsional stiffness of such a throw, % of the design's."""
    bending_percent: float
    """Bending stiffness of such a throw, % of the design's."""
    dimensions: dict[str, float]
    """Dimensions of the web by name, mm or degrees."""
    limits_held: bool
    """True where its search kept every limit, its safety among them."""
    makeable: bool
    """True where the process can make it, as far as that was looked at."""


class CrankRound(Result):
    """A crank after a round of searches, on all its main bearings."""

    mass_kg: float
    safety: float
    safeties: tuple[float, ...]
    """Least safety of each web, from the free end."""
    held: bool
    """True where every web has the safety that is required."""


class CrankVariant(Result):
    """A crank whose webs were found: all alike, or each distinct one its own."""

    design: FileName
    shaft: ShaftFigures
    groups: tuple[GroupSearch, ...]
    rounds: tuple[CrankRound, ...]
    """The second one with the loads that the webs of the first bring about."""
    best_round: int

    @property
    def held(self) -> bool:
        """True where every limit of every web holds."""
        return self.rounds[self.best_round].held and all(group.limits_held for group in self.groups)

    @property
    def makeable(self) -> bool:
        """True where the process can make every web, as far as that was looked at."""
        return all(group.makeable for group in self.groups)

    def group_of(self, web: int) -> GroupSearch:
        """Return the search that found a web."""
        return next(group for group in self.groups if web in group.webs)


class EachWebResult(Result):
    """The content of each-web.json, and what `shape --each-web --json` prints."""

    schema_version: int = 1
    design: str
    goal: GoalWords
    limits: dict[str, str]
    """Limits of every web by quantity, as the search had them; the safety is that of `required_safety`."""
    required_safety: float
    """Least safety of every web in the shaft."""
    alike_percent: float
    """Webs whose least safeties in the design's shaft differ by less were searched for together."""
    same_webs: tuple[tuple[int, ...], ...]
    """Webs that the design makes equal, by their numbers."""
    mirrored: bool
    """True where mirror pairs of webs were taken as equal."""
    original: ShaftFigures
    one_web: CrankVariant
    each_web: CrankVariant
    safety_decides: bool
    """True where the safety decides the one web for all; else webs of their own are that web."""
    saved_percent: float
    """Mass that the crank with its own webs saves against that with one web for all, %."""
    seconds: float
    left_off: str | None = UNLESS_NONE
    """Loads that the safety does not count although they are above the threshold, in words."""
    assumed: tuple[Assumption, ...] = ()
    files: dict[str, FileName] = Field(default_factory=dict)

    @property
    def held(self) -> bool:
        """True where the crank with its own webs keeps every limit."""
        return self.each_web.held

    @property
    def makeable(self) -> bool:
        """True where the process can make its webs, as far as that was looked at."""
        return self.each_web.makeable


def is_safe(figures: ShaftFigures, required: float) -> bool:
    """Tell whether every web of a shaft has a safety, within what counts as kept everywhere."""
    return figures.safety >= required * (1 - TOLERANCE)


def differing(dimensions: Mapping[str, Mapping[str, float]], least: float = 0.05) -> list[str]:
    """Return the names of dimensions that are not the same in all of several webs, mm or degrees."""
    names = dict.fromkeys(name for own in dimensions.values() for name in own)

    def spread(name: str) -> bool:
        values = [own.get(name) for own in dimensions.values()]
        known = [value for value in values if value is not None]
        return len(known) < len(values) or max(known) - min(known) >= least

    return [name for name in names if spread(name)]
