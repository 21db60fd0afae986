"""Ends and main journals that an import found, as the [crank] of its design."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import about_z_deg
from cranktopo.base.notes import redirected
from cranktopo.design.crank import Crank
from cranktopo.design.loading import load_scene, parse_scene
from cranktopo.tasks.crank_import.design_text import design_text
from cranktopo.tasks.crank_import.found_crank import FoundCrank, FoundJournal, FoundStep

STEPS = (FoundStep(18.0, 10.0, 16.0), FoundStep(14.0, 0.0, 22.0))


def found(lengths_mm: tuple[float, ...], radius_mm: float = 21.0) -> FoundCrank:
    """The plain Mikron's crank of two throws; its outer journals are whole."""
    at, journals, pins, axis = 0.0, [], [], np.array([0.0, 0.0, 1.0])
    for number, length in enumerate(lengths_mm):
        free = number == 0, number == len(lengths_mm) - 1
        radius = radius_mm if number == 1 else 21.0
        journals.append(FoundJournal(radius, 24.0, (at, at + length), free, np.zeros(3)))
        at += length + 19.0
        pin = np.array([0.0, 48.0 if number else -48.0, 0.0])
        pins.append(FoundJournal(21.0, 24.0, (at, at + 36.0), (False, False), pin))
        at += 36.0 + 19.0
    return FoundCrank(np.zeros(3), axis, tuple(journals), tuple(pins[:-1]), (), (STEPS, ()), (), ())


def crank_of(found_crank: FoundCrank) -> Crank | None:
    text = design_text(load_scene("mikron-iiic-plain"), found_crank, ("half-1.step", None), ("x.step",))
    return parse_scene(text).crank


def test_ends_and_a_longer_journal_are_written() -> None:
    crank = crank_of(found((40.0, 44.0, 40.0)))
    assert crank is not None
    assert crank.throws == ("throw", "throw")
    assert [(own.number, own.length_mm, own.outer_diameter_mm) for own in crank.main_journal] == [
        (1, 44.0, None)
    ]
    assert [end.side for end in crank.end] == ["free", "output"]
    assert [step.length_mm for step in crank.end[0].step] == [16.0, 22.0]
    assert [step.bore_radius_mm for step in crank.end[0].step] == [5.0, 0.0]
    assert crank.end[1].step == ()


def test_what_was_cut_has_no_crank() -> None:
    assert crank_of(replace(found((20.0, 40.0, 20.0)), ends=(None, None))) is None


def test_a_journal_that_the_web_cannot_take_is_left_out() -> None:
    notes: list[str] = []
    with redirected(notes.append):
        assert crank_of(found((40.0, 44.0, 40.0), radius_mm=26.0)) is None
    assert "are left out: " in notes[0]


def across(about_z: float) -> Array:
    """The direction of a throw that is turned about the axis."""
    turn = np.radians(about_z)
    return np.array([-np.sin(turn), np.cos(turn), 0.0])


def test_throws_have_one_angle_in_design_and_words() -> None:
    """A crank at 0, 120, 240 deg, turned as the exported shaft is, is told so and comes back so."""
    three = found((40.0, 40.0, 40.0, 40.0))
    wanted = [0.0, 120.0, 240.0]
    pins = tuple(
        replace(pin, centre_mm=48.0 * across(about_z_deg(angle)))
        for pin, angle in zip(three.pins, wanted, strict=True)
    )
    crank = replace(three, pins=pins)
    assert [crank.angle_deg(pin) for pin in pins] == wanted
    assert "3 throws at 0, 120, 240 deg" in crank.words
    text = design_text(load_scene("mikron-iiic-plain"), crank, ("half-1.step", None), ("x.step",))
    assert "throw_angles_deg = [0.0, 120.0, 240.0]" in text


def test_split_pins_of_a_six_are_those_of_three_throws() -> None:
    """Half pins at 0, 330, 240, 210, 120 and 90 deg; designs had six throws of these to fill in."""
    pins, journals = [], [FoundJournal(21.0, 0.0, (0.0, 20.0), (True, False), np.zeros(3))]
    for throw in range(3):
        at = 114.0 * throw + 39.0
        for half, turn in enumerate((0.0, 330.0)):
            angle = np.radians(about_z_deg(turn - 120.0 * throw))
            centre = 48.0 * np.array([-np.sin(angle), np.cos(angle), 0.0])
            span = at + 18.0 * half, at + 18.0 * (half + 1)
            pins.append(FoundJournal(21.0, 0.0, span, (False, False), centre))
        journals.append(FoundJournal(21.0, 0.0, (at + 55.0, at + 95.0), (False, throw == 2), np.zeros(3)))
    axis = np.array([0.0, 0.0, 1.0])
    crank = FoundCrank(np.zeros(3), axis, tuple(journals), tuple(pins), (), (None, None), (), ())
    assert crank.split == (1, 3, 5)
    assert [crank.splay_deg(number) for number in crank.split] == [-30.0] * 3
    text = design_text(load_scene("mikron-iiic-plain"), crank, ("half-1.step", None), ("x.step",))
    assert 'layout = "V", pin_splay_deg = -30.0, throw_angles_deg = [0.0, 240.0, 120.0]' in text
    assert found((40.0, 40.0, 40.0)).split == ()


def test_a_single_throw_is_no_split_pin() -> None:
    """It ended in an internal error."""
    text = design_text(
        load_scene("mikron-iiic-plain"), found((40.0, 40.0)), ("half-1.step", None), ("x.step",)
    )
    assert "# cylinders = 1" in text
    assert "arrangement" not in text
