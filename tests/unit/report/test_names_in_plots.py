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


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("ending", ["pdf", "svg", "png"])
def test_a_full_disk_is_the_error_of_the_system(ending: str, tmp_path: Path) -> None:
    """matplotlib and its compressors turn it into errors of their own."""
    path = tmp_path / f"plot.{ending}"
    path.symlink_to("/dev/full")
    with pytest.raises(OSError, match="No space left"):
        save_figure(Figure(), path)
