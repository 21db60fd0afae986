"""A model engine of 12 mm stroke: what is small there is told with its digits, and as no zero."""

from __future__ import annotations

import re

import pytest

from cranktopo.design.loading import scene_from_dict
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.loads.stage import loads_at_speeds
from cranktopo.tasks.loads.text import loads_text, sweep_text
from tests.hostile.featured_engines import featured_engine

MODEL = 34


def test_loads_have_digits() -> None:
    """It had an inertia of 0 kg mm2, counterweights of 0.001 kg and a torque of -1.0 N m."""
    scene = scene_from_dict(featured_engine(MODEL) | {"effects": {"torsional_vibration": "off"}})
    loads = loads_at_speeds(scene)[0]
    text, balance = loads_text(loads), throw_balance(scene)
    for words, value in (
        (r"rotating unbalance ([\d.]+) kg mm", balance.rotating_unbalance_kg_mm),
        (r"inertia ([\d.]+) kg mm2", balance.inertia_kg_mm2),
        (r"mass ([\d.]+) kg\n", balance.mass_kg),
        (r"power of the engine ([\d.]+) kW", loads.indicated_power_kW),
        (r"torque +N m +([\d.]+) ", loads.extremes["torque_Nm"].max.value),
    ):
        (told,) = re.findall(words, text)
        assert float(told) == pytest.approx(value, rel=0.05), words
    swept = sweep_text([loads]).splitlines()[-1].split()
    assert float(swept[-2]) == pytest.approx(loads.engine_torque_Nm.max, rel=0.05)
