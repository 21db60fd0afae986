"""What the user wrote: schema, TOML loading, material library, built-in designs."""

from cranktopo.scene.loading import builtin_designs, load_scene, parse_scene, scene_from_dict
from cranktopo.scene.schema import Scene

__all__ = ["Scene", "builtin_designs", "load_scene", "parse_scene", "scene_from_dict"]
