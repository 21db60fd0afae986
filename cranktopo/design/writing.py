"""Designs as text: written, copied, joined of two webs, and kept in a run with what it was started with."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import as_path, write_text
from cranktopo.design.assumed import Assumption
from cranktopo.design.halves import halves
from cranktopo.design.idle_keys import without_idle_keys
from cranktopo.design.loading import (
    design_text,
    load_scene,
    parse_scene,
    resolve_design,
    scene_from_dict,
)
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.scene_files import input_files, name_from
from cranktopo.design.schema import Scene
from cranktopo.runs.directories import RunStore, create_run
from cranktopo.throw.journal import Journal


def copy_of(design: str, file: Path) -> str:
    """Return the text of a design for another file, which names it; what was published about it goes."""
    import tomlkit

    load_scene(design, whole=True)
    document = tomlkit.parse(design_text(design))
    document["name"] = design_name(file)
    document.pop("published", None)
    name_from(document, resolve_design(design).resolve().parent, file.resolve().parent)
    return tomlkit.dumps(document).rstrip() + "\n"


def design_name(file: Path) -> str:
    """Return the name of a design kept in a file: the file's, with a hyphen for what no name may hold."""
    name = re.sub(r"[^A-Za-z0-9._-]+", "-", file.stem).strip("-._")
    if not name:
        raise CranktopoError(
            f"'{file}': no name of a design can be made of '{file.stem}'.",
            hint="Use letters or digits in the file's name.",
            code=ExitCode.USAGE,
        )
    return name


def design_from_run(run: RunStore) -> Scene:
    """Return the scene of a run with the command line's options in it and the paths of its files absolute.

    The design.toml of a run is the user's text: it lacks those options, and its relative paths are relative
    to where it came from.
    """
    return scene_from_dict(run.manifest().scene, str(run.path / "manifest.json"))


def toml_text(scene: Scene, heading: str, *, with_defaults: bool = False) -> str:
    """Return the scene as TOML below a comment; what was assumed stays out, so that commands go on saying so.

    A scene that was stored has every key: of these stay out those that change nothing beside the others.
    `with_defaults` writes these values out: a record holds them whatever later versions assume.
    """
    import tomlkit

    data = scene.model_dump(mode="json", exclude_none=True, exclude_unset=not with_defaults)
    data = data if with_defaults else without_idle_keys(scene, data)
    return f"# {heading}\n{tomlkit.dumps(data)}"


def save_scene(scene: DesignLike, path: Path | str) -> None:
    """Write a scene as a TOML file that every command takes; raises CranktopoError where it cannot."""
    scene = as_scene(scene)
    write_text(as_path(path), toml_text(scene, f"{scene.name}, written by cranktopo"))


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
        options: what the scene does not hold.
    """
    return create_run(
        design=scene.name,
        design_toml=design_toml or toml_text(scene, f"Design of this run: {scene.name}", with_defaults=True),
        scene=scene.model_dump(mode="json"),
        options=dict(options),
        command=command,
        inputs=input_files(scene),
        assumed=[asdict(item) for item in assumed],
        out=out,
    )


_JOURNALS = ("main_journal", "crankpin")


def pair_text(design: str, file: Path, first: Scene | None = None, second: Scene | None = None) -> str:
    """Return the text of a design for another file, with other webs and the lengths of their journals.

    Args:
        first, second: designs of one web each, whose halves are alike; without one the design's own stays.
    """
    import tomlkit

    own = halves(load_scene(design, whole=True))
    webs = {"--first": first, "--second": second}
    for (option, scene), half in zip(webs.items(), own, strict=True):
        if scene is not None:
            _check_throw(option, scene, half)
    one, other = (scene or half for scene, half in zip(webs.values(), own, strict=True))
    document: Any = tomlkit.parse(copy_of(design, file))
    document["web"] = _table(one)
    document["second_web"] = _table(other)
    for name in _JOURNALS:
        document["throw"][name]["length_mm"] = getattr(one.throw, name).length_mm
        document["throw"][f"second_{name}_length_mm"] = getattr(other.throw, name).length_mm
    text = tomlkit.dumps(document)
    parse_scene(text, str(file), file.resolve().parent, whole=True)
    return text


def _table(scene: Scene) -> dict[str, Any]:
    """Return the table of a scene's web, without keys that were not given or change nothing."""
    data = scene.model_dump(mode="json", include={"web"}, exclude_none=True, exclude_unset=True)
    table: dict[str, Any] = _without_empty(without_idle_keys(scene, data)["web"])
    return table


def _without_empty(data: Any) -> Any:
    """Return tables without lists of nothing, which a stored scene has for every list."""
    if isinstance(data, dict):
        return {key: _without_empty(value) for key, value in data.items() if value != []}
    return [_without_empty(value) for value in data] if isinstance(data, list) else data


def _check_throw(option: str, scene: Scene, half: Scene) -> None:
    """Refuse another throw: only the lengths of its journals may differ."""
    pairs: dict[str, tuple[Any, Any]] = {"radius_mm": (scene.throw.radius_mm, half.throw.radius_mm)}
    for name in _JOURNALS:
        one, other = getattr(scene.throw, name), getattr(half.throw, name)
        keys = [key for key in Journal.model_fields if key != "length_mm"]
        pairs |= {f"{name}.{key}": (getattr(one, key), getattr(other, key)) for key in keys}
    for key, (found, expected) in pairs.items():
        if found != expected:
            raise CranktopoError(
                f"{option}: its throw.{key} is {found}, that of the design {expected}.",
                hint="A web goes onto the journals that it was found for.",
            )
