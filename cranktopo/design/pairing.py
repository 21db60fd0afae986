"""Two webs that were found one by one, together on the throw that they are for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.design.copying import copy_of
from cranktopo.design.halves import halves
from cranktopo.design.loading import load_scene, parse_scene
from cranktopo.design.schema import Scene
from cranktopo.throw.geometry import Journal

_JOURNALS = ("main_journal", "crankpin")


def pair_text(design: str, file: Path, first: Scene | None = None, second: Scene | None = None) -> str:
    """Text of a design for another file, with other webs and the lengths of journals that come with them.

    Args:
        design: TOML path or name of a built-in design, whose halves may differ.
        first, second: designs of one web each, whose halves are alike; without one the design's own stays.

    Raises:
        CranktopoError: a throw that is not the design's, or webs that do not go with each other.
    """
    import tomlkit

    own = halves(load_scene(design, whole=True))
    given = {"--first": first, "--second": second}
    for (option, scene), half in zip(given.items(), own, strict=True):
        if scene is not None:
            _check_throw(option, scene, half)
    one, other = (scene or half for scene, half in zip(given.values(), own, strict=True))
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
    return scene.web.model_dump(mode="json", exclude_none=True)


def _check_throw(option: str, scene: Scene, half: Scene) -> None:
    """Refuse another throw: only the lengths of its journals may differ."""
    pairs: dict[str, tuple[Any, Any]] = {"radius_mm": (scene.throw.radius_mm, half.throw.radius_mm)}
    for name in _JOURNALS:
        one, other = getattr(scene.throw, name), getattr(half.throw, name)
        keys = [key for key in Journal.model_fields if key != "length_mm"]
        pairs |= {f"{name}.{key}": (getattr(one, key), getattr(other, key)) for key in keys}
    for key, (found, wanted) in pairs.items():
        if found != wanted:
            raise CranktopoError(
                f"{option}: its throw.{key} is {found}, that of the design {wanted}.",
                hint="A web goes onto the journals that it was found for.",
            )
