"""Torque of an order at its critical speed, beside the sum of all orders: against its equations."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.base.units import angular_speed_rad_s
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.engine.vibration.study import VibrationStudy, largest_swing, study_vibration, worst_swing
from cranktopo.tasks.vibration.page import vibration_page
from cranktopo.tasks.vibration.text import critical_table, vibration_text, worst_sentence
from tests.physics.engine.test_orders_of_a_slow_engine import LOSS, SHAFT, medium_speed

COUPLING_LOSS, RING_NMS = 0.15, 30000.0


@cache
def mean_inertia() -> VibrationStudy:
    """The slow six without the varying part of its inertia, so that each order is one system of equations."""
    scene = medium_speed(shaft=SHAFT, effects={"threshold": 0.5})
    study = study_vibration(scene, estimated_chain(scene), 1.0, "closed form")
    assert not study.varying.included
    return study


def order_alone_Nm(study: VibrationStudy, order: float, rpm: float) -> float:
    """The largest torque of a throw's section under one order of the cylinders' torques."""
    return float(torques_Nm(study, order, rpm)[np.array(study.shaft.in_crankshaft)].max())


def torques_Nm(study: VibrationStudy, order: float, rpm: float) -> Array:
    """Torque of every section under one order of the cylinders' torques."""
    shaft, harmonics = study.shaft, study.response.harmonics
    inertia, w = np.array(shaft.chain.inertia_kg_m2), order * rpm * np.pi / 30
    matrix = np.diag(-(w**2) * inertia).astype(complex)
    springs = []
    for i, (name, k) in enumerate(zip(shaft.sections, shaft.chain.stiffness_Nm_per_rad, strict=True)):
        loss = {"damper ring - hub": 0.0, "flywheel - coupling + driven machine": COUPLING_LOSS}
        spring = k * (1 + 1j * loss.get(name, LOSS)) + (1j * w * RING_NMS if i == 0 else 0.0)
        springs.append(spring)
        matrix[i : i + 2, i : i + 2] += spring * np.array([[1, -1], [-1, 1]])
    place = round(order * 2)
    single = harmonics.gas_Nm[place] + angular_speed_rad_s(rpm) ** 2 * harmonics.inertia_Nm_s2[place]
    torque = np.zeros(len(inertia), dtype=complex)
    torque[shaft.driven] = single * np.exp(-1j * order * np.radians(harmonics.firing_deg))
    twist = np.linalg.solve(matrix, torque)
    return np.asarray(np.abs(np.array(springs) * (twist[:-1] - twist[1:])))


def test_an_order_has_its_own_torque_beside_the_sum() -> None:
    study = mean_inertia()
    table = critical_table(study)
    columns = ("speed_rpm", "order", "this_order_alone_Nm", "sum_of_all_orders_Nm")
    rows = np.array([[row[column] for column in columns] for row in table.rows], dtype=float)
    assert len(rows) > 5
    for rpm, order, alone, every in rows:
        assert alone == pytest.approx(order_alone_Nm(study, order, rpm), rel=1e-6)
        assert every > alone
    assert (rows[:, 2] / rows[:, 3]).min() < 0.1, "an order that adds next to nothing"


def test_no_header_leaves_open_which_of_them_it_is() -> None:
    study = mean_inertia()
    table = critical_table(study)
    heads = [" ".join(table.head(column)) for column in table.columns]
    assert heads[-3:] == ["this order alone N m", "sum of all orders N m", "shear of sum MPa"]
    told = (
        "of this order alone, and of the sum of all orders over the cycle at that speed, whose stress it is."
    )
    assert told in " ".join(vibration_text(study).split())
    section = next(one for one in vibration_page(study, "").sections if one.anchor == "critical-speeds")
    assert told in " ".join([section.text, *section.tables[0][:1]])


def test_a_swing_is_mostly_of_an_order_that_makes_more_than_half_of_it() -> None:
    """It was so of the largest order, which may be a sixth of the swing: order 4.5 is 41 % of this one."""
    study = mean_inertia()
    worst = worst_swing(study.response)
    orders = study.response.orders.tolist()
    single = max((torques_Nm(study, order, worst.speed_rpm)[worst.section], order) for order in orders)
    assert (worst.order_Nm, worst.order) == pytest.approx(single, rel=1e-6)
    assert 0.4 < single[0] / study.response.worst_Nm < 0.42
    assert worst.orders_words == f"of many orders, the largest of them order 4.5 with {single[0]:,.0f} N m"
    sentence = worst_sentence(study)
    assert sentence.endswith(f"nominal shear stress, {worst.orders_words}.")
    page = vibration_page(study, "")
    torque = next(one for one in page.sections if one.anchor == "critical-speeds").pictures[1]
    for told in (vibration_text(study).replace("\n", " "), page.headline, torque.alt):
        assert worst.orders_words in told
        assert "mostly of order" not in told
    first = largest_swing(study.response, 0)
    assert first.order_Nm > 0.5 * first.torque_amplitude_Nm
    assert first.orders_words == "mostly of order 4.5"
