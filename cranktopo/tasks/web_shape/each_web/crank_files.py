"""One design of a whole crank whose webs differ: its own file, and one for each further throw."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from cranktopo.design.crank import OWN_THROW, Crank
from cranktopo.design.crank_throws import throw_count
from cranktopo.design.free_dimensions import with_counterweight_ranges
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.runs.stored import write_recorded
from cranktopo.throw.web import WebTable

MAIN = "crank.toml"


def write_crank(scene: Scene, webs: Mapping[int, WebTable], folder: Path, heading: str) -> tuple[str, ...]:
    """Write the design with its own web at each place, by number from the free end; return the files' names.

    The first throw is the design's own, so that the main file alone is a design of that throw.

    Raises:
        CranktopoError: webs that do not go together on a crank.
    """
    every = [_with_webs(scene, web, web) for web in dict.fromkeys(webs.values())]
    scene = with_counterweight_ranges(scene, scene, every)
    throws = [(webs[2 * index + 1], webs[2 * index + 2]) for index in range(throw_count(scene))]
    different = list(dict.fromkeys(throws))
    names = [OWN_THROW, *(f"throw-{throws.index(pair) + 1}.toml" for pair in different[1:])]
    for name, pair in zip(names[1:], different[1:], strict=True):
        write_recorded(folder / name, toml_text(_with_webs(scene, *pair), f"{heading} One of its throws."))
    order = tuple(names[different.index(pair)] for pair in throws)
    crank = (scene.crank or Crank()).model_copy(update={"throws": order if len(different) > 1 else ()})
    main = _with_webs(scene, *throws[0])
    if crank != Crank():
        main = main.model_copy(update={"crank": crank})
    write_recorded(folder / MAIN, toml_text(main, heading))
    load_scene(str(folder / MAIN), whole=True)
    return (MAIN, *names[1:])


def _with_webs(scene: Scene, first: WebTable, second: WebTable) -> Scene:
    update = {"web": first, "second_web": None if second == first else second, "crank": None}
    return scene.model_copy(update={**update, "published": None, "original": None})
