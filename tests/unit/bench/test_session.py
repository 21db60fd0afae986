"""What a page asks of a session and is told: variants, commands, warnings; no process answers here."""

from __future__ import annotations

import asyncio
import runpy
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any
from unittest.mock import AsyncMock, MagicMock

import pytest

pytest.importorskip("tornado")
import cranktopo
from cranktopo import Target
from cranktopo.design.loading import design_text
from cranktopo.tasks.bench.session import Bench

THICKNESS, MAIN = "web.thickness_mm", "throw.main_journal.length_mm"


def asked(folder: Path, *messages: dict[str, Any]) -> list[dict[str, Any]]:
    """Say something to a bench; return all that it tells."""
    bench = Bench(folder)
    told: list[dict[str, Any]] = []

    def shown(data: dict[str, Any], seq: int | None, tell: Any, text: str = "") -> None:
        tell({"type": "live", "seq": seq, "data": data})

    quiet = {"checked": AsyncMock(return_value=[]), "outlines": AsyncMock(return_value=[[[0.0, 1.0]]])}
    bench.answers = MagicMock(known=lambda text: {}, live=shown, **quiet)

    async def talk() -> None:
        bench.open_text(design_text("mikron-iiic-plain"), "mine.toml", "opened", "cranktopo bench mine")
        bench.enter(told.append)
        for message in messages:
            await bench.hear(message, told.append)
        bench.close()

    with ThreadPoolExecutor(1) as pool:  # the thread of a browser's tests has a loop that runs
        pool.submit(asyncio.run, talk()).result()
    assert [message for message in told if message["type"] == "error"] == []
    return told


def test_a_thickness_with_and_without_the_pitch_kept_are_two_variants(tmp_path: Path) -> None:
    """Both steps were typed alike: both variants were named by that alone."""
    edit = {"do": "edit", "changes": {THICKNESS: 21.0}, "what": "thickness: 21 mm"}
    keep = {"do": "keep"}
    told = asked(tmp_path, edit, keep, {"do": "undo"}, {**edit, "keep_pitch": True}, keep)
    project = told[-1]["project"]
    first, second = project["variants"]
    assert (first["name"], second["name"]) == ("variant 1", "variant 2")
    assert first["what"] == f"{THICKNESS}: 19 to 21"
    assert first["outlines"] == [[[0.0, 1.0]]]
    assert MAIN in second["what"]
    assert project["steps"][1]["what"].startswith(f"thickness: 21 mm; {MAIN}: "), "the step says it, too"


def test_a_drag_that_ends_where_it_began_is_no_step(tmp_path: Path) -> None:
    """The page kept waiting for its step: gauges stayed those of the drag, and nothing settled."""
    told = asked(tmp_path, {"do": "edit", "changes": {THICKNESS: 19}, "what": "thickness: 19 mm"})
    (live,) = told
    assert (live["type"], live["seq"], live["data"]["web"]["thickness_mm"]) == ("live", None, 19)


def test_what_is_told_as_commands_runs_in_the_folder(tmp_path: Path) -> None:
    edit = {"do": "edit", "changes": {THICKNESS: 21.0}, "what": "thickness: 21 mm"}
    told = asked(tmp_path, edit, {"do": "save", "name": "own.toml"})
    (made,) = (message for message in told if message["type"] == "made")
    assert made["command"] == "cranktopo designs copy bench/mine/0001.toml own.toml --force"
    project = told[-1]["project"]
    assert project["commands"] == ["cranktopo designs copy bench/mine/0001.toml mine-0001.toml"]
    assert project["made"] == [{"name": "own.toml", "command": made["command"]}], "kept for the next page"
    assert (tmp_path / "bench" / "mine" / "0001.toml").is_file()


def test_two_variants_that_are_compared_are_told_apart_key_by_key(tmp_path: Path) -> None:
    edit = {"do": "edit", "changes": {THICKNESS: 21.0}, "what": "thickness: 21 mm"}
    pins = [{"do": "compare", "id": id_, "pinned": True} for id_ in ("v1", "v2")]
    told = asked(tmp_path, {"do": "keep"}, edit, {"do": "keep"}, *pins)
    compared = told[-1]["project"]["compared"]
    assert compared["words"] == f"variant 2 beside variant 1: {THICKNESS}: 19 to 21"
    assert compared["values"] == {THICKNESS: (19.0, 21.0)}, "each may be taken alone"
    assert told[-2]["project"]["compared"] == {"words": "", "values": {}}


def test_any_step_of_the_history_is_gone_to(tmp_path: Path) -> None:
    edits = [{"do": "edit", "changes": {THICKNESS: mm}, "what": f"{mm}"} for mm in (20.0, 21.0, 22.0)]
    told = asked(tmp_path, *edits, {"do": "go", "to": 1}, {"do": "go", "to": 3}, {"do": "go", "to": 7})
    at = [one["project"]["at"] for one in told if one["type"] == "state"]
    assert at[-3:] == [1, 3, 3], "nothing beyond the last one"


def test_the_script_of_a_session_repeats_its_steps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run as Python with the evaluation left out: every step is loaded, with words that cannot be code."""
    what = 'thickness: 21 mm"); import os #'
    edit = {"do": "edit", "changes": {THICKNESS: 21.0}, "what": what}
    told = asked(
        tmp_path, edit, edit | {"changes": {THICKNESS: 22.0}}, {"do": "undo"}, {"do": "script", "name": "own"}
    )
    assert told[-1]["project"]["made"] == [{"name": "own-steps.py", "command": "python own-steps.py"}]
    seen, written = [], []

    def evaluated(target: Target) -> Any:
        seen.append((target.name, target.scene.web.thickness_mm))
        return MagicMock(throw_kg=1.0, torsion_Nm_per_rad=1.0, bending_N_per_mm=1.0)

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(cranktopo, "evaluate_target", evaluated, raising=False)
    monkeypatch.setattr(cranktopo, "export_solid", lambda *asked: written.append(asked[1:]), raising=False)
    runpy.run_path(str(tmp_path / "own-steps.py"))
    assert seen == [("opened", 19.0), (what, 21.0)]
    assert written == [("throw", "mine-steps.step")]
