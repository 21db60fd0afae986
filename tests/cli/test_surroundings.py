"""The process around a command: streams that are closed or full, no home, other locales, no device."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.machine import private_cache
from cranktopo.design.loading import designs_folder

PATIENT = "from cranktopo.cli import verbosity; verbosity._QUIET_S = 3600.0"  # no lines about waits
PROGRAM = f"{sys.executable} -c '{PATIENT}; from cranktopo.app.main import main; main()'"


def shell(line: str, folder: Path, **settings: str) -> subprocess.CompletedProcess[bytes]:
    line = line.replace("cranktopo", PROGRAM, 1)
    return subprocess.run(
        ["bash", "-c", line],
        cwd=folder,
        env={**os.environ, **settings},
        capture_output=True,
        timeout=600,
        check=False,
    )


@pytest.mark.parametrize(
    ("line", "code", "message"),
    [
        pytest.param("cranktopo designs list >&-", 0, "", marks=pytest.mark.slow),
        pytest.param("cranktopo designs list 2>&-", 0, "", marks=pytest.mark.slow),
        pytest.param("cranktopo plan nothing <&- >&- 2>&-", 3, "", marks=pytest.mark.slow),
        pytest.param("cranktopo plan nothing --json >&-", 3, "no such file", marks=pytest.mark.slow),
        ("cranktopo designs list > /dev/full", 3, "error: output: cannot be used: No space left on device."),
        pytest.param("cranktopo plan nothing 2> /dev/full", 3, "", marks=pytest.mark.slow),
        pytest.param("cranktopo plan nothing --json > /dev/full", 3, "no such file", marks=pytest.mark.slow),
        pytest.param("set -o pipefail; cranktopo designs list | true", 0, "", marks=pytest.mark.slow),
    ],
)
def test_streams(line: str, code: int, message: str, tmp_path: Path) -> None:
    result = shell(line, tmp_path)
    assert result.returncode == code, result.stderr
    lines = result.stderr.decode().splitlines()
    assert len(lines) == (1 if message else 0), lines
    assert message in result.stderr.decode()


def test_a_closed_stdout_does_not_hand_its_number_to_a_file(tmp_path: Path) -> None:
    """Else what libraries print ends up in the file that is opened next."""
    result = shell("cranktopo designs copy mikron-iiic-plain new.toml >&- <&-", tmp_path)
    assert result.returncode == 0
    assert (tmp_path / "new.toml").read_text().startswith("#")


@pytest.mark.parametrize(
    "locale",
    [
        pytest.param({"LC_ALL": "C"}, marks=pytest.mark.slow),
        {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
        pytest.param({"PYTHONIOENCODING": "latin-1"}, marks=pytest.mark.slow),
    ],
    ids=str,
)
def test_names_beyond_ascii_in_any_locale(locale: dict[str, str], tmp_path: Path) -> None:
    name = "Kröpfung µ.toml"
    shutil.copy(designs_folder() / "mikron-iiic-plain.toml", tmp_path / name)
    assert shell(f"cranktopo designs copy '{name}' new.toml", tmp_path, **locale).returncode == 0
    missing = shell("cranktopo loads $'nicht\\xff da ä.toml'", tmp_path, **locale)
    assert missing.returncode == 3
    assert missing.stderr.startswith(b"error: design 'nicht")


def test_without_a_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def nobody() -> Path:
        raise RuntimeError("Could not determine home directory.")

    for value in ("", "relative"):
        monkeypatch.setenv("XDG_CACHE_HOME", value)
        monkeypatch.setenv("HOME", str(tmp_path))
        assert private_cache("code") == tmp_path / ".cache" / "cranktopo" / "code"
    monkeypatch.setattr(Path, "home", nobody)
    assert private_cache("code") is None


@pytest.mark.slow
@pytest.mark.parametrize("platform", ["cuda"])
def test_a_device_that_is_not_there(platform: str, tmp_path: Path) -> None:
    result = shell("cranktopo optimise --resolution-mm 4.5", tmp_path, JAX_PLATFORMS=platform)
    assert result.returncode == 7
    (line,) = result.stderr.decode().splitlines()
    assert f"JAX finds no device to compute on (JAX_PLATFORMS = '{platform}')" in line
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["optimise", ""], "an argument is empty"),
        (["optimise", "--resume", ""], "--resume is empty"),
        (["optimise", "--out", " "], "--out is empty"),
        (["optimise", "--out="], "--out is empty"),
        (["evaluate", "mikron-iiic-plain", ""], "an argument is empty"),
        (["loads", "a\0b"], r"'a\x00b' holds a NUL character"),
    ],
    ids=str,
)
def test_empty_words(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "-1", "1e999", "", "1,5", "0x10"])
def test_every_numeric_option_refuses(value: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Also options that are added later: every option of every command that takes a number."""
    from tests.cli.test_command_line import commands

    tried = 0
    for path, command in commands().items():
        for option in command.params:
            if "float" not in option.type.name or not option.opts[0].startswith("--"):
                continue
            tried += 1
            needed = ["x" for p in command.params if p.param_type_name == "argument" and p.required]
            assert main([*path.split(), *needed, option.opts[0], value]) == 2, (path, option.opts)
            assert option.opts[0] in capsys.readouterr().err
    assert tried > 15


TAKEN_AWAY = """
import os, sys, threading
from cranktopo.app import launch, main

def run(arguments):
    kept, taken = os.dup(2), os.open("taken.txt", os.O_WRONLY | os.O_CREAT)
    os.dup2(taken, 2)
    other = threading.Thread(target=lambda: print("solving: 24 s so far", file=sys.stderr))
    other.start()
    other.join()
    os.write(2, b"said by native code")
    os.dup2(kept, 2)
    return 0

main._run = run
launch.main()
"""


def test_lines_come_while_a_mesher_has_taken_stderr_away(tmp_path: Path) -> None:
    """As mmgpy does, which keeps what MMG says from the terminal and lets other threads run meanwhile."""
    done = subprocess.run(
        [sys.executable, "-c", TAKEN_AWAY], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stderr == "solving: 24 s so far\n"
    assert (tmp_path / "taken.txt").read_text() == "said by native code"


LAUNCHED = """
import os, sys
from cranktopo.app import launch, main
assert "numpy" not in sys.modules
main.main = lambda: print(os.environ["OPENBLAS_NUM_THREADS"], os.environ["TF_CPP_MIN_LOG_LEVEL"])
launch.main()
"""


@pytest.mark.parametrize(("asked", "used"), [({}, "1"), ({"OPENBLAS_NUM_THREADS": "3"}, "3")])
def test_threads_that_would_wait_busily(asked: dict[str, str], used: str) -> None:
    """Small matrices are factorised by one thread, unless the user says otherwise; XLA keeps its log."""
    ours = "OPENBLAS_NUM_THREADS", "TF_CPP_MIN_LOG_LEVEL"
    own = {name: value for name, value in os.environ.items() if name not in ours}
    done = subprocess.run(
        [sys.executable, "-c", LAUNCHED], env=own | asked, capture_output=True, text=True, check=True
    )
    assert done.stdout == f"{used} 3\n"
