"""A scene as TOML text that reads back as the same scene."""

from __future__ import annotations

from cranktopo.design.schema import Scene


def toml_text(scene: Scene, heading: str) -> str:
    """Return the scene as TOML below a comment; values that were left out or are None stay out."""
    import tomlkit

    data = scene.model_dump(mode="json", exclude_none=True)
    return f"# {heading}\n{tomlkit.dumps(data)}"
