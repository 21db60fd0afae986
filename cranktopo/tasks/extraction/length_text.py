"""Least member and gap that were asked for beside what was measured on the surface."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_NAMES = {"member": "thinnest member", "gap": "narrowest gap"}
_KEPT = 0.9
"""Share of an asked length that counts as kept: cells and smoothing round the surface by about as much."""


def asked_lengths(surface: Mapping[str, Any]) -> dict[str, tuple[float | None, float]]:
    """Measured and asked length of everything that was asked for, mm, by its name in words.

    Args:
        surface: as metrics.json holds it; the measured length is None where no such wall faces another.
    """
    walls = surface.get("walls") or {}
    return {
        words: (walls[f"least_{name}_mm"], walls[f"asked_{name}_mm"])
        for name, words in _NAMES.items()
        if walls.get(f"asked_{name}_mm") is not None
    }


def kept(measured_mm: float | None, asked_mm: float) -> bool:
    """Whether a measured length is the asked one, as nearly as a surface is known."""
    return measured_mm is None or measured_mm >= _KEPT * asked_mm


def length_lines(surface: Mapping[str, Any]) -> list[str]:
    """One line for every length that was asked for."""
    return [
        f"{words} {shown(measured)}, {asked:g} mm asked{'' if kept(measured, asked) else ': NOT KEPT'}"
        for words, (measured, asked) in asked_lengths(surface).items()
    ]


def shown(measured_mm: float | None) -> str:
    """A measured length; none where there is nothing to measure."""
    return "none" if measured_mm is None else f"{measured_mm:.1f} mm"
