"""Lengths of main journals that keep throws as far apart as they were."""

from __future__ import annotations

from cranktopo.design.schema import Scene

JOURNAL_LENGTHS = ("throw.main_journal.length_mm", "throw.second_main_journal_length_mm")
SAME_PITCH_MM = 1e-6
"""Difference of two pitches that counts as none."""


def lengths_at_pitch(scene: Scene, pitch_mm: float) -> dict[str, float]:
    """Return the lengths of a scene's main journals at which its throws are so far apart, by key path."""
    lengths = (scene.throw.main_journal.length_mm, scene.throw.second_main_journal_length_mm)
    more = pitch_mm - scene.pitch_mm
    return {
        key: length + more for key, length in zip(JOURNAL_LENGTHS, lengths, strict=True) if length is not None
    }
