"""A bench at work: what pages ask, the processes that answer, and what every page is told."""

from __future__ import annotations

import asyncio
import re
import shlex
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cranktopo.base.child import in_child
from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.files import read_text_file, write_bytes, write_text
from cranktopo.design.edits import changed_data, difference_words
from cranktopo.design.loading import builtin_designs, design_text, resolve_design
from cranktopo.design.material import material_library
from cranktopo.design.pitch import JOURNAL_LENGTHS
from cranktopo.tasks.bench.answers import Answers
from cranktopo.tasks.bench.design_files import changed_files, check_files_inside
from cranktopo.tasks.bench.forms import BODIES, form_reference, new_design, read_upload, remarks_of
from cranktopo.tasks.bench.job_watch import JobWatch, job_states, jobs_of
from cranktopo.tasks.bench.jobs import Jobs
from cranktopo.tasks.bench.project import Project, file_in
from cranktopo.tasks.bench.proposals import with_pitch_kept
from cranktopo.tasks.bench.session_files import SCRIPT_ENDING, portable, session_script, write_lines
from cranktopo.tasks.bench.writes import ENDINGS, WRITTEN, written_by

Tell = Callable[[dict[str, Any]], None]
_WATCH_S = 1.0
_UPLOADS = (".toml", ".csv", *BODIES)
_GIVEN = (".toml", *ENDINGS)
_ACTIONS = re.compile(
    "hello|drag|edit|pick|place|free|balance|rod|undo|redo|go|pin|keep|drop|take|compare|job|stop|resume|write|script|save|start|open|close"
)


def _values_words(values: Mapping[str, float]) -> str:
    return "; ".join(f"{key}: {value:g}" for key, value in values.items())


@dataclass
class Bench:
    """A folder, the session in it, and the pages that show it."""

    folder: Path
    project: Project | None = None
    _pages: list[Tell] = field(default_factory=list)
    _written_names: set[str] = field(default_factory=set)
    _tasks: set[asyncio.Task[None]] = field(default_factory=set)
    _watch: asyncio.Task[None] | None = None

    def __post_init__(self) -> None:
        self.answers = Answers(self._tell_all)
        self.jobs = JobWatch(self._tell_all, self._tell_state)

    def close(self) -> None:
        """End the processes that answer; jobs go on."""
        self.answers.close()
        if self._watch:
            self._watch.cancel()
        self._leave_project()

    def enter(self, tell: Tell) -> None:
        """Take note of a page that was opened."""
        self._pages.append(tell)
        if self._watch is None:
            self._watch = asyncio.get_running_loop().create_task(self._watch_jobs())

    def leave(self, tell: Tell) -> None:
        """Forget a page that was closed."""
        with suppress(ValueError):
            self._pages.remove(tell)

    async def hear(self, message: Mapping[str, Any], tell: Tell) -> None:
        """Do what a page asks; a mistake is told to it alone."""
        action = message.get("do")
        try:
            if not isinstance(action, str) or not _ACTIONS.fullmatch(action):
                raise CranktopoError(f"there is no action {quoted(action)}.")
            done: Awaitable[None] | None = getattr(self, f"_{action}")(message, tell)
            if done is not None:
                await done
        except (CranktopoError, ValidationError) as error:
            tell({"type": "error", "message": str(error)})
        except OSError as error:
            tell({"type": "error", "message": f"A file cannot be used: {error.strerror}."})
        except (KeyError, TypeError, ValueError, AttributeError):
            tell({"type": "error", "message": "The page asked for something that makes no sense here."})

    def open_text(self, text: str, source: str, what: str, command: str) -> None:
        """Put a design on the bench; raises CranktopoError where another bench has its session."""
        opened = Project.opened(self.folder, text, source, what, command, self.project)
        if opened is not self.project:
            self._leave_project()
        self.answers.forget()
        self.project = opened
        self._moved()

    def _leave_project(self) -> None:
        self.jobs.proof.forget()
        if self.project is not None:
            self.project.close()
        self.project = None

    async def uploaded(self, name: str, content: bytes) -> dict[str, Any]:
        """Read a dropped file in a process of its own: a design, a crank from CAD, or a pressure trace."""
        path = file_in(self.folder, name, _UPLOADS)
        if not content:
            raise CranktopoError(f"'{name}': is empty.")
        if path.exists() and path.read_bytes() != content:
            raise CranktopoError(
                f"'{name}': is in the folder already, with other content.", hint="Rename it."
            )
        write_bytes(path, content)
        text, source = await asyncio.to_thread(in_child, f"'{name}'", read_upload, path)
        if text is None:
            data = self._required.data()
            changes = await self.answers.proposed("trace_changes", data, str(path))
            self._required.change({**changes, "engine.gas.indicator_csv": name}, f"pressure trace {name}")
            self._moved()
        else:
            command = (
                ["cranktopo", "import", name]
                if path.suffix.lower() != ".toml"
                else ["cranktopo", "bench", name]
            )
            self.open_text(text, source, f"dropped {name}", shlex.join(command))
        return {"opened": name, "told": remarks_of(text) if text and path.suffix != ".toml" else ""}

    def written_file(self, name: str) -> Path:
        """Return a file that the bench wrote; raises CranktopoError for any other."""
        if name not in {file.name for file in self._required.files}:
            raise CranktopoError("file: was not made here.")
        return file_in(self.folder, name, _GIVEN)

    def report_of(self, job: str) -> Path:
        """Return the page of a job's run."""
        found = self._jobs.job(job)
        if not found.page:
            raise CranktopoError("job: has no page.")
        return found.out / found.page

    @property
    def _required(self) -> Project:
        if self.project is None:
            raise CranktopoError("no design is on the bench.", hint="Begin one, or open one.")
        return self.project

    @property
    def _jobs(self) -> Jobs:
        return jobs_of(self._required)

    def _data(self, text: str) -> dict[str, Any]:
        return self._required.data(text)

    def _tell_all(self, message: dict[str, Any]) -> None:
        for tell in list(self._pages):
            tell(message)

    def _tell_state(self) -> None:
        self._tell_all(self._state())

    def _state(self) -> dict[str, Any]:
        shared = {"type": "state", "designs": builtin_designs(), "files": self._files()}
        if self.project is None:
            return {**shared, "project": None}
        shown = {"project": self.project.as_json(), "jobs": job_states(self.project)}
        return {**shared, **shown, "no_proof": self.jobs.proof.missing(self.project.step.file)}

    def _files(self) -> list[str]:
        return sorted(path.name for path in self.folder.glob("*.toml"))[:200]

    def _moved(self) -> None:
        """Tell every page of a new step, and have it settled; the proof of another step ends."""
        self.jobs.proof.leave(self._required.step.file)
        self._tell_state()
        self._show(self._tell_all)

    def _show(self, tell: Tell) -> None:
        project = self._required
        original = project.text_of(project.original)
        self.answers.original(project.data(original), original, tell)
        self.answers.live(project.data(), None, tell, project.text)
        self.answers.coarse(project.data(), None, tell)
        self.answers.settle(self._data, project.text, original)

    # What pages ask.

    def _hello(self, message: Mapping[str, Any], tell: Tell) -> None:
        tell({"type": "reference", **form_reference(), "materials": sorted(material_library())})
        tell(self._state())
        if self.project is not None:
            self._show(tell)

    def _drag(self, message: Mapping[str, Any], tell: Tell) -> None:
        data = self._changed(self._requested_changes(message))
        self.jobs.proof.leave()
        self.answers.live(data, message.get("seq"), tell)
        self.answers.coarse(data, message.get("seq"), tell)

    async def _edit(self, message: Mapping[str, Any], tell: Tell) -> None:
        """Take a step; a single value that breaks a sound design is told to the page and not taken.

        What was dragged there goes to the nearest value that breaks none. A drag that ended where it began
        is no step: its page is told of the design in hand again.
        """
        project, changes = self._required, self._requested_changes(message)
        if self._changed(changes) == project.data():
            self._show(tell)
            return
        violated = await self._newly_violated(message, changes)
        nearest = await self._nearest(message) if violated else {}
        if violated and not nearest:
            tell({"type": "live", "seq": None, "broken": violated})
            return
        what = str(message.get("what", ""))[:200] if not nearest else _values_words(nearest)
        besides = {key: value for key, value in changes.items() if key not in message["changes"]}
        project.change(nearest or changes, "; ".join(filter(None, [what, _values_words(besides)])))
        self._moved()
        if nearest:
            rules = [rule["message"] for rule in violated]
            tell({"type": "told", "message": "\n".join([*rules, f"Taken is the nearest value, {what}."])})

    async def _newly_violated(
        self, message: Mapping[str, Any], changes: dict[str, Any]
    ) -> list[dict[str, str]]:
        """Return the rules that a single value breaks in a design that broke none."""
        if len(message["changes"]) != 1 or isinstance(next(iter(changes.values())), dict | None):
            return []
        found = await self.answers.checked(self._changed(changes))
        return found if found and not await self.answers.checked(self._required.data()) else []

    async def _nearest(self, message: Mapping[str, Any]) -> dict[str, float]:
        """Return the value nearest to where a dimension was dragged that keeps the rules, by its key."""
        if not message.get("snap") or message.get("keep_pitch"):
            return {}
        return await self.answers.proposed("nearest_sound", self._required.data(), dict(message["changes"]))

    async def _balance(self, message: Mapping[str, Any], tell: Tell) -> None:
        """Give the web the counterweight that balances a share of the oscillating mass."""
        percent = float(message["percent"])
        changes = await self.answers.proposed("counterweight_changes", self._required.data(), percent)
        self._required.change(changes, f"counterweight for a balance factor of {percent:g} %")
        self._moved()

    async def _free(self, message: Mapping[str, Any], tell: Tell) -> None:
        """Give `shape` a range of a dimension that it keeps otherwise."""
        key = str(message["key"])
        changes = await self.answers.proposed("freed_changes", self._required.data(), key)
        ((low, high),) = changes.values()
        self._required.change(changes, f"{key}: free for shape from {low:g} to {high:g}")
        self._moved()

    async def _rod(self, message: Mapping[str, Any], tell: Tell) -> None:
        """Add a connecting rod that fits engine and crankpin."""
        self._required.change(await self.answers.proposed("rod_changes", self._required.data()), "added rod")
        self._moved()

    async def _pick(self, message: Mapping[str, Any], tell: Tell) -> None:
        """Tell the page what it sees along a line of sight."""
        sight = dict(message["sight"])
        tell({"type": "picked", **await self.answers.picked(self._required.data(), sight)})

    async def _place(self, message: Mapping[str, Any], tell: Tell) -> None:
        """Add a pocket or a hole where the page picked a web face, and have its form opened."""
        kind, place = message["kind"], dict(message["place"])
        if kind not in ("hole", "pocket"):
            raise CranktopoError("place: a hole or a pocket.")
        changes = await self.answers.placed(self._required.data(), kind, place)
        ((key, table),) = changes.items()
        size = table.get("diameter_mm") or table["size_x_mm"]
        where = f"x = {table['x_mm']:g}, y = {table['y_mm']:g} mm"
        self._required.change(changes, f"added {kind}: {size:g} mm at {where}")
        self._moved()
        tell({"type": "picked", "key": key})

    def _undo(self, message: Mapping[str, Any], tell: Tell) -> None:
        self._required.move(-1)
        self._moved()

    def _redo(self, message: Mapping[str, Any], tell: Tell) -> None:
        self._required.move(1)
        self._moved()

    def _go(self, message: Mapping[str, Any], tell: Tell) -> None:
        """Go to any step of the history."""
        self._required.move(int(message["to"]) - self._required.at)
        self._moved()

    def _pin(self, message: Mapping[str, Any], tell: Tell) -> None:
        self._required.pin()
        self._moved()

    async def _keep(self, message: Mapping[str, Any], tell: Tell) -> None:
        project = self._required
        original = project.data(project.text_of(project.original))
        changed = difference_words(original, project.data()) or "as the original"
        text, name = project.text, str(message.get("name", ""))
        outlines = await self.answers.outlines(project.data(text))
        project.keep(name, self.answers.known(text), text, changed, outlines)
        self._tell_state()

    def _drop(self, message: Mapping[str, Any], tell: Tell) -> None:
        self._required.drop(str(message["id"]))
        self._tell_state()

    def _take(self, message: Mapping[str, Any], tell: Tell) -> None:
        project, id_ = self._required, str(message["id"])
        name = next((v.name for v in project.variants if v.id == id_), id_)
        project.replace(project.variant_text(id_), f"took {name}")
        self._moved()

    def _compare(self, message: Mapping[str, Any], tell: Tell) -> None:
        self._required.update_variant(str(message["id"]), pinned=bool(message["pinned"]))
        self._tell_state()

    def _job(self, message: Mapping[str, Any], tell: Tell) -> None:
        design = portable(self._required, self._required.text, "check").read_text(encoding="utf-8")
        step = self._required.step.file
        options, run = dict(message.get("options", {})), str(message.get("run", ""))
        self._jobs.start(str(message["kind"]), design, options, step, run)
        self._tell_state()

    def _stop(self, message: Mapping[str, Any], tell: Tell) -> None:
        self._jobs.job(str(message["id"])).stop()

    def _resume(self, message: Mapping[str, Any], tell: Tell) -> None:
        self._jobs.resume(str(message["id"]))
        self._tell_state()

    def _write(self, message: Mapping[str, Any], tell: Tell) -> None:
        """Have a file written, beside whatever else is asked meanwhile."""
        kind = WRITTEN[str(message["kind"])]
        path = self._target(message, kind.ending)
        words, command = write_lines(self._required, kind, path)
        tell({"type": "busy", "what": f"writing {path.name}"})
        task = asyncio.get_running_loop().create_task(
            self._write_by(words, kind.printed, path, command, tell)
        )
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _write_by(self, words: list[str], printed: bool, path: Path, command: str, tell: Tell) -> None:
        try:
            warned = await written_by(words, printed, path)
        except CranktopoError as error:
            tell({"type": "error", "message": str(error)})
        else:
            self._announce_file(path, command, warned)

    def _save(self, message: Mapping[str, Any], tell: Tell) -> None:
        path = self._target(message)
        project = self._required
        write_text(path, project.text)
        words = ["cranktopo", "designs", "copy", project.runnable(project.at), path.name, "--force"]
        self._announce_file(path, shlex.join(words))

    def _script(self, message: Mapping[str, Any], tell: Tell) -> None:
        """Write a Python script that repeats the session as far as the step in hand."""
        path, project = self._target(message, SCRIPT_ENDING), self._required
        write_text(path, session_script(project))
        self._announce_file(path, shlex.join(["python", path.name]))

    def _start(self, message: Mapping[str, Any], tell: Tell) -> None:
        text, name, command, assumed = new_design(dict(message["answers"]))
        self.open_text(text, f"{name}.toml", "begun from usual proportions", command)
        tell({"type": "told", "message": "\n".join(assumed)})

    def _open(self, message: Mapping[str, Any], tell: Tell) -> None:
        name = str(message["name"])
        if name in builtin_designs():
            path = resolve_design(name)
            text = changed_files(design_text(name), path.parent)
        else:
            path = file_in(self.folder, name, (".toml",))
            text = read_text_file(path, f"design '{name}'")
        self.open_text(text, path.name, f"opened {name}", f"cranktopo bench {name}")

    def _close(self, message: Mapping[str, Any], tell: Tell) -> None:
        self._leave_project()
        self._tell_state()

    # Helpers.

    def _requested_changes(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Return the changes that a page asks for, with the journals that keep the pitch if it wants that."""
        changes = dict(message["changes"])
        if not message.get("keep_pitch") or JOURNAL_LENGTHS[0] in changes:
            return changes
        with suppress(CranktopoError):  # what is broken is told by the answer
            return with_pitch_kept(self._required.data(), changes)
        return changes

    def _changed(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        project = self._required
        data = changed_data(project.data(), changes)
        check_files_inside(data, project.folder, project.opened_data)
        return data

    def _target(self, message: Mapping[str, Any], ending: str = "") -> Path:
        path = file_in(self.folder, f"{message['name']}{ending}", ENDINGS if ending else (".toml",))
        if path.exists() and path.name not in self._written_names and not message.get("replace"):
            raise CranktopoError(f"'{path.name}': is in the folder already.", hint="Choose another name.")
        return path

    def _announce_file(self, path: Path, command: str, warned: list[str] | None = None) -> None:
        self._written_names.add(path.name)
        self._required.record_file(path.name, command)
        self._tell_all({"type": "made", "name": path.name, "command": command, "warnings": warned or []})
        self._tell_state()

    async def _watch_jobs(self) -> None:
        """Look at the jobs of the session in hand, every second."""
        while True:
            await asyncio.sleep(_WATCH_S)
            if self.project is not None:
                await self.jobs.look(self.project, self.answers)
