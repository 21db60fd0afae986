"""Header of an indicator diagram: which column holds the crank angle, which the pressure, in what unit.

Names as indicating systems write them, in English or German: `Kurbelwinkel [°KW]`, `PCYL1 (bar)`, `p_MPa`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import NamedTuple

from cranktopo.base.errors import quoted
from cranktopo.base.units import MPA_PER

HEADER_HINT = "Start it with a line such as crank_angle_deg,pressure_bar (or pressure_MPa)."
_ANGLE, _PRESSURE = "crank_angle_deg", "pressure_"
_NAMES = {"crank angle": _ANGLE, "pressure": "pressure_bar, or pressure_ with its own unit"}
"""Names that are taken before all others: by them a user chooses among several columns."""
_GAUGE_UNITS = {f"{unit.lower()}g": factor for unit, factor in MPA_PER.items()}
_FACTORS = {
    **{unit.lower(): factor for unit, factor in MPA_PER.items()},
    "bara": MPA_PER["bar"],
    **_GAUGE_UNITS,
}
_UNIT_WORDS = "bar, kPa, MPa, Pa, hPa or mbar"
_DEGREES = {"grad", "gradkw", "cad"}
"""Beside all words that begin with `deg` or a degree sign."""
_CRANK = {"crank", "crankangle", "kurbelwinkel", "kurbel", "kw", "ca", "cad", "degca", "gradkw", "°kw", "°ca"}
_PLAIN = {"p", "pressure", "druck", "abs", "absolute", "absolut", "a"}
_CYLINDER = re.compile(r"p?(cyl|zyl)(inder)?(druck|pressure)?")
_GAUGE = {"g", "gauge", "rel", "relative", "relativ", "überdruck", *_GAUGE_UNITS}
_TEMPERATURE = re.compile(r"(deg|grad|°)[\s_]*[cfk]\b")
_WORD = re.compile(r"°?[^\W\d_]+|°")
_BRACKETS = re.compile(r"[\[(]([^\])]*)[\])]")
_NUMBER = re.compile(r"[+-]?[.,]?\d")


class UnusableError(ValueError):
    """The reason why a file of a pressure trace is unusable, and what to do next."""

    def __init__(self, what: str, hint: str = "") -> None:
        super().__init__(what)
        self.hint = hint


class TraceColumns(NamedTuple):
    """Index of the column of the crank angle, of that of the pressure, and MPa of one unit of it."""

    angle: int
    pressure: int
    factor: float


def trace_columns(header: Sequence[str]) -> TraceColumns:
    """Return the columns that a header names; raises UnusableError where none or several fit."""
    angle = _chosen(header, _in_degrees, (_is_named_angle, _of_crank), "crank angle", "deg")
    pressure = _chosen(header, _pressure_unit, (_is_named_pressure, _of_cylinder), "pressure", _UNIT_WORDS)
    if _GAUGE & set(_words(header[pressure])):
        raise UnusableError(
            f"column {quoted(header[pressure])} is a gauge pressure",
            "Pressures must be absolute: add that of the surroundings, and rename the column.",
        )
    return TraceColumns(angle, pressure, _FACTORS[_pressure_unit(header[pressure])])


def is_row_of_units(row: Sequence[str]) -> bool:
    """Tell whether a row below the header holds units, such as `Grad;bar`."""
    return not any(map(_NUMBER.match, row)) and any(_in_degrees(cell) or _pressure_unit(cell) for cell in row)


def with_units(header: Sequence[str], units: Sequence[str]) -> list[str]:
    """Return the names of a header with the units of the row below it."""
    padded = [*units, *[""] * len(header)]
    return [
        f"{name} [{unit.strip('[]()')}]" if unit else name for name, unit in zip(header, padded, strict=False)
    ]


def _chosen(
    header: Sequence[str],
    fits: Callable[[str], object],
    preferred: Sequence[Callable[[str], bool]],
    quantity: str,
    units: str,
) -> int:
    """Return the one column that fits, of several that which the first rule has alone."""
    found = [index for index, cell in enumerate(header) if fits(cell)]
    for rule in preferred:
        found = [index for index in found if rule(header[index])] or found
    if not found:
        raise UnusableError(f"header {quoted(list(header))}: no {quantity} in {units}", HEADER_HINT)
    if len(found) > 1:
        names = ", ".join(quoted(header[index]) for index in found)
        raise UnusableError(
            f"several columns fit as {quantity}: {names}",
            f"Rename the header of the one to be read to {_NAMES[quantity]}.",
        )
    return found[0]


def _lower(cell: str) -> str:
    """The name in small letters, with one degree sign for all that look like it, temperatures as a word."""
    return _TEMPERATURE.sub("temperature", re.sub("[º˚]", "°", cell).lower())


def _words(text: str) -> list[str]:
    return _WORD.findall(_lower(text))


def _unit_texts(cell: str) -> list[str]:
    """Return the places where a unit may stand: in brackets, or else after a stroke or as a word of the name.

    A rate, such as bar/°KW in brackets, is neither an angle nor a pressure.
    """
    text = _lower(cell)
    inside = [part for part in _BRACKETS.findall(text) if "/" not in part]
    return [*inside, _BRACKETS.sub(" ", text).rpartition("/")[2]]


def _in_degrees(cell: str) -> bool:
    if _pressure_unit(cell):
        return False
    words = [word for text in _unit_texts(cell) for word in _words(text)]
    return any(word in _DEGREES or word.startswith(("deg", "°")) for word in words)


def _pressure_unit(cell: str) -> str:
    """Unit of a pressure in small letters; empty for another quantity and where two units are named."""
    for text in _unit_texts(cell):
        words = _words(text)
        # "pa" is ambient pressure where another unit follows it, as in pa_bar.
        found = {word for word in words if word in _FACTORS and (word != "pa" or word == words[-1])}
        if found:
            return found.pop() if len(found) == 1 and "per" not in words else ""
    return ""


def _is_named_angle(cell: str) -> bool:
    return cell.lower() == _ANGLE


def _is_named_pressure(cell: str) -> bool:
    return cell.lower().startswith(_PRESSURE) and cell.lower().removeprefix(_PRESSURE) in _FACTORS


def _of_crank(cell: str) -> bool:
    return bool(_CRANK & set(_words(cell)))


def _of_cylinder(cell: str) -> bool:
    words = _words(cell)
    plain = all(word in _PLAIN or word in _FACTORS for word in words)
    return plain or any(map(_CYLINDER.fullmatch, words))
