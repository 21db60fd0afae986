"""Run directories that were damaged, edited or made to harm: one line each, nothing unpacked."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import inside, read_json, write_npz, write_text
from cranktopo.base.progress import StageCache
from cranktopo.runs.checkpoint import load_checkpoint, load_iteration, saved_iterations
from cranktopo.runs.directories import RunStore, create_run
from cranktopo.runs.kind import read_result, result_file, resume_command, working_in
from cranktopo.runs.manifest import file_hash
from cranktopo.tasks.optimise.run_record import read_run_stress
from cranktopo.tasks.sweep.result import SweepFiles


@pytest.fixture
def run(tmp_path: Path) -> RunStore:
    return create_run(
        design="demo",
        design_toml="",
        scene={"name": "demo", "throw": {"radius_mm": 48.0}},
        options={},
        command=["cranktopo", "optimise"],
        root=tmp_path / "runs",
    )


def bomb(path: Path, size_MiB: int) -> None:
    """A small .npz whose one array unpacks to many zeros."""
    path.parent.mkdir(exist_ok=True)
    header = np.lib.format.header_data_from_array_1_0(np.zeros(0)) | {"shape": (size_MiB * 2**17,)}
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as packed,
        packed.open("x.npy", "w", force_zip64=True) as member,
    ):
        np.lib.format.write_array_header_1_0(member, header)
        for _ in range(size_MiB):
            member.write(bytes(2**20))


def test_archives_that_unpack_to_more_than_a_run_holds(
    run: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cranktopo.base.files.ARRAYS_LIMIT_MIB", 64)
    for path in (run.checkpoint, run.path / "density" / "iteration-0001.npz"):
        bomb(path, 128)
        assert path.stat().st_size < 2e6
    with pytest.raises(CranktopoError, match="unpacks to 128 MiB"):
        load_checkpoint(run.checkpoint)
    with pytest.raises(CranktopoError, match="unpacks to 128 MiB"):
        load_iteration(run.path, 1)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("scene", {"name": "demo", "throw": {"radius_mm": 49.0}}, "changed by hand"),
        ("options", {"max_iterations": 3}, "changed by hand"),
        ("scene", "x", "damaged, scene not as written"),
        ("options", None, "damaged, options not as written"),
        ("command", [1], "damaged, command not as written"),
        ("inputs", {"a": {"path": 1}}, "damaged, inputs not as written"),
        ("status", 3, "damaged, status not as written"),
        ("status", "done\x1b[2J", "damaged, status not as written"),
    ],
)
def test_an_edited_manifest(run: RunStore, key: str, value: Any, message: str) -> None:
    path = run.path / "manifest.json"
    run.manifest()
    path.write_text(json.dumps({**json.loads(path.read_text()), key: value}))
    with pytest.raises(CranktopoError, match=message):
        run.manifest()


@pytest.mark.parametrize(
    "content",
    [
        b"[" * 100_000,
        b'{"a": NaN}',
        b'{"a": ' + b"9" * 5000 + b"}",
        b'{"a": [' + b"9" * 400 + b"]}",
        b'{"a": 1e999}',
        b"\xff",
        b"",
    ],
)
def test_json_that_is_none(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x.json").write_bytes(content)
    with pytest.raises(CranktopoError, match=r"x.json'.*(corrupted|not text)"):
        read_json(tmp_path / "x.json")


def test_files_of_other_names_among_the_iterations(run: RunStore) -> None:
    (run.path / "density").mkdir()
    for name in ("iteration-0007.npz", "iteration-x.npz", "iteration-²3.npz"):
        (run.path / "density" / name).touch()
    assert saved_iterations(run.path) == [7]


def test_one_damaged_run_does_not_hide_the_others(run: RunStore, capsys: pytest.CaptureFixture[str]) -> None:
    (run.path / "metrics.json").write_text("{}")
    root = str(run.path.parent)
    assert main(["runs", "list", "--root", root, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["result"] == "unreadable"
    assert main(["runs", "show", run.name, "--root", root]) == 3
    assert "its results are damaged" in capsys.readouterr().err


def test_a_result_that_was_changed_since_the_run_wrote_it(
    run: RunStore, capsys: pytest.CaptureFixture[str]
) -> None:
    """A valid file with another number in it was told as the run's own."""
    with working_in(run, "nothing is kept"):
        run.write_metrics({"mass_kg": 1.47})
    assert read_result(run) == {"mass_kg": 1.47}
    run.write_metrics({"mass_kg": 0.5})
    for read in (read_result, result_file):
        with pytest.raises(CranktopoError, match=r"metrics.json': changed since the run wrote it") as raised:
            read(run)
        assert raised.value.code == ExitCode.INVALID_INPUT
    assert main(["report", str(run.path)]) == ExitCode.INVALID_INPUT
    assert "changed since the run wrote it" in capsys.readouterr().err
    run.resume()
    assert read_result(run) == {"mass_kg": 0.5}, "a run that goes on writes another one"


def test_a_web_that_was_changed_since_the_run_wrote_it(run: RunStore) -> None:
    with working_in(run, "nothing is kept"):
        (run.path / "web.stl").write_bytes(b"solid")
    assert run.unchanged("web.stl") == run.path / "web.stl"
    assert run.unchanged("web.toml") == run.path / "web.toml", "it never had one"
    (run.path / "web.stl").write_bytes(b"other")
    with pytest.raises(CranktopoError, match=r"web.stl': changed since the run wrote it"):
        run.unchanged("web.stl")


def test_a_device_or_pipe_is_never_replaced_by_a_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "device").symlink_to("/dev/full")
    for name in ("pipe", "device"):
        with pytest.raises(CranktopoError, match="cannot be written: it exists and is no regular file"):
            write_text(tmp_path / name, "x")
    assert (tmp_path / "pipe").is_fifo()
    assert (tmp_path / "device").is_symlink()


def test_the_command_that_resumes_is_quoted_for_the_shell(run: RunStore, tmp_path: Path) -> None:
    moved = run.path.rename(tmp_path / "my run; ls")
    assert shlex.split(resume_command(RunStore(moved))) == ["cranktopo", "optimise", "--resume", str(moved)]


@pytest.mark.parametrize("name", ["/etc/passwd", "../other/web.toml", "a/../../b", "", "a\nb"])
def test_a_stored_name_that_leads_out_of_its_folder(tmp_path: Path, name: str) -> None:
    with pytest.raises(CranktopoError, match="which is no file in it"):
        inside(tmp_path, name)
    with pytest.raises(CranktopoError, match=r"table: .*leads out of its folder"):
        SweepFiles.of_json({"table": name, "parquet": "a", "page": "b"}, "run 'x'")
    assert inside(tmp_path, "points/a/web.toml") == tmp_path / "points" / "a" / "web.toml"


@pytest.mark.parametrize("kind", ["pipe", "device", "folder"])
def test_only_files_are_hashed(tmp_path: Path, kind: str) -> None:
    """A pipe that nobody writes to, or a device without an end, would be read for ever."""
    path = tmp_path / kind
    {"pipe": os.mkfifo, "device": lambda p: p.symlink_to("/dev/zero"), "folder": Path.mkdir}[kind](path)
    with pytest.raises(CranktopoError, match=f"is a {kind}, not a file"):
        file_hash(path)


def test_stresses_that_unpack_to_more_than_a_run_holds(
    run: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cranktopo.base.files.ARRAYS_LIMIT_MIB", 64)
    bomb(run.path / "stress.npz", 128)
    with pytest.raises(CranktopoError, match="unpacks to 128 MiB"):
        read_run_stress(run, "web.stl")
    for about in ("{}", "[" * 10**5):
        write_npz(run.path / "stress.npz", {"about": np.array(about)})
        with pytest.raises(CranktopoError, match="corrupted, holds no stresses"):
            read_run_stress(run, "web.stl")


def test_escapes_of_a_manifest_do_not_reach_the_terminal(run: RunStore, tmp_path: Path) -> None:
    path = run.path / "manifest.json"
    path.write_text(
        json.dumps({**json.loads(path.read_text()), "command": ["cranktopo", "\x1b]0;x\x07", "a\x9bb"]})
    )
    done = subprocess.run(
        [sys.executable, "-c", "from cranktopo.app.main import main; main()", "runs", "show", str(run.path)],
        capture_output=True,
        text=True,
        check=True,
    )
    assert r"cranktopo \x1b]0;x\x07 a\x9bb" in done.stdout


def test_damaged_parts_of_a_work_are_done_again(tmp_path: Path) -> None:
    path = tmp_path / "work.json"
    kept = StageCache(path)
    kept["a"], kept["b"] = {"x": (1.0, 2)}, {"y": "é"}
    assert dict(StageCache(path)) == {"a": {"x": [1.0, 2]}, "b": {"y": "é"}}
    path.write_text(path.read_text().replace("1.0", "1.5"))
    assert dict(StageCache(path)) == {"b": {"y": "é"}}
    for content in ("{", '{"a": 1}', '{"a": {}}', '{"a": {"result": 1e999}}'):
        path.write_text(content)
        assert dict(StageCache(path)) == {}
