"""The scene of a run: what it was started with, not what its copy of the design says."""

from __future__ import annotations

from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.runs.directories import RunStore


def design_from_run(run: RunStore) -> Scene:
    """Return the scene of a run with the command line's options in it and the paths of its files absolute.

    The design.toml of a run is the user's text: it lacks those options, and its relative paths are relative
    to where it came from.

    Args:
        run: an optimisation or a loop, finished or not.

    Raises:
        CranktopoError: the manifest is missing or damaged, or its scene is invalid.
    """
    manifest = run.manifest()
    return scene_from_dict(manifest["scene"], str(run.path / "manifest.json"))
