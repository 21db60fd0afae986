"""Rounds of searches for the webs of a crank: what each is asked for, and which round counts."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import Pace
from cranktopo.base.progress import StageMemory
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_goal
from cranktopo.engine.histories import WebLoads
from cranktopo.tasks.web_shape import evaluated_web
from cranktopo.tasks.web_shape import run as shape_run
from cranktopo.tasks.web_shape.each_web import rounds
from cranktopo.tasks.web_shape.each_web.groups import WebGroup
from cranktopo.tasks.web_shape.each_web.loaded_shaft import LoadedShaft
from cranktopo.tasks.web_shape.each_web.rounds import CrankSearch
from cranktopo.tasks.web_shape.run import ShapedRun, shape_settings
from tests import shape_stand_in
from tests.shaft_stand_in import told_shaft
from tests.shape_stand_in import ORIGINAL, ShapeStandIn

SCENE = with_goal(load_scene("mikron-iiic"), minimise="mass")
OUTER, INNER = WebGroup((1, 2, 7, 8)), WebGroup((3, 4, 5, 6))
ALL = WebGroup(tuple(range(1, 9)))
DESIGN = (1.2, 1.3, 1.6, 1.5, 1.5, 1.6, 1.3, 1.2)


Searches = Callable[..., tuple[CrankSearch, ShapeStandIn]]


@pytest.fixture
def searches(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Searches:
    """Make the search of a crank whose shafts, one after another, have these safeties."""

    def made(*after: tuple[float, ...], percent: dict[str, float]) -> tuple[CrankSearch, ShapeStandIn]:
        monkeypatch.setattr(shape_stand_in, "export_solid", lambda *_: None)
        stand_in, shafts = ShapeStandIn(percent), iter(map(told_shaft, after))
        monkeypatch.setattr(shape_run, "shape_design", stand_in.design)
        monkeypatch.setattr(shape_run, "resume_shape", stand_in.resume)
        monkeypatch.setattr(rounds, "loaded_shaft", lambda design, fraction: next(shafts))
        monkeypatch.setattr(evaluated_web, "web_safety", lambda scene, judging: 3.0)
        pace, settings = Pace("each web", 4), shape_settings(SCENE)
        return CrankSearch(tmp_path, SCENE, settings, StageMemory(), told_shaft(DESIGN), 1.2, pace), stand_in

    return made


def asked(stand_in: ShapeStandIn) -> list[tuple[str, set[int]]]:
    """Questions to each search: its least safety, and whose loads it had."""
    found = []
    for scene, settings, _ in stand_in.asked:
        assert isinstance(settings.loads, WebLoads)
        whose = {int(history.radial_N[0]) for history in settings.loads.histories}
        found.append((scene.goal.limits.fatigue_safety, whose))
    return found


def test_a_web_that_is_safer_may_lose_as_much(searches: Searches) -> None:
    """Required is the least safety of the design; a web with 1.5 times that needs 1 / 1.5 of its own."""
    search, stand_in = searches(DESIGN, percent={"mass": 90.0})
    found = search.variant("own", (OUTER, INNER))
    crank, decides = found.variant, found.safety_decides
    assert asked(stand_in) == [(">= 100 %", {1, 2, 7, 8}), (">= 80 %", {3, 4, 5, 6})]
    assert crank.held
    assert decides  # the outer webs have 100 % of what they need, and no more
    assert [one.required for one in crank.groups] == [ORIGINAL["fatigue_safety"], 1.6]
    assert len(crank.rounds) == 1


def test_webs_of_their_own_begin_with_that_for_all_under_the_loads_of_its_shaft(searches: Searches) -> None:
    """Its throw alone has 3: outer webs with 1.2 in the shaft keep all of it, inner ones with 1.5 do not."""
    after = tuple(1.2 if web in OUTER.webs else 1.5 for web in range(1, 9))
    search, stand_in = searches(after, tuple(1.2 for _ in DESIGN), percent={"mass": 90.0})
    alike = search.variant("one", (ALL,))
    search.variant("own", (OUTER, INNER), alike)
    assert asked(stand_in)[1:3] == [(">= 3", set(OUTER.webs)), (">= 2.4", set(INNER.webs))]
    for _, settings, begun in stand_in.asked[1:3]:
        assert {float(one.torque_Nm[0]) for one in settings.loads.histories} <= {1.2, 1.5}
        assert begun.name == "mikron-iiic-web-1-to-8"
        assert not settings.features


def test_a_web_that_falls_short_is_sought_again_under_its_new_loads(searches: Searches) -> None:
    """Its throw alone has 3 where the shaft has 1.0, so that 1.2 in the shaft are 3.6 alone."""
    short = tuple(1.0 if web in OUTER.webs else 1.5 for web in range(1, 9))
    search, stand_in = searches(short, DESIGN, percent={"mass": 90.0, "fatigue_safety": 110.0})
    crank = search.variant("own", (OUTER, INNER)).variant
    assert asked(stand_in)[2:] == [(">= 3.6", {1, 2, 7, 8})]  # the others have enough
    loads = stand_in.asked[2][1].loads
    assert {float(history.torque_Nm[0]) for history in loads.histories} == {1.0}
    assert stand_in.asked[2][2].name == "mikron-iiic-web-1-2-7-8"  # it begins with the web that was found
    assert crank.best_round == 1
    assert [one.safety for one in crank.rounds] == [1.0, 1.2]
    assert crank.design == "own-2/crank.toml"


def test_a_web_that_is_safer_than_its_search_knew_is_sought_again(searches: Searches) -> None:
    search, stand_in = searches(tuple(2.0 for _ in DESIGN), DESIGN, percent={"mass": 90.0})
    search.variant("own", (ALL,))
    assert [settings.features for _, settings, _ in stand_in.asked] == [True, False]
    assert asked(stand_in)[1:] == [(">= 1.8", set(ALL.webs))]  # at its limit, and 1.2 of 2.0 would do


def test_the_nearest_round_counts_where_none_is_safe(searches: Searches) -> None:
    low, lower = tuple(1.1 for _ in DESIGN), tuple(1.0 for _ in DESIGN)
    search, _ = searches(low, lower, percent={"mass": 90.0})
    crank = search.variant("own", (ALL,)).variant
    assert (crank.best_round, crank.held) == (0, False)


def test_an_interrupted_search_goes_on_and_finished_ones_are_read(
    searches: Searches, monkeypatch: pytest.MonkeyPatch
) -> None:
    search, stand_in = searches(tuple(1.2 for _ in DESIGN), percent={"mass": 90.0})

    def ends_in_the_second(*given: Any) -> ShapedRun:
        if stand_in.asked:
            stand_in.error = CranktopoError("interrupted", code=ExitCode.INTERRUPTED)
        return stand_in.design(*given)

    monkeypatch.setattr(shape_run, "shape_design", ends_in_the_second)
    with pytest.raises(CranktopoError, match="interrupted"):
        search.variant("own", (OUTER, INNER))
    stand_in.error = None
    crank = search.variant("own", (OUTER, INNER)).variant
    assert stand_in.asked[2:] == [search.folder / INNER.name]
    assert [one.webs for one in crank.groups] == [OUTER.webs, INNER.webs]


def test_the_shaft_of_a_run_is_read_as_it_was_written() -> None:
    own = told_shaft(DESIGN)
    read = LoadedShaft.of_json(own.as_json())
    assert read.figures == own.figures
    for one, other in zip(own.histories, read.histories, strict=True):
        assert one[0].labels == other[0].labels
        assert np.array_equal(one[0].torque_Nm, other[0].torque_Nm)
