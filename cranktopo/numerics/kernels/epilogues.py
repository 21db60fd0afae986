"""What is done with the forces of a plane of nodes once they are complete."""

from __future__ import annotations

from collections.abc import Sequence

import llvmlite.ir as ir

from cranktopo.numerics.kernels.ir_builder import INT64, Value, VectorCode
from cranktopo.numerics.kernels.plane_sweep import Grid, Planes, Shape, field_offset


class Store:
    """The forces themselves are the result: a product."""

    arrays = 1
    replaced = 0

    def results(self, field: Shape) -> list[Shape]:
        """Return forces."""
        return [field]

    def write(
        self, code: VectorCode, grid: Grid, arrays: Sequence[Value], case: Value, plane: Value, forces: Planes
    ) -> None:
        """Write them to their place."""
        for c, address in enumerate(forces):
            code.copy(address, code.at(arrays[1], field_offset(code, grid, case, c, plane)), grid.plane)


class FreeForces:
    """Forces on the displacements that are free to move, and the work of the field.

    Arrays: field (cases, 3, nodes...), factors along x (cases, 3, nodes) and along z (cases, 3, nodes), 1
    where a component is free.
    """

    arrays = 3
    replaced = 0

    def results(self, field: Shape) -> list[Shape]:
        """Return forces times factors, all forces on the ends along z, works of the former per plane."""
        cases, _, nx, ny, _ = field
        return [field, (cases, 3, nx, ny, 2), (cases, nx)]

    def write(
        self, code: VectorCode, grid: Grid, arrays: Sequence[Value], case: Value, plane: Value, forces: Planes
    ) -> None:
        """Write row by row."""
        field, along_x, along_z, free, ends, works = arrays
        total = code.zero
        for c, address in enumerate(forces):
            component = code.plus(code.times(case, INT64(3)), c)
            start = field_offset(code, grid, case, c, plane)
            across = code.spread(code.at(along_x, code.times(component, grid.nx), plane))
            factors = code.at(along_z, code.times(component, grid.nz))
            rows = code.times(code.plus(code.times(component, grid.nx), plane), grid.ny)
            with code.loop(INT64(0), grid.ny, INT64(1), (total,)) as row:
                line = code.times(row.index, grid.nz)
                end = code.at(ends, code.times(code.plus(rows, row.index), INT64(2)))
                for number, node in enumerate((INT64(0), code.plus(grid.nz, -1))):
                    force = code.builder.load(code.at(address, line, node), typ=code.number)
                    code.builder.store(force, code.at(end, number))
                with code.loop(INT64(0), grid.nz, INT64(code.width), row.values) as column:
                    k, (total,) = column.index, column.values
                    mask = code.first_lanes(code.plus(grid.nz, code.builder.neg(k)))
                    factor = code.multiply(across, code.load(code.at(factors, k), mask))
                    value = code.multiply(factor, code.load(code.at(address, line, k), mask))
                    code.store(value, code.at(free, start, line, k), mask)
                    moved = code.load(code.at(field, start, line, k), mask)
                    column.following = (code.add(total, code.multiply(value, moved)),)
                row.following = column.values
            (total,) = row.values
        code.builder.store(code.total(total), code.at(works, code.times(case, grid.nx), plane))


class Smooth:
    """One step of Chebyshev-Jacobi smoothing.

    Arrays: correction, field and residual (cases, 3, nodes...), which are replaced; step (3, nodes...), its
    factors along x (cases, 3, nodes) and along z (cases, 3, nodes), two weights. Residual -= forces of the
    correction; correction = first weight * correction + second weight * step * factors * residual; field +=
    correction. With a second weight of 0 only the residual is changed.
    """

    arrays = 7
    replaced = 3

    def results(self, field: Shape) -> list[Shape]:
        """Return correction, field and residual."""
        return [field] * 3

    def write(
        self, code: VectorCode, grid: Grid, arrays: Sequence[Value], case: Value, plane: Value, forces: Planes
    ) -> None:
        """Write row by row, each number read and written once."""
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
