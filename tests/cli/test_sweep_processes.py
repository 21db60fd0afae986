"""Processes of a sweep: scripts, workers and schedulers that are killed, the overhead of a point."""

from __future__ import annotations

import logging
import os
import signal
import socket
import ssl
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from collections import Counter
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from cranktopo import sweep
from cranktopo.tasks.sweep import executor
from tests import sweep_cases
from tests.sweep_cases import CALLS, FILLET, HELD, WIDTH


def script(folder: Path, body: str) -> list[str]:
    """A command line that sweeps with functions of the tests, on workers of its own."""
    file = folder / "script.py"
    imports = "from cranktopo import sweep\nfrom tests.sweep_cases import *\n"
    file.write_text(f"{imports}if __name__ == '__main__':\n    {body}\n")
    return [sys.executable, str(file)]


@pytest.mark.slow
def test_a_script_without_a_main_guard_is_told_so(tmp_path: Path) -> None:
    file = tmp_path / "script.py"
    file.write_text("from cranktopo import sweep\nsweep(vary={'web.width_mm': [50, 52]}, out='out')\n")
    done = subprocess.run(
        [sys.executable, str(file)],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert 'Put the call below `if __name__ == "__main__":`' in done.stderr.splitlines()[-1]
    assert not (tmp_path / "out").exists()


def environment() -> dict[str, str]:
    root = str(Path(__file__).resolve().parents[2])
    return {**os.environ, "PYTHONPATH": os.pathsep.join([root, os.environ.get("PYTHONPATH", "")])}


def signal_after(process: subprocess.Popen[str], trace: Path, lines: int, how: signal.Signals) -> int:
    """Send a signal once so many points were computed; the exit code."""
    end = time.monotonic() + 1200
    while len(trace.read_text().splitlines()) < lines and process.poll() is None and time.monotonic() < end:
        time.sleep(0.02)
    process.send_signal(how)
    return process.wait(600)


@pytest.mark.slow
def test_a_killed_sweep_goes_on(scheduler: str, tmp_path: Path, trace: Path) -> None:
    """`kill -9` of workers and all: no finished point is lost or computed twice."""
    out = tmp_path / "out"
    body = f"sweep(vary={{'{WIDTH}': '46:56:11'}}, out={str(out)!r}, workers=1, function=empty)"
    killed = subprocess.Popen(script(tmp_path, body), env={**environment(), CALLS: "3"}, text=True)
    assert signal_after(killed, trace, 3, signal.SIGKILL) == -signal.SIGKILL
    time.sleep(0.5)  # until its workers have ended too
    kept = {file: file.stat().st_mtime_ns for file in out.glob("points/*/point.json")}
    assert len(kept) in (2, 3), "the last of them may have been cut off before its file"
    frame = sweep(resume=out, scheduler=scheduler, function=sweep_cases.empty)
    assert frame["status"].value_counts().to_dict() == {"done": 9, "impossible": 2}
    assert all(file.stat().st_mtime_ns == then for file, then in kept.items())
    assert len(trace.read_text().splitlines()) <= 9 + 1, "one was under way at the kill"


@pytest.mark.slow
def test_dead_workers_and_twenty_kills(tmp_path: Path, trace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A point that always kills its worker, one that does it once, and a sweep that is ended twenty times.

    `python -m pytest -m slow tests/cli/test_sweep_processes.py -n 0`, a few minutes.
    """
    monkeypatch.setenv(HELD, "0.3")
    vary = {WIDTH: "48:60:49", FILLET: [2.0, 2.5]}
    whole = sweep(vary=vary, out=tmp_path / "whole", workers=2, function=sweep_cases.empty)
    trace.write_text("")
    out, place = tmp_path / "out", "workers=2, function=deadly"
    command, counts = script(tmp_path, f"sweep(vary={vary}, out={str(out)!r}, {place})"), [0]
    for kill in range(20):
        with subprocess.Popen(command, env=environment(), text=True, stderr=subprocess.DEVNULL) as process:
            signal_after(process, trace, 3 * (kill + 1), signal.SIGINT if kill % 2 else signal.SIGKILL)
        counts.append(len(list(out.glob("points/*/point.json"))))
        command = script(tmp_path, f"sweep(resume={str(out)!r}, {place})")
    assert counts == sorted(counts)
    subprocess.run(command, env=environment(), check=True)
    calls = Counter(trace.read_text().split())
    assert sum(calls.values()) <= len(calls) + 2 * 20, "at most what was under way at a kill is repeated"
    frame = pd.read_parquet(out / "table.parquet")
    fine = frame["status"] == "done"
    assert frame[WIDTH][frame["status"] == "failed"].tolist() == [52.0, 52.0]
    numbers = [WIDTH, FILLET, "mass_kg", "torsion_Nm_per_rad"]
    pd.testing.assert_frame_equal(frame[numbers][fine], whole[numbers][fine])


class Cluster:
    """A scheduler and two workers as processes of their own; whichever ends is started again."""

    def __init__(self, folder: Path, port: int) -> None:
        self.address, self._folder = f"tcp://127.0.0.1:{port}", folder
        dask = [sys.executable, "-m", "dask"]
        place = ["--host", "127.0.0.1", "--local-directory", str(folder)]
        worker = [*dask, "worker", self.address, "--nthreads", "1", "--no-dashboard", *place]
        self._commands = {
            "scheduler": [
                *dask,
                "scheduler",
                "--host",
                "127.0.0.1",
                "--port",
                str(port),
                "--dashboard-address",
                ":0",
            ],
            "first": [*worker, "--no-nanny"],
            "second": [*worker, "--no-nanny"],
        }
        self._running: dict[str, subprocess.Popen[bytes]] = {}

    def keep_up(self) -> None:
        """Start what does not run."""
        for name, command in self._commands.items():
            if name not in self._running or self._running[name].poll() is not None:
                log = (self._folder / f"{name}.log").open("ab")
                self._running[name] = subprocess.Popen(
                    command, env=environment(), stdout=log, stderr=log, cwd=self._folder
                )
                log.close()

    def kill(self, name: str) -> None:
        """End one of them without a word."""
        self._running[name].kill()
        self._running[name].wait()

    def close(self) -> None:
        """End all of them."""
        for name in self._running:
            self.kill(name)


def test_nobody_else_reaches_the_scheduler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every user of a machine reaches its loopback ports: a client needs the credentials of this sweep."""
    import distributed

    usual, heard = distributed.LocalCluster, []

    def watched(**settings: Any) -> Any:
        cluster = usual(**settings)
        place = cluster.scheduler_address.partition("://")[2].rsplit(":", 1)
        address = place[0], int(place[1])
        own, foreign = settings["security"], distributed.Security.temporary()
        for context in (None, _without_certificate(), _as_client(foreign), _as_client(own)):
            heard.append(_first_bytes(address, context))
        page = f"http://127.0.0.1:{cluster.scheduler_info['services']['dashboard']}"
        for path in ("/", "/status", "/info/main/workers.html", "/json/index.html", "/metrics"):
            with pytest.raises(urllib.error.HTTPError, match="404"):
                urllib.request.urlopen(page + path)
        return cluster

    monkeypatch.setattr("distributed.LocalCluster", watched)
    frame = sweep(vary={WIDTH: [50, 51]}, workers=1, out=tmp_path / "out", function=sweep_cases.empty)
    assert frame["status"].tolist() == ["done"] * 2
    assert heard[:3] == [b""] * 3  # nothing is said to a stranger
    assert heard[3]  # the greeting of the scheduler, to its own


def _without_certificate() -> ssl.SSLContext:
    """Accept any server and show nothing."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    return context


def _as_client(security: Any) -> ssl.SSLContext:
    """Show the certificate of these credentials, accept any server."""
    context: ssl.SSLContext = security.get_connection_args("client")["ssl_context"]
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    return context


def _first_bytes(address: tuple[str, int], context: ssl.SSLContext | None) -> bytes:
    """What the scheduler says to one who connects; nothing where it closes, sends an alert or waits.

    By a plain socket: a client of Dask starts a loop of its own, and gives up after 10 s on short cores.
    """
    with socket.create_connection(address, timeout=600) as bare:
        try:
            if context is None:
                bare.settimeout(1)
                return bare.recv(1024)
            with context.wrap_socket(bare) as secure:
                return secure.recv(1024)
        except OSError:
            return b""


@pytest.mark.slow
def test_workers_that_are_all_gone_are_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nannies that have given up are not started again by Dask.

    `python -m pytest -m slow tests/cli/test_sweep_processes.py -n 0 -k all_gone`, some seconds.
    """
    import distributed

    started: list[Any] = []
    usual = distributed.LocalCluster

    def lose(cluster: Any) -> None:
        """Close every nanny."""
        for nanny in list(cluster.workers.values()):
            cluster.sync(nanny.close)

    def giving_up(**settings: Any) -> Any:
        """A cluster, the first of which loses its workers after a second."""
        started.append(usual(**settings))
        if len(started) == 1:
            threading.Timer(1.0, lose, started).start()
        return started[-1]

    monkeypatch.setattr("distributed.LocalCluster", giving_up)
    monkeypatch.setattr("cranktopo.tasks.sweep.executor.GONE_S", 1.0)
    monkeypatch.setenv(HELD, "1")
    frame = sweep(vary={WIDTH: [50, 51, 52, 53]}, workers=1, out=tmp_path / "out", function=sweep_cases.empty)
    assert frame["status"].tolist() == ["done"] * 4
    assert len(started) == 2


@pytest.mark.slow
def test_a_real_scheduler_with_kills(tmp_path: Path, trace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A scheduler and two worker processes; a worker is killed every 20 s, the scheduler once.

    `python -m pytest -m slow tests/cli/test_sweep_processes.py -n 0 -k real_scheduler`, about five minutes.
    """
    monkeypatch.setenv(HELD, "2")
    vary, out, place = {WIDTH: "48:60:145", FILLET: [2.0, 2.5]}, tmp_path / "out", Cluster(tmp_path, 28786)
    body = f"sweep(vary={vary}, out={str(out)!r}, scheduler={place.address!r}, function=empty)"
    place.keep_up()
    time.sleep(5.0)
    log = (tmp_path / "sweep.log").open("w")
    sweeping = subprocess.Popen(script(tmp_path, body), env=environment(), stdout=log, stderr=log)
    began, kills = time.monotonic(), 0
    try:
        while sweeping.poll() is None and time.monotonic() < began + 1500:
            time.sleep(1.0)
            place.keep_up()
            if time.monotonic() > began + 20 * (kills + 1) and kills < 15:
                kills += 1
                place.kill("scheduler" if kills == 7 else ("first", "second")[kills % 2])
    finally:
        place.close()
        sweeping.kill()
        log.close()
    assert sweeping.returncode == 0, (tmp_path / "sweep.log").read_text()
    assert kills == 15
    frame = pd.read_parquet(out / "table.parquet")
    assert frame["status"].tolist() == ["done"] * 290
    assert frame["mass_kg"].tolist() == (frame[WIDTH] / 30).tolist()
    calls = Counter(trace.read_text().split())
    assert sum(calls.values()) <= len(calls) + 2 * 15, "only what was under way at a kill is repeated"


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
def test_ten_thousand_empty_points(tmp_path: Path, workers: int) -> None:
    """`python -m pytest -m slow tests/cli/test_sweep_processes.py -n 0 -s` prints the overhead of a point."""
    vary = {WIDTH: "46:60:100", "throw.radius_mm": "44:52:100"}
    began = time.perf_counter()
    frame = sweep(vary=vary, out=tmp_path / "out", workers=workers, function=sweep_cases.empty)
    seconds = time.perf_counter() - began
    print(f"{workers} workers: {1000 * seconds / len(frame):.1f} ms a point")
    assert (~frame["original"]).sum() == 10_000
    assert set(frame["status"]) == {"done", "impossible"}
    assert (tmp_path / "out" / "report.html").stat().st_size < 10_000_000


def test_what_dask_cannot_close_after_an_interrupt_is_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C while its workers begin: its own end of the process would show an AssertionError."""
    from distributed.deploy import spec

    closed = []

    def fails() -> None:
        logging.getLogger("asyncio").error("Future exception was never retrieved")
        closed.append(logging.getLogger("asyncio").isEnabledFor(logging.ERROR))
        raise AssertionError("Status.init")

    monkeypatch.setattr(spec, "close_clusters", fails)
    executor._close_clusters()
    assert closed == [False]
    assert logging.getLogger("asyncio").isEnabledFor(logging.ERROR)
