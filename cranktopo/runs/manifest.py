"""Origin of a run: command, resolved scene, versions, hashes, status."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Mapping, Sequence
from datetime import datetime
from importlib import metadata
from pathlib import Path
from typing import Any, Literal

from pydantic import ConfigDict, Field, ValidationError

from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.faults import MISSING, faults_of
from cranktopo.base.files import GEOMETRY_LIMIT_MIB, check_input, json_text, read_json
from cranktopo.base.reproducible import SEED
from cranktopo.base.result import Result

SCHEMA_VERSION = 1
RunStatus = Literal["running", "done", "interrupted", "failed"]
_PACKAGES = (
    "cranktopo",
    "numpy",
    "scipy",
    "jax",
    "jaxlib",
    "nlopt",
    "scikit-image",
    "trimesh",
    "manifold3d",
    "meshio",
    "gmsh",
    "scikit-fem",
)


class InputFile(Result):
    """A file that a run read, with its SHA-256 (hex) at the start."""

    path: str
    sha256: str


class Manifest(Result):
    """Origin of a run, as its manifest.json holds it; keys that a newer version added stay in it."""

    model_config = ConfigDict(extra="allow")

    schema_version: int
    run: str
    design: str
    command: tuple[str, ...]
    status: RunStatus
    started: str
    """Local time with its offset from UTC, ISO 8601, as of the times that follow."""
    ended: str | None = None
    resumed: tuple[str, ...] = ()
    seed: int
    settings_sha256: str
    results_sha256: dict[str, str] = Field(default_factory=dict)
    """Of the files with what the run reached, by name, once it has ended."""
    recorded_sha256: dict[str, str] = Field(default_factory=dict)
    """Of the files of finished parts, and of what other commands added, by name: a resume leaves them."""
    inputs: dict[str, InputFile] = Field(default_factory=dict)
    """By their roles."""
    versions: dict[str, str | None]
    options: dict[str, Any]
    """Additions of the command line to the scene, plain values."""
    scene: dict[str, Any]
    assumed: tuple[dict[str, Any], ...] = ()


def new_manifest(
    *,
    run: str,
    design: str,
    command: Sequence[str],
    scene: Mapping[str, Any],
    options: Mapping[str, Any],
    inputs: Mapping[str, Path],
    assumed: Sequence[Mapping[str, Any]] = (),
) -> Manifest:
    """Return the manifest of a run that starts now; raises CranktopoError for an unreadable input."""
    return Manifest(
        schema_version=SCHEMA_VERSION,
        run=run,
        design=design,
        command=tuple(command),
        status="running",
        started=timestamp(),
        seed=SEED,
        settings_sha256=settings_hash(scene, options),
        inputs={role: InputFile(path=str(path), sha256=file_hash(path)) for role, path in inputs.items()},
        versions=versions(),
        options=dict(options),
        scene=dict(scene),
        assumed=tuple(dict(entry) for entry in assumed),
    )


def settings_hash(scene: Mapping[str, Any], options: Mapping[str, Any]) -> str:
    """Return SHA-256 (hex) over the resolved scene and the options, whatever the order of their keys."""
    text = json_text({"options": _ordered(options), "scene": _ordered(scene)}, "settings")
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def file_hash(path: Path) -> str:
    """Return SHA-256 (hex) of a file's content; raises CranktopoError for what is no readable file."""
    check_input(path, f"input '{path}'", GEOMETRY_LIMIT_MIB, "Check the path.")
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise CranktopoError(
            f"input '{path}': cannot be read: {error.strerror}.", hint="Check the path."
        ) from None


def versions() -> dict[str, str | None]:
    """Return versions of python and of the packages that make the numbers; None for one not installed."""
    found: dict[str, str | None] = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            found[package] = None
    return found


def timestamp() -> str:
    """Return the local time now with its offset from UTC, ISO 8601, to the second."""
    return datetime.now().astimezone().isoformat(timespec="seconds")


def read_manifest(path: Path) -> Manifest:
    """Return the manifest in a file; raises CranktopoError where it is none that this program can use."""
    data = read_json(path)
    version = data.get("schema_version")
    if version != SCHEMA_VERSION:
        raise CranktopoError(
            f"'{path}': schema_version {quoted(version)}, this program reads {SCHEMA_VERSION}.",
            hint="Use the version of cranktopo that made the run, or start a new one.",
        )
    try:
        manifest = Manifest.model_validate(data)
    except ValidationError as error:
        raise CranktopoError(f"'{path}': {_wrong(error)}.", hint="Start a new run.") from None
    if settings_hash(manifest.scene, manifest.options) != manifest.settings_sha256:
        raise CranktopoError(
            f"'{path}': changed by hand, its scene and options do not match settings_sha256.",
            hint="Restore it; to change settings, edit the design and start a new run.",
        )
    return manifest


def _wrong(error: ValidationError) -> str:
    """Return which keys are missing; where none is, which are not as written."""
    faults = faults_of(error)
    missing = [str(fault.place[0]) for fault in faults if fault.kind == MISSING and len(fault.place) == 1]
    if missing:
        return f"incomplete, {', '.join(missing)} missing"
    wrong = dict.fromkeys(str(fault.place[0]) for fault in faults)
    return f"damaged, {', '.join(wrong)} not as written"


def _ordered(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _ordered(value[key]) for key in sorted(value)}
    if isinstance(value, list | tuple):
        return [_ordered(item) for item in value]
    return value
