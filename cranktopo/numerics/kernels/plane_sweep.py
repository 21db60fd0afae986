"""Code that goes through the planes of nodes along x: an operator couples two neighbours, a finish ends one.

Nodal forces of two planes are kept at a time, in spare memory that stays in the cache. Once the operator has
coupled a plane to the next one its forces are complete, and the finish does with them what the call is for:
fields that it changes are read and written once. A finish keeps the forces, masks them, or smooths with them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import llvmlite.ir as ir

from cranktopo.numerics.kernels.ir_builder import INT64, Value, VectorCode

# What a kernel gets after its arrays: cases, nodes along x, y, z, part, its first plane, that after its last.
NUMBERS = [INT64] * 7

Shape = tuple[int, ...]
Planes = tuple[Value, ...]
"""Addresses of a plane of nodes, one per component."""


@dataclass(frozen=True)
class Grid:
    """Numbers of nodes; in `plane` and `component`, numbers from one plane or component to the next."""

    cases: Value
    nx: Value
    ny: Value
    nz: Value
    plane: Value
    component: Value


@dataclass(frozen=True)
class Pair:
    """A plane of nodes and the one after it: displacements to read, forces to add to, each near and far."""

    field: tuple[Planes, Planes]
    forces: tuple[Planes, Planes]


@dataclass(frozen=True)
class Layer:
    """Planes of every case that an operator couples in one go.

    The addresses of the far plane must not be used where it is not `inside`.
    """

    number: Value
    inside: Value
    cases: Value
    pair: Callable[[Value], Pair]


class Operator(Protocol):
    """Forces on two planes by a layer of cells, or by the stencils of a plane.

    It is made of so many arrays; `all_cases_at_once`: all load cases go through the planes side by side.
    """

    arrays: int
    all_cases_at_once: bool

    def couple(self, code: VectorCode, grid: Grid, arrays: Sequence[Value], layer: Layer) -> None:
        """Write what couples the planes of a layer."""


class Finish(Protocol):
    """Work on a plane whose forces are complete.

    It reads so many arrays, the field first; the first `replaced` of them are the memory of its results.
    """

    arrays: int
    replaced: int

    def results(self, field: Shape) -> list[Shape]:
        """Return shapes of what it writes; the first one has the field's."""

    def write(
        self, code: VectorCode, grid: Grid, arrays: Sequence[Value], case: Value, plane: Value, forces: Planes
    ) -> None:
        """Write what ends a plane of one case."""


def write_planes(code: VectorCode, operator: Operator, finish: Finish) -> None:
    """Write the kernel that ends the planes of nodes from `first` to before `last` of every case.

    Inputs of the function: arrays of the operator and of the finish, spare memory (parts, planes, 3, nodes
    along y, along z), `NUMBERS`. A part couples the planes on both sides of its own, whose forces it does not
    end, so that the number of parts does not change the result.
    """
    march = _March(code, operator, finish)
    if operator.all_cases_at_once:
        march.write(INT64(0), march.grid.cases)
    else:
        with code.loop(march.grid.cases) as case:
            march.write(case.index, INT64(1))
    code.builder.ret_void()


def spare_planes(operator: Operator, finish: Finish) -> tuple[int, int]:
    """Return planes in the spare memory of a part, per case and besides: copies, forces of two."""
    copies = _copied_planes(finish)
    return (copies + 2, 0) if operator.all_cases_at_once else (copies, 2)


def _copied_planes(finish: Finish) -> int:
    """Planes that a part keeps copies of, per case: one on each side of what it overwrites."""
    return 2 if finish.replaced else 0


def write_copies(code: VectorCode, operator: Operator, finish: Finish) -> None:
    """Write what is called for every part before the kernel, with the same inputs.

    Where the finish overwrites the field it copies the planes next to the part's own into its spare memory.
    """
    march = _March(code, operator, finish)
    if finish.replaced:
        march.copy_neighbours()
    code.builder.ret_void()


class _March:
    def __init__(self, code: VectorCode, operator: Operator, finish: Finish):
        *arrays, spare, cases, nx, ny, nz, part, self._first, self._last = code.function.args
        plane = code.times(ny, nz)
        self._code, self._operator, self._finish = code, operator, finish
        self.grid = Grid(cases, nx, ny, nz, plane, code.times(nx, plane))
        self._own, self._others = arrays[: operator.arrays], arrays[operator.arrays :]
        each, besides = spare_planes(operator, finish)
        planes = code.plus(code.times(INT64(each), cases), besides)
        self._copies = code.at(spare, code.times(part, INT64(3), planes, plane))
        copied = INT64(3 * _copied_planes(finish))
        self._near = code.at(self._copies, code.times(copied, cases, plane))

    def write(self, start: Value, cases: Value) -> None:
        """Go through the planes with so many cases, from one on."""
        code, first = self._code, self._first
        size = code.times(INT64(3), cases, self.grid.plane)
        before = code.plus(first, -1)
        begin = code.builder.select(code.below(before, INT64(0)), INT64(0), before)
        near, far = self._near, code.at(self._near, size)
        code.clear(near, size)
        with code.loop(self._last, start=begin, carried=(near, far)) as turn:
            plane, (near, far) = turn.index, turn.values
            code.clear(far, size)
            inside = code.below(code.plus(plane, 1), self.grid.nx)
            layer = Layer(plane, inside, cases, lambda k: self._pair(start, k, plane, (near, far)))
            self._operator.couple(code, self.grid, self._own, layer)
            with code.builder.if_then(code.builder.not_(code.below(plane, first))), code.loop(cases) as k:
                case, forces = code.plus(start, k.index), self._forces(near, k.index)
                self._finish.write(code, self.grid, self._others, case, plane, forces)
            turn.following = far, near

    def copy_neighbours(self) -> None:
        """Copy the planes before and after the part's own, of all cases."""
        code, there = self._code, (self._code.plus(self._first, -1), self._last)
        exists = code.below(INT64(0), self._first), code.below(self._last, self.grid.nx)
        for side in range(2):
            with code.builder.if_then(exists[side]), code.loop(self.grid.cases) as case:
                for c in range(3):
                    copy = self._copy(side, case.index, c)
                    code.copy(self._plane(case.index, c, there[side]), copy, self.grid.plane)

    def _pair(self, start: Value, k: Value, plane: Value, forces: tuple[Value, Value]) -> Pair:
        case = self._code.plus(start, k)
        far = self._code.plus(plane, 1)
        fields = self._field(case, plane), self._field(case, far)
        return Pair(fields, (self._forces(forces[0], k), self._forces(forces[1], k)))

    def _field(self, case: Value, plane: Value) -> Planes:
        code, own = self._code, tuple(self._plane(case, c, plane) for c in range(3))
        if not self._finish.replaced:
            return own
        before, after = code.below(plane, self._first), code.builder.not_(code.below(plane, self._last))
        select = code.builder.select
        return tuple(
            select(before, self._copy(0, case, c), select(after, self._copy(1, case, c), address))
            for c, address in enumerate(own)
        )

    def _plane(self, case: Value, c: int, plane: Value) -> Value:
        return self._code.at(self._others[0], _field_offset(self._code, self.grid, case, c, plane))

    def _copy(self, side: int, case: Value, c: int) -> Value:
        code, cases = self._code, self.grid.cases
        fields = code.plus(code.times(INT64(side), cases), case)
        return code.at(self._copies, code.times(code.plus(code.times(fields, INT64(3)), c), self.grid.plane))

    def _forces(self, start: Value, k: Value) -> Planes:
        code = self._code
        first = code.times(k, INT64(3))
        return tuple(code.at(start, code.times(code.plus(first, c), self.grid.plane)) for c in range(3))


def _field_offset(code: VectorCode, grid: Grid, case: Value, c: int, plane: Value) -> Value:
    """Return numbers before a plane of a component in a field (cases, 3, nodes...)."""
    component = code.plus(code.times(case, INT64(3)), c)
    return code.plus(code.times(component, grid.component), code.times(plane, grid.plane))


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
            code.copy(address, code.at(arrays[1], _field_offset(code, grid, case, c, plane)), grid.plane)


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
            start = _field_offset(code, grid, case, c, plane)
            across = code.spread(code.at(along_x, code.times(component, grid.nx), plane))
            factors = code.at(along_z, code.times(component, grid.nz))
            rows = code.times(code.plus(code.times(component, grid.nx), plane), grid.ny)
            with code.loop(grid.ny, carried=(total,)) as row:
                line = code.times(row.index, grid.nz)
                end = code.at(ends, code.times(code.plus(rows, row.index), INT64(2)))
                for number, node in enumerate((INT64(0), code.plus(grid.nz, -1))):
                    force = code.builder.load(code.at(address, line, node), typ=code.number)
                    code.builder.store(force, code.at(end, number))
                with code.loop(grid.nz, step=code.width, carried=row.values) as column:
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
        start = _field_offset(code, grid, case, c, plane)
        own = code.plus(code.times(INT64(c), grid.component), code.times(plane, grid.plane))
        component = code.plus(code.times(case, INT64(3)), c)
        keep, fresh = (code.spread(code.at(weights, n)) for n in range(2))
        fresh = code.multiply(fresh, code.spread(code.at(along_x, code.times(component, grid.nx), plane)))
        factors = code.at(along_z, code.times(component, grid.nz))
        with code.loop(grid.ny) as row, code.loop(grid.nz, step=code.width) as column:
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
