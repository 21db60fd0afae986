"""Tables of cost over mesh size and of other codes: slopes, rows, failures, both load cases on one mesh."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.tasks.throw_fea.condense import condense
from tests.benchmarks import body_fitted_codes as of_codes
from tests.benchmarks import body_fitted_peers as peers
from tests.benchmarks import body_fitted_scale as scale
from tests.physics.fea.evaluation_cases import elastic, mikron_with

EVALUATE, FATIGUE = scale.COMMANDS["evaluate"], scale.COMMANDS["fatigue"]


def row(size: float, unknowns: int) -> scale.ScaleRow:
    """A row whose seconds grow with the power 1.2 of the unknowns, and memory by 2 KiB an unknown."""
    seconds = 1e-4 * unknowns**1.2
    return scale.ScaleRow(size, unknowns, *[seconds] * 4, 100 + unknowns / 512, "found")


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_exponent() -> None:
    unknowns = [2e4, 1e5, 2e6]
    assert scale.exponent(unknowns, [3 * n**1.15 for n in unknowns]) == pytest.approx(1.15)
    assert math.isnan(scale.exponent([5.0], [1.0]))


def test_rows_of_a_command() -> None:
    lines = scale.table_rows(EVALUATE, [row(4.2, 51_200), row(2.1, 512_000)])
    small, large, slope = map(cells, lines)
    assert len(scale.HEADS) == len(small) == len(large) == len(slope)
    assert small[8:] == ["4,096", "-", "found"]
    assert large[:3] == ["`evaluate`", "2.1 mm", "512,000"]
    assert large[8:] == ["2,253", "2,048", "found"]
    assert slope[2:8] == ["51,200 to 512,000", *["**1.20**"] * 4, "-"]


def test_slope_is_that_of_elements_of_one_kind() -> None:
    refused = scale.ScaleRow(0.01, told="exit 3: error: memory")
    rows = [row(0.5, 70_000), row(0.2, 100_000), row(0.1, 400_000), refused]
    *_, told, slope = map(cells, scale.table_rows(FATIGUE, rows))
    assert slope[2] == "100,000 to 400,000"
    assert told[-1] == "exit 3: error: memory"
    assert len(told) == len(slope)
    for few in ([], rows[1:2]):
        assert cells(scale.exponent_row(FATIGUE, few))[2:4] == ["-", "-"]


def test_why_a_command_gave_nothing() -> None:
    notes = "mikron-iiic: element size 0.1 mm\nerror: element size 0.1: too fine\n  The finest is 1 mm.\n"
    assert scale.failure(3, notes) == "exit 3: error: element size 0.1: too fine The finest is 1 mm."
    assert scale.failure(-9, "") == "signal 9"


def test_rows_of_codes() -> None:
    own = peers.PeerRow("cranktopo", 30_000, 1.0, 1.0, 3.0, 200.0, 4e-9, 192.0, 1900.0)
    other = peers.PeerRow("other", 30_000, 2.0, 6.0, 8.0, 900.0, None, 192.00192, 1900.0)
    late = peers.PeerRow("late", told="not within 600 s")
    first, second, third = (cells(peers.table_row(one, own)) for one in (own, other, late))
    assert len(first) == len(second) == len(third) == len(peers.HEADS)
    assert first[5] == "1.0"
    assert second[4:9] == ["8.00", "4.0", "8.00", "900", "-"]
    assert second[9:] == ["192.0019", "+0.00100", "1900.0000", "+0.00000"]
    assert third[:3] == ["30,000", "late", "not within 600 s"]


def test_why_a_code_gave_nothing() -> None:
    assert peers.failure(1, "Traceback\nMemoryError: Unable to allocate") == "out of memory"
    assert peers.failure(-9, "") == "ended by signal 9"
    assert peers.failure(1, "ValueError: a | b") == "failed: ValueError: a / b"


def test_own_code_comes_first() -> None:
    own = next(iter(of_codes.codes()))
    assert of_codes.chosen(["SPOOLES"]) == [own, "CalculiX, SPOOLES"]
    assert of_codes.chosen([]) == [*of_codes.codes()]


def test_matrix_is_ready_when_the_solver_begins(tmp_path: Path) -> None:
    program = "import time; print('Factoring the system', flush=True); time.sleep(0.2); print('Job finished')"
    found = of_codes.run_calculix([sys.executable, "-c", program], tmp_path)
    assert 0 < found.ready_s < found.end_s - 0.1
    assert found.peak_MiB > 1
    with pytest.raises(RuntimeError, match="not enough"):
        of_codes.run_calculix([sys.executable, "-c", "print('not enough')"], tmp_path)


def test_cases_are_those_of_the_evaluation(tmp_path: Path) -> None:
    """Written, read again and solved by both codes of this environment, they give the condensation."""
    scene = mikron_with(0.0)
    mesh = mesh_throw(scene, 13.0, graded=False).mesh
    of_codes.quarter_cases(mesh, scene).save(tmp_path / "cases.npz")
    cases = of_codes.load_cases(tmp_path / "cases.npz")
    model = elastic(mesh, scene)
    twist, bend = condense(model, scene, "antisymmetric", "odd"), condense(model, scene, "symmetric", "even")
    turn = twist.index(of_codes.RZ)[0]
    expected = twist.stiffness[turn, turn] / 2e6, 2 / bend.load_compliance / 1e3
    for code in (of_codes.with_cranktopo, of_codes.codes()["scikit-fem, SuperLU"]):
        found = code(cases, tmp_path).displacements_mm
        assert of_codes.stiffnesses(cases.assembled(), cases, found) == pytest.approx(expected, rel=1e-9)
        left = [of_codes.free_residual(model, cases, case, field) for case, field in enumerate(found)]
        assert np.max(left) < of_codes.RESIDUAL
