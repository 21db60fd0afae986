"""The Mikron's throw and masses in engines of other arrangements."""

from __future__ import annotations

from cranktopo.design.loading import designs_folder, parse_scene
from cranktopo.design.schema import Scene

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
VEE = "layout = 'V'\nbank_angle_deg = 90.0\n"


def arranged(
    arrangement: str, cylinders: int = 4, order: tuple[int, ...] = (1, 3, 4, 2), strokes: int = 4
) -> Scene:
    """The Mikron with another `[engine.arrangement]`."""
    text = MIKRON
    for old, new in (
        ("cylinders = 4", f"cylinders = {cylinders}"),
        ("[1, 3, 4, 2]", str(list(order))),
        ("strokes = 4", f"strokes = {strokes}"),
        ("[engine.masses]", f"[engine.arrangement]\n{arrangement}\n[engine.masses]"),
    ):
        assert old in text
        text = text.replace(old, new)
    return parse_scene(text)
