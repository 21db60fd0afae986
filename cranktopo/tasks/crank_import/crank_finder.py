"""Crank axis, main journals, crankpins and webs of a body, found among its exact faces.

The crank axis is the line whose full cylinders reach outermost along it; every other line of full cylinders
parallel to it carries crankpins. A web lies between a pin and the main journal next to it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.tasks.crank_import.choices import EndJournals
from cranktopo.tasks.crank_import.end_journals import cut_ends
from cranktopo.tasks.crank_import.end_steps import EndFinder
from cranktopo.tasks.crank_import.found_crank import FoundCrank, FoundHalf, FoundJournal, FoundStep, meet
from cranktopo.tasks.crank_import.no_crank import PIN_SHARE, check_parallel, no_crank, splines_words
from cranktopo.tasks.importing.faces import (
    CylinderFace,
    Faces,
    from_line_mm,
    lines_of,
    parallel,
    same_axis,
    span_along,
)

_Spans = Callable[[CylinderFace], tuple[float, float]]
_NEAR = 1e-5
"""Share of a journal's radius in which places along the axis count as one."""
_SHORTEST = 0.15
"""Length of a journal over its radius; what is shorter is a collar."""
_SHORTEST_WEB = 0.02
"""Thickness of a web over the pin's radius."""
_OFF_AXIS = 0.05
"""Distance of a pin's axis from the crank axis over the main journal's radius."""
_DISC = 0.9
"""A cylinder on the crank axis that holds so much of the pin is a disc web or a flange, not a journal."""


def find_crank(faces: Faces, name: str, ends: EndJournals = "auto") -> FoundCrank:
    """Return the crank that the faces of one body show.

    Raises:
        CranktopoError: no two parallel lines of full cylinders, or no pin between main journals.
    """
    lines = lines_of([face for face in faces.cylinders if face.outward and face.full])
    if not lines:
        raise no_crank(name, f"no face is a full cylinder{splines_words(faces)}")
    direction = _direction(lines)
    check_parallel([line[0] for line in lines], direction, name)
    lines = [line for line in lines if parallel(line[0].axis, direction)]
    main_line, assumed = _axis(lines, direction, name)
    origin = main_line[0].point_mm - (main_line[0].point_mm @ direction) * direction
    found = _Finder(faces, origin, direction)
    pins = found.pins([line for line in lines if line is not main_line], main_line, name)
    main_line = found.welded(main_line)
    journals, unread = found.mains(main_line, pins)
    beyond = EndFinder(faces, origin, direction)
    steps = [
        beyond.steps_beyond(main_line, journals[side].faces_mm[side], outward)
        for side, outward in ((0, -1), (-1, 1))
    ]
    holes = [
        words
        for own, side, outward in zip(steps, (0, -1), (-1, 1), strict=True)
        if journals[side].free[side]
        for words in beyond.holes_left(own, journals[side].faces_mm[side], outward)
    ]
    cut, missing = cut_ends(journals, len(pins), (bool(steps[0]), bool(steps[1])), ends)
    halves = _halves(journals, pins, cut)
    if not halves:
        raise no_crank(name, "no crankpin lies next to a main journal")
    taken = [
        None if half.main_plane_mm in half.main.faces_mm or not any(half.main.free) else own
        for half, own in zip((halves[0], halves[-1]), steps, strict=True)
    ]
    known = {words for own in taken for step in own or () for words in _step_words(step)}
    left = [words for words in unread if words not in known]
    crank = FoundCrank(
        origin,
        direction,
        journals,
        pins,
        halves,
        (taken[0], taken[1]),
        tuple(assumed + missing),
        tuple(left + found.spare + holes),
    )
    return replace(crank, unread=(*crank.unread, *_flying_words(crank)))


def _flying_words(crank: FoundCrank) -> list[str]:
    flying = [
        f"crankpins {number} and {number + 1} have no main journal between them: their flying web, and ends "
        "and main journals of the crank, are in no design"
        for number in crank.flying
        if number not in crank.split
    ]
    return [*flying, *([_split_words(crank)] if crank.split else [])]


def _split_words(crank: FoundCrank) -> str:
    pairs = ", ".join(f"{number} and {number + 1}" for number in crank.split)
    apart = ", ".join(dict.fromkeys(f"{abs(crank.splay_deg(number)):.4g}" for number in crank.split))
    return (
        f"crankpins {pairs} meet without a web, {apart} deg apart: split pins. A design has its half throw, "
        "with a straight pin of twice the half pin's length. The splay is among the lines of the engine; "
        "ends and main journals of the crank are in no design"
    )


def _step_words(step: FoundStep) -> tuple[str, str]:
    """Return a step as `mains` names what it does not take."""
    size = f"{2 * step.radius_mm:.5g}"
    return f"step of {size} x {step.length_mm:.4g} mm on the crank axis", f"disc or flange of {size} mm"


def _direction(lines: Sequence[Sequence[CylinderFace]]) -> Array:
    """Return the direction in which most area of full cylinders lies, its largest component positive."""

    def area(line: Sequence[CylinderFace]) -> float:
        return sum(face.area_mm2 for other in lines for face in other if parallel(face.axis, line[0].axis))

    axis = max(lines, key=area)[0].axis
    return np.asarray(axis * np.sign(axis[np.abs(axis).argmax()]))


def _axis(
    lines: list[list[CylinderFace]], direction: Array, name: str
) -> tuple[list[CylinderFace], list[str]]:
    """Return the line of the main journals, and what was assumed to tell it."""
    if len(lines) < 2:
        raise no_crank(name, "all full cylinders lie on one axis")
    spans = [_extent(line, direction) for line in lines]
    low, high = min(span[0] for span in spans), max(span[1] for span in spans)
    near = _NEAR * max(face.radius_mm for line in lines for face in line)
    outermost = [
        line
        for line, span in zip(lines, spans, strict=True)
        if span[0] < low + near and span[1] > high - near
    ]
    if len(outermost) == 1:
        return outermost[0], []
    ends = [
        line for line, span in zip(lines, spans, strict=True) if span[0] < low + near or span[1] > high - near
    ]
    through = min(ends, key=lambda line: (round(_off_origin(line) / near), -line[0].radius_mm))
    return through, [
        "the crank axis: a half throw has one journal on each axis; the nearer to the file's origin is taken"
    ]


def _off_origin(line: Sequence[CylinderFace]) -> float:
    return from_line_mm(np.zeros(3), line[0].point_mm, line[0].axis)


def _extent(line: Sequence[CylinderFace], direction: Array) -> tuple[float, float]:
    spans = [span_along(face, np.zeros(3), direction) for face in line]
    return min(low for low, _ in spans), max(high for _, high in spans)


class _Finder:
    """Journals of a body along a known axis; places are measured along it from the origin.

    `spare` tells, in words, cylinders off the axis that are no crankpins.
    """

    def __init__(self, faces: Faces, origin: Array, axis: Array) -> None:
        self.origin, self.axis = origin, axis
        inward = [face for face in faces.cylinders if not face.outward and face.full]
        bores = [face for face in inward if parallel(face.axis, axis)]
        self.bores = [face for line in lines_of(bores) for face in self.welded(line)]
        self.steps = sorted(
            float((plane.point_mm - origin) @ axis) for plane in faces.planes if parallel(plane.normal, axis)
        )
        self.spare: list[str] = []

    def pins(
        self, lines: Sequence[list[CylinderFace]], main: Sequence[CylinderFace], name: str
    ) -> tuple[FoundJournal, ...]:
        """Return the crankpins from low to high; raises CranktopoError without one."""
        thick = max(face.radius_mm for face in main)
        found: list[tuple[float, FoundJournal]] = []
        for line in lines:
            off = from_line_mm(line[0].point_mm, self.origin, self.axis)
            own = [face for face in self.welded(line) if self._long(face)]
            if off < _OFF_AXIS * min(face.radius_mm for face in main) or not own:
                self.spare.append(f"cylinder of {2 * line[0].radius_mm:.4g} mm, {off:.4g} mm off the axis")
                continue
            journals = [face for face in main if face.radius_mm < off + _DISC * own[0].radius_mm]
            for group in _between(own, journals, self._span):
                face = max(group, key=lambda one: one.area_mm2)
                if face.radius_mm > PIN_SHARE * thick:
                    found.append((self._span(face)[0], self._journal(face, (False, False))))
        if not found:
            raise no_crank(name, "no cylinder off the axis is as thick as a crankpin")
        return tuple(journal for _, journal in sorted(found, key=lambda pair: pair[0]))

    def mains(
        self, line: Sequence[CylinderFace], pins: Sequence[FoundJournal]
    ) -> tuple[tuple[FoundJournal, ...], list[str]]:
        """Return the main journals from low to high, and what else turns about the axis."""
        reach = min(
            from_line_mm(pin.centre_mm, self.origin, self.axis) + _DISC * pin.radius_mm for pin in pins
        )
        shafts = sorted((face for face in line if face.radius_mm < reach), key=self._span)
        groups = list(_apart(shafts, pins, self._span))
        journals, unread = (
            [],
            [f"disc or flange of {2 * face.radius_mm:.5g} mm" for face in line if face.radius_mm >= reach],
        )
        for place, group in groups:
            long = [face for face in group if self._long(face)] or list(group)
            if place == 0:
                chosen = max(long, key=self._span)
            elif place == len(pins):
                chosen = min(long, key=self._span)
            else:
                chosen = max(long, key=lambda face: face.area_mm2)
            journals.append(self._journal(chosen, (place == 0, place == len(pins))))
            unread += [
                f"step of {2 * face.radius_mm:.5g} x {np.ptp(self._span(face)):.4g} mm on the crank axis"
                for face in group
                if face is not chosen
            ]
        return tuple(journals), unread

    def welded(self, line: Sequence[CylinderFace]) -> list[CylinderFace]:
        """Return the cylinders of one line, those of one radius that follow each other as one."""
        whole: list[CylinderFace] = []
        for face in sorted(line, key=self._span):
            near = _NEAR * face.radius_mm
            last = whole[-1] if whole else None
            if (
                last is None
                or abs(last.radius_mm - face.radius_mm) > near
                or abs(self._span(last)[1] - self._span(face)[0]) > near
            ):
                whole.append(face)
                continue
            more = self._span(face)[1] - self._span(last)[1]
            low, high = last.span_mm
            same = float(last.axis @ self.axis) > 0
            whole[-1] = replace(last, span_mm=(low, high + more) if same else (low - more, high))
        return whole

    def _long(self, face: CylinderFace) -> bool:
        return face.span_mm[1] - face.span_mm[0] > _SHORTEST * face.radius_mm

    def _span(self, face: CylinderFace) -> tuple[float, float]:
        return span_along(face, self.origin, self.axis)

    def _journal(self, face: CylinderFace, free: tuple[bool, bool]) -> FoundJournal:
        """Return a journal whose ends are the next faces across the axis."""
        low, high = self._span(face)
        near = _NEAR * face.radius_mm
        below = max((z for z in self.steps if z < low + near), default=low)
        above = min((z for z in self.steps if z > high - near), default=high)
        bores = [
            2 * bore.radius_mm
            for bore in self.bores
            if same_axis(bore, face)
            and bore.radius_mm < face.radius_mm
            and self._span(bore)[0] < (low + high) / 2 < self._span(bore)[1]
        ]
        ends = (low if free[0] else below, high if free[1] else above)
        return FoundJournal(face.radius_mm, max(bores, default=0.0), ends, free, face.point_mm)


def _between(
    own: Sequence[CylinderFace], mains: Sequence[CylinderFace], span: _Spans
) -> Iterator[list[CylinderFace]]:
    """Yield cylinders of one line in groups that no main journal parts."""
    group: list[CylinderFace] = []
    for face in sorted(own, key=span):
        if group and any(
            span(group[-1])[1] <= span(main)[0] and span(main)[1] <= span(face)[0] for main in mains
        ):
            yield group
            group = []
        group.append(face)
    if group:
        yield group


def _apart(
    shafts: Sequence[CylinderFace], pins: Sequence[FoundJournal], span: _Spans
) -> Iterator[tuple[int, list[CylinderFace]]]:
    """Yield cylinders on the axis with the number of pins below them, by that number."""
    for place in range(len(pins) + 1):
        own = [face for face in shafts if sum(pin.middle_mm < sum(span(face)) / 2 for pin in pins) == place]
        if own:
            yield place, own


def _halves(
    journals: Sequence[FoundJournal], pins: Sequence[FoundJournal], cut: tuple[bool, bool]
) -> tuple[FoundHalf, ...]:
    """Return the half throws from low to high; `cut`: whether the journal of an end is in its middle."""
    halves = []
    for number, pin in enumerate(pins, 1):
        below = max(
            (j for j in journals if j.middle_mm < pin.middle_mm), key=lambda j: j.middle_mm, default=None
        )
        above = min(
            (j for j in journals if j.middle_mm > pin.middle_mm), key=lambda j: j.middle_mm, default=None
        )
        beside = pins[max(number - 2, 0) : number - 1], pins[number : number + 1]
        halved = any(meet(one, pin) for one in beside[0]) or any(meet(pin, one) for one in beside[1])
        one_sided = below is None or above is None or halved
        for main, side in ((below, 0), (above, 1)):
            if main is None or _pin_between(main, pin, pins) or not _web_between(main, pin):
                continue
            ended = next((end for end in (0, 1) if main.free[end] and cut[end]), None)
            plane = main.middle_mm if ended is None else main.faces_mm[ended]
            middle = pin.faces_mm[1 - side] if one_sided else pin.middle_mm
            halves.append(
                FoundHalf(number, main, pin, plane, middle, (main.faces_mm[1 - side], pin.faces_mm[side]))
            )
    return tuple(halves)


def _web_between(main: FoundJournal, pin: FoundJournal) -> bool:
    """Tell whether one journal ends before the other begins."""
    low, high = sorted((main, pin), key=lambda journal: journal.middle_mm)
    return high.faces_mm[0] - low.faces_mm[1] > _SHORTEST_WEB * pin.radius_mm


def _pin_between(main: FoundJournal, pin: FoundJournal, pins: Sequence[FoundJournal]) -> bool:
    low, high = sorted((main.middle_mm, pin.middle_mm))
    return any(low < other.middle_mm < high for other in pins)
