"""Ctrl-C during long work: at once where it can be, and never lost."""

from __future__ import annotations

import contextlib
import json
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.runs.kind import interruptible


@pytest.fixture(autouse=True)
def sigterm_as_the_command_has_it() -> Iterator[None]:
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    yield
    signal.signal(signal.SIGTERM, before)


def swallowed_interrupt(number: signal.Signals = signal.SIGINT) -> None:
    """Ctrl-C while code runs that drops exceptions, as callbacks of compiled libraries do."""
    with contextlib.suppress(KeyboardInterrupt):
        signal.raise_signal(number)


def work(interrupted: Callable[[], None], done: list[int]) -> None:
    """Three steps with a check after each; Ctrl-C comes in the second."""
    with interruptible() as check:
        for step in range(3):
            done.append(step)
            if step == 1:
                interrupted()
                done.append(-step)
            check()


@pytest.mark.parametrize(
    ("interrupted", "expected"),
    [
        (lambda: signal.raise_signal(signal.SIGINT), [0, 1]),
        (lambda: signal.raise_signal(signal.SIGTERM), [0, 1]),
        (swallowed_interrupt, [0, 1, -1]),
        (lambda: swallowed_interrupt(signal.SIGTERM), [0, 1, -1]),
    ],
    ids=["Ctrl-C", "SIGTERM", "Ctrl-C swallowed", "SIGTERM swallowed"],
)
def test_work_ends_at_once_or_with_its_step(interrupted: Callable[[], None], expected: list[int]) -> None:
    done: list[int] = []
    with pytest.raises(KeyboardInterrupt):
        work(interrupted, done)
    assert done == expected


def test_swallowed_interrupt_is_raised_at_the_end() -> None:
    with pytest.raises(KeyboardInterrupt), interruptible():
        swallowed_interrupt()


def nested(found: list[str]) -> None:
    with interruptible() as outer:
        with contextlib.suppress(KeyboardInterrupt), interruptible():
            swallowed_interrupt()
        found.append("inner ended")
        outer()
        found.append("outer went on")


def test_inner_and_outer_work_both_learn_of_it() -> None:
    found: list[str] = []
    with pytest.raises(KeyboardInterrupt):
        nested(found)
    assert found == ["inner ended"]


def test_handler_is_as_before() -> None:
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = [signal.getsignal(number) for number in numbers]
    with interruptible() as check:
        assert not set(before) & {signal.getsignal(number) for number in numbers}
        check()
    assert [signal.getsignal(number) for number in numbers] == before


def test_ignored_signal_stays_ignored() -> None:
    """A job in the background of a shell ignores Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with interruptible() as check:
            signal.raise_signal(signal.SIGINT)
            check()
    finally:
        signal.signal(signal.SIGINT, before)


def test_other_threads_work_without_a_handler() -> None:
    found: list[Callable[[], None]] = []

    def elsewhere() -> None:
        with interruptible() as check:
            found.append(check)

    thread = threading.Thread(target=elsewhere)
    thread.start()
    thread.join()
    assert len(found) == 1


def test_a_program_that_leaves_sigterm_alone_is_ended_by_it() -> None:
    """As a library: the handler of the program that imports it stays."""
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with interruptible():
        assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


DROPPED = """
import signal, time
from cranktopo.app import launch, main

class Object:
    def __del__(self):
        signal.raise_signal(signal.{name})

def work():
    try:
        Object()
        for _ in range(60_000):  # it comes between two of them: no call of Python's ends early for it
            time.sleep(0.01)
        print("went on")
    except KeyboardInterrupt:
        print("interrupted")

main.main = work
launch.main()
"""


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_what_a_destructor_drops_is_raised_again(name: str) -> None:
    result = subprocess.run(
        [sys.executable, "-c", DROPPED.format(name=name)],
        capture_output=True,
        text=True,
        timeout=1200,
        check=True,
    )
    assert (result.stdout, result.stderr) == ("interrupted\n", "")


AT_THE_EDGE = """
import signal
from cranktopo.app import launch, main, process

steps, put = [], signal.signal

def put_and_asked(number, handler):
    before = put(number, handler)
    if len(steps) == {steps} and handler is {handler}:
        steps.append("asked")
        signal.raise_signal(signal.{asked})
    return before

main.main = lambda: steps.append("ran")
signal.signal = put_and_asked
launch.main()
"""


@pytest.mark.parametrize(
    ("steps", "handler", "asked"),
    [(0, "process.interrupt", "SIGINT"), (1, "process._end_at_once", "SIGTERM")],
)
def test_a_signal_just_before_or_after_the_command_is_no_traceback(
    steps: int, handler: str, asked: str
) -> None:
    """While the handlers are put in place, or taken away: seen once in 200 kills, 0.18 s after the start."""
    code = AT_THE_EDGE.format(steps=steps, handler=handler, asked=asked)
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600)
    assert (result.returncode, result.stdout, result.stderr) == (130, "", "")


@pytest.mark.parametrize("asked", ["SIGINT", "SIGTERM"])
def test_a_signal_while_python_ends_is_no_death_by_it(asked: str) -> None:
    """Seen once in 200 kills: exit -2 of a command that was done."""
    code = "import signal\nfrom cranktopo.app import launch, main, process\nmain.main = lambda: None\n"
    code += f"process._end = lambda _: signal.raise_signal(signal.{asked})\nlaunch.main()"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600)
    assert (result.returncode, result.stdout, result.stderr) == (130, "", "")


DURING_AN_IMPORT = """
import importlib.abc, os, signal, sys

class Asked(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name.startswith("cranktopo.") and name != "cranktopo.app.launch" and name != "cranktopo.app":
            os.kill(os.getpid(), signal.{asked})

before = set(sys.modules)
import cranktopo.app.launch
print(*sorted(set(sys.modules) - before), flush=True)
sys.meta_path.insert(0, Asked())
cranktopo.app.launch.main()
"""


@pytest.mark.parametrize("asked", ["SIGINT", "SIGTERM"])
def test_a_signal_while_the_program_loads_is_no_traceback(asked: str) -> None:
    """Ctrl-C in the first hundredths of a second showed where an import stood: the entry loads nothing."""
    code = DURING_AN_IMPORT.format(asked=asked)
    result = subprocess.run([sys.executable, "-S", "-c", code], capture_output=True, text=True, timeout=600)
    assert (result.returncode, result.stderr) == (-getattr(signal, asked), "")
    assert result.stdout.split() == ["__future__", "cranktopo", "cranktopo.app", "cranktopo.app.launch"]


HELD = """
import signal, sys, time
from contextlib import suppress
from pathlib import Path
from cranktopo.app import launch, main, process
from cranktopo.base.files import replacing
from cranktopo.runs.directories import create_run
from cranktopo.runs.kind import working_in

def work():
    options = {"iterate": {}}
    run = create_run(design="x", design_toml="", scene={}, options=options, command=[], out=Path("run"))
    with working_in(run, "finished steps are kept"), replacing(Path("unwritten.step")):
        signal.raise_signal(signal.SIGWINCH)  # asks nobody to end
        while True:  # as native code that does not return, or a lock
            with suppress(KeyboardInterrupt):
                print("at work", flush=True)
                time.sleep(3600)

process._SAVING_S, process._TELLING_S = 0.3, 300.0
signal.signal(signal.SIGWINCH, lambda *_: None)
main._run = lambda _: work()
launch.main()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_main_thread_that_is_held_is_cut_off(number: signal.Signals, tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", HELD], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "at work\n"
    process.send_signal(number)
    _, stderr = process.communicate(timeout=600)
    assert process.returncode == 130
    assert "interrupted; finished steps are kept in run." in stderr
    assert "cranktopo iterate --resume run" in stderr
    assert json.loads((tmp_path / "run" / "manifest.json").read_text())["status"] == "interrupted"
    assert [path.name for path in tmp_path.iterdir()] == ["run"], "what was half written is gone"


_BEGINNING = """
import os, signal, time
from importlib.machinery import ExtensionFileLoader
from cranktopo.app.process import interrupt

def begin(self):
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(0.3)
    print("begun")

signal.signal(signal.SIGINT, interrupt)
try:
    begin(ExtensionFileLoader("native", "native.so"))
    time.sleep(10)
except KeyboardInterrupt:
    print("ended")
"""


@pytest.mark.slow
def test_a_native_module_begins_before_the_end() -> None:
    """jaxlib ended by signal 11 where Ctrl-C fell into its beginning."""
    done = subprocess.run([sys.executable, "-c", _BEGINNING], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["begun", "ended"]


def test_an_interruption_that_a_library_turned_into_its_own_error(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Ctrl-C while an import makes a class: Python 3.11 raises RuntimeError from it (seen in matplotlib)."""

    def loaded(*_: object, **__: object) -> None:
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt as error:
            raise RuntimeError("Error calling __set_name__ on 'Field'") from error

    monkeypatch.setattr("cranktopo.design.loading.builtin_designs", loaded)
    assert main(["designs", "list"]) == 130
    assert capsys.readouterr().err == "error: interrupted.\n"
