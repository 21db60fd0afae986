"""Atomic files and the checkpoint: whole or absent, bit for bit, and clear when broken."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from cranktopo.base import files
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.runs.checkpoint import load_checkpoint, save_checkpoint
from cranktopo.runs.destination import locked
from cranktopo.runs.directories import RunStore

_WRITER = """
import sys
from pathlib import Path
import numpy as np
from cranktopo.runs.checkpoint import save_checkpoint
path = Path(sys.argv[1])
step = 0
while True:
    save_checkpoint(path, {"x": np.full(200_000, float(step))}, {"step": step})
    step += 1
    print(step, flush=True)
"""


def _arrays() -> dict[str, np.ndarray]:
    random = np.random.default_rng(5)
    return {
        "density": random.random((5, 4, 3)),
        "edge": np.array([0.1, -0.0, 5e-324, np.nextafter(1.0, 2.0), np.inf]),
        "mask": np.array([True, False]),
        "steps": np.arange(3, dtype=np.int64),
    }


def test_failed_write_keeps_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    files.write_text(path, "old")

    def interrupted() -> None:
        with files.replacing(path) as temporary:
            temporary.write_text("half of the n")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_a_link_at_the_place_of_a_temporary_file_leads_nowhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another user who guessed the name would choose which file of this one is overwritten."""
    monkeypatch.setattr(files.secrets, "token_hex", lambda _: "guessed")
    victim, path = tmp_path / "victim", tmp_path / "a.txt"
    victim.write_text("kept")
    with files.replacing(path) as temporary:
        temporary.write_text("new")
    temporary.symlink_to(victim)
    with pytest.raises(CranktopoError, match="cannot be written: File exists"):
        files.write_text(path, "newer")
    assert (victim.read_text(), path.read_text()) == ("kept", "new")


@pytest.mark.parametrize("name", [".lock", "run.log"])
def test_a_link_in_a_run_leads_nowhere(tmp_path: Path, name: str) -> None:
    victim = tmp_path / "victim"
    victim.write_text("kept")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / name).symlink_to(victim)

    def used() -> None:
        with locked(tmp_path / "run"):
            RunStore(tmp_path / "run").log("resumed")

    with pytest.raises(CranktopoError, match="cannot be written: Too many levels of symbolic links"):
        used()
    assert victim.read_text() == "kept"


def test_write_replaces_and_leaves_no_temporary(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    files.write_text(path, "old")
    files.write_text(path, "größer")
    assert path.read_text(encoding="utf-8") == "größer"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_unwritable_output_says_what_and_what_next(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(CranktopoError) as caught:
        files.write_bytes(tmp_path / "file" / "x.bin", b"")
    assert "cannot be written: Not a directory" in caught.value.message
    assert "--out" in caught.value.hint
    with pytest.raises(CranktopoError, match="No such file"):
        files.write_npz(tmp_path / "absent" / "x.npz", {"a": np.zeros(1)})


def test_json_takes_numpy_values_and_keeps_doubles(tmp_path: Path) -> None:
    third = np.float64(1) / 3
    data = {
        "a": third,
        "b": np.int32(4),
        "c": np.array([[1.5, third]]),
        "d": np.bool_(True),
        "p": Path("x/y"),
    }
    files.write_json(tmp_path / "m.json", data)
    back = files.read_json(tmp_path / "m.json")
    assert back == {"a": 1 / 3, "b": 4, "c": [[1.5, 1 / 3]], "d": True, "p": "x/y"}
    assert list(back) == list(data)


@pytest.mark.parametrize("value", [float("nan"), np.float32("inf"), np.array([1.0, -np.inf])])
def test_json_refuses_what_is_not_finite_and_names_it(tmp_path: Path, value: object) -> None:
    with pytest.raises(CranktopoError, match=r"m.json: cases\[1\].stiffness.* = -?(nan|inf)") as caught:
        files.write_json(tmp_path / "m.json", {"cases": [{"stiffness": 1.0}, {"stiffness": value}]})
    assert caught.value.code == ExitCode.SOLVER
    assert os.listdir(tmp_path) == []


def test_read_json_tells_missing_from_corrupted(tmp_path: Path) -> None:
    with pytest.raises(CranktopoError, match="no such file"):
        files.read_json(tmp_path / "m.json")
    (tmp_path / "m.json").write_text('{"a": ')
    with pytest.raises(CranktopoError, match="corrupted"):
        files.read_json(tmp_path / "m.json")
    (tmp_path / "m.json").write_text("[1]")
    with pytest.raises(CranktopoError, match="not a JSON object"):
        files.read_json(tmp_path / "m.json")


def test_checkpoint_is_bit_for_bit(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint" / "state.npz"
    state = {"iteration": 7, "objective": 0.1 + 0.2, "notes": ["a"], "best": None}
    save_checkpoint(path, _arrays(), state)
    loaded = load_checkpoint(path)
    assert loaded.state == state
    assert loaded.arrays.keys() == _arrays().keys()
    for name, array in _arrays().items():
        assert loaded.arrays[name].dtype == array.dtype
        assert loaded.arrays[name].shape == array.shape
        assert loaded.arrays[name].tobytes() == array.tobytes()


def test_checkpoint_keeps_fortran_order_and_scalars_right(tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    array = np.asfortranarray(np.arange(6.0).reshape(2, 3))
    save_checkpoint(path, {"a": array, "s": np.array(2.5)}, {})
    loaded = load_checkpoint(path)
    np.testing.assert_array_equal(loaded.arrays["a"], array)
    assert float(loaded.arrays["s"]) == 2.5


def test_checkpoint_says_what_is_missing(tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    with pytest.raises(CranktopoError, match="missing: the run stopped before its first checkpoint"):
        load_checkpoint(path)
    save_checkpoint(path, {"density": np.zeros(2)}, {})
    np.savez(path, density=np.zeros(2))
    with pytest.raises(CranktopoError, match="incomplete, __state__ missing"):
        load_checkpoint(path)


def test_every_flipped_byte_is_noticed(tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    save_checkpoint(path, {"density": np.linspace(0, 1, 50)}, {"iteration": 3})
    good = path.read_bytes()
    reference = load_checkpoint(path)
    noticed = 0
    for place in range(0, len(good), 5):
        path.write_bytes(good[:place] + bytes([good[place] ^ 0x10]) + good[place + 1 :])
        try:
            loaded = load_checkpoint(path)
        except CranktopoError:
            noticed += 1
        else:  # bytes of the container that carry nothing (dates, attributes)
            assert loaded.state == reference.state
            np.testing.assert_array_equal(loaded.arrays["density"], reference.arrays["density"])
    assert noticed > 0.5 * len(good) / 5


@pytest.mark.parametrize("keep", [0, 1, 100, 0.5, 0.99])
def test_truncated_checkpoint_is_refused(tmp_path: Path, keep: float) -> None:
    path = tmp_path / "c.npz"
    save_checkpoint(path, {"density": np.zeros(500)}, {})
    content = path.read_bytes()
    path.write_bytes(content[: int(keep * len(content)) if keep < 1 else int(keep)])
    with pytest.raises(CranktopoError, match="corrupted"):
        load_checkpoint(path)


def test_checkpoint_of_another_version_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "c.npz"
    monkeypatch.setattr("cranktopo.runs.checkpoint.SCHEMA_VERSION", 99)
    save_checkpoint(path, {}, {})
    monkeypatch.undo()
    with pytest.raises(CranktopoError, match="schema_version 99"):
        load_checkpoint(path)


def test_checkpoint_refuses_state_that_is_not_finite(tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    save_checkpoint(path, {}, {"iteration": 1})
    with pytest.raises(CranktopoError, match=r"state\.best = inf"):
        save_checkpoint(path, {}, {"best": float("inf")})
    assert load_checkpoint(path).state == {"iteration": 1}


def test_killed_writer_leaves_a_valid_checkpoint(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint" / "state.npz"
    for pause in (0.0, 0.003, 0.011):
        process = subprocess.Popen(
            [sys.executable, "-c", _WRITER, str(path)], stdout=subprocess.PIPE, text=True
        )
        assert process.stdout is not None
        for _ in range(3):
            process.stdout.readline()
        time.sleep(pause)
        process.send_signal(signal.SIGKILL)
        process.wait()
        process.stdout.close()
        loaded = load_checkpoint(path)
        assert loaded.state["step"] >= 2
        np.testing.assert_array_equal(loaded.arrays["x"], np.full(200_000, float(loaded.state["step"])))


def test_state_is_plain_json_inside(tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    save_checkpoint(path, {}, {"iteration": np.int64(3)})
    with np.load(path) as file:
        saved = json.loads(file["__state__"].tobytes())
    assert saved == {"schema_version": 1, "state": {"iteration": 3}}


def test_a_planted_link_is_not_followed(tmp_path: Path) -> None:
    """At the name that temporary files had once, with the number of the process in it."""
    victim = tmp_path / "victim"
    victim.write_text("mine")
    (tmp_path / f".result.{os.getpid()}.tmp.json").symlink_to(victim)
    files.write_json(tmp_path / "result.json", {"a": 1})
    assert victim.read_text() == "mine"
    assert json.loads((tmp_path / "result.json").read_text()) == {"a": 1}
