"""The command `bench`: what it refuses, and that a killed server loses nothing and leaves no process."""

from __future__ import annotations

import asyncio
import json
import os
import random
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import psutil
import pytest

pytest.importorskip("tornado")
from tornado.httpclient import HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect

from cranktopo.app.main import main
from cranktopo.design.loading import design_text
from cranktopo.tasks.bench.jobs import Jobs, reap

PROGRAM = [sys.executable, "-c", "from cranktopo.app.launch import main; main()"]
WORDS = [*PROGRAM, "bench", "mikron-iiic-plain", "--no-browser"]
CHANGES = {"web.width_mm": 52, "web.thickness_mm": 20}


def environment() -> dict[str, str]:
    """That of a command that takes the code of this test run."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}


def started(folder: Path) -> tuple[subprocess.Popen[str], str]:
    process = subprocess.Popen(
        WORDS, cwd=folder, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    assert process.stdout is not None
    return process, process.stdout.readline().strip()


def state_after(address: str, *messages: dict[str, Any]) -> dict[str, Any]:
    """Say something to a bench; return the state that it tells after it."""

    async def talk() -> dict[str, Any]:
        origin = address.rpartition("/")[0].rpartition("/")[0]
        where = f"{address.replace('http:', 'ws:')}talk"
        line = await websocket_connect(HTTPRequest(where, headers={"Origin": origin}, connect_timeout=90))
        found: dict[str, Any] = {}
        for message in messages:
            await line.write_message(json.dumps(message))
            while (told := json.loads(str(await asyncio.wait_for(line.read_message(), 600))))[
                "type"
            ] != "state":
                assert told["type"] != "error", told
            found = told["project"]
        await _closed(line)
        return found

    return asyncio.run(talk())


async def _closed(line: WebSocketClientConnection) -> None:
    """Close the line of a page, its socket included."""
    line.close()
    while await line.read_message() is not None:
        pass


@pytest.mark.slow
def test_a_killed_bench_loses_nothing_and_leaves_no_process(tmp_path: Path) -> None:
    process, address = started(tmp_path)
    state = state_after(address, {"do": "hello"}, {"do": "edit", "changes": CHANGES, "what": "wider"})
    assert [step["what"] for step in state["steps"]] == ["opened mikron-iiic-plain", "wider"]
    children = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(signal.SIGKILL)
    process.wait(600)
    assert process.stdout is not None
    process.stdout.close()
    assert psutil.wait_procs(children, timeout=600)[1] == [], "what answers ends with the server"
    process, address = started(tmp_path)
    again = state_after(address, {"do": "hello"})
    assert (again["at"], again["data"]["web"]["width_mm"]) == (1, 52.0)
    _ended(process)


@pytest.mark.slow
def test_a_server_killed_at_any_moment_loses_no_step(tmp_path: Path) -> None:
    """Ten times: every step that a page was told of is there again, and at most the one in hand besides."""
    dice, told = random.Random(5), 0
    for _ in range(10):
        process, address = started(tmp_path)
        steps = len(state_after(address, {"do": "hello"})["steps"])
        assert told <= steps <= told + 1, "what was told is kept"
        told = asyncio.run(_edits_until_killed(process, address, steps, dice.uniform(0.1, 1.5)))
    process, address = started(tmp_path)
    state = state_after(address, {"do": "hello"})
    assert told <= len(state["steps"]) <= told + 1
    files = {step["file"] for step in state["steps"]}
    assert files <= {path.name for path in (tmp_path / "bench" / "mikron-iiic-plain").iterdir()}
    _ended(process)


async def _edits_until_killed(
    process: subprocess.Popen[str], address: str, steps: int, after_s: float
) -> int:
    """Take step after step until the server is killed; return how many steps it told of."""
    origin = address.rpartition("/")[0].rpartition("/")[0]
    where = f"{address.replace('http:', 'ws:')}talk"
    line = await websocket_connect(HTTPRequest(where, headers={"Origin": origin}, connect_timeout=90))
    asyncio.get_running_loop().call_later(after_s, process.kill)
    for number in range(1000):
        changes = {"web.width_mm": 50 + 0.001 * (steps + number), "web.thickness_mm": 19}
        await line.write_message(json.dumps({"do": "edit", "changes": changes, "what": "wider"}))
        while (message := await line.read_message()) is not None:
            told = json.loads(str(message))
            if told["type"] == "state" and len(told["project"]["steps"]) > steps:
                steps = len(told["project"]["steps"])
                break
        else:
            break
    await _closed(line)
    await asyncio.sleep(0.1)
    process.wait(600)
    assert process.stdout is not None
    process.stdout.close()
    return steps


@pytest.mark.slow
def test_a_job_killed_at_any_moment_goes_on(tmp_path: Path) -> None:
    """At most ten times while it lives: it is found stopped, is continued, and comes to its end."""
    dice, jobs = random.Random(3), Jobs(tmp_path)
    options = {"volume-fraction": 0.3, "resolution-mm": 4.5, "max-iterations": 40}
    job = jobs.start("optimise", design_text("mikron-iiic-plain"), options)
    iterations = 0
    for _ in range(10):
        time.sleep(dice.uniform(0.0, 12.0))
        if jobs.job(job.known.id).state == "done":
            break
        with suppress(ProcessLookupError):
            os.killpg(jobs.job(job.known.id).known.pid, signal.SIGKILL)
        _until_not_running(jobs, job.known.id)
        assert jobs.job(job.known.id).state in ("stopped", "done")
        history = job.out / "history.csv"
        rows = len(history.read_text(encoding="utf-8").splitlines()) if history.is_file() else 0
        assert rows >= iterations, "no iteration is lost"
        iterations = max(0, rows - 1)  # the last row may have been written before its checkpoint
        if jobs.job(job.known.id).state == "stopped":
            jobs.resume(job.known.id)
    _until_not_running(jobs, job.known.id)
    found = jobs.job(job.known.id)
    assert found.state == "done", found.as_json()["notes"]
    assert found.command.startswith("cranktopo optimise design.toml --volume-fraction=0.3"), "told as begun"
    assert (found.out / "metrics.json").is_file()


def _until_not_running(jobs: Jobs, id_: str) -> None:
    for _ in range(6000):
        reap()
        if jobs.job(id_).state != "running":
            return
        time.sleep(0.1)


def test_what_is_no_design_is_refused_before_anything_is_served(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["bench", "mikron-iic", "--no-browser"]) == 3
    assert "Did you mean 'mikron-iiic'" in capsys.readouterr().err
    (tmp_path / "bad.toml").write_text("name = 3\n", encoding="utf-8")
    assert main(["bench", "bad.toml", "--no-browser"]) == 3
    assert not (tmp_path / "bench").exists()


@pytest.mark.slow
def test_a_taken_port_is_one_line(tmp_path: Path) -> None:
    """In a process of its own: a browser that another test drives has an event loop in this one."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        begin = [sys.executable, "-c", "from cranktopo.app.launch import main; main()", "bench"]
        command = [*begin, "--no-browser", "--port", str(port)]
        ended = subprocess.run(
            command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=600
        )
    assert ended.returncode == 3
    assert f"--port {port}: cannot be used" in ended.stderr


@pytest.mark.slow
def test_a_second_bench_on_one_session_is_one_line(tmp_path: Path) -> None:
    """Both went on, and wrote their steps over each other's."""
    process, address = started(tmp_path)
    state_after(address, {"do": "edit", "changes": CHANGES, "what": "wider"})
    second = subprocess.run(
        WORDS, cwd=tmp_path, env=environment(), capture_output=True, text=True, check=False, timeout=600
    )
    assert second.returncode != 0
    told = [line for line in second.stderr.splitlines() if line.startswith("error: ")]
    assert len(told) == 1
    assert f"in use by process {process.pid}." in told[0]
    _ended(process)
    process, address = started(tmp_path)
    assert state_after(address, {"do": "hello"})["at"] == 1, "nothing of the first is lost, and it was left"
    _ended(process)


def _ended(process: subprocess.Popen[str]) -> None:
    process.send_signal(signal.SIGINT)
    assert process.wait(600) == 0, "Ctrl-C ends it well"
    assert process.stdout is not None
    process.stdout.close()


def test_help_does_not_load_the_server(tmp_path: Path) -> None:
    code = "from cranktopo.app.main import main; main(['--help']); sys.exit('tornado' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; {code}"],
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0
    assert "bench" in done.stdout
