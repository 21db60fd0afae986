"""The throws of an imported crank: which half throws each has, and those that differ as designs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from cranktopo.design.halves import mirror_image
from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.alike import alike, dumped
from cranktopo.tasks.crank_import.found_crank import FoundCrank
from cranktopo.tasks.crank_import.web_reading import ImportedWeb
from cranktopo.throw.journal import FilletSection

Throws = Sequence[tuple[Scene, Scene]]
"""Of each throw from the low end the designs of its first and its second half."""


def throws_of(webs: Sequence[ImportedWeb], crank: FoundCrank) -> tuple[tuple[Scene, Scene], ...]:
    """Return the designs of both half throws of every throw, low end first, as a design has them.

    Empty where a throw lacks one of them: of a half throw, or beside a flying web.
    """
    found: dict[tuple[int, bool], Scene] = {}
    for web in webs:
        for half in web.body.others:
            turned = half in web.body.mirrored
            # A design's second web is the mirror image of its half throw, which is cut as it is.
            image = turned == (half.toward > 0)
            found[half.throw, half.toward > 0] = mirror_image(web.read.scene) if image else web.read.scene
    numbers = range(1, len(crank.pins) + 1)
    if not all((number, low) in found for number in numbers for low in (True, False)):
        return ()
    return tuple((found[number, True], found[number, False]) for number in numbers)


def second_body(webs: Sequence[ImportedWeb], crank: FoundCrank) -> str | None:
    """Return the file of the second half of every throw, where the first distinct half is the first of all.

    None where it is the same one, or no mirror image of itself: a design describes it as its mirror image.
    """
    groups = {(half.throw, half.toward > 0): web for web in webs for half in web.body.others}
    numbers = range(1, len(crank.pins) + 1)
    firsts, seconds = ([groups.get((number, low)) for number in numbers] for low in (True, False))
    if any(one is not webs[0] for one in firsts) or any(one is not seconds[0] for one in seconds):
        return None
    other = seconds[0]
    if (
        other is None
        or other is webs[0]
        or not alike(dumped(other.read.scene), dumped(mirror_image(other.read.scene)))
    ):
        return None
    return other.body.file


def different(throws: Throws) -> list[int]:
    """Return of each throw the index of the first one that is alike, but for its main journals."""
    return [next(i for i, one in enumerate(throws) if alike(_parts(one), _parts(own))) for own in throws]


def uneven(throws: Throws) -> bool:
    """Tell whether a throw differs from another one, or its two webs from each other."""
    return any(different(throws)) or any("second_web" in throw_keys(*throw) for throw in throws[:1])


def throw_keys(first: Scene, second: Scene) -> dict[str, Any]:
    """Return the tables `throw`, `web` and, where it differs, `second_web` of a throw of two half throws."""
    throw, web = dumped(first.throw), dumped(first.web)
    length = second.throw.crankpin.length_mm
    if not alike(length, first.throw.crankpin.length_mm):
        throw["second_crankpin_length_mm"] = length
    one, other = (dumped(scene.throw).get("drilling", []) for scene in (first, second))
    if not alike(one, other):
        throw["drilling"] = [{**own, "web": "first"} for own in one] + [
            {**own, "web": "second"} for own in other
        ]
    beyond = dumped(second.web)
    return {"throw": throw, "web": web} | ({} if alike(web, beyond) else {"second_web": beyond})


def fillets_of(throws: Throws, number: int) -> list[FilletSection]:
    """Return the fillets of a main journal to the webs beside it, by its number from the low end."""
    beside = [throws[number - 1][1]] if 0 < number <= len(throws) else []
    beside += [throws[number][0]] if number < len(throws) else []
    return [scene.throw.main_journal.fillet for scene in beside]


def unsaid(throws: Throws) -> Iterator[str]:
    """Yield, in words, what of the throws no design of a crank says."""
    radius = throws[0][0].throw.radius_mm if throws else 0.0
    for number, (first, second) in enumerate(throws, 1):
        if not alike(_pin(first), _pin(second)):
            yield f"throw {number}: its crankpin differs at its two webs; that at the first is in the design"
        if not alike(first.throw.radius_mm, radius):
            yield f"throw {number}: its throw radius differs from the first one's, which is in the design"
    for number in range(len(throws) + 1) if throws else ():
        found = fillets_of(throws, number)
        shapes = {(one.flattening, one.recess_mm) for one in (*found, *fillets_of(throws, 0))}
        if len(shapes) > 1 or not alike(found[0].radial_mm, found[-1].radial_mm):
            yield f"main journal {number}: its fillets differ, which no design says; one of them is taken"


def _parts(throw: tuple[Scene, Scene]) -> Any:
    return [(dumped(one.web), dumped(one.throw.crankpin), dumped(one.throw).get("drilling")) for one in throw]


def _pin(scene: Scene) -> dict[str, Any]:
    return {key: value for key, value in dumped(scene.throw.crankpin).items() if key != "length_mm"}
