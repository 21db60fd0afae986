"""Run directories: made once, never overwritten, found again by path or by name."""

from __future__ import annotations

import csv
import io
import shlex
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError, quoted, suggest
from cranktopo.base.files import (
    as_path_if_any,
    no_link,
    read_json,
    read_text_file,
    sweep_temporaries,
    unwritable,
    write_json,
    write_text,
)
from cranktopo.base.notes import note
from cranktopo.runs.destination import LOCK, check_folder, locked, moved, unfinished_folder
from cranktopo.runs.manifest import (
    Manifest,
    RunStatus,
    file_hash,
    new_manifest,
    read_manifest,
    settings_hash,
    timestamp,
)

RUNS = Path("runs")
MANIFEST = "manifest.json"
_DESIGN, _LOG = "design.toml", "run.log"
WORK = "work.json"
"""Name of the file with the finished parts of a search."""
_HISTORY, _METRICS, _CHECKPOINT = "history.csv", "metrics.json", "checkpoint/state.npz"


@dataclass(frozen=True)
class RunStore:
    """A run directory and the files in it."""

    path: Path

    @property
    def has_only_begun(self) -> bool:
        """True while it holds nothing but what a run begins with, so that a refusal may leave nothing."""
        return self._files <= {LOCK, MANIFEST, _DESIGN, _LOG}

    @property
    def has_searched_only(self) -> bool:
        """True while it holds no more than the finished parts of a search besides, and no result."""
        return self._files <= {LOCK, MANIFEST, _DESIGN, _LOG, WORK}

    @property
    def _files(self) -> set[str]:
        return {file.name for file in self.path.iterdir()}

    @property
    def name(self) -> str:
        """Name of the run directory."""
        return self.path.resolve().name

    @property
    def checkpoint(self) -> Path:
        """Path of the checkpoint of the run."""
        return self.path / _CHECKPOINT

    def manifest(self) -> Manifest:
        """Return the manifest; raises CranktopoError when it is missing, corrupted or of another version."""
        return read_manifest(self.path / MANIFEST)

    def started(self) -> datetime:
        """Return when the run was started; raises CranktopoError when the manifest does not say."""
        text = self.manifest().started
        try:
            return datetime.fromisoformat(text)
        except ValueError:
            raise CranktopoError(
                f"'{self.path / MANIFEST}': started = {quoted(text)} is no date.", hint="Start a new run."
            ) from None

    def set_status(self, status: RunStatus) -> None:
        """Record the status; every status but "running" also records the time as the end of the run."""
        self._record(status=status, ended=None if status == "running" else timestamp())

    def set_done(self, results: Sequence[str]) -> None:
        """Record that the run has ended, with the hash of each file of these names that it has."""
        digests = {name: file_hash(self.path / name) for name in results if (self.path / name).is_file()}
        self._record(status="done", ended=timestamp(), results_sha256=digests)

    def record(self, digests: Mapping[str, str]) -> None:
        """Record hashes of files by name that stay as they are, whether the run goes on or has ended."""
        self._record(recorded_sha256={**self.manifest().recorded_sha256, **digests})

    def recorded(self, name: str) -> bool:
        """Tell whether the run has the hash of a file; raises CranktopoError where the file has another."""
        path, manifest = self.path / name, self.manifest()
        written = manifest.results_sha256.get(name) or manifest.recorded_sha256.get(name)
        if written and file_hash(path) != written:
            raise CranktopoError(
                f"'{path}': changed since the run wrote it.",
                hint="Restore that file, start a new run, or use a copy of it elsewhere.",
            )
        return bool(written)

    def unchanged(self, name: str) -> Path:
        """Return a file of the run; raises CranktopoError where it is not as the run wrote it.

        A line tells where the run has no hash of it, as one of an older version, or one that goes on.
        """
        path = self.path / name
        if not self.recorded(name) and path.is_file():
            note(f"'{path}': the run has no hash of it, so it is not checked for changes")
        return path

    def resume(self) -> None:
        """Mark the run as running again, with the time, and clear what a killed process left unfinished."""
        sweep_temporaries(self.path)
        resumed = (*self.manifest().resumed, timestamp())
        self._record(status="running", ended=None, resumed=resumed, results_sha256={})

    def _record(self, **changes: Any) -> None:
        write_json(self.path / MANIFEST, self.manifest().model_copy(update=changes).as_json())

    def require_same_inputs(self) -> None:
        """Check that the input files are those the run was started with; raises CranktopoError."""
        for role, file in self.manifest().inputs.items():
            if file_hash(Path(file.path)) != file.sha256:
                raise CranktopoError(
                    f"run '{self.path}': {role} '{file.path}' changed since it was started.",
                    hint="Restore that file, or start a new run.",
                )

    def log(self, text: str) -> None:
        """Append one line with the time to run.log."""
        try:
            with open(self.path / _LOG, "a", encoding="utf-8", opener=no_link) as file:
                file.write(f"{timestamp()} {text}\n")
        except OSError as error:
            raise unwritable(self.path / _LOG, error) from None

    def write_history(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Write history.csv: one row per iteration, columns in order of first appearance, units in names."""
        columns = list(dict.fromkeys(key for row in rows for key in row))
        text = io.StringIO()
        writer = csv.DictWriter(text, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
        write_text(self.path / _HISTORY, text.getvalue())

    def read_history(self) -> list[dict[str, Any]]:
        """Return the rows of history.csv, numbers as numbers; none before the first write."""
        path = self.unchanged(_HISTORY)
        if not path.is_file():
            return []
        lines = read_text_file(path, f"'{path}'").splitlines()
        return [{k: _number(v) for k, v in row.items() if k and v} for row in csv.DictReader(lines)]

    def write_metrics(self, metrics: Mapping[str, Any]) -> None:
        """Write metrics.json; raises CranktopoError when a number is not finite."""
        write_json(self.path / _METRICS, metrics)


def check_destination(out: Path | str | None, root: Path = RUNS) -> Path | None:
    """Return `out` as a path if a run can be made in it or anew under `root`: call it before long work.

    Writes nothing. Raises CranktopoError where `out` is a file or holds files, or its parent is not writable.
    """
    out = as_path_if_any(out)
    if out is not None and out.exists():
        _check_empty(out)
    check_folder(out or root)
    return out


def create_run(
    *,
    design: str,
    design_toml: str,
    scene: Mapping[str, Any],
    options: Mapping[str, Any],
    command: Sequence[str],
    inputs: Mapping[str, Path] | None = None,
    assumed: Sequence[Mapping[str, Any]] = (),
    out: Path | None = None,
    root: Path = RUNS,
) -> RunStore:
    """Make a new run directory with its manifest and a copy of the design.

    Call it after all validation: nothing exists on the disk before. Raises CranktopoError where the directory
    is taken or cannot be written, or an input cannot be read.

    Args:
        design_toml: text of the design as the user wrote it.
        scene, options: the resolved scene and what the command line added to it, plain values.
        inputs: other input files by role, hashed into the manifest.
        assumed: what the scene does not say and is assumed.
        out: directory to use; it must not exist or be empty. By default
            `root/<date-time>_<design>_<hash>`, hash over scene and options.
    """
    check_destination(out, root)
    stem = f"{datetime.now():%Y%m%d-%H%M%S}_{design}_{settings_hash(scene, options)[:8]}"
    name = stem if out is None else out.resolve().name
    manifest = new_manifest(
        run=name,
        design=design,
        command=command,
        scene=scene,
        options=options,
        inputs=inputs or {},
        assumed=assumed,
    )
    with unfinished_folder(root if out is None else out.parent) as folder:
        write_text(folder / _DESIGN, design_toml)
        write_json(folder / MANIFEST, manifest.as_json())
        RunStore(folder).log(f"started: {shlex.join(command)}")
        return RunStore(_published(folder, root / stem) if out is None else moved(folder, out))


def open_run(reference: str | Path, root: Path = RUNS) -> RunStore:
    """Return an existing run by path, by name or by the beginning of its name.

    Raises CranktopoError: no such run, several with that beginning, not a run, manifest unusable.
    """
    path = Path(reference)
    if not path.exists():
        path = _by_name(str(reference), root)
    if not path.is_dir() or not (path / MANIFEST).is_file():
        what = f"{MANIFEST} is missing" if path.is_dir() else "a file"
        raise CranktopoError(
            f"run '{reference}': not a run directory ({what}).", hint="List runs with 'cranktopo runs list'."
        )
    run = RunStore(path)
    run.manifest()
    return run


def status_of(folder: Path) -> RunStatus | None:
    """Return the status of the run in a folder, None where none was begun; raises CranktopoError."""
    return open_run(folder).manifest().status if (folder / MANIFEST).is_file() else None


def runs_named(reference: str, root: Path = RUNS) -> list[str]:
    """Return the names of the runs that begin so; none for an empty beginning."""
    names = [run.path.name for run in list_runs(root)]
    return [name for name in names if name.startswith(reference)] if reference else []


def list_runs(root: Path = RUNS) -> list[RunStore]:
    """Return the runs under `root`, oldest first; directories without a manifest are left out."""
    found = sorted(root.glob(f"*/{MANIFEST}"))
    return [RunStore(path.parent) for path in found if not path.parent.name.startswith(".")]


def remove_run(run: RunStore) -> None:
    """Delete a run directory that no process works in; raises CranktopoError."""
    run.manifest()
    with locked(run.path):
        delete_folder(run.path)


def delete_folder(folder: Path) -> None:
    """Delete the directory of a run that this process has locked; raises CranktopoError."""
    try:
        shutil.rmtree(folder)
    except OSError as error:
        raise unwritable(folder, error) from None


def _check_empty(out: Path) -> None:
    if not out.is_dir():
        raise CranktopoError(f"output '{out}': exists and is a file.", hint="Choose another --out.")
    if any(out.iterdir()):
        raise CranktopoError(
            f"output '{out}': exists and is not empty; runs are never overwritten.",
            hint="Choose another --out.",
        )


def _published(folder: Path, preferred: Path) -> Path:
    """Return the folder under the wanted name, with a number behind it where that is taken."""
    number = 1
    while True:
        path = preferred if number == 1 else preferred.with_name(f"{preferred.name}-{number}")
        manifest = read_json(folder / MANIFEST)
        write_json(folder / MANIFEST, {**manifest, "run": path.name})
        if not path.exists():
            try:
                return moved(folder, path)
            except CranktopoError:
                if not path.exists():
                    raise
        number += 1


def _by_name(reference: str, root: Path) -> Path:
    matches = runs_named(reference, root)
    if reference in matches or len(matches) == 1:
        return root / (reference if reference in matches else matches[0])
    if matches:
        raise CranktopoError(
            f"run '{reference}': {len(matches)} runs begin so: {', '.join(matches[:4])}.",
            hint="Give more of the name.",
        )
    names = [run.path.name for run in list_runs(root)]
    near = f"{suggest(reference, names)} " if get_close_matches(reference, names, n=1) else ""
    raise CranktopoError(
        f"run '{reference}': no such run under '{root}'.", hint=f"{near}List runs with 'cranktopo runs list'."
    )


def _number(text: str) -> int | float | str:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
