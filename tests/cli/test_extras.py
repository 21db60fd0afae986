"""The core without the packages of its extras: what works, and what the rest says."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from cranktopo.tasks.doctor import stage as checks
from tests.source_facts import OF_EXTRAS

WITHOUT = f"""
import contextlib, io, json, os, sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {OF_EXTRAS!r}:
            raise ModuleNotFoundError("No module named " + repr(name), name=name)

sys.meta_path.insert(0, Missing())
from cranktopo.app.main import main

def ended(words):
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        code = main(words)
    return [code, out.getvalue(), err.getvalue(), sorted(os.listdir())]

print(json.dumps([ended(words) for words in json.load(sys.stdin)]))
"""
"""Command lines one after the other in a process that finds no package of an extra."""
SWEEP = ["sweep", "mikron-iiic-plain", "--vary", "web.width_mm=48,50"]
COMPARE = ["compare", "mikron-iiic-plain", "--baseline", "mikron-iiic-plain"]


class Ended(NamedTuple):
    """A command: its code, what it said, and the files in its folder then."""

    code: int
    out: str
    err: str
    files: list[str]


def without_extras(folder: Path, *lines: list[str]) -> list[Ended]:
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT],
        cwd=folder,
        input=json.dumps(lines),
        capture_output=True,
        text=True,
        check=True,
    )
    return [Ended(*one) for one in json.loads(done.stdout)]


NEEDED = [
    (SWEEP, "sweep", "cryptography", "sweep"),
    (["sweep", "--resume", "any"], "sweep", "cryptography", "sweep"),
    (["fatigue", "--method", "fkm"], "fatigue by method 'fkm'", "pandas", "fatigue"),
    ([*COMPARE, "--fatigue", "fkm"], "fatigue by method 'fkm'", "pandas", "fatigue"),
]


BENCH = ["bench", "mikron-iiic-plain", "--no-browser"]
CORE = ["loads", "plan", "evaluate --element-size-mm 20"]


@pytest.fixture(scope="module")
def ended(tmp_path_factory: pytest.TempPathFactory) -> list[Ended]:
    """Every command that needs an extra, twice, then the bench and some of the core: in one process."""
    lines = [[*words, *more] for words, *_ in NEEDED for more in (["--json"], [])]
    return without_extras(tmp_path_factory.mktemp("extras"), *lines, BENCH, *map(str.split, CORE))


def test_a_missing_extra_ends_before_anything_is_done(ended: list[Ended]) -> None:
    done = ended[: 2 * len(NEEDED)]
    for (_, need, package, extra), told, said in zip(NEEDED, done[::2], done[1::2], strict=True):
        message = f"{need}: a package cannot be loaded: No module named '{package}'."
        hint = f"Install it: pip install 'cranktopo[{extra}]'"
        assert (told.code, said.code, said.out) == (7, 7, "")
        assert json.loads(told.out) == {"error": {"code": 7, "message": message, "hint": hint}}
        for one in (told, said):
            assert one.err.splitlines()[-1] == f"error: {message} {hint}"
            assert one.files == []


def test_the_bench_without_its_package(ended: list[Ended]) -> None:
    done = ended[2 * len(NEEDED)]
    assert (done.code, done.out, done.files) == (7, "", [])
    assert done.err.endswith("Install it: pip install 'cranktopo[bench]'\n")


def test_the_core_does_without_extras(ended: list[Ended]) -> None:
    for done in ended[-len(CORE) :]:
        assert done.out, done.err
        assert done.code == 0, done.err


@pytest.mark.slow
@pytest.mark.parametrize(
    "line",
    [
        "fatigue --fillet-fraction 0.5",
        "optimise --volume-fraction 0.3 --resolution-mm 4.5 --max-iterations 1",
    ],
    ids=["fatigue", "optimise"],
)
def test_more_of_the_core_does_without_extras(tmp_path: Path, line: str) -> None:
    (done,) = without_extras(tmp_path, line.split())
    assert done.out, done.err
    assert done.code == (5 if "--max-iterations" in line else 0), done.err


def test_doctor_lists_the_extras(monkeypatch: pytest.MonkeyPatch) -> None:
    assert [(check.name, check.state) for check in checks.extras()] == [
        ("extra bench", "ok"),
        ("extra dxf", "ok"),
        ("extra fatigue", "ok"),
        ("extra sweep", "ok"),
    ]
    version = checks.metadata.version

    def without_pylife(name: str) -> str:
        if name == "pylife":
            raise checks.metadata.PackageNotFoundError(name)
        return version(name)

    monkeypatch.setattr(checks.metadata, "version", without_pylife)
    *_, fatigue, sweep = checks.extras()
    assert (sweep.state, sweep.value) == ("ok", "all 5 installed")
    assert (fatigue.state, fatigue.value) == ("absent", "missing: pylife")
    assert fatigue.remedy == "pip install 'cranktopo[fatigue]'"
    (packages,) = checks.packages()
    assert packages.state == "ok"
