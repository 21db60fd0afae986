"""Origin of a run: command, resolved scene, versions, hashes, status."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Mapping, Sequence
from datetime import datetime
from importlib import metadata
from pathlib import Path
from typing import Any, Literal, get_args

from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.files import GEOMETRY_LIMIT_MIB, check_input, json_text
from cranktopo.base.reproducible import SEED

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
_KEYS: dict[str, type] = {
    "run": str,
    "design": str,
    "scene": dict,
    "options": dict,
    "settings_sha256": str,
    "status": str,
    "started": str,
}
_LISTS: dict[str, type] = {"command": str, "resumed": str, "assumed": dict}


def new_manifest(
    *,
    run: str,
    design: str,
    command: Sequence[str],
    scene: Mapping[str, Any],
    options: Mapping[str, Any],
    inputs: Mapping[str, Path],
    assumed: Sequence[Mapping[str, Any]] = (),
) -> dict[str, Any]:
    """Return the manifest of a run that starts now; raises CranktopoError for an unreadable input."""
    return {
        "schema_version": SCHEMA_VERSION,
        "run": run,
        "design": design,
        "command": list(command),
        "status": "running",
        "started": timestamp(),
        "ended": None,
        "resumed": [],
        "seed": SEED,
        "settings_sha256": settings_hash(scene, options),
        "inputs": {role: {"path": str(path), "sha256": file_hash(path)} for role, path in inputs.items()},
        "versions": versions(),
        "options": dict(options),
        "scene": dict(scene),
        "assumed": [dict(entry) for entry in assumed],
    }


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


def check_manifest(manifest: Mapping[str, Any], path: Path) -> None:
    """Check that a manifest is one this program can use; raises CranktopoError."""
    version = manifest.get("schema_version")
    if version != SCHEMA_VERSION:
        raise CranktopoError(
            f"'{path}': schema_version {quoted(version)}, this program reads {SCHEMA_VERSION}.",
            hint="Use the version of cranktopo that made the run, or start a new one.",
        )
    missing = [key for key in (*_KEYS, "command") if key not in manifest]
    if missing:
        raise CranktopoError(f"'{path}': incomplete, {', '.join(missing)} missing.", hint="Start a new run.")
    wrong = [key for key, kind in _KEYS.items() if not isinstance(manifest[key], kind)]
    wrong += [] if manifest["status"] in get_args(RunStatus) or "status" in wrong else ["status"]
    wrong += [] if _is_inputs(manifest.get("inputs", {})) else ["inputs"]
    wrong += [key for key, kind in _LISTS.items() if not _is_list(manifest.get(key, []), kind)]
    if wrong:
        raise CranktopoError(
            f"'{path}': damaged, {', '.join(wrong)} not as written.", hint="Start a new run."
        )
    if settings_hash(manifest["scene"], manifest["options"]) != manifest["settings_sha256"]:
        raise CranktopoError(
            f"'{path}': changed by hand, its scene and options do not match settings_sha256.",
            hint="Restore it; to change settings, edit the design and start a new run.",
        )


def _is_list(value: Any, kind: type) -> bool:
    return isinstance(value, list) and all(isinstance(item, kind) for item in value)


def _is_inputs(inputs: Any) -> bool:
    return isinstance(inputs, dict) and all(
        isinstance(entry, dict) and all(isinstance(entry.get(key), str) for key in ("path", "sha256"))
        for entry in inputs.values()
    )


def _ordered(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _ordered(value[key]) for key in sorted(value)}
    if isinstance(value, list | tuple):
        return [_ordered(item) for item in value]
    return value
