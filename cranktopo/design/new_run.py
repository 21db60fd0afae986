"""A run directory for a scene, with all that a later reader and a resumption need."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cranktopo.design.assumed import Assumption, assumed_json
from cranktopo.design.loading import input_files
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.runs.directories import RunStore, create_run


def new_run(
    scene: Scene,
    assumed: Sequence[Assumption],
    out: Path | None,
    design_toml: str | None,
    command: Sequence[str],
    options: Mapping[str, Any],
) -> RunStore:
    """Make the directory of a run, its scene and its manifest.

    Args:
        out: directory; None makes a new one under runs/.
        design_toml: text of the design as the user wrote it; None writes it from the scene.
        command: the command line.
        options: what the scene does not hold.

    Raises:
        CranktopoError: the directory is taken, or cannot be written.
    """
    return create_run(
        design=scene.name,
        design_toml=design_toml or toml_text(scene, f"Design of this run: {scene.name}"),
        scene=scene.model_dump(mode="json"),
        options=dict(options),
        command=command,
        inputs=input_files(scene),
        assumed=assumed_json(assumed),
        out=out,
    )
