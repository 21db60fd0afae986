"""Code of the product with a stencil of 27 blocks 3 x 3, of which 14 are stored, row by row of nodes along z.

What a row of nodes needs lies in one piece of memory, and the next row is asked for while this one is
computed: the product takes little more time than reading the stencil.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from cranktopo.fem.kernels.code import INT64, Value, VectorCode

# A node itself and the half of its neighbours that come later; the rest of a symmetric operator follows.
OFFSETS = [offset for offset in product((-1, 0, 1), repeat=3) if offset >= (0, 0, 0)]
# Empty planes before the first: rows of earlier neighbours can then be read everywhere.
LEAD = 2


@dataclass(frozen=True)
class _Sizes:
    """Numbers from a row, plane or component to the next: of the stencil, the padded fields, the result."""

    stencil_row: Value
    stencil_plane: Value
    field_row: Value
    field_plane: Value
    field: Value
    plane: Value
    component: Value


def write_stencil(code: VectorCode) -> None:
    """Product on the planes of nodes from `first` to before `last` of every case.

    Inputs of the function: stencil (LEAD + nodes along x, along y, 14, 3, 3, along z), fields with a node of
    zeros around them, result, cases, nodes along x, along y, along z, part, first, last.
    """
    stencil, fields, result, cases, nx, ny, nz, _, first, last = code.function.args
    sizes = _sizes(code, nx, ny, nz)
    zero, one = INT64(0), INT64(1)
    with code.loop(first, last, one) as plane, code.loop(zero, ny, one) as row:
        i, j = plane.index, row.index
        rows = code.times(code.plus(i, LEAD), sizes.stencil_plane), code.times(j, sizes.stencil_row)
        inner = (
            code.times(code.plus(i, 1), sizes.field_plane),
            code.times(code.plus(j, 1), sizes.field_row),
        )
        outer = code.times(i, sizes.plane), code.times(j, nz)
        with code.loop(zero, nz, INT64(code.width)) as nodes, code.loop(zero, cases, one) as case:
            k, components = nodes.index, code.times(case.index, INT64(3))
            mask = code.first_lanes(code.plus(nz, code.builder.neg(k)))
            field = code.at(fields, code.times(components, sizes.field), *inner, k, 1)
            sums = _products(code, code.at(stencil, *rows, k), field, sizes, nz, mask)
            target = code.at(result, code.times(components, sizes.component), *outer, k)
            for c in range(3):
                code.store(sums[c], code.at(target, code.times(INT64(c), sizes.component)), mask)
    code.builder.ret_void()


def _sizes(code: VectorCode, nx: Value, ny: Value, nz: Value) -> _Sizes:
    stencil_row = code.times(INT64(9 * len(OFFSETS)), nz)
    field_row, plane = code.plus(nz, 2), code.times(ny, nz)
    field_plane = code.times(field_row, code.plus(ny, 2))
    return _Sizes(
        stencil_row=stencil_row,
        stencil_plane=code.times(stencil_row, ny),
        field_row=field_row,
        field_plane=field_plane,
        field=code.times(field_plane, code.plus(nx, 2)),
        plane=plane,
        component=code.times(plane, nx),
    )


def _products(
    code: VectorCode, blocks: Value, field: Value, sizes: _Sizes, nz: Value, mask: Value
) -> list[Value]:
    """The three components of the product at a vector of nodes, given where its blocks and fields begin."""
    sums = [code.zero] * 3

    def add(c: int, entry: Value, displacement: Value) -> None:
        sums[c] = code.add(sums[c], code.multiply(code.load(entry, mask), displacement))

    for index, (i, j, k) in enumerate(OFFSETS):
        shift = code.plus(code.times(INT64(i), sizes.field_plane), code.times(INT64(j), sizes.field_row), k)
        back = code.times(INT64(-i), sizes.stencil_plane), code.times(INT64(-j), sizes.stencil_row)
        before = code.at(blocks, *back, -k)
        for d in range(3):
            line = code.at(field, code.times(INT64(d), sizes.field))
            later = code.load(code.at(line, shift), mask)
            earlier = code.load(code.at(line, code.builder.neg(shift)), mask) if index else None
            for c in range(3):
                entry = code.at(blocks, code.times(INT64((index * 3 + c) * 3 + d), nz))
                code.prefetch(code.at(entry, sizes.stencil_row))
                add(c, entry, later)
                if earlier is not None:
                    add(c, code.at(before, code.times(INT64((index * 3 + d) * 3 + c), nz)), earlier)
    return sums
