"""Disks joined by springs, with damping: natural frequencies, modes, steady forced vibration."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Complex

_RIGID = 1e-12
"""Square of a frequency over that of the highest below which a motion is rigid."""
_CREEPING = 1e-6
"""Imaginary part of an eigenvalue over the highest frequency below which a motion is rigid."""
_OF_ROUNDING = 2.0
"""The same over the root of what rounding adds to strongly damped chains."""
_SWINGING = 0.1
"""Imaginary part of an eigenvalue over its magnitude from which a motion swings, a damping ratio of 0.995."""


@dataclass(frozen=True)
class Mode:
    """A natural vibration without damping; the largest amplitude of its shape is 1, the first positive."""

    frequency_Hz: float
    shape: Array


@dataclass(frozen=True)
class DampedMode:
    """A free vibration with all damping.

    Attributes:
        frequency_Hz: magnitude of its eigenvalue.
        damping_ratio: damping over critical damping.
        shape: complex amplitude of every disk, the largest 1 or -1, the real part of the first disk not
            negative.
    """

    frequency_Hz: float
    damping_ratio: float
    shape: Complex

    @property
    def eigenvalue(self) -> complex:
        """Its eigenvalue, rad/s; the imaginary part is positive."""
        swinging = math.sqrt(1 - self.damping_ratio**2)
        return 2 * math.pi * self.frequency_Hz * complex(-self.damping_ratio, swinging)


@dataclass(frozen=True)
class DiskChain:
    """Disks joined by massless springs; damping that is not given is zero.

    Attributes:
        stiffness_Nm_per_rad: of the spring after each disk but the last.
        loss_factor: of each spring: its stiffness times 1 + i loss factor.
        relative_damping_Nms_per_rad: viscous, beside each spring.
        absolute_damping_Nms_per_rad: viscous, of each disk.
    """

    inertia_kg_m2: tuple[float, ...]
    stiffness_Nm_per_rad: tuple[float, ...]
    loss_factor: tuple[float, ...] = ()
    relative_damping_Nms_per_rad: tuple[float, ...] = ()
    absolute_damping_Nms_per_rad: tuple[float, ...] = ()

    def natural_frequencies_Hz(self) -> tuple[float, ...]:
        """Return natural frequencies above the rigid rotation, Hz, rising."""
        squares = np.linalg.eigvalsh(self._scaled_stiffness())
        return tuple(float(math.sqrt(max(s, 0.0)) / (2 * math.pi)) for s in squares[1:])

    def modes(self) -> tuple[Mode, ...]:
        """Return natural vibrations above the rigid rotation of the whole or of disks on no spring."""
        squares, vectors = np.linalg.eigh(self._scaled_stiffness())
        shapes = vectors / np.sqrt(self.inertia_kg_m2)[:, None]
        shapes = shapes / np.abs(shapes).max(axis=0)
        shapes = shapes * np.where(shapes[0] < 0, -1.0, 1.0)
        return tuple(
            Mode(float(math.sqrt(max(square, 0.0)) / (2 * math.pi)), shape)
            for square, shape in zip(squares, shapes.T, strict=True)
            if square > _RIGID * squares[-1]
        )

    def damped_modes(self) -> tuple[DampedMode, ...]:
        """Return the free vibrations with all damping, by complex eigenvalues, slowest first.

        What creeps back without swinging, as the ring of a strong viscous damper, is none of them.
        """
        inertia, count = np.array(self.inertia_kg_m2), len(self.inertia_kg_m2)
        highest = math.sqrt(max(np.linalg.eigvalsh(self._scaled_stiffness())[-1], 0.0))
        if highest == 0.0:
            return ()
        stiffness = _joined(self.section_stiffness_Nm_per_rad(np.array(0.0)))
        viscous = _joined(_filled(self.relative_damping_Nms_per_rad, count - 1))
        viscous = viscous + np.diag(_filled(self.absolute_damping_Nms_per_rad, count))
        state = np.zeros((2 * count, 2 * count), dtype=complex)  # time in units of 1 / highest
        state[:count, count:] = np.eye(count)
        state[count:, :count] = -stiffness / inertia[:, None] / highest**2
        state[count:, count:] = -viscous / inertia[:, None] / highest
        values, vectors = np.linalg.eig(state)
        # the motion as one body is a double zero: rounding moves it by the root of what it adds
        rounding = math.sqrt(np.finfo(float).eps * float(np.abs(state).sum(axis=1).max()))
        least = np.maximum(max(_CREEPING, _OF_ROUNDING * rounding), _SWINGING * np.abs(values))
        swinging = [i for i in np.argsort(np.abs(values), kind="stable") if values[i].imag > least[i]]
        return tuple(_damped_mode(highest * values[i], vectors[:count, i]) for i in swinging)

    def frequency_slopes(self, mode: DampedMode) -> tuple[Array, Complex]:
        """Return the derivatives of a damped mode's frequency.

        With K, C and J of the springs, the damping and the disks, and the shape s as left and right vector:
        d lambda = -s' (lambda^2 dJ + dK) s / s' (2 lambda J + C) s.

        Returns:
            By the inertia of every disk, Hz / (kg m2), and by the complex stiffness of every spring,
            Hz / (N m/rad), of which a change is worth the real part of its product with that.
        """
        shape, value, count = mode.shape, mode.eigenvalue, len(self.inertia_kg_m2)
        twist = np.diff(shape)
        relative = _filled(self.relative_damping_Nms_per_rad, count - 1)
        damping = relative @ twist**2 + _filled(self.absolute_damping_Nms_per_rad, count) @ shape**2
        weight = 2 * value * (np.array(self.inertia_kg_m2) @ shape**2) + damping
        of_value = -value.conjugate() / abs(value) / (2 * math.pi) / weight
        return np.asarray((of_value * value**2 * shape**2).real), np.asarray(of_value * twist**2)

    def _scaled_stiffness(self) -> Array:
        scale = 1.0 / np.sqrt(self.inertia_kg_m2)
        return np.asarray(_joined(np.array(self.stiffness_Nm_per_rad)) * np.outer(scale, scale))

    def section_stiffness_Nm_per_rad(self, frequency_rad_s: Array) -> Complex:
        """Return complex stiffness of each spring with its damping, shape (*frequencies, springs)."""
        stiffness = np.array(self.stiffness_Nm_per_rad)
        lossy = stiffness * (1 + 1j * _filled(self.loss_factor, len(stiffness)))
        viscous = _filled(self.relative_damping_Nms_per_rad, len(stiffness))
        return np.asarray(lossy + 1j * np.asarray(frequency_rad_s)[..., None] * viscous)

    def response_rad(self, frequency_rad_s: Array, torque_Nm: Complex) -> Complex:
        """Return complex amplitudes of the disks under harmonic torques of shape (*frequencies, disks)."""
        return self.responses_rad(frequency_rad_s, torque_Nm[..., None])[..., 0]

    def responses_rad(self, frequency_rad_s: Array, torque_Nm: Complex) -> Complex:
        """Return the same under several torques at each frequency, (*frequencies, disks, torques)."""
        frequency = np.asarray(frequency_rad_s)
        inertia = np.array(self.inertia_kg_m2)
        absolute = _filled(self.absolute_damping_Nms_per_rad, len(inertia))
        matrix = _joined(self.section_stiffness_Nm_per_rad(frequency))
        own = 1j * frequency[..., None] * absolute - frequency[..., None] ** 2 * inertia
        disks = np.arange(len(inertia))
        matrix[..., disks, disks] += own
        return np.asarray(np.linalg.solve(matrix, torque_Nm))

    def section_torque_Nm(self, frequency_rad_s: Array, twist_rad: Complex) -> Complex:
        """Return the torque that each spring passes on toward the last disk, complex amplitudes."""
        relative = twist_rad[..., :-1] - twist_rad[..., 1:]
        return np.asarray(self.section_stiffness_Nm_per_rad(frequency_rad_s) * relative)

    def as_opentorsion(self) -> dict[str, Any]:
        """Return arguments of openTorsion's `Disk(node, I)` and `Shaft(nl, nr, k=..., I=0)`, SI units.

        All inertia sits in the disks: openTorsion 0.3.2 takes an inertia given with `k` six times too large.
        """
        return {
            "disks": [{"node": i, "I": inertia} for i, inertia in enumerate(self.inertia_kg_m2)],
            "shafts": [
                {"nl": i, "nr": i + 1, "k": k, "I": 0.0} for i, k in enumerate(self.stiffness_Nm_per_rad)
            ],
        }


def _damped_mode(eigenvalue: complex, vector: Complex) -> DampedMode:
    shape = vector / vector[np.abs(vector).argmax()]
    size = abs(eigenvalue)
    return DampedMode(size / (2 * math.pi), -eigenvalue.real / size, -shape if shape[0].real < 0 else shape)


def _filled(values: tuple[float, ...], count: int) -> Array:
    return np.array(values) if values else np.zeros(count)


def _joined(stiffness: NDArray[Any]) -> NDArray[Any]:
    """Return the stiffness matrix of disks in a row, shape (*..., disks, disks)."""
    disks = stiffness.shape[-1] + 1
    matrix = np.zeros((*stiffness.shape[:-1], disks, disks), dtype=stiffness.dtype)
    first, second = np.arange(disks - 1), np.arange(1, disks)
    matrix[..., first, first] += stiffness
    matrix[..., second, second] += stiffness
    matrix[..., first, second] -= stiffness
    matrix[..., second, first] -= stiffness
    return matrix
