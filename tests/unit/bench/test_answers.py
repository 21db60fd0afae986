"""No drag waits for ever: whatever is asked between, its page is told of every one."""

from __future__ import annotations

import asyncio
import random
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

pytest.importorskip("tornado")
from cranktopo.tasks.bench.answers import Answers, Processes
from cranktopo.tasks.bench.workers import AbandonedError, Worker


class SlowWorker(Worker):
    """A process that takes as long as it is told, in turns of the loop."""

    def __init__(self, turns: list[int]) -> None:
        super().__init__()
        self.turns = turns

    async def ask(self, function: str, *asked: Any) -> Any:
        for _ in range(self.turns.pop()):
            await asyncio.sleep(0)
        return {"gauges": {"mass": asked[0]["step"]}}


def told(asked: list[tuple[int | None, int]], turns: list[int]) -> list[dict[str, Any]]:
    """Ask for live answers, each after some turns of the loop; return all that is told, to the end."""
    found: list[dict[str, Any]] = []

    async def talk() -> None:
        answers = Answers(found.append)
        slow = SlowWorker(turns)
        answers._workers = Processes(live=slow, picture=slow)
        for step, (seq, pause) in enumerate(asked):
            answers.live({"step": step}, seq, found.append)
            for _ in range(pause):
                await asyncio.sleep(0)
        while answers._live.busy:
            await asyncio.sleep(0)

    with ThreadPoolExecutor(1) as pool:  # the thread of a browser's tests has a loop that runs
        pool.submit(asyncio.run, talk()).result()
    return found


def test_a_drag_that_a_step_overtakes_is_told_as_passed_over() -> None:
    """The page waited for it, and no drag was sent any more until the page was loaded again."""
    found = told([(None, 1), (1, 0), (None, 0)], [20] * 6)
    assert [(one["type"], one["seq"]) for one in found] == [("passed", 1), ("live", None), ("live", None)]
    assert [one["gauges"]["mass"] for one in found[1:]] == [0, 2], "the newest is answered"


@pytest.mark.parametrize("seed", range(30))
def test_every_drag_has_one_answer(seed: int) -> None:
    dice = random.Random(seed)
    seqs = [number if dice.random() < 0.7 else None for number in range(1, 40)]
    asked = [(seq, dice.randrange(12)) for seq in seqs]
    found = told(asked, [dice.randrange(12) for _ in range(2 * len(asked))])
    of_drags = sorted(one["seq"] for one in found if one["seq"] is not None)
    assert of_drags == [seq for seq in seqs if seq is not None]
    assert found[-1]["gauges"]["mass"] == len(asked) - 1, "the last word is the newest question's"


class SettlingWorker(Worker):
    """A process that settles a part as soon as it is let."""

    def __init__(self, asked: list[str], let: dict[str, asyncio.Event], found: dict[str, Any]) -> None:
        super().__init__()
        self.asked, self.let, self.found = asked, let, found
        self.given_up = asyncio.Event()

    def abandon(self) -> None:
        self.given_up.set()

    async def ask(self, function: str, *arguments: Any) -> Any:
        name = function.partition(".")[2]
        self.asked.append(name)
        if name in self.let:
            ways = [asyncio.ensure_future(way.wait()) for way in (self.let[name], self.given_up)]
            await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
            for way in ways:
                way.cancel()
        if self.given_up.is_set():
            self.given_up.clear()
            raise AbandonedError
        return {"gauges": {}, **self.found.get(name, {})}


def settling(data: dict[str, Any], release: list[str], found: dict[str, Any]) -> list[list[str]]:
    """Settle a design; return what was asked before each part was let end."""
    asked, seen = list[str](), list[list[str]]()

    async def talk() -> None:
        answers = Answers(lambda message: None)
        let = {name: asyncio.Event() for name in release}
        names = ("live", "coarse", "settled", "safety")
        answers._workers = Processes(**{name: SettlingWorker(asked, let, found) for name in names})
        answers.settle(lambda text: data, "now", "now")
        for name in release:
            for _ in range(20):
                await asyncio.sleep(0)
            seen.append([one for one in asked if one.startswith("settled")])
            let[name].set()
        while answers._settle.busy:
            await asyncio.sleep(0)
        assert answers.at_rest("now")

    with ThreadPoolExecutor(1) as pool:
        pool.submit(asyncio.run, talk()).result()
    return [*seen, [one for one in asked if one.startswith("settled")]]


def test_safety_settles_beside_the_stiffness_and_colours_after_both() -> None:
    first, second, last = settling({}, ["settled_stiffness", "settled_safety"], {})
    assert first == ["settled_stiffness", "settled_safety"]
    assert second == [*first, "settled_shaft", "settled_vibration", "settled_film"], (
        "the safety takes longest"
    )
    assert last == [*second, "settled_colours"]


def test_safety_waits_for_the_stiffness_of_a_vibrating_shaft() -> None:
    *_, before, last = settling({"shaft": {}}, ["settled_stiffness", "settled_shaft"], {})
    assert before == ["settled_stiffness", "settled_shaft"]
    beside = ["settled_vibration", "settled_safety", "settled_film"]
    assert sorted(last[:-1]) == sorted([*before, *beside])
    assert last[-1] == "settled_colours"


@pytest.mark.parametrize(("at_work", "moved_to"), [("first", "second"), ("original", "second")])
def test_a_design_that_was_left_is_given_up_but_not_the_original(at_work: str, moved_to: str) -> None:
    told = list[dict[str, Any]]()

    async def talk() -> None:
        answers = Answers(told.append)
        let, asked = {"settled_safety": asyncio.Event()}, list[str]()
        names = ("live", "coarse", "settled", "safety")
        answers._workers = Processes(**{name: SettlingWorker(asked, let, {}) for name in names})
        answers.settle(lambda text: {}, at_work, "original")
        await _turns()
        answers.settle(lambda text: {}, moved_to, "original")
        await _turns()
        if at_work == "original":
            assert "safety" not in answers._settled["original"]["parts"], "it goes on"
        let["settled_safety"].set()
        while answers._settle.busy:
            await asyncio.sleep(0)
        assert asked.count("settled_safety") == (3 if at_work == "first" else 2)
        assert ("safety" in answers._settled[at_work]["parts"]) == (at_work == "original")
        assert answers.at_rest(moved_to)

    with ThreadPoolExecutor(1) as pool:
        pool.submit(asyncio.run, talk()).result()


async def _turns() -> None:
    for _ in range(30):
        await asyncio.sleep(0)


def test_a_drag_after_an_undo_begins_at_the_design_in_hand() -> None:
    """What was settled last was another web: its safety would be carried on from too far away."""
    rule = {"gauges": {"m53_pin": 1.3, "m53_journal": 1.6}}
    safety = {"gauges": {"pin_fillet_safety": 1.1, "journal_fillet_safety": 1.3}, "elsewhere": 1.4}
    found = {"live_numbers": rule, "live_picture": rule, "settled_safety": safety}
    journals = {name: {"outer_diameter_mm": 42.0} for name in ("main_journal", "crankpin")}
    drags = list[dict[str, Any]]()

    async def talk() -> None:
        answers = Answers(lambda message: None)
        names = ("live", "picture", "coarse", "settled", "safety")
        answers._workers = Processes(**{name: SettlingWorker([], {}, found) for name in names})
        for text, width in (("narrow", 50), ("wide", 58), ("narrow", 50)):
            data = {"web": {"width_mm": width}, "throw": journals}
            answers.settle(dict.fromkeys((text,), data).__getitem__, text, text)
            while answers._settle.busy:
                await asyncio.sleep(0)
        answers.live({"web": {"width_mm": 51}, "throw": journals}, 1, drags.append)
        while answers._live.busy:
            await asyncio.sleep(0)

    with ThreadPoolExecutor(1) as pool:
        pool.submit(asyncio.run, talk()).result()
    (told,) = drags
    assert told["safety"]["gauges"]["pin_fillet_safety"] == 1.1
    assert told["safety"]["error_percent"]["pin_fillet_safety"] < 3.0
