"""Names as they are in plots: a pair of `$` is no formula."""

from __future__ import annotations

import io

import pytest
from matplotlib.figure import Figure

from cranktopo.report.plot import png, save_figure


@pytest.mark.parametrize("name", ["steel $x^{", "C45 $a$ $b", r"$\frac$"])
def test_a_name_with_dollars_is_drawn_as_it_is(name: str) -> None:
    figure = Figure()
    axes = figure.subplots()
    axes.loglog([1, 1000], [1, 10], label=name)
    axes.set(title=name, xlabel=name)
    axes.annotate(name, (10, 3))
    axes.legend()
    assert png(figure).startswith(b"\x89PNG")
    stream = io.StringIO()
    save_figure(figure, stream, format="svg")
    assert all(label.get_parse_math() for label in axes.get_xticklabels())
