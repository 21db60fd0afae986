"""Long work of a session: the commands of the command line as processes, with their notes, stopped, resumed.

A job outlives the server. What is known of it is in its folder: `job.json` and `notes.txt`.
"""

from __future__ import annotations

import math
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import psutil
from pydantic import Field

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import check_input, from_json, read_text_file, write_json
from cranktopo.base.line_width import unfolded
from cranktopo.base.notes import pace_of
from cranktopo.base.result import Result
from cranktopo.tasks.bench.job_kinds import (
    FOUND,
    KEPT_EARLY,
    OF_RUN,
    OUT,
    RESUMABLE,
    SEARCHES,
    SURFACE,
    check_kind,
    command_words,
)

JobState = Literal["running", "done", "stopped", "failed"]
_JOB, _NOTES, _CODE, _DESIGN = "job.json", "notes.txt", "code", "design.toml"
_STDOUT = "stdout.txt"
_SAVED = "manifest.json"
"""In a run that resumes, whatever else a kill keeps back."""
_LAST = ["nice", "-n", "19"]
"""Before the words of a job that nobody asked for: whatever else runs goes first."""
_SHELL = '"$@" >stdout.txt 2>>notes.txt; echo $? >code.tmp; mv code.tmp code'
_SHOWN, _OF_PACE = 4000, 2**18
"""Ends of the notes, bytes, that are shown, and in which the pace of the whole is looked for."""
_MOST_MIB = 256
"""Of what a job printed."""

PARTLY = (0, 5, 6)
"""Exit codes with a result."""
_INTERRUPTED = (130, 128 + signal.SIGTERM)
"""Exit codes of a job that was asked to end; the second one while its program loads."""


def own_command(*words: str) -> list[str]:
    """Return the command line, by this interpreter, of the program itself."""
    return [sys.executable, "-c", "from cranktopo.app.launch import main; main()", *words]


class _KnownJob(Result):
    id: str
    kind: str
    words: tuple[str, ...]
    started: float
    automatic: bool = False
    pid: int = 0
    born: float = 0.0
    step: str = ""
    variant: str = ""
    found: tuple[str, ...] = ()
    table: tuple[tuple[str, ...], ...] = ()
    gauges: dict[str, float] = Field(default_factory=dict)


@dataclass
class BenchJob:
    """A job that was started, whoever started it."""

    place: Path
    known: _KnownJob

    @property
    def out(self) -> Path:
        """Folder of its run."""
        return self.place / OUT

    @property
    def code(self) -> int | None:
        """Exit code; None while it runs, or where it was killed."""
        with suppress(CranktopoError, ValueError):
            return int(self._text(_CODE))
        return None

    @property
    def alive(self) -> bool:
        """True while its process is there, and not another one of its number."""
        with suppress(psutil.Error):
            process = psutil.Process(self.known.pid)
            return (
                process.status() != psutil.STATUS_ZOMBIE and abs(process.create_time() - self.known.born) < 1
            )
        return False

    @property
    def state(self) -> JobState:
        """State of its process, or how that ended."""
        code = self.code
        if code is None:
            return "running" if self.alive else "stopped"
        return "done" if code in PARTLY else "stopped" if code in _INTERRUPTED else "failed"

    @property
    def has_result(self) -> bool:
        """True where it is done, or was stopped and keeps what was done by then."""
        early = KEPT_EARLY.get(self.known.kind)
        stopped = self.state == "stopped" and early is not None and (self.out / early).is_file()
        return self.state == "done" or stopped

    @property
    def command(self) -> str:
        """The command line that it is, in its own folder."""
        return shlex.join(["cranktopo", *self.known.words])

    def line(self, folder: Path) -> str:
        """Return the command line that does the same in a folder above its own."""
        design = (self.place / _DESIGN).relative_to(folder).as_posix()
        own = f"{self.known.kind.replace(' ', '-')}-{self.known.id}"
        names = {_DESIGN: design, OUT: own, SURFACE: f"{own}.stl"}
        names |= {f"{option}={FOUND}": f"{option}={own}.toml" for option in SEARCHES.values()}
        names |= {
            word: (self.place / word).resolve().relative_to(folder.resolve()).as_posix()
            for word in self.known.words
            if word.startswith("../")
        }
        return shlex.join(["cranktopo", *(names.get(word, word) for word in self.known.words)])

    @property
    def resumable(self) -> bool:
        """True where it can go on: from what it saved, or anew where it was killed before that."""
        if self.known.kind not in RESUMABLE:
            return False
        return self.state == "stopped" or (self.state == "failed" and self.out.is_dir())

    def as_json(self, folder: Path | None = None) -> dict[str, Any]:
        """Return what the page shows of it, with the command as it is typed in a folder."""
        state = self.state
        return {
            "id": self.known.id,
            "kind": self.known.kind,
            "command": self.command if folder is None else self.line(folder),
            "state": state,
            "resumable": self.resumable,
            "notes": self._notes(_SHOWN)[-6:],
            "pace": self._pace() if state == "running" else None,
            "seconds": round(time.time() - self.known.started),
            "variant": self.known.variant,
            "found": list(self.known.found),
            "table": self.known.table,
            "gauges": self.known.gauges,
            "step": self.known.step,
            "automatic": self.known.automatic,
            "page": self.page,
        }

    @property
    def page(self) -> str:
        """Name of its report in its run; empty where there is none."""
        return next((n for n in ("report.html", "page.html", "sweep.html") if (self.out / n).is_file()), "")

    def stdout(self) -> str:
        """Return what it printed."""
        with suppress(CranktopoError):
            return self._text(_STDOUT)
        return ""

    def printed(self) -> Any:
        """Return the JSON that it printed; raises ValueError where that is none."""
        return from_json(self.stdout())

    def _text(self, name: str) -> str:
        path = self.place / name
        return read_text_file(path, f"'{path}'", _MOST_MIB, otherwise="latin-1")

    def stop(self) -> None:
        """Ask it to end, so that it saves what it has.

        It ends as by Ctrl-C, but SIGINT would not reach a job of a bench in the background: shells have such
        commands ignore it, and all that they start.
        """
        if self.alive:
            for child in psutil.Process(self.known.pid).children():
                with suppress(psutil.Error):
                    child.send_signal(signal.SIGTERM)

    def discard(self) -> None:
        """Kill it with all that it started, and forget it."""
        if self.alive:
            with suppress(OSError):  # it ended just now
                os.killpg(self.known.pid, signal.SIGKILL)
        shutil.rmtree(self.place, ignore_errors=True)

    def note_result(
        self,
        variant: str,
        lines: Sequence[str],
        gauges: Mapping[str, float],
        table: Sequence[Sequence[str]] = (),
    ) -> None:
        """Record that its result was kept as a variant, or `-`, and what it found, in words and numbers.

        Args:
            table: rows of cells, the heads first.
        """
        rows = tuple(map(tuple, table))
        kept = {"variant": variant, "found": tuple(lines), "gauges": dict(gauges), "table": rows}
        self.known = self.known.model_copy(update=kept)
        write_json(self.place / _JOB, self.known.as_json())

    def _pace(self) -> dict[str, Any] | None:
        """Return the share that is done and the time left by its newest line of a pace.

        Lines of a part of the work are indented: where the whole has a pace, theirs do not count, but for the
        time left of the part in hand where that of the whole is not known yet.
        """
        lines = reversed(self._notes(_OF_PACE))
        paces = [(line, found) for line in lines if (found := pace_of(line))]
        if not paces:
            return None
        share, left = min(paces, key=lambda pace: len(pace[0]) - len(pace[0].lstrip()))[1]
        of_part = paces[0][1][1]
        return {"share": share, "left": left or (of_part and f"{of_part} of this part")}

    def _notes(self, tail: int) -> list[str]:
        path = self.place / _NOTES
        with suppress(OSError, CranktopoError):
            check_input(path, f"'{path}'", math.inf)
            with path.open("rb") as file:
                file.seek(0, os.SEEK_END)
                file.seek(max(0, file.tell() - tail))
                text = file.read().decode("utf-8", "replace").replace("\r", "\n")
            return [line for line in unfolded(text) if line.strip()]
        return []


class Jobs:
    """The jobs of a session."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def all(self) -> list[BenchJob]:
        """Return every job, the oldest first."""
        found = []
        for file in sorted(self._folder.glob(f"*/{_JOB}")):
            with suppress(CranktopoError):
                found.append(BenchJob(file.parent, _KnownJob.read(file)))
        return found

    def job(self, id_: str) -> BenchJob:
        """Return a job by its name."""
        for job in self.all():
            if job.known.id == id_:
                return job
        raise CranktopoError("job: there is no such job.")

    def start(
        self,
        kind: str,
        design: str,
        options: Mapping[str, Any],
        step: str = "",
        run: str = "",
        *,
        automatic: bool = False,
    ) -> BenchJob:
        """Start a command on the text of a design, that of a step of the session, or on the run of a job.

        Args:
            automatic: nobody asked for it, so that everything else goes first.
        """
        check_kind(kind, options)
        words = command_words(kind, self._run_of(run) if kind in OF_RUN else _DESIGN, options)
        number = 1 + max((int(place.name) for place in self._folder.glob("[0-9][0-9][0-9]")), default=0)
        place = self._folder / f"{number:03d}"
        place.mkdir(parents=True)
        (place / _DESIGN).write_text(design, encoding="utf-8")
        known = _KnownJob(
            id=place.name,
            kind=kind,
            words=words,
            started=time.time(),
            step=step,
            automatic=automatic,
        )
        return self._run(place, known, words)

    def _run_of(self, id_: str) -> str:
        """Return the run of an optimisation, as it is named in the folder of another job."""
        job = self.job(id_)
        if job.known.kind != "optimise" or job.state != "done":
            raise CranktopoError(f"run: job {id_} is no finished optimise job.")
        return f"../{job.place.name}/{OUT}"

    def resume(self, id_: str) -> BenchJob:
        """Continue a job that was stopped."""
        job = self.job(id_)
        if not job.resumable:
            raise CranktopoError("job: there is nothing to continue.")
        (job.place / _CODE).unlink(missing_ok=True)
        if (job.out / _SAVED).is_file():
            return self._run(job.place, job.known, [job.known.kind, "--resume", OUT])
        if job.out.is_dir():
            shutil.rmtree(job.out)
        return self._run(job.place, job.known, job.known.words)

    def _run(self, place: Path, known: _KnownJob, words: Sequence[str]) -> BenchJob:
        shell = ["/bin/sh", "-c", _SHELL, "sh", *own_command(*words)]
        line = [*_LAST, *shell] if known.automatic else shell
        process = subprocess.Popen(
            line,
            cwd=place,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        )
        born = psutil.Process(process.pid).create_time()
        known = known.model_copy(update={"started": time.time(), "pid": process.pid, "born": born})
        write_json(place / _JOB, known.as_json())
        _running.append(process)
        return BenchJob(place, known)


_running: list[subprocess.Popen[bytes]] = []


def reap() -> None:
    """Take note of processes that ended, so that none stays as a zombie."""
    _running[:] = [process for process in _running if process.poll() is None]
