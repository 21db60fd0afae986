"""Code of the strain energy of cells on the finest grid."""

from __future__ import annotations

from itertools import product

from cranktopo.numerics.kernels.ir_builder import INT64, Value, VectorCode
from cranktopo.numerics.kernels.parity_sums import ROWS, Cells, Classes, Waves, block_product
from cranktopo.numerics.kernels.plane_sweep import Planes


def write_energies(code: VectorCode) -> None:
    """v^T K_e u of the cells for unit modulus, from plane of cells `first` to before `last` of every case.

    Inputs of the function: reflection blocks (8, 3, 3, cells along z); fields v and u (cases, 3, nodes...);
    energies (cases, 1, cells...); cases, cells along x, y, z, part, first, last.
    """
    blocks, left, right, target, cases, nx, ny, nz, _, first, last = code.function.args
    row = code.plus(nz, 1)
    cells = Cells(ny, nz, row, code.times(code.plus(ny, 1), row))
    with (
        code.loop(INT64(0), cases, INT64(1)) as case,
        code.loop(first, last, INT64(1)) as plane,
        code.loop(INT64(0), nz, INT64(code.width)) as column,
    ):
        number = code.plus(code.times(case.index, nx), plane.index)
        energies = code.at(target, code.times(number, ny, nz), column.index)
        fields = [_layer(code, cells, start, nx, (case.index, plane.index)) for start in (left, right)]
        waves = [Waves(code, cells, column.index, field) for field in fields]
        _write_column(code, blocks, waves, energies)
    code.builder.ret_void()


def _layer(
    code: VectorCode, cells: Cells, start: Value, nx: Value, place: tuple[Value, Value]
) -> tuple[Planes, Planes]:
    """Return both planes of nodes of a layer of cells of a field."""
    case, plane = place
    component = code.times(code.plus(nx, 1), cells.plane)
    planes = []
    for step in (0, 1):
        within = code.times(code.plus(plane, step), cells.plane)
        firsts = (code.times(code.plus(code.times(case, INT64(3)), c), component) for c in range(3))
        planes.append(tuple(code.at(start, offset, within) for offset in firsts))
    return planes[0], planes[1]


def _write_column(code: VectorCode, blocks: Value, waves: list[Waves], energies: Value) -> None:
    """All rows of cells of a column, one after the other."""
    cells, count = waves[0].cells, len(ROWS)
    before = [wave for side in waves for wave in side.along_z(INT64(0))]
    with code.loop(INT64(0), cells.ny, INT64(1), before) as row:
        after = [side.along_z(code.plus(row.index, 1)) for side in waves]
        known = row.values[:count], row.values[count:]
        left, right = (side.classes(near, far) for side, near, far in zip(waves, known, after, strict=True))
        energy = _energy(code, waves[1], blocks, left, right)
        code.store(energy, code.at(energies, code.times(row.index, cells.nz)), waves[0].inside)
        row.following = (*after[0], *after[1])


def _energy(code: VectorCode, waves: Waves, blocks: Value, left: Classes, right: Classes) -> Value:
    """Of a row of cells: the sum over classes and components."""
    energy = code.zero
    for entry in product(range(8), range(3)):
        force = block_product(code, waves, blocks, right, entry)
        if force is not None:
            energy = code.add(energy, code.multiply(left[entry], force))
    return energy
