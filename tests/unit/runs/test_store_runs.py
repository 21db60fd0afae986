"""Run directories: never overwritten, nothing written on bad input, found again, locked while in use."""

from __future__ import annotations

import hashlib
import json
import os
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.runs.destination import locked
from cranktopo.runs.directories import RunStore, check_destination, create_run, list_runs, open_run
from cranktopo.runs.kind import read_result, working_in
from cranktopo.runs.manifest import settings_hash

SCENE = {"name": "demo", "throw": {"radius_mm": 48.0}, "optimise": {"volume_fraction": 0.3}}


def _create(tmp_path: Path, **changes: Any) -> RunStore:
    arguments: dict[str, Any] = {
        "design": "demo",
        "design_toml": "name = 'demo'\n",
        "scene": SCENE,
        "options": {"max_iterations": 5},
        "command": ["cranktopo", "optimise", "demo"],
        "root": tmp_path / "runs",
    }
    return create_run(**{**arguments, **changes})


def _tree(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_new_run_has_its_name_manifest_design_and_log(tmp_path: Path) -> None:
    envelope = tmp_path / "envelope.stl"
    envelope.write_bytes(b"solid")
    run = _create(tmp_path, inputs={"envelope": envelope})
    assert re.fullmatch(r"\d{8}-\d{6}_demo_[0-9a-f]{8}", run.name)
    assert run.name.endswith(settings_hash(SCENE, {"max_iterations": 5})[:8])
    manifest = json.loads((run.path / "manifest.json").read_text())
    assert manifest["scene"] == SCENE
    assert manifest["command"] == ["cranktopo", "optimise", "demo"]
    assert manifest["status"] == "running"
    assert manifest["ended"] is None
    assert manifest["seed"] == 0
    assert manifest["versions"]["numpy"] == np.__version__
    assert manifest["inputs"]["envelope"]["sha256"] == hashlib.sha256(b"solid").hexdigest()
    assert (run.path / "design.toml").read_text() == "name = 'demo'\n"
    assert (run.path / "run.log").read_text().endswith("started: cranktopo optimise demo\n")


def test_settings_hash_ignores_key_order_and_sees_every_value() -> None:
    shuffled = {"optimise": {"volume_fraction": 0.3}, "throw": {"radius_mm": 48.0}, "name": "demo"}
    assert settings_hash(SCENE, {}) == settings_hash(shuffled, {})
    assert settings_hash(SCENE, {}) != settings_hash(SCENE, {"a": 1})
    assert settings_hash(SCENE, {}) != settings_hash({**SCENE, "throw": {"radius_mm": 48.000001}}, {})


def test_same_second_gives_two_runs(tmp_path: Path) -> None:
    first, second, third = (_create(tmp_path) for _ in range(3))
    assert len({first.path, second.path, third.path}) == 3
    assert [
        json.loads((run.path / "manifest.json").read_text())["run"] for run in (first, second, third)
    ] == [
        first.name,
        second.name,
        third.name,
    ]


def test_out_may_be_new_or_empty_but_never_taken(tmp_path: Path) -> None:
    run = _create(tmp_path, out=tmp_path / "deep" / "mine")
    assert run.name == "mine"
    (tmp_path / "empty").mkdir()
    assert _create(tmp_path, out=tmp_path / "empty").path == tmp_path / "empty"
    before = _tree(tmp_path)
    with pytest.raises(CranktopoError, match="not empty; runs are never overwritten"):
        _create(tmp_path, out=run.path)
    (tmp_path / "file").write_text("x")
    with pytest.raises(CranktopoError, match="is a file"):
        _create(tmp_path, out=tmp_path / "file")
    with pytest.raises(CranktopoError, match=r"file' is a file"):
        _create(tmp_path, out=tmp_path / "file" / "below")
    assert _tree(tmp_path) == [*before, "file"]


def test_what_is_interrupted_before_it_has_a_manifest_is_no_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither a folder that cannot be resumed nor one that is in the way of the next try."""

    def interrupted(*_: object) -> None:
        assert [path.name for path in tmp_path.iterdir() if not path.name.startswith(".")] == []
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("cranktopo.runs.directories.write_json", interrupted)
        with pytest.raises(KeyboardInterrupt):
            _create(tmp_path, out=tmp_path / "mine")
    assert _tree(tmp_path) == []
    assert _create(tmp_path, out=tmp_path / "mine").manifest().status == "running"


def test_check_destination_writes_nothing(tmp_path: Path) -> None:
    check_destination(tmp_path / "a" / "b")
    check_destination(None, tmp_path / "runs")
    assert _tree(tmp_path) == []


def test_unwritable_parent_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(CranktopoError, match="is not writable"):
        _create(tmp_path)
    assert _tree(tmp_path) == []


def test_unreadable_input_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(CranktopoError, match=r"absent.stl': cannot be read: No such file"):
        _create(tmp_path, inputs={"envelope": tmp_path / "absent.stl"})
    assert _tree(tmp_path) == []


def test_status_and_resume_are_recorded(tmp_path: Path) -> None:
    run = _create(tmp_path)
    run.set_status("interrupted")
    manifest = run.manifest()
    assert manifest.status == "interrupted"
    assert manifest.ended is not None
    assert manifest.ended >= manifest.started
    (run.path / ".state.99.tmp.npz").write_text("left by a killed process")
    (run.path / "step-01" / ".unfinished-abc.tmp").mkdir(parents=True)
    (run.path / "step-01" / ".unfinished-abc.tmp" / "design.toml").write_text("as well")
    run.resume()
    assert run.manifest().status == "running"
    assert run.manifest().ended is None
    assert len(run.manifest().resumed) == 1
    assert not list(run.path.rglob(".*tmp*"))
    run.set_status("done")
    assert run.manifest().scene == SCENE


def test_history_round_trip_with_columns_that_come_later(tmp_path: Path) -> None:
    run = _create(tmp_path)
    assert run.read_history() == []
    rows = [
        {"iteration": 0, "objective": np.float64(1) / 3, "stage": "grey"},
        {"iteration": 1, "objective": 1e-17, "stage": "sharp", "beta": 2.0},
    ]
    run.write_history(rows)
    assert (run.path / "history.csv").read_text().splitlines()[0] == "iteration,objective,stage,beta"
    assert run.read_history() == rows
    assert isinstance(run.read_history()[1]["iteration"], int)


def test_metrics_round_trip(tmp_path: Path) -> None:
    run = _create(tmp_path)
    assert read_result(run) is None
    run.write_metrics({"greyness": np.float64(0.1)})
    assert read_result(run) == {"greyness": 0.1}


def test_open_by_path_name_and_prefix(tmp_path: Path) -> None:
    root = tmp_path / "runs"
    run, other = _create(tmp_path), _create(tmp_path, scene={**SCENE, "name": "x"}, design="x-demo")
    assert open_run(str(run.path), root) == run
    assert open_run(run.name, root) == run
    assert open_run(other.name[:-3], root) == other
    assert list_runs(root) == sorted([run, other], key=lambda r: r.path)
    with pytest.raises(CranktopoError, match="2 runs begin so"):
        open_run(run.name[:4], root)
    with pytest.raises(CranktopoError, match="no such run"):
        open_run("2031", root)


def test_name_that_begins_another_is_found(tmp_path: Path) -> None:
    first = _create(tmp_path)
    second = first.path.with_name(f"{first.name}-2")
    second.mkdir()
    (second / "manifest.json").write_text((first.path / "manifest.json").read_text())
    assert open_run(first.name, tmp_path / "runs") == first


def test_open_says_why_it_is_no_run(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    with pytest.raises(CranktopoError, match=r"manifest.json is missing"):
        open_run(str(tmp_path / "folder"))
    (tmp_path / "file").write_text("")
    with pytest.raises(CranktopoError, match="a file"):
        open_run(str(tmp_path / "file"))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ('{"schema_version": 1, "run"', "corrupted"),
        ('{"schema_version": 7}', "schema_version 7"),
        (
            '{"schema_version": 1, "run": "a"}',
            "incomplete, design, command, status, started, seed, settings_sha256, versions, .* missing",
        ),
    ],
)
def test_open_refuses_a_broken_manifest(tmp_path: Path, content: str, message: str) -> None:
    run = _create(tmp_path)
    (run.path / "manifest.json").write_text(content)
    with pytest.raises(CranktopoError, match=message):
        open_run(str(run.path))


def test_changed_input_file_is_named(tmp_path: Path) -> None:
    envelope = tmp_path / "envelope.stl"
    envelope.write_bytes(b"solid")
    run = _create(tmp_path, inputs={"envelope": envelope})
    run.require_same_inputs()
    envelope.write_bytes(b"other")
    with pytest.raises(CranktopoError, match=r"envelope.stl' changed since"):
        run.require_same_inputs()


def test_second_process_on_a_run_is_refused(tmp_path: Path) -> None:
    run = _create(tmp_path)
    refused = pytest.raises(CranktopoError, match=rf"in use by process {os.getpid()}\.")
    with locked(run.path), refused, locked(run.path):
        pass
    with locked(run.path):
        pass


def test_a_refused_run_leaves_nothing(tmp_path: Path) -> None:
    run = _create(tmp_path)
    with pytest.raises(CranktopoError, match="impossible"), working_in(run, "nothing"):
        raise CranktopoError("impossible")
    assert not run.path.exists()
    assert _create(tmp_path).path.exists(), "the same command may be given again"


def test_a_search_that_found_nothing_leaves_nothing(tmp_path: Path) -> None:
    run = _create(tmp_path)
    (run.path / "work.json").write_text("{}")
    with pytest.raises(CranktopoError, match="no web"), working_in(run, "nothing"):
        raise CranktopoError("no web", code=ExitCode.CRITERION_NOT_MET)
    assert not run.path.exists()
    run = _create(tmp_path)
    (run.path / "web.toml").write_text("")
    with pytest.raises(CranktopoError, match="no web"), working_in(run, "nothing"):
        raise CranktopoError("no web", code=ExitCode.CRITERION_NOT_MET)
    assert run.manifest().status == "failed", "what it wrote stays"


def test_a_refusal_keeps_what_was_found(tmp_path: Path) -> None:
    run = _create(tmp_path)
    (run.path / "work.json").write_text("{}")
    with pytest.raises(CranktopoError, match="impossible"), working_in(run, "nothing"):
        raise CranktopoError("impossible")
    assert run.manifest().status == "failed"


def test_a_manifest_keeps_its_keys_in_their_order_and_those_of_a_newer_version(tmp_path: Path) -> None:
    run = _create(tmp_path)
    path = run.path / "manifest.json"
    before = json.loads(path.read_text()) | {"later": [1, {"a": None}]}
    path.write_text(json.dumps(before))
    run.set_status("done")
    after = json.loads(path.read_text())
    assert list(after) == list(before)
    assert after | {"status": "running", "ended": None} == before
