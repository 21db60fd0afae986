"""Closed-form compliance of a throw from beams, plates and discs: for decisions, not for results.

Bending and tangential force: journal, web and pin as Timoshenko beams in series (Castigliano). Torsion:
the mean of the formulae of B. C. Carter (Engineering, 1928) and W. Ker Wilson (Practical Solution of
Torsional Vibration Problems, Chapman & Hall 1956). Such formulae are some 10 to 30 %
off: for the web of the Walter Mikron III C they give 297 N/um in bending, 220 N/um tangentially and
142 kN m/rad in torsion, finite elements on a grid of 3 mm 235, 198 and 144.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.units import MPA_PER_GPA
from cranktopo.design.halves import of_halves
from cranktopo.design.schema import Scene
from cranktopo.engine.torsional_stiffness import (
    EquivalentBeam,
    effective_length,
    equivalent_beam,
    throw_torsion_rad_per_Nmm,
)
from cranktopo.throw.journal import Journal

_SHEAR_RING = 0.5  # shear coefficient of a hollow circular section (thin ring; 0.9 for a solid one)
_SHEAR_RECTANGLE = 5 / 6


@dataclass(frozen=True)
class ThrowCompliance:
    """Compliance of the full throw between its two mid-journal planes.

    Attributes:
        bending_mm_per_N: radial displacement of the pin per radial force, journals pinned.
        tangential_mm_per_N: tangential displacement of the pin per tangential force, journals held
            laterally and against rotation.
        torsion_rad_per_Nmm: rotation between the mid-journal planes per torque.
    """

    bending_mm_per_N: float
    tangential_mm_per_N: float
    torsion_rad_per_Nmm: float


def throw_compliance(scene: Scene) -> ThrowCompliance:
    """Closed-form compliance of the scene's throw with its own web, bores and fillets.

    Fillets shorten the journals by the integral of 1 - J / J(z), and the web, whose free length ends at
    their feet. Of halves that differ it is the mean of what throws of two such halves have.
    """
    one, other = of_halves(scene, _equal_halves)
    return ThrowCompliance(
        (one.bending_mm_per_N + other.bending_mm_per_N) / 2,
        (one.tangential_mm_per_N + other.tangential_mm_per_N) / 2,
        (one.torsion_rad_per_Nmm + other.torsion_rad_per_Nmm) / 2,
    )


def _equal_halves(scene: Scene) -> ThrowCompliance:
    main, pin = (effective_length(q) for q in (scene.throw.main_journal, scene.throw.crankpin))
    web = equivalent_beam(scene)
    e = scene.material.E_GPa * MPA_PER_GPA
    g = e / (2 * (1 + scene.material.poisson))
    bars = _journal_bending(main, e, g) + _pin_bending(pin, web, e, g)
    half = web.length
    along = (web.lever / 2) ** 2 * half / (e * web.width * web.thickness**3 / 12) + half / (4 * e * web.area)
    across = (web.lever / 2) ** 2 * half / (g * web.twist)
    across += web.arm**2 / 12 * half / (e * web.thickness * web.width**3 / 12)
    across += half / (4 * _SHEAR_RECTANGLE * g * web.area)
    across += (web.arm / 2) ** 2 * (main.length_mm / 2) / (g * 2 * _second_moment(main))
    return ThrowCompliance(2 * (bars + along), 2 * (bars + across), throw_torsion_rad_per_Nmm(scene))


def web_section_modulus_mm3(scene: Scene) -> float:
    """Modulus of the web's section half-way along the throw against bending out of its plane, mm3."""
    web = equivalent_beam(scene)
    return web.width * web.thickness**2 / 6


def _second_moment(journal: Journal) -> float:
    return math.pi / 4 * (journal.radius_mm**4 - journal.bore_radius_mm**4)


def _area(journal: Journal) -> float:
    return math.pi * (journal.radius_mm**2 - journal.bore_radius_mm**2)


def _journal_bending(main: Journal, e: float, g: float) -> float:
    """Half journal as a cantilever under half of a unit force."""
    length = main.length_mm / 2
    return length**3 / (12 * e * _second_moment(main)) + length / (4 * _SHEAR_RING * g * _area(main))


def _pin_bending(pin: Journal, web: EquivalentBeam, e: float, g: float) -> float:
    """Half pin under its part of a unit force spread over its length, and the moment from the bearing."""
    nodes, weights = np.polynomial.legendre.leggauss(5)
    s = pin.length_mm / 4 * (nodes + 1)
    moment = (web.lever + web.thickness / 2 + s) / 2 - s**2 / (2 * pin.length_mm)
    shear = 0.5 - s / pin.length_mm
    density = moment**2 / (e * _second_moment(pin)) + shear**2 / (_SHEAR_RING * g * _area(pin))
    return float((density * weights).sum() * pin.length_mm / 4)
