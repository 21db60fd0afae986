"""Closed-form compliance of a throw, for decisions and for the loads of a vibrating shaft.

Bending and tangential force: journal, web and pin as Timoshenko beams in series (Castigliano). Torsion:
the mean of the formulae of B. C. Carter (Engineering, 1928) and W. Ker Wilson (Practical Solution of
Torsional Vibration Problems, Chapman & Hall 1956), with bores and fillets. Such formulae are some 10 to 30 %
off: for the web of the Walter Mikron III C they give 297 N/um in bending, 220 N/um tangentially and
142 kN m/rad in torsion, finite elements on a grid of 3 mm 235, 198 and 144.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass
from functools import lru_cache

import numpy as np

from cranktopo.base.quadrature import gauss_legendre
from cranktopo.base.units import MPA_PER_GPA, NMM_PER_NM
from cranktopo.design.halves import of_halves
from cranktopo.design.schema import Scene
from cranktopo.throw.journal import Journal


@dataclass(frozen=True)
class _EquivalentBeam:
    """Web as a bar of rectangular section between the journals."""

    width: float
    thickness: float
    length: float  # free length between the journals
    arm: float  # throw radius
    lever: float  # mid-journal plane to the web's mid-plane

    @property
    def area(self) -> float:
        """Its section, mm2."""
        return self.width * self.thickness

    @property
    def twist(self) -> float:
        """Torsion constant of the rectangle (Roark's Formulas for Stress and Strain, first terms)."""
        long, short = max(self.width, self.thickness), min(self.width, self.thickness)
        return long * short**3 / 3 * (1 - 0.63 * short / long)


def throw_torsion_rad_per_Nmm(scene: Scene) -> float:
    """Return the rotation between the mid-journal planes of a throw per torque, ends free to move laterally.

    Halves that differ are in series, each half as soft as a throw of two such halves.
    """
    return sum(of_halves(scene, _half_torsion)) / 2


def first_half_share(scene: Scene) -> float:
    """Share of a throw's twist that is in its first half, in closed form; one half where both are alike."""
    first, second = of_halves(scene, _half_torsion)
    return first / (first + second)


def _half_torsion(scene: Scene) -> float:
    main, pin = (_effective_length(q) for q in (scene.throw.main_journal, scene.throw.crankpin))
    g = scene.material.E_GPa * MPA_PER_GPA / (2 * (1 + scene.material.poisson))
    return _torsion_sum(main, pin, _equivalent_beam(scene)) * 32 / (math.pi * g)


def throw_stiffness_Nm_per_rad(scene: Scene) -> float:
    """Torsional stiffness of a throw: the shaft table's own (the mean of several), else in closed form."""
    shaft = scene.shaft
    if shaft is not None and shaft.throw_stiffnesses_Nm_per_rad is not None:
        return sum(shaft.throw_stiffnesses_Nm_per_rad) / len(shaft.throw_stiffnesses_Nm_per_rad)
    stiffness = shaft.throw_stiffness_Nm_per_rad if shaft else None
    return stiffness if stiffness is not None else 1 / throw_torsion_rad_per_Nmm(scene) / NMM_PER_NM


@lru_cache(maxsize=32)
def fillet_length_saving_mm(journal: Journal) -> float:
    """Length by which the fillets at both ends shorten a journal in torsion: integral of 1 - J / J(z)."""
    nodes, weights = gauss_legendre(16)
    turn = (np.pi / 2 - journal.fillet.start_rad) / 2
    angle = journal.fillet.start_rad + turn * (nodes + 1)
    outer = journal.radius_mm + journal.fillet_mm * (1 - np.sin(angle))
    dz = journal.fillet.axial_mm * np.sin(angle) * weights * turn
    polar = journal.radius_mm**4 - journal.bore_radius_mm**4
    return 2 * float(((1 - polar / (outer**4 - journal.bore_radius_mm**4)) * dz).sum())


def web_lever_mm(scene: Scene) -> float:
    """Distance from the mid-journal plane to the mid-plane of the web, mm."""
    return (scene.throw.main_journal.length_mm + scene.web.thickness_mm) / 2


def journal_torsion_modulus_mm3(journal: Journal) -> float:
    """Modulus of a hollow journal in torsion, mm3."""
    return math.pi / 2 * (journal.radius_mm**4 - journal.bore_radius_mm**4) / journal.radius_mm


def _effective_length(journal: Journal) -> Journal:
    """Return the journal, shorter in torsion and bending by what its fillets take."""
    length = journal.length_mm - fillet_length_saving_mm(journal)
    return journal.model_copy(update={"length_mm": length})


def _equivalent_beam(scene: Scene) -> _EquivalentBeam:
    """Return the scene's web as a bar between its journals."""
    throw = scene.throw
    radius = throw.radius_mm
    width = 2 * float(scene.web.half_width_mm(radius, np.array([radius / 2]))[0])
    overlap = 0.2 * sum(q.outer_diameter_mm + 2 * q.fillet_mm for q in (throw.main_journal, throw.crankpin))
    # Ker Wilson's free length; journals that overlap leave at least a tenth of the throw.
    return _EquivalentBeam(
        width, scene.web.thickness_mm, max(radius - overlap, 0.1 * radius), radius, web_lever_mm(scene)
    )


def _torsion_sum(main: Journal, pin: Journal, web: _EquivalentBeam) -> float:
    """Mean compliance of Carter and Ker Wilson times pi G / 32, 1/mm3."""
    j, p = ((2 * q.radius_mm) ** 4 - (2 * q.bore_radius_mm) ** 4 for q in (main, pin))
    lj, lp = main.length_mm, pin.length_mm
    # The bores run through the web and take (d / b)^2 of it around each axis. The formulae of Carter and Ker
    # Wilson know no bored web; chosen on the Mikron's web; on four engines the
    # estimate then is 0.64 to 0.86 of finite elements.
    bored = 2 * (main.bore_radius_mm**2 + pin.bore_radius_mm**2) / web.width**2
    bar = web.thickness * web.width**3 * (1 - bored)
    carter = (lj + 0.8 * web.thickness) / j + 0.75 * lp / p + 1.5 * web.arm / bar
    wilson = (lj + 0.4 * main.outer_diameter_mm) / j + (lp + 0.4 * pin.outer_diameter_mm) / p
    wilson += web.length / bar
    return 2 / (1 / carter + 1 / wilson)


_SHEAR_RING = 0.5  # shear coefficient of a hollow circular section (thin ring; 0.9 for a solid one)
_SHEAR_RECTANGLE = 5 / 6


@dataclass(frozen=True)
class ThrowCompliance:
    """Displacement per load of the full throw between its two mid-journal planes.

    Attributes:
        bending_mm_per_N: radially of the pin per radial force, journals pinned.
        tangential_mm_per_N: of the pin per tangential force, journals held laterally and against rotation.
        torsion_rad_per_Nmm: between the mid-journal planes per torque.
    """

    bending_mm_per_N: float
    tangential_mm_per_N: float
    torsion_rad_per_Nmm: float


def throw_compliance(scene: Scene) -> ThrowCompliance:
    """Return the closed-form compliance of the scene's throw with its own web, bores and fillets.

    Fillets shorten the journals by the integral of 1 - J / J(z), and the web, whose free length ends at
    their feet. Of halves that differ it is the mean of what throws of two such halves have.
    """
    both = zip(*(astuple(half) for half in of_halves(scene, _equal_halves)), strict=True)
    return ThrowCompliance(*((one + other) / 2 for one, other in both))


def _equal_halves(scene: Scene) -> ThrowCompliance:
    main, pin = (_effective_length(q) for q in (scene.throw.main_journal, scene.throw.crankpin))
    web = _equivalent_beam(scene)
    e = scene.material.E_GPa * MPA_PER_GPA
    g = e / (2 * (1 + scene.material.poisson))
    bars = _journal_bending(main, e, g) + _pin_bending(pin, web, e, g)
    half = web.length
    along = sum(_web_along(web, e))
    across = (web.lever / 2) ** 2 * half / (g * web.twist)
    across += web.arm**2 / 12 * half / (e * web.thickness * web.width**3 / 12)
    across += half / (4 * _SHEAR_RECTANGLE * g * web.area)
    across += (web.arm / 2) ** 2 * (main.length_mm / 2) / (g * 2 * _second_moment(main))
    return ThrowCompliance(2 * (bars + along), 2 * (bars + across), throw_torsion_rad_per_Nmm(scene))


def radial_energy_Nmm(scene: Scene, pin_N: float, web_N: float) -> float:
    """Return the strain energy of a throw on its bearings under outward forces on its pin and on each web.

    The bars are those of `throw_compliance`. Forces on the webs act in their mid-planes: what they take off
    the bearings relieves journals and webs, but leaves the pin a constant moment, so that a counterweight
    does not relieve it as a force on the pin would.
    """
    return sum(of_halves(scene, lambda half: _half_radial_energy(half, pin_N, web_N)))


def web_stretch_energy_Nmm(scene: Scene, pull_N: float, arm_mm: float) -> float:
    """Return the strain energy of a web that its counterweight stretches from the axis to its centre."""
    return pull_N**2 * arm_mm / (2 * scene.material.E_GPa * MPA_PER_GPA * _equivalent_beam(scene).area)


def _half_radial_energy(scene: Scene, pin_N: float, web_N: float) -> float:
    main, pin = (_effective_length(q) for q in (scene.throw.main_journal, scene.throw.crankpin))
    web, e = _equivalent_beam(scene), scene.material.E_GPa * MPA_PER_GPA
    g = e / (2 * (1 + scene.material.poisson))
    bent, pulled = _web_along(web, e)
    borne = (pin_N + 2 * web_N) ** 2 * (_journal_bending(main, e, g) + bent)
    return (borne + pin_N**2 * pulled + _pin_bending(pin, web, e, g, pin_N, web_N)) / 2


def web_section_modulus_mm3(scene: Scene) -> float:
    """Modulus of the web's section half-way along the throw against bending out of its plane, mm3."""
    web = _equivalent_beam(scene)
    return web.width * web.thickness**2 / 6


def _second_moment(journal: Journal) -> float:
    return math.pi / 4 * (journal.radius_mm**4 - journal.bore_radius_mm**4)


def _area(journal: Journal) -> float:
    return math.pi * (journal.radius_mm**2 - journal.bore_radius_mm**2)


def _journal_bending(main: Journal, e: float, g: float) -> float:
    """Half journal as a cantilever under half of a unit force."""
    length = main.length_mm / 2
    return length**3 / (12 * e * _second_moment(main)) + length / (4 * _SHEAR_RING * g * _area(main))


def _web_along(web: _EquivalentBeam, e: float) -> tuple[float, float]:
    """Web bent by half of a unit force at the bearing, and pulled by it."""
    bent = (web.lever / 2) ** 2 * web.length / (e * web.width * web.thickness**3 / 12)
    return bent, web.length / (4 * e * web.area)


def _pin_bending(
    pin: Journal, web: _EquivalentBeam, e: float, g: float, pin_N: float = 1.0, web_N: float = 0.0
) -> float:
    """Half pin under its part of a force spread over its length, and the moment from bearing and web."""
    nodes, weights = gauss_legendre(5)
    s = pin.length_mm / 4 * (nodes + 1)
    moment = pin_N * ((web.lever + web.thickness / 2 + s) / 2 - s**2 / (2 * pin.length_mm))
    moment += web_N * web.lever
    shear = pin_N * (0.5 - s / pin.length_mm)
    density = moment**2 / (e * _second_moment(pin)) + shear**2 / (_SHEAR_RING * g * _area(pin))
    return float((density * weights).sum() * pin.length_mm / 4)
