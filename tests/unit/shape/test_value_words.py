"""Values of original and result in words: with their unit, small ones with digits that tell them apart."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from cranktopo.tasks.shape.text import value_words


@pytest.mark.parametrize(
    ("key", "original", "result", "words"),
    [
        ("mass", 2.1234, 1.7994, ("2.123", "1.799", "kg")),
        ("mass", 0.0063127, 0.0058761, ("0.006313", "0.005876", "kg")),
        ("inertia", 2768.2, 2242.1, ("2768", "2242", "kg mm2")),
        ("torsion", 418_860.0, 419_140.0, ("418.86", "419.14", "kN m/rad")),
    ],
)
def test_values_have_digits_and_a_unit(
    key: str, original: float, result: float, words: tuple[str, str, str]
) -> None:
    found = SimpleNamespace(values=SimpleNamespace(original={key: original}, result={key: result}))
    assert value_words(found, key) == words  # type: ignore[arg-type]
