"""Values of original and result in words: with their unit, small ones with digits that tell them apart."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from cranktopo.report.goal_table import missed_words
from cranktopo.tasks.web_shape.result import ShapeResult
from cranktopo.tasks.web_shape.text import rounds_table, value_words
from tests.unit.shape.shape_results import invented_data


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


def test_webs_on_the_way_name_the_limits_that_they_miss_as_the_terminal_does() -> None:
    """A miss that shows as 0.00 % is none, by the table as by the terminal."""
    found = ShapeResult.of_json(invented_data(), "shape.json")
    told = [row["limits missed"] for row in rounds_table(found).rows]
    quantities = [price.quantity for price in found.prices]
    assert told == ["torsion by 0.03 %, unbalance by 0.40 %", "-"]
    assert told[0] == missed_words(quantities, found.rounds[0].excess_percent)
    assert missed_words(["torsion"], [0.0049]) == ""
    assert missed_words(["torsion"], [0.0051]) == "torsion by 0.01 %"
