"""Hardness, residual stress and strength over depth against the formulae of rule and guideline."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cranktopo.design.hardening import TENSILE_OF_HV, vickers
from cranktopo.tasks.fatigue.fkm import load_rules
from cranktopo.tasks.throw_fatigue.hardened_layer import (
    LAWS,
    HardenedLayer,
    layer_residual_MPa,
    reversed_MPa,
    support_factor,
)
from tests.unit.fatigue.hardened_layers import INDUCTION, NITRIDED

ROLLED = HardenedLayer("rolled", 1.5, 380.0, 340.0, 340.0)
GUIDELINE = {"nitrided": "Nitriding", "induction": "Inductive hardening", "rolled": "Cold rolling"}


def test_the_nitriding_depth_is_where_50_HV_above_the_core_are_left() -> None:
    """Appendix V, 5: HV = core + (surface - core) (50 / (surface - core))^((t / t_N)^2)."""
    at = NITRIDED.hardness_HV(np.array([0.0, 0.2, 0.4]))
    assert at[0] == 700.0
    assert at[1] == pytest.approx(340 + 360 * (50 / 360) ** 0.25)
    assert at[2] == pytest.approx(390.0)
    assert NITRIDED.hardness_HV(np.array([0.48]))[0] == pytest.approx(361, abs=1)  # section 5: about 20 HV


def test_induction_has_two_layers_with_a_drop_between() -> None:
    at = INDUCTION.hardness_HV(np.array([0.0, 1.999, 2.0, 2.39, 2.41, 4.0]))
    assert at.tolist() == [600.0, 600.0, 306.0, 306.0, 340.0, 340.0]
    assert INDUCTION.residual_MPa(np.array([0.0, 1.9, 2.0, 4.0])).tolist() == [-200.0, -200.0, 300.0, 300.0]


def test_rolled_fillets_harden_linearly() -> None:
    assert ROLLED.hardness_HV(np.array([0.0, 0.75, 1.5, 3.0])).tolist() == [380.0, 360.0, 340.0, 340.0]


@pytest.mark.parametrize("layer", [NITRIDED, INDUCTION, ROLLED], ids=lambda layer: layer.process)
def test_numbers_are_those_of_the_guideline_as_pylife_has_it(layer: HardenedLayer) -> None:
    pd, rules = load_rules()
    name = GUIDELINE[layer.process]
    process = rules.get_material_constants_chap5_5(pd.Series([name]))
    law = LAWS[layer.process]
    assert law.mean_stress_sensitivity == process.M_RS.iloc[0]
    group, kind = pd.Series(["Steel"] * 5), pd.Series(["normal"] * 5)
    constants, shares = rules.get_material_constants(group, kind)
    hardness = np.array([200.0, 350.0, 499.0, 500.0, 800.0])
    table = rules.get_material_constants_chap5_5(pd.Series([name] * 5))
    names = np.array([name] * 5, dtype=object)
    wanted = rules.reversed_mat_strength_chap5_5(
        3.3 * hardness, constants, shares, kind, hardness, table, names
    )
    assert reversed_MPa(layer.process, hardness) == pytest.approx(np.asarray(wanted), rel=2e-3)
    assert support_factor(hardness, np.full(5, 0.7)) == pytest.approx(
        np.asarray(rules.support_chap5(np.full(5, 0.7), hardness)), rel=1e-14
    )


@pytest.mark.parametrize("surface", [400.0, 600.0, 739.0, 741.0, 900.0])
@pytest.mark.parametrize("process", ["nitrided", "rolled"])
def test_residual_stress_is_that_of_the_guideline(process: Any, surface: float) -> None:
    rules = load_rules()[1]
    names = np.array([GUIDELINE[process]], dtype=object)
    layer = HardenedLayer(process, 0.4, surface, 340.0, 340.0)
    wanted = rules.eigenstress_RS(np.array([1122.0]), np.array([surface]), np.array([340.0]), names)[0]
    assert layer_residual_MPa(layer) == pytest.approx(wanted, rel=1e-12)
    assert layer.residual_MPa(np.array([0.0]))[0] == pytest.approx(wanted)
    assert layer.residual_MPa(np.array([9.0]))[0] == pytest.approx(-0.3 * wanted)  # SE_trans of the guideline


def test_measured_residual_stress_is_joined_by_lines_and_ends_on_the_safe_side() -> None:
    pressed = replace(NITRIDED, residual=((0.0, -600.0), (0.2, -200.0)))
    assert pressed.residual_MPa(np.array([0.0, 0.1, 0.2, 0.3])).tolist() == [-600.0, -400.0, -200.0, 0.0]
    pulled = replace(NITRIDED, residual=((0.0, -600.0), (0.2, 100.0)))
    assert pulled.residual_MPa(np.array([0.2, 5.0])).tolist() == [100.0, 100.0]


@pytest.mark.parametrize("layer", [NITRIDED, INDUCTION, ROLLED], ids=lambda layer: layer.process)
def test_scatter_moves_the_residual_stress_of_a_process_at_every_depth(layer: HardenedLayer) -> None:
    depths = np.array([0.0, 0.3, 1.0, 2.0, 5.0])
    moved = replace(layer, scatter_MPa=80.0).residual_MPa(depths)
    assert moved == pytest.approx(layer.residual_MPa(depths) + 80.0)


def test_scatter_of_measured_stress_ends_on_the_safe_side() -> None:
    """Below the last point compression does not go on, with the scatter added or taken off."""
    measured = replace(NITRIDED, residual=((0.0, -600.0), (0.2, -50.0)))
    ends = [
        replace(measured, scatter_MPa=s).residual_MPa(np.array([0.0, 0.2, 3.0])).tolist()
        for s in (80.0, -80.0)
    ]
    assert ends == [[-520.0, 30.0, 30.0], [-680.0, -130.0, 0.0]]


def test_the_core_without_residual_stress_has_its_own_strength_exactly() -> None:
    plain = HardenedLayer("induction", 2.0, 340.0, 340.0, 340.0, ((0.0, 0.0),))
    gradients = np.full(plain.depths_mm.shape, 0.8)
    assert (plain.relative_strength(plain.depths_mm, gradients) == 1.0).all()


def test_relative_strength_in_closed_form() -> None:
    """At the surface of an induction-hardened fillet: hardness, support and 200 MPa of compression."""
    found = float(INDUCTION.relative_strength(np.array(0.0), np.array(0.75)))
    harder = 733 / (1.42 * 340 + 23)
    support = (1 + math.sqrt(1200) / 600) / (1 + math.sqrt(1200) / 340)
    assert found == pytest.approx(harder * support * (1 + 0.4 * 200 / 733), rel=1e-12)


def test_tension_below_the_layer_costs_at_least_what_the_rule_takes_off() -> None:
    """Appendix V, 4 (1) (E): 20 % for 300 MPa."""
    plain = replace(INDUCTION, transition_HV=340.0)
    below = float(plain.relative_strength(np.array(2.0), np.array(0.5)))
    assert below == pytest.approx(0.8, abs=1e-12)


def test_compression_counts_as_far_as_the_cyclic_yield_strength_carries_it() -> None:
    """FKM 5.5.1.2, range I at R = -1: a factor of (1 + M Rp / S) / (1 + M) at most."""
    core, sensitivity = 340.0, 0.18
    pressed = HardenedLayer("rolled", 1.5, core, core, core, ((0.0, -2000.0),))
    strength, yielding = 0.45 * 3.3 * core, 0.6 * 3.3 * core
    most = (1 + sensitivity * yielding / strength) / (1 + sensitivity)
    assert float(pressed.relative_strength(np.array(0.0), np.array(0.5))) == pytest.approx(most, rel=1e-12)


@pytest.mark.parametrize("process", ["nitrided", "induction", "rolled"])
def test_harder_and_more_pressed_is_never_weaker(process: Any) -> None:
    depths, gradients = np.linspace(0.0, 0.39, 14), np.full(14, 0.8)
    made = [
        HardenedLayer(process, 0.4, surface, 340.0, 340.0, ((0.0, residual),)).relative_strength(
            depths, gradients
        )
        for residual in (0.0, -100.0, -300.0)
        for surface in (400.0, 500.0, 650.0, 800.0)
    ]
    by_residual = np.array(made).reshape(3, 4, -1)
    assert (np.diff(by_residual, axis=0) >= -1e-12).all()
    without = by_residual[0]
    assert (np.diff(without[:2], axis=0) >= 0).all()
    assert (np.diff(without, axis=0) > -0.05).all()  # from 500 HV on: less support, no more strength


def test_hardness_of_a_tensile_strength_is_that_of_the_standard() -> None:
    """ISO 18265, Table A.1, and Rm = 3.2 to 3.36 HV over all of it."""
    assert vickers(965.0) == 300.0
    assert vickers(1095.0) == pytest.approx(340.0, abs=1)
    assert vickers(1420.0) == pytest.approx(440.0, abs=1)
    assert vickers(200.0) is None
    assert vickers(2300.0) is None
    ratios = [tensile / hardness for hardness, tensile in TENSILE_OF_HV]
    assert min(ratios) > 3.18
    assert max(ratios) < 3.36
