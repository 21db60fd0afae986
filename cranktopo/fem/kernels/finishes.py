"""What is done with the forces of a plane of nodes once they are complete."""

from __future__ import annotations

from collections.abc import Sequence

import llvmlite.ir as ir

from cranktopo.fem.kernels.code import INT64, Value, VectorCode
from cranktopo.fem.kernels.planes import Grid, Planes, field_offset


class Store:
    """The forces themselves are the result: a product."""

    arrays = 1, 1
    replaced = 0

    def write(
        self, code: VectorCode, grid: Grid, arrays: Sequence[Value], case: Value, plane: Value, forces: Planes
    ) -> None:
        """Write them to their place."""
        for c, address in enumerate(forces):
            code.copy(address, code.at(arrays[1], field_offset(code, grid, case, c, plane)), grid.plane)


class Smooth:
    """One step of Chebyshev-Jacobi smoothing.

    Arrays: correction, field and residual (cases, 3, nodes...), which are replaced; step (3, nodes...), its
    factors along x (cases, 3, nodes) and along z (cases, 3, nodes), two weights. Residual -= forces of the
    correction; correction = first weight * correction + second weight * step * factors * residual; field +=
    correction. With a second weight of 0 only the residual is changed.
    """

    arrays = 7, 3
    replaced = 3

    def write(
        self, code: VectorCode, grid: Grid, arrays: Sequence[Value], case: Value, plane: Value, forces: Planes
    ) -> None:
        """Row by row, each number read and written once."""
        weights = arrays[6]
        second = code.builder.load(code.at(weights, 1), typ=code.number)
        smooth = code.builder.fcmp_unordered("!=", second, ir.Constant(code.number, 0.0))
        with code.builder.if_else(smooth) as (whole, residual_alone):
            for branch, with_correction in ((whole, True), (residual_alone, False)):
                with branch:
                    for c in range(3):
                        self._component(code, grid, arrays, (case, c, plane), forces[c], with_correction)

    def _component(
        self,
        code: VectorCode,
        grid: Grid,
        arrays: Sequence[Value],
        place: tuple[Value, int, Value],
        forces: Value,
        with_correction: bool,
    ) -> None:
        correction, field, residual, step, along_x, along_z, weights = arrays[:7]
        case, c, plane = place
        start = field_offset(code, grid, case, c, plane)
        own = code.plus(code.times(INT64(c), grid.component), code.times(plane, grid.plane))
        component = code.plus(code.times(case, INT64(3)), c)
        keep, fresh = (code.spread(code.at(weights, n)) for n in range(2))
        fresh = code.multiply(fresh, code.spread(code.at(along_x, code.times(component, grid.nx), plane)))
        factors = code.at(along_z, code.times(component, grid.nz))
        with (
            code.loop(INT64(0), grid.ny, INT64(1)) as row,
            code.loop(INT64(0), grid.nz, INT64(code.width)) as column,
        ):
            k = column.index
            mask = code.first_lanes(code.plus(grid.nz, code.builder.neg(k)))
            at = code.times(row.index, grid.nz), k

            def load(array: Value, *offset: Value) -> Value:
                return code.load(code.at(array, *offset, *at), mask)

            left = code.subtract(load(residual, start), load(forces))
            code.store(left, code.at(residual, start, *at), mask)
            if with_correction:
                factor = code.multiply(fresh, code.load(code.at(factors, k), mask))
                scale = code.multiply(factor, load(step, own))
                kept = code.multiply(keep, load(correction, start))
                following = code.add(kept, code.multiply(scale, left))
                code.store(following, code.at(correction, start, *at), mask)
                code.store(code.add(load(field, start), following), code.at(field, start, *at), mask)
