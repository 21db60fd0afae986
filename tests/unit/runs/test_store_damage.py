"""Run directories that were damaged, edited or made to harm: one line each, nothing unpacked."""

from __future__ import annotations

import json
import os
import shlex
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import read_json, write_text
from cranktopo.runs.checkpoint import load_checkpoint, load_iteration, saved_iterations
from cranktopo.runs.directories import RunStore, create_run
from cranktopo.runs.kind import resume_command


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
    ],
)
def test_an_edited_manifest(run: RunStore, key: str, value: Any, message: str) -> None:
    path = run.path / "manifest.json"
    run.manifest()
    path.write_text(json.dumps({**json.loads(path.read_text()), key: value}))
    with pytest.raises(CranktopoError, match=message):
        run.manifest()


@pytest.mark.parametrize(
    "content", [b"[" * 100_000, b'{"a": NaN}', b'{"a": ' + b"9" * 5000 + b"}", b"\xff", b""]
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
