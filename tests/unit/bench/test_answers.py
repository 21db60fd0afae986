"""No drag waits for ever: whatever is asked between, its page is told of every one."""

from __future__ import annotations

import asyncio
import random
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

pytest.importorskip("tornado")
from cranktopo.tasks.bench.answers import Answers, Processes
from cranktopo.tasks.bench.workers import Worker


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
