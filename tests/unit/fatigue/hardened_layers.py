"""Layers of treated fillets for tests, on a core of 340 HV."""

from __future__ import annotations

from cranktopo.tasks.throw_fatigue.hardened_layer import HardenedLayer

NITRIDED = HardenedLayer("nitrided", 0.4, 700.0, 340.0, 340.0)
INDUCTION = HardenedLayer("induction", 2.0, 600.0, 340.0, 306.0)
