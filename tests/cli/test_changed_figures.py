"""One figure of a stored file changed, its shape kept: every command that reads it refuses it in one line."""

from __future__ import annotations

import io
import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import redirected
from cranktopo.base.seals import read_arrays, write_arrays
from cranktopo.design.loading import stored_scene
from cranktopo.runs.stored import unchanged, write_recorded
from cranktopo.tasks.throw_fea.studies import EVALUATION, load_study
from tests.hostile.undamaged import CACHE, DESIGN, made

Capture = pytest.CaptureFixture[str]
_FIGURE = re.compile(rb"(\d\.\d*?)([1-8])(?=\d*[^\d.])")


def one_figure(content: bytes, key: bytes) -> bytes:
    """Text with one digit of the first number behind a key changed."""
    found = _FIGURE.search(content, content.index(key) + len(key))
    assert found
    return content[: found.start(2)] + b"%d" % (int(found[2]) + 1) + content[found.end(2) :]


def one_value(content: bytes, key: bytes) -> bytes:
    """Arrays with one value of one of them changed, all else as it was."""
    with np.load(io.BytesIO(content)) as file:
        arrays = dict(file)
    array = arrays[key.decode()].copy()
    array.flat[array.size // 2] *= 0.75
    packed = io.BytesIO()
    np.savez(packed, **{**arrays, key.decode(): array})
    return packed.getvalue()


def one_facet(content: bytes, key: bytes) -> bytes:
    """Binary STL with one coordinate moved by some per cent."""
    triangles = bytearray(content)
    triangles[84 + 50 * 30 + 14] ^= 1 << 6
    return bytes(triangles)


def change(path: Path, key: str) -> None:
    how = {".npz": one_value, ".stl": one_facet}.get(path.suffix, one_figure)
    content = path.read_bytes()
    path.write_bytes(how(content, key.encode()))
    assert path.read_bytes() != content
    assert len(path.read_bytes()) == len(content) or path.suffix == ".npz"


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Folder with the sound files of a kind, made once."""
    folders: dict[str, Path] = {}

    def of(kind: str) -> Path:
        if kind not in folders:
            folders[kind] = tmp_path_factory.mktemp(kind)
            made(kind, folders[kind])
        return folders[kind]

    return of


@pytest.fixture
def copied(
    stored: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[[str], Path]:
    """Folder with a copy of the sound files of a kind, which commands then work in."""

    def of(kind: str) -> Path:
        shutil.copytree(stored(kind), tmp_path, dirs_exist_ok=True)
        monkeypatch.chdir(tmp_path)
        return tmp_path

    return of


SLOW = pytest.mark.slow
CHANGES = [
    ("iterate", "run/step-01/step.json", '"torsion_Nm_per_rad"', ["report run", "iterate --resume run"]),
    ("iterate", "run/original/step.json", '"throw_kg"', ["report run", "iterate --resume run"]),
    ("iterate", "run/step-02/web_only.stl", "", ["report run", "iterate --resume run"]),
    ("iterate", "run/step-01/web.stl", "", ["report run", f"evaluate run/step-01/web.stl --design {DESIGN}"]),
    ("each-web", "run/one-web/crank.toml", "width_mm", ["shape --resume run"]),
    ("sweep", "", "radius_mm", ["compare run --baseline mikron-iiic-plain"]),
    ("optimise", "run/checkpoint/state.npz", "x", ["extract run", "optimise --resume run"]),
    ("optimise", "run/density/iteration-0002.npz", "x", ["extract run --iteration 2"]),
    ("optimise", "run/history.csv", "\n2,1.0", ["report run"]),
    ("remodel", "run/remodel/remodel.json", '"web_mass_kg"', ["report run", "evaluate run --sensitivities"]),
]


@pytest.mark.parametrize(
    ("kind", "name", "key", "commands"),
    [pytest.param(*case, marks=[SLOW] * (case[0] in ("optimise", "remodel"))) for case in CHANGES],
    ids=lambda value: value if isinstance(value, str) and "run" in value else "",
)
def test_a_changed_figure_is_refused(
    kind: str,
    name: str,
    key: str,
    commands: list[str],
    copied: Callable[[str], Path],
    capsys: Capture,
) -> None:
    folder = copied(kind)
    file = folder / name if name else picked(folder)
    change(file, key)
    for command in commands:
        capsys.readouterr()
        code = main(command.split())
        told = capsys.readouterr()
        assert code == ExitCode.INVALID_INPUT, f"{command}: {told.out[-300:]}"
        line = re.sub(r"\n +", " ", told.err)
        assert re.search(rf"{file.name}'?: changed since (the run wrote it|it was written)\. \w", line), line


@pytest.mark.parametrize(
    ("kind", "name", "command"),
    [
        ("iterate", "run/step-01/web.toml", "plan"),
        ("each-web", "run/own-webs/crank.toml", "loads"),
        ("each-web", "run/web-3-6/web.toml", "plan"),
    ],
)
def test_a_design_that_is_asked_for_itself_may_be_edited(
    kind: str,
    name: str,
    command: str,
    copied: Callable[[str], Path],
    capsys: Capture,
) -> None:
    """With a line: it is no longer what its run found."""
    folder = copied(kind)
    assert main([command, name]) == 0
    assert "changed" not in capsys.readouterr().err
    change(folder / name, "width_mm")
    assert main([command, name]) == 0
    told = re.sub(r"\n +", " ", capsys.readouterr().err)
    assert told.count("changed since its run wrote it, taken as it is now") == 1, told
    with pytest.raises(CranktopoError, match="changed since the run wrote it"):
        stored_scene(folder / name)


def test_a_throw_of_a_crank_may_be_edited_as_the_crank_itself(
    copied: Callable[[str], Path], capsys: Capture
) -> None:
    """With a line; it was refused where the crank was only told."""
    crank = copied("each-web") / "run" / "own-webs" / "crank.toml"
    throw, text = crank.with_name("throw-2.toml"), crank.read_text(encoding="utf-8")
    write_recorded(throw, text)
    write_recorded(crank, f'{text}\n[crank]\nthrows = ["throw", "{throw.name}", "{throw.name}", "throw"]\n')
    assert main(["loads", str(crank)]) == 0
    assert "changed" not in capsys.readouterr().err
    change(throw, "width_mm")
    assert main(["loads", str(crank)]) == 0
    told = re.sub(r"\n +", " ", capsys.readouterr().err)
    assert told.count(f"{throw.name}': changed since its run wrote it, taken as it is now") == 1, told


def picked(folder: Path) -> Path:
    """The design of a point that the sweep picks."""
    result = json.loads((folder / "run" / "sweep.json").read_text())
    return folder / "run" / "points" / next(iter(result["picks"].values())) / "design.toml"


def added_to(run: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What `fatigue` and `accuracy` add to a run, by themselves; the first one solves."""
    if name == "fatigue.json":
        command = ["fatigue", DESIGN, "--fillet-fraction", "0.5", "--out", str(run)]
    else:
        monkeypatch.setattr("cranktopo.tasks.accuracy.study.planned_studies", lambda _: {})
        command = ["accuracy", str(run), "--out", str(run)]
    assert main([*command, "--quiet"]) == 0


@SLOW
@pytest.mark.parametrize(
    ("name", "key"),
    [("fatigue.json", '"safety"'), ("accuracy.json", '"spent_s"')],
    ids=["fatigue", "accuracy"],
)
def test_a_changed_figure_of_what_was_added_to_a_run(
    name: str,
    key: str,
    stored: Callable[[str], Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Capture,
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / CACHE))
    run = shutil.copytree(stored("optimise") / "run", tmp_path / "run")
    added_to(run, name, monkeypatch)
    assert main(["report", str(run)]) == 0
    assert "no hash" not in capsys.readouterr().err
    change(run / name, key)
    assert main(["report", str(run)]) == ExitCode.INVALID_INPUT
    assert "changed since the run wrote it" in re.sub(r"\n +", " ", capsys.readouterr().err)
    manifest = json.loads((run / "manifest.json").read_text())
    del manifest["recorded_sha256"]  # as an older version left it
    (run / "manifest.json").write_text(json.dumps(manifest))
    assert main(["report", str(run)]) == 0
    assert "the run has no hash of it" in re.sub(r"\n +", " ", capsys.readouterr().err)


def test_a_changed_study_of_the_cache_is_left_out(
    stored: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(stored("accuracy"), tmp_path, dirs_exist_ok=True)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / CACHE))
    kept = load_study(DESIGN, EVALUATION)
    assert kept is not None
    assert kept.result.rungs
    change(tmp_path / CACHE / "cranktopo" / "studies" / "accuracy.json", '"torsion_Nm_per_rad"')
    lines: list[str] = []
    with redirected(lines.append):
        assert load_study(DESIGN, EVALUATION) is None
    assert [line for line in lines if f"the study of '{DESIGN}' was changed since it was written" in line]


def test_another_program_has_a_manifest_too(tmp_path: Path) -> None:
    """A design beside it is one as any other; so is one in the folder of a run that did not write it."""
    for content in ('{"name": "page"}', "no JSON", "[]"):
        (tmp_path / "manifest.json").write_text(content)
        assert unchanged(tmp_path / "mine.toml") == tmp_path / "mine.toml"
        write_recorded(tmp_path / "mine.toml", "name = 1")
        assert unchanged(tmp_path / "mine.toml").read_text() == "name = 1"
        assert (tmp_path / "manifest.json").read_text() == content


def test_arrays_of_an_older_version_are_read_with_a_line(tmp_path: Path) -> None:
    path, lines = tmp_path / "x.npz", list[str]()
    np.savez(path, x=np.arange(3.0))
    with redirected(lines.append):
        assert (read_arrays(path, "'x.npz'", "")["x"] == [0, 1, 2]).all()
    assert lines == ["'x.npz': holds no hash of its content, so it is not checked for changes"]
    write_arrays(path, {"x": np.arange(3.0)})
    with redirected(lines.append):
        assert list(read_arrays(path, "'x.npz'", "")) == ["x"]
    assert len(lines) == 1
