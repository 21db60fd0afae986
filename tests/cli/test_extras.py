"""The core without the packages of its extras: what works, and what the rest says."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

from cranktopo.tasks.doctor import stage as checks

PACKAGE = Path(__file__).resolve().parents[2] / "cranktopo"
LEFT_OUT = {"cryptography", "dask", "distributed", "h5py", "pandas", "pyarrow", "pylife", "tornado"}
WITHOUT = f"""
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {LEFT_OUT!r}:
            raise ModuleNotFoundError("No module named " + repr(name), name=name)

sys.meta_path.insert(0, Missing())
from cranktopo.app.main import main
main()
"""
"""The command line in a process that finds no package of an extra."""
SWEEP = ["sweep", "mikron-iiic-plain", "--vary", "web.width_mm=48,50"]
COMPARE = ["compare", "mikron-iiic-plain", "--baseline", "mikron-iiic-plain"]


def without_extras(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, "-c", WITHOUT, *words]
    return subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("words", "need", "package", "extra"),
    [
        (SWEEP, "sweep", "cryptography", "sweep"),
        (["sweep", "--resume", "any"], "sweep", "cryptography", "sweep"),
        (["fatigue", "--method", "fkm"], "fatigue by method 'fkm'", "pandas", "fatigue"),
        pytest.param(
            [*COMPARE, "--fatigue", "fkm"],
            "fatigue by method 'fkm'",
            "pandas",
            "fatigue",
            marks=pytest.mark.slow,
        ),
    ],
    ids=["sweep", "resume", "fatigue", "compare"],
)
def test_a_missing_extra_ends_before_anything_is_done(
    tmp_path: Path, words: list[str], need: str, package: str, extra: str
) -> None:
    message = f"{need}: a package cannot be loaded: No module named '{package}'."
    hint = f"Install it: pip install 'cranktopo[{extra}]'"
    done = without_extras(tmp_path, *words, "--json")
    assert done.returncode == 7
    assert json.loads(done.stdout) == {"error": {"code": 7, "message": message, "hint": hint}}
    assert done.stderr.splitlines()[-1] == f"error: {message} {hint}"
    done = without_extras(tmp_path, *words)
    assert (done.returncode, done.stdout) == (7, "")
    assert done.stderr.splitlines()[-1] == f"error: {message} {hint}"
    assert not list(tmp_path.iterdir())


def test_the_bench_without_its_package(tmp_path: Path) -> None:
    done = without_extras(tmp_path, "bench", "mikron-iiic-plain", "--no-browser")
    assert (done.returncode, done.stdout) == (7, "")
    assert done.stderr.endswith("Install it: pip install 'cranktopo[bench]'\n")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "line",
    [
        "loads",
        "plan",
        pytest.param("fatigue --fillet-fraction 0.5", marks=pytest.mark.slow),
        "evaluate --element-size-mm 8",
        pytest.param(
            "optimise --volume-fraction 0.3 --resolution-mm 4.5 --max-iterations 1", marks=pytest.mark.slow
        ),
    ],
)
def test_the_core_does_without_extras(tmp_path: Path, line: str) -> None:
    done = without_extras(tmp_path, *line.split())
    assert done.stdout, done.stderr
    assert done.returncode == (5 if "--max-iterations" in line else 0), done.stderr


def test_nothing_else_imports_packages_of_extras() -> None:
    importing = set()
    for file in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            if {name.partition(".")[0] for name in names} & LEFT_OUT:
                importing.add(file.relative_to(PACKAGE / "tasks").as_posix())
    assert {name for name in importing if not name.startswith(("bench/", "sweep/"))} == {"fatigue/fkm.py"}


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
