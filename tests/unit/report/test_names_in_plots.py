"""Figures as files: names as they are, a pair of `$` being no formula; a full disk."""

from __future__ import annotations

import io
from pathlib import Path

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


def test_names_of_ticks_are_drawn_as_they_are() -> None:
    """Of places and of categories; labels of parts of a figure too."""
    figure = Figure()
    above, below = figure.add_subfigure(figure.add_gridspec(1, 1)[0]).subplots(2)
    above.plot([0, 1], [0, 1])
    above.set_xticks([0, 1], ["C45 $x^{", "$b$"])
    below.barh(["$n_{$", "m"], [1, 2])
    assert png(figure).startswith(b"\x89PNG")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("ending", ["pdf", "svg", "png"])
def test_a_full_disk_is_the_error_of_the_system(ending: str, tmp_path: Path) -> None:
    """matplotlib and its compressors turn it into errors of their own."""
    path = tmp_path / f"plot.{ending}"
    path.symlink_to("/dev/full")
    with pytest.raises(OSError, match="No space left"):
        save_figure(Figure(), path)
