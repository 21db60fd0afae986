"""Plot of the oil films over the cycle, and of the orbits of the journals in their clearances."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from cranktopo.base.files import replacing
from cranktopo.base.units import UM_PER_MM
from cranktopo.numerics.bearing_film.orbit import Orbit
from cranktopo.report.plot import curve_style, name_above, plain_decades, save_figure
from cranktopo.tasks.film.stage import BearingOrbits, LoadedBearing

_COLUMNS = 4
_AXES_INCHES = 8.8
_ORBITS = (
    "Path of each journal's centre in its clearance; up is along the first cylinder; red: the film is least"
)


def plot_films(name: str, rpm: float, found: BearingOrbits, path: Path) -> None:
    """Write film and pressure over the crank angle, and the orbit of every journal; PNG, SVG or PDF.

    Raises:
        CranktopoError: it cannot be written.
    """
    from matplotlib.figure import Figure

    rows = -(-len(found) // _COLUMNS)
    figure = Figure(figsize=(_AXES_INCHES + 1.2, 6 + 2.6 * rows), layout="constrained")
    parts: Any = figure.subfigures(2, 1, height_ratios=(6, 2.6 * rows))
    upper, lower = parts
    lower.suptitle(_ORBITS, fontsize=9)
    _draw_cycle(upper, found)
    places = list(lower.subplots(rows, _COLUMNS, squeeze=False).flat)
    for axes, (loaded, steady) in zip(places, found, strict=False):
        _draw_orbit(axes, loaded, steady)
    for axes in places[len(found) :]:
        axes.set_axis_off()
    figure.suptitle(f"Oil film of {name} at {rpm:g} rpm, by the mobility method for all bearings")
    with replacing(path) as temporary:
        save_figure(figure, temporary, dpi=120)


def _draw_cycle(figure: Any, found: BearingOrbits) -> None:
    film, pressure = figure.subplots(2, 1, sharex=True)
    for number, (loaded, steady) in enumerate(found):
        style = {"color": "k", "lw": 1.5} if loaded is found[-1][0] else {"lw": 1.0, **curve_style(number)}
        film.plot(steady.angle_deg, steady.film_mm * UM_PER_MM, label=loaded.name, **style)
        pressure.plot(steady.angle_deg, steady.pressure_MPa, **style)
    film.set(yscale="log", ylabel="least film (µm)")
    plain_decades(film.yaxis)
    name_above(film, _AXES_INCHES)
    pressure.set(ylabel="largest pressure (MPa)", xlabel="crank angle (deg)", ylim=(0, None))
    for axes in (film, pressure):
        axes.set(xlim=(0, steady.angle_deg[-1]))
        axes.grid(alpha=0.3)


def _draw_orbit(axes: Any, loaded: LoadedBearing, steady: Orbit) -> None:
    """The path of the journal's centre in the clearance; up is along the axis of the first cylinder."""
    edge = np.exp(1j * np.linspace(0, 2 * np.pi, 181))
    path = np.append(steady.eccentricity, steady.eccentricity[0])
    axes.plot(edge.imag, edge.real, color="0.6", lw=1)
    axes.plot(path.imag, path.real, lw=1)
    thinnest = steady.eccentricity[int(steady.film_mm.argmin())]
    axes.plot(thinnest.imag, thinnest.real, "r.")
    axes.set(aspect="equal", title=loaded.name, xticks=[], yticks=[])
    axes.title.set_fontsize(9)
    axes.set_frame_on(False)
