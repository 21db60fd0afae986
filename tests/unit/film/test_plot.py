"""What `film --plot` draws: an orbit for each bearing, in its clearance, with the place of the least film."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.tasks.film import plot
from cranktopo.tasks.film.stage import films_and_orbits
from tests.unit.film.test_film import scene


def test_orbits_are_drawn_in_their_clearance(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Up is along the first cylinder, the real axis; right is where the shaft turns to."""
    own, drawn = scene(), list[Any]()
    write = plot.save_figure
    monkeypatch.setattr(
        plot, "save_figure", lambda figure, *to, **how: (drawn.append(figure), write(figure, *to, **how))
    )
    monkeypatch.setattr("cranktopo.tasks.film.stage.with_conserving", lambda _, films, *rest: tuple(films))
    _, found = films_and_orbits(own)
    plot.plot_films(own.name, 2100.0, found, tmp_path / "film.png")
    assert (tmp_path / "film.png").stat().st_size > 10_000
    film, pressure, *places = drawn[0].axes
    shown = [axes for axes in places if axes.axison and axes.get_title()]
    assert [axes.get_title() for axes in shown] == [loaded.name for loaded, _ in found]
    assert len(film.lines) == len(pressure.lines) == len(found)
    for axes, (_, steady) in zip(shown, found, strict=True):
        edge, path, least = (line.get_xydata() for line in axes.lines)
        assert np.hypot(*edge.T) == pytest.approx(1.0)
        assert path[:-1] @ [1j, 1] == pytest.approx(steady.eccentricity)
        assert (path[0] == path[-1]).all(), "closed"
        assert np.hypot(*least[0]) == np.hypot(*path.T).max()
        assert axes.get_aspect() == 1.0
