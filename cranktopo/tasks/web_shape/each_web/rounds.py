"""Searches for the webs of a crank, one for each group, and the shaft solved again with what they found.

The loads of the webs are those of the shaft, and stay as they are within a search. A throw that stands
alone under them has not quite the safety that its web has in the shaft; the search keeps the same share of
the former as is wanted of the latter. Webs change the shaft, so a second round begins with that of the first.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cranktopo.base.notes import Pace, indented, note
from cranktopo.base.progress import StageMemory
from cranktopo.design.goal.constraint import TOLERANCE
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import stored_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import WebLoads
from cranktopo.runs.stored import unchanged
from cranktopo.tasks.web_shape.each_web.crank_files import MAIN, write_crank
from cranktopo.tasks.web_shape.each_web.groups import WebGroup
from cranktopo.tasks.web_shape.each_web.loaded_shaft import LoadedShaft, loaded_shaft
from cranktopo.tasks.web_shape.each_web.result import CrankRound, CrankVariant, GroupSearch, is_safe
from cranktopo.tasks.web_shape.evaluated_web import Judging, kept_safety
from cranktopo.tasks.web_shape.optimum import ShapeSettings
from cranktopo.tasks.web_shape.result import ShapeResult
from cranktopo.tasks.web_shape.run import shape_in

_ROUNDS = 2
_ROOM = 0.05
"""Share of the required safety that a web keeps too much where the safety does not decide: a search that
ends early may leave some percent of a limit that does."""
_SLACK = 0.01
"""Share of the required safety that a web has too much, above which a second round makes use of it."""


@dataclass(frozen=True)
class Searched:
    """A finished search for the web of a group.

    Attributes:
        round: number of the round, from 1.
        required: safety that it kept, under the loads of the shaft on a throw that stands alone.
    """

    group: WebGroup
    round: int
    folder: Path
    required: float
    result: ShapeResult

    @property
    def scene(self) -> Scene:
        """The throw with its web twice."""
        return stored_scene(self.folder / self.result.files.design)

    def settled(self, safeties: Sequence[float], required: float) -> bool:
        """Tell whether its webs have the safety that is required in the shaft, and no useless one."""
        least = self.group.least(safeties)
        at_limit = self.result.values.result["fatigue_safety"] <= self.required * (1 + _SLACK)
        useless = at_limit and least > required * (1 + _SLACK)
        return least >= required * (1 - TOLERANCE) and not useless

    @property
    def safety_decides(self) -> bool:
        """True where the web is near its least safety, so that another limit of it gives another web."""
        return self.result.values.result["fatigue_safety"] < self.required * (1 + _ROOM)


@dataclass(frozen=True)
class SearchedCrank:
    """A crank with the webs that its searches found, and its shaft."""

    variant: CrankVariant
    searches: tuple[Searched, ...]
    shaft: LoadedShaft

    @property
    def safety_decides(self) -> bool:
        """True where it decides one of the webs."""
        return any(one.safety_decides for one in self.searches)


@dataclass(frozen=True)
class CrankSearch:
    """Everything that all searches of a run share.

    Attributes:
        required: safety that every web must have in the shaft.
        original: the shaft of the design's own web.
        pace: told at the beginning of every part.
    """

    folder: Path
    scene: Scene
    settings: ShapeSettings
    work: StageMemory
    original: LoadedShaft
    required: float
    pace: Pace

    def variant(
        self, name: str, groups: Sequence[WebGroup], begun: SearchedCrank | None = None
    ) -> SearchedCrank:
        """Return the crank with the best web of every group.

        Args:
            name: of its folder.
            begun: crank with one web, with which and with whose loads every search begins, and whose features
                it keeps; by default the design, and features are sought.

        Raises:
            CranktopoError: no web that keeps limits and rules, a failed solve, or interruption.
        """
        rounds = list(self._rounds(name, groups, begun))
        safe = [n for n, (_, _, shaft) in enumerate(rounds) if is_safe(shaft.figures, self.required)]
        nearest = max(range(len(rounds)), key=lambda n: rounds[n][2].figures.safety)
        best = safe[-1] if safe else nearest
        folder, found, shaft = rounds[best]
        crank = CrankVariant(
            design=f"{folder.name}/{MAIN}",
            shaft=shaft.figures,
            groups=tuple(self._group_search(one) for one in found),
            rounds=tuple(
                CrankRound(
                    mass_kg=shaft.figures.mass_kg,
                    safety=shaft.figures.safety,
                    safeties=shaft.figures.safeties,
                    held=is_safe(shaft.figures, self.required),
                )
                for _, _, shaft in rounds
            ),
            best_round=best,
        )
        return SearchedCrank(crank, found, shaft)

    def _rounds(
        self, name: str, groups: Sequence[WebGroup], begun: SearchedCrank | None
    ) -> Iterator[tuple[Path, tuple[Searched, ...], LoadedShaft]]:
        found: tuple[Searched, ...] = tuple(
            self._from_design(group) if begun is None else self._on(group, begun.searches[0], begun.shaft, 1)
            for group in groups
        )
        for number in range(1, _ROUNDS + 1):
            folder = self.folder / (name if number == 1 else f"{name}-{number}")
            shaft = self._shaft(folder, found)
            yield folder, found, shaft
            safeties = shaft.figures.safeties
            if number == _ROUNDS or all(one.settled(safeties, self.required) for one in found):
                return
            found = tuple(
                one if one.settled(safeties, self.required) else self._on(one.group, one, shaft, number + 1)
                for one in found
            )

    def _from_design(self, group: WebGroup) -> Searched:
        share = self.required / group.least(self.original.figures.safeties)
        return self._searched(group, 1, f"{100 * share:.5g} %", self.original.loads(group), None)

    def _on(self, group: WebGroup, before: Searched, shaft: LoadedShaft, number: int) -> Searched:
        """Go on from a web that was found, under the loads of the shaft that has it."""
        loads, name = shaft.loads(group), f"{group.name}-judged-{number}"
        judging = Judging(loads, self.settings.fillet_fraction)
        alone = kept_safety(self.work, name, before.scene, judging)
        required = alone * self.required / group.least(shaft.figures.safeties)
        return self._searched(group, number, f"{required:.5g}", loads, before.scene)

    def _searched(
        self, group: WebGroup, number: int, limit: str, loads: WebLoads, begun: Scene | None
    ) -> Searched:
        folder = self.folder / (group.name if number == 1 else f"{group.name}-{number}")
        round_words = "" if number == 1 else ", second round"
        self.pace.begin(f"{group.words}{round_words}: safety >= {limit}")
        scene = with_goal(self.scene, limits=[f"fatigue_safety >= {limit}"])
        scene = scene.model_copy(update={"name": f"{scene.name}-{folder.name}"})
        with indented():
            settings = replace(self.settings, loads=loads, features=begun is None)
            result = shape_in(folder, scene, settings, ["cranktopo", "shape", "--each-web"], begun)
        required = next(one.required for one in result.goal.limits if one.quantity == "fatigue_safety")
        return Searched(group, number, folder, required or 0.0, result)

    def _shaft(self, folder: Path, searches: Sequence[Searched]) -> LoadedShaft:
        def solved() -> dict[str, object]:
            self.pace.begin(f"the shaft with {len(searches)} different web{'s' * (len(searches) > 1)}")
            webs = {web: one.scene.web for one in searches for web in one.group.webs}
            folder.mkdir(exist_ok=True)
            scene = self.scene.model_copy(update={"name": f"{self.scene.name}-{folder.name}"})
            heading = f"Crank of {self.scene.name} with the webs that `cranktopo shape --each-web` found."
            write_crank(scene, webs, folder, heading)
            with indented():
                return loaded_shaft(str(folder / MAIN), self.settings.fillet_fraction).as_json()

        kept = LoadedShaft.of_json(self.work.once(folder.name, solved))
        for design in folder.glob("*.toml"):
            unchanged(design)
        safeties = ", ".join(f"{safety:.3f}" for safety in kept.figures.safeties)
        note(f"{folder.name}: {kept.figures.mass_kg:.3f} kg; safety of the webs {safeties}")
        return kept

    def _group_search(self, one: Searched) -> GroupSearch:
        result, values, before = one.result, one.result.values.result, one.result.values.original
        return GroupSearch(
            webs=one.group.webs,
            folder=one.folder.name,
            required_in_shaft=self.required,
            required=one.required,
            reached=values["fatigue_safety"],
            original_reached=before["fatigue_safety"],
            throw_kg=values["mass"],
            original_throw_kg=before["mass"],
            torsion_percent=100 * values["torsion"] / before["torsion"],
            bending_percent=100 * values["bending"] / before["bending"],
            dimensions={row.name: row.value for row in result.parameters},
            limits_held=result.held,
            makeable=result.makeable,
        )
