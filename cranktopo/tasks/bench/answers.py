"""The three rings of answers of a bench: live and coarse while a dimension is dragged, settled after."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.tasks.bench.coarse_error import stated_errors
from cranktopo.tasks.bench.live_safety import SettledSafety, estimated_safety, rule_of_fillets
from cranktopo.tasks.bench.workers import AbandonedError, Newest, Worker

Tell = Callable[[dict[str, Any]], None]
Data = dict[str, Any]
_PARTS = {"stiffness", "film", "shaft", "vibration", "safety", "colours"}
"""Of what settles after a release."""
_OF_TORQUE = ("stiffness", "shaft")
_OF_STIFFNESS = (*_OF_TORQUE, "vibration", "film")
"""Parts that the torque of a vibrating shaft needs, and all beside the safety; films near what is permitted
take seconds."""


@dataclass(frozen=True)
class Processes:
    """The processes that answer: exact numbers, the picture, stiffness on cells, settled numbers, safety."""

    live: Worker = field(default_factory=Worker)
    picture: Worker = field(default_factory=Worker)
    coarse: Worker = field(default_factory=lambda: Worker(background=True))
    settled: Worker = field(default_factory=lambda: Worker(background=True))
    safety: Worker = field(default_factory=lambda: Worker(background=True))

    def close(self) -> None:
        """End all of them."""
        for worker in vars(self).values():
            worker.close()


class Answers:
    """Questions to the processes that answer, and what was settled so far, by the text of the design."""

    def __init__(self, tell_all: Tell) -> None:
        self._tell_all = tell_all
        self._workers = Processes()
        self._live, self._coarse = Newest(self._answer_live), Newest(self._answer_coarse)
        self._settle, self._originals = Newest(self._answer_settled), Newest(self._answer_original)
        self._settled: dict[str, dict[str, Any]] = {}
        self._settling: dict[Worker, str] = {}
        self._exact: dict[str, dict[str, float]] = {}
        self._calibrated: tuple[Data, dict[str, float], dict[str, float]] = {}, {}, {}
        self._safety = SettledSafety()
        self._factors: Sequence[float] = ()
        self._now = self._original = ""

    def forget(self) -> None:
        """Forget what was learned of the design that was on the bench."""
        self._calibrated, self._factors, self._safety = ({}, {}, {}), (), SettledSafety()

    def close(self) -> None:
        """End the processes."""
        self._workers.close()

    def live(self, data: Data, seq: int | None, tell: Tell, text: str = "") -> None:
        """Ask for exact numbers and the picture; `seq` is the drag's, None after a release.

        A page sends no drag before it has heard of the last: it is told of one that is passed over.
        """
        passed = self._live.put((data, seq, tell, text))
        if passed is not None and passed[1] is not None:
            passed[2]({"type": "passed", "seq": passed[1]})

    def coarse(self, data: Data, seq: int | None, tell: Tell) -> None:
        """Ask for the stiffness of a drag; nothing before the first stiffness has settled."""
        if self._calibrated[1]:
            self._coarse.put((data, seq, tell))

    def settle(self, data_of: Callable[[str], Data], now: str, original: str) -> None:
        """Ask for the settled numbers of the design, then for those of the original; others are given up."""
        self._now, self._original = now, original
        for worker, text in self._settling.items():
            if text not in (now, original):
                worker.abandon()
        for text in (now, original):
            self._tell_settled(text, self._tell_all)
        self._settle.put((data_of, now, original))

    def original(self, data: Data, text: str, tell: Tell) -> None:
        """Ask for exact numbers and the picture of what gauges are compared with."""
        self._originals.put((data, text, tell))

    async def checked(self, data: Data) -> list[dict[str, str]]:
        """Return the rules that a design breaks, each with its key; none where it is sound."""
        found: list[dict[str, str]] = await self._workers.live.ask("live.violated_rules_of", data)
        return found

    async def proposed(self, name: str, data: Data, *arguments: Any) -> dict[str, Any]:
        """Return changes that a function of `proposals` finds for what is wanted."""
        found: dict[str, Any] = await self._workers.live.ask(f"proposals.{name}", data, *arguments)
        return found

    async def picked(self, data: Data, sight: dict[str, Any]) -> dict[str, Any]:
        """Return what is seen of a design along a line of sight."""
        found: dict[str, Any] = await self._workers.picture.ask("picking.picked", data, sight)
        return found

    async def placed(self, data: Data, kind: str, place: dict[str, Any]) -> dict[str, Any]:
        """Return the change that adds a pocket or a hole at a place of a web face."""
        found: dict[str, Any] = await self._workers.live.ask("placing.placed_pocket", data, kind, place)
        return found

    async def exact(self, data: Data) -> dict[str, float]:
        """Return the exact numbers of a design; none where it is broken."""
        found = await self._workers.live.ask("live.live_numbers", data, self._factors)
        return _known_gauges(found)

    async def outlines(self, data: Data) -> list[Any]:
        """Return the outlines of the web of a design; none where it is broken."""
        try:
            found: list[Any] = await self._workers.live.ask("front_view.web_outlines", data)
        except CranktopoError:
            return []
        return found

    def known(self, text: str) -> dict[str, float]:
        """Return all numbers that are known of a design."""
        return {**self._exact.get(text, {}), **self._settled.get(text, {}).get("gauges", {})}

    def at_rest(self, text: str) -> bool:
        """Tell whether all of a design has settled, and nothing is asked."""
        asked = (self._live, self._coarse, self._settle, self._originals)
        settled = set(self._settled.get(text, {}).get("parts", ()))
        return self._now == text and settled >= _PARTS and not any(one.busy for one in asked)

    async def _answer_live(self, question: tuple[Data, int | None, Tell, str]) -> None:
        data, seq, tell, text = question
        found = await self._live_answer(data, text)
        if "gauges" in found:
            found["safety"] = estimated_safety(self._safety, data, rule_of_fillets(found))
        tell({"type": "live", "seq": seq, **found})

    async def _answer_original(self, question: tuple[Data, str, Tell]) -> None:
        data, text, tell = question
        tell({"type": "original", **await self._live_answer(data, text)})

    async def _live_answer(self, data: Data, text: str) -> dict[str, Any]:
        """Return numbers and picture, made side by side."""
        factors = self._settled.get(text, {}).get("stiffness_factors", self._factors)
        try:
            parts = await asyncio.gather(
                self._workers.live.ask("live.live_numbers", data, factors),
                self._workers.picture.ask("live_picture.live_picture", data),
            )
        except CranktopoError as error:
            return {"broken": [{"key": "", "message": str(error)}]}
        found: dict[str, Any] = {**parts[0], **parts[1]}
        if "broken" in found:
            return {"broken": found["broken"]}
        if text and "gauges" in found:
            self._exact[text] = _known_gauges(found)
            settled = self._settled.get(text, {}).get("gauges", {})
            found["gauges"] |= {name: settled[name] for name in found.get("waiting", ()) if name in settled}
        return found

    async def _answer_coarse(self, question: tuple[Data, int | None, Tell]) -> None:
        data, seq, tell = question
        settled, cells, truth = self._calibrated
        try:
            found = await self._coarse_values(data, settled)
        except CranktopoError:
            return  # the live answer tells what is broken
        changes = {name: value / cells[name] - 1 for name, value in found.items() if name in truth}
        errors = stated_errors(settled, data, {name: 100 * change for name, change in changes.items()})
        gauges = {name: truth[name] * (1 + change) for name, change in changes.items() if name in errors}
        tell({"type": "coarse", "seq": seq, "gauges": gauges, "error_percent": errors})

    async def _coarse_values(self, data: Data, settled: Data) -> dict[str, float]:
        found: dict[str, float] = await self._workers.coarse.ask("coarse.coarse_stiffness", data, settled)
        return found

    async def _answer_settled(self, question: tuple[Callable[[str], Data], str, str]) -> None:
        data_of, now, original = question
        for text in dict.fromkeys((now, original)):
            await self._settle_design(text, data_of(text), now)
            if self._now != now:
                return  # a newer design waits

    async def _settle_design(self, text: str, data: Data, now: str) -> None:
        """Settle stiffness and safety side by side; the colours and some loads need the stiffness."""
        if "shaft" in data:
            await self._settle_parts(_OF_TORQUE, text, data, now)
        await asyncio.gather(
            self._settle_parts(_OF_STIFFNESS, text, data, now), self._settle_part(text, data, "safety", now)
        )
        await self._settle_part(text, data, "colours", now)

    async def _settle_parts(self, parts: Sequence[str], text: str, data: Data, now: str) -> None:
        for part in parts:
            await self._settle_part(text, data, part, now)

    async def _settle_part(self, text: str, data: Data, part: str, now: str) -> None:
        """Have a part settle that has not yet, unless the design has moved on."""
        so_far = self._settled.get(text, {})
        if part in so_far.get("parts", ()) or self._now != now:
            if part == "safety" and text == self._now:  # undone: drags begin here again
                await self._learn_safety(data, so_far)
            return
        throws, gauges = so_far.get("throw_stiffnesses_Nm_per_rad", ()), so_far.get("gauges", {})
        known = {"vibration": (throws,), "safety": (throws,), "colours": (throws, gauges)}.get(part, ())
        worker = self._workers.safety if part in ("safety", "colours") else self._workers.settled
        self._settling[worker] = text
        try:
            found = await worker.ask(f"settled.settled_{part}", data, *known)
        except AbandonedError:  # asks again where the design is wanted after all
            return await self._settle_part(text, data, part, now)
        except CranktopoError as error:
            found = {"gauges": {}, **({"missing": str(error)} if part in ("stiffness", "safety") else {})}
        finally:
            self._settling.pop(worker, None)
        self._keep(text, part, found)
        if text == now and part == "stiffness":
            await self._calibrate(data, found["gauges"])
        if text == now and part == "safety":
            await self._learn_safety(data, found)

    async def _calibrate(self, data: Data, truth: dict[str, float]) -> None:
        """Learn what the cells say of a design that has settled."""
        try:
            coarse = await self._coarse_values(data, data)
        except CranktopoError:
            return
        self._calibrated = data, coarse, truth

    async def _learn_safety(self, data: Data, found: dict[str, Any]) -> None:
        """Learn the safety of a design that has settled, beside what the rule says of it."""
        try:
            numbers = await self._workers.live.ask("live.live_numbers", data, self._factors)
        except CranktopoError:
            return
        elsewhere = found.get("elsewhere", 0.0)
        self._safety = SettledSafety(data, found["gauges"], elsewhere, rule_of_fillets(numbers))

    def _keep(self, text: str, part: str, found: dict[str, Any]) -> None:
        before = self._settled.get(text, {"gauges": {}, "error_percent": {}, "parts": ()})
        joined = {name: {**before[name], **found.get(name, {})} for name in ("gauges", "error_percent")}
        self._settled[text] = {**before, **found, **joined, "parts": (*before["parts"], part)}
        if text == self._now:
            self._factors = found.get("stiffness_factors", self._factors)
        self._tell_settled(text, self._tell_all)

    def _tell_settled(self, text: str, tell: Tell) -> None:
        found = self._settled.get(text)
        for which, settled_text in (("now", self._now), ("original", self._original)):
            if found is not None and text == settled_text:
                tell({"type": "settled", "which": which, **found})


def _known_gauges(found: dict[str, Any]) -> dict[str, float]:
    """Return the gauges of a live answer that may be kept: none that rest on a stiffness in closed form."""
    unsure = found.get("of_stiffness", ()) if found.get("stiffness") == "closed form" else ()
    return {name: value for name, value in found.get("gauges", {}).items() if name not in unsure}
