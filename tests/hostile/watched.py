"""A command in a process of its own, watched: exit code, seconds, what it told, whether it fell silent."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import psutil

PROGRAM = [sys.executable, "-X", "faulthandler", "-c", "from cranktopo.app.launch import main; main()"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
SILENT_S, ENDLESS_S = 30.0, 900.0
_BUSY = 8
"""A machine that has other work to do may take so many times as long."""
SILENT, ENDLESS = "silent for too long", "does not end in time"


@dataclass(frozen=True)
class Ended:
    """How a command ended.

    Attributes:
        told: what it wrote to stderr.
        fault: what ended it before its own end; empty where nothing did.
    """

    code: int
    seconds: float
    told: str
    fault: str = ""

    @property
    def last_line(self) -> str:
        """The last line of stderr that is not empty."""
        lines = [line for line in self.told.splitlines() if line.strip()]
        return lines[-1].strip() if lines else ""


def watched(
    words: list[str], folder: Path, limit: Callable[[], None] | None = None, endless_s: float = ENDLESS_S
) -> Ended:
    """Run a command in a folder to its end, or until it has worked or said nothing for too long."""
    process = subprocess.Popen(
        [*PROGRAM, *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env=ENVIRONMENT,
        cwd=folder,
        preexec_fn=limit,
    )
    lines, heard = list[bytes](), [time.monotonic(), 0.0]

    def listen() -> None:
        assert process.stderr is not None
        for line in process.stderr:
            lines.append(line)
            heard[:] = time.monotonic(), worked_s(process.pid)

    listener = threading.Thread(target=listen)
    listener.start()
    began = time.monotonic()
    fault = _until_its_end(process, endless_s, heard)
    listener.join()
    return Ended(process.wait(), time.monotonic() - began, b"".join(lines).decode(), fault)


def _until_its_end(process: subprocess.Popen[bytes], endless_s: float, heard: list[float]) -> str:
    began = time.monotonic()
    while process.poll() is None:
        time.sleep(0.2)
        now, worked = time.monotonic(), worked_s(process.pid)
        # A machine that has other work to do is no fault: both clocks count.
        silent = min(now - heard[0], worked - heard[1]) > SILENT_S
        if silent or worked > endless_s or now - began > _BUSY * endless_s:
            end_with_children(process.pid)
            return SILENT if silent else ENDLESS
    return ""


def end_with_children(pid: int) -> None:
    """Kill a process and those that it has begun: one of them may hold its stderr open."""
    try:
        family = [*psutil.Process(pid).children(recursive=True), psutil.Process(pid)]
    except psutil.NoSuchProcess:
        return
    for one in family:
        one.kill()


def worked_s(pid: int) -> float:
    """Return the seconds that the processors have worked for a process, 0 when it is gone."""
    try:
        times = psutil.Process(pid).cpu_times()
    except psutil.NoSuchProcess:
        return 0.0
    return float(times.user + times.system + times.children_user + times.children_system)
