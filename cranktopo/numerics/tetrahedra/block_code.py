"""Machine code for sums of element matrices, and for products with symmetric matrices of 3x3 blocks.

SciPy's products take five times as long. A product reads every block once and uses it twice, as it stands and
transposed, for all columns at once.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from cranktopo.numerics.machine_code import address_of, with_target

_INDEX, _POINTER = ctypes.c_int64, ctypes.c_void_p
_KINDS = {"double": ctypes.c_double, "float": ctypes.c_float}
_ARRAYS = "start", "column", "value", "field", "total"
_PRODUCT = """
declare {vector} @llvm.masked.load.v{lanes}f{bits}.p0(ptr, i32, {mask}, {vector})
declare void @llvm.masked.store.v{lanes}f{bits}.p0({vector}, ptr, i32, {mask})

define internal void @part(i64 %begin, i64 %rows, {kind} %factor, ptr noalias %start, ptr noalias %column,
                           ptr noalias %value, ptr noalias %field, ptr noalias %total) {{
entry:
  br label %row
row:
  %i = phi i64 [%begin, %entry], [%next, %finish]
  %next = add i64 %i, 1
  %first.at = getelementptr i32, ptr %start, i64 %i
  %end.at = getelementptr i32, ptr %start, i64 %next
  %first.short = load i32, ptr %first.at
  %end.short = load i32, ptr %end.at
  %first = sext i32 %first.short to i64
  %end = sext i32 %end.short to i64
{row}
  br label %block
block:
  %p = phi i64 [%first, %row], [%following, %block]
{sums}
  %following = add i64 %p, 1
  %column.at = getelementptr i32, ptr %column, i64 %p
  %column.short = load i32, ptr %column.at
  %j = sext i32 %column.short to i64
  %aside = icmp ne i64 %j, %i
{block}
  %more = icmp slt i64 %following, %end
  br i1 %more, label %block, label %finish
finish:
{finish}
  %again = icmp slt i64 %next, %rows
  br i1 %again, label %row, label %exit
exit:
  ret void
}}

{threads}
%task = type {{ i64, i64, {kind}, ptr, ptr, ptr, ptr, ptr }}

define internal ptr @beside(ptr %task) {{
  %all = load %task, ptr %task
{fields}
  call void @part(i64 %f0, i64 %f1, {kind} %f2, ptr %f3, ptr %f4, ptr %f5, ptr %f6, ptr %f7)
  ret ptr null
}}

define void @product(i64 %first, i64 %middle, i64 %rows, {kind} %factor, ptr %start, ptr %column, ptr %value,
                     ptr %field, ptr %total) {{
entry:
  %task = alloca %task
  %thread = alloca i64
  %split = icmp slt i64 %middle, %rows
  br i1 %split, label %shared, label %own
shared:
{stores}
  %refused = call i32 @pthread_create(ptr %thread, ptr null, ptr @beside, ptr %task)
  %alone = icmp ne i32 %refused, 0
  br i1 %alone, label %all, label %own
all:
  %none = call ptr @beside(ptr %task)
  br label %own
own:
  %joins = phi i1 [false, %entry], [true, %shared], [false, %all]
  %any = icmp sgt i64 %first, 0
  br i1 %any, label %low, label %end
low:
  call void @part(i64 0, i64 %first, {kind} %factor, {arrays})
  br label %end
end:
  br i1 %joins, label %join, label %rest
join:
  %number = load i64, ptr %thread
  %joined = call i32 @pthread_join(i64 %number, ptr null)
  br label %rest
rest:
  %between = icmp slt i64 %first, %middle
  br i1 %between, label %last, label %done
last:
  call void @part(i64 %first, i64 %middle, {kind} %factor, {arrays})
  br label %done
done:
  ret void
}}
"""
_THREADS = """declare i32 @pthread_create(ptr, ptr, ptr, ptr)
declare i32 @pthread_join(i64, ptr)"""
_NO_THREADS = """define internal i32 @pthread_create(ptr %a, ptr %b, ptr %c, ptr %d) {
  ret i32 1
}
define internal i32 @pthread_join(i64 %a, ptr %b) {
  ret i32 1
}"""
_ASSEMBLY = """
declare double @llvm.vector.reduce.fadd.v4f64(double, <4 x double>)

define void @assembly(i64 %count, i64 %nodes, ptr noalias %rows, ptr noalias %slopes, ptr noalias %dx,
                      double %first, double %shear, ptr noalias %start, ptr noalias %column,
                      ptr noalias %value) {{
entry:
  br label %element
element:
  %e = phi i64 [0, %entry], [%e.next, %done]
  %e.next = add i64 %e, 1
  %e.first = mul i64 %e, %nodes
  %dx.at = getelementptr [4 x double], ptr %dx, i64 %e
  %w = load <4 x double>, ptr %dx.at, align 8
  br label %own
own:
  %a = phi i64 [0, %element], [%a.next, %other.end]
  %a.next = add i64 %a, 1
  %a.place = add i64 %e.first, %a
  %a.row.at = getelementptr i32, ptr %rows, i64 %a.place
  %a.row = load i32, ptr %a.row.at
  %a.slopes = getelementptr [12 x double], ptr %slopes, i64 %a.place
{own}
  %start.at = getelementptr i32, ptr %start, i32 %a.row
  %start.short = load i32, ptr %start.at
  %begin = sext i32 %start.short to i64
  br label %other
other:
  %b = phi i64 [0, %own], [%b.next, %next]
  %b.next = add i64 %b, 1
  %b.place = add i64 %e.first, %b
  %b.row.at = getelementptr i32, ptr %rows, i64 %b.place
  %b.row = load i32, ptr %b.row.at
  %upper = icmp sge i32 %b.row, %a.row
  br i1 %upper, label %search, label %next
search:
  %p = phi i64 [%begin, %other], [%p.next, %search]
  %p.next = add i64 %p, 1
  %column.at = getelementptr i32, ptr %column, i64 %p
  %here = load i32, ptr %column.at
  %found = icmp eq i32 %here, %b.row
  br i1 %found, label %add, label %search
add:
  %b.slopes = getelementptr [12 x double], ptr %slopes, i64 %b.place
  %block = getelementptr [9 x double], ptr %value, i64 %p
{add}
  br label %next
next:
  %b.more = icmp slt i64 %b.next, %nodes
  br i1 %b.more, label %other, label %other.end
other.end:
  %a.more = icmp slt i64 %a.next, %nodes
  br i1 %a.more, label %own, label %done
done:
  %e.more = icmp slt i64 %e.next, %count
  br i1 %e.more, label %element, label %exit
exit:
  ret void
}}
"""


@cache
def product(width: int, kind: str = "double") -> Callable[..., None]:
    """Return `product(first, middle, rows, factor, start, column, value, field, total)`.

    It adds factor * matrix @ field to the total: the rows before the first, and beside them in a second
    thread those from the middle on, with which they share no column; then the rows between. Threads of Python
    would wait for the interpreter at each end. Arrays by address; field and total have `width` columns, all
    numbers are of a kind, "double" or "float".
    """
    arguments = *(_INDEX,) * 3, _KINDS[kind], *(_POINTER,) * 5
    text = _product_text(width, kind, masks=_has_masks(), threads=_has_threads())
    return _function(text, "product", arguments)


@cache
def assembly() -> Callable[..., None]:
    """Return `assembly(count, nodes, rows, slopes, dx, first, shear, start, column, value)`.

    It adds the stiffness of elements, whose nodes have rows (count, nodes) of blocks, to those blocks; slopes
    are (count, nodes, 3, 4 points), volumes of the points dx (count, 4), first and shear Lame's constants.
    """
    numbers = _KINDS["double"], _KINDS["double"]
    arguments = _INDEX, _INDEX, *(_POINTER,) * 3, *numbers, *(_POINTER,) * 3
    return _function(_assembly_text(), "assembly", arguments)


@cache
def _has_masks() -> bool:
    """Tell whether the processor loads and stores some lanes of a vector alone."""
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features()
    return any(features.get(one, False) for one in ("avx", "sve"))


def _has_threads() -> bool:
    """Tell whether the system begins threads as POSIX does."""
    return sys.platform != "win32"


def _function(text: str, name: str, arguments: tuple[Any, ...]) -> Callable[..., None]:
    whole = with_target(text)
    return ctypes.CFUNCTYPE(None, *arguments)(address_of(name, whole, lambda: whole))


@dataclass(frozen=True)
class _Columns:
    """Lines for the columns of a node, of numbers of a kind, in as many lanes or more.

    Where the processor masks lanes, they are a power of two: five to seven columns take the time of eight
    then, where a vector of just as many numbers takes up to twice that.
    """

    width: int
    kind: str
    masks: bool

    @property
    def lanes(self) -> int:
        """Numbers of a vector."""
        return 1 << (self.width - 1).bit_length() if self.masks else self.width

    @property
    def bits(self) -> int:
        """Size of a number."""
        return 64 if self.kind == "double" else 32

    @property
    def vector(self) -> str:
        """Type of the columns of a row."""
        return f"<{self.lanes} x {self.kind}>"

    @property
    def mask(self) -> str:
        """Type of what tells which lanes have a column."""
        return f"<{self.lanes} x i1>"

    @property
    def _where(self) -> str:
        on = ", ".join(f"i1 {int(lane < self.width)}" for lane in range(self.lanes))
        return f"i32 {self.bits // 8}, {self.mask} <{on}>"

    def loads(self, array: str, name: str, node: str) -> list[str]:
        """Lines that load the three rows of a node."""
        lines = []
        for axis in range(3):
            value = f"%{name}{axis}"
            lines += [f"{value}.node = mul i64 {node}, {3 * self.width}"]
            lines += [f"{value}.place = add i64 {value}.node, {axis * self.width}"]
            lines += [f"{value}.at = getelementptr {self.kind}, ptr %{array}, i64 {value}.place"]
            given = f"ptr {value}.at, {self._where}, {self.vector} zeroinitializer"
            called = f"call {self.vector} @llvm.masked.load.v{self.lanes}f{self.bits}.p0"
            lines += [f"{value} = {called}({given})"]
        return lines

    def store(self, value: str, at: str) -> str:
        """Line that stores a row of a node."""
        called = f"call void @llvm.masked.store.v{self.lanes}f{self.bits}.p0"
        return f"{called}({self.vector} {value}, ptr {at}, {self._where})"

    def scaled(self, name: str) -> list[str]:
        """Lines that scale the three rows of a node by the factor."""
        lines = self.spread(f"{name}.by", "%factor")
        return lines + [f"%{name}{a}.s = fmul {self.vector} %{name}{a}, %{name}.by" for a in range(3)]

    def spread(self, name: str, number: str) -> list[str]:
        """Lines that repeat a number in every lane."""
        lanes = f"<{self.lanes} x i32> zeroinitializer"
        return [
            f"%{name}.one = insertelement {self.vector} poison, {self.kind} {number}, i64 0",
            f"%{name} = shufflevector {self.vector} %{name}.one, {self.vector} poison, {lanes}",
        ]

    def entry(self, r: int, c: int) -> list[str]:
        """Lines that use an entry of a block for the row of nodes, and transposed for the column."""
        vector = self.vector
        own = f"%sum{r}" if c == 0 else f"%sum{r}{c - 1}"
        other = f"%other{c}" if r == 0 else f"%turned{c}{r - 1}"
        return [
            f"%m{r}{c}.at = getelementptr {self.kind}, ptr %block.at, i64 {3 * r + c}",
            f"%m{r}{c}.number = load {self.kind}, ptr %m{r}{c}.at, align {self.bits // 8}",
            *self.spread(f"m{r}{c}", f"%m{r}{c}.number"),
            f"%a{r}{c} = fmul contract {vector} %m{r}{c}, %z{c}.s",
            f"%sum{r}{c} = fadd contract {vector} {own}, %a{r}{c}",
            f"%b{r}{c} = fmul contract {vector} %m{r}{c}, %x{r}.s",
            f"%turned{c}{r} = fadd contract {vector} {other}, %b{r}{c}",
        ]


def _product_text(width: int, kind: str, *, masks: bool, threads: bool) -> str:
    code = _Columns(width, kind, masks)
    row = [*code.loads("field", "x", "%i"), *code.loads("total", "own", "%i"), *code.scaled("x")]
    block = [*code.loads("field", "z", "%j"), *code.loads("total", "other", "%j"), *code.scaled("z")]
    block += [f"%block.at = getelementptr [9 x {kind}], ptr %value, i64 %p"]
    block += [line for r in range(3) for c in range(3) for line in code.entry(r, c)]
    for c in range(3):
        block += [f"%told{c} = select i1 %aside, {code.vector} %turned{c}2, {code.vector} %other{c}"]
        block += [code.store(f"%told{c}", f"%other{c}.at")]
    sums = [f"%sum{r} = phi {code.vector} [%own{r}, %row], [%sum{r}2, %block]" for r in range(3)]
    return _PRODUCT.format(
        vector=code.vector,
        mask=code.mask,
        lanes=code.lanes,
        bits=code.bits,
        kind=kind,
        row=_lines(row),
        sums=_lines(sums),
        block=_lines(block),
        threads=_THREADS if threads else _NO_THREADS,
        fields=_lines([f"%f{i} = extractvalue %task %all, {i}" for i in range(8)]),
        stores=_lines(_task_stores(kind)),
        arrays=", ".join(f"ptr %{name}" for name in _ARRAYS),
        finish=_lines([code.store(f"%sum{r}2", f"%own{r}.at") for r in range(3)]),
    )


def _task_stores(kind: str) -> list[str]:
    """Lines that write down what a second thread is to do."""
    values = "i64 %middle", "i64 %rows", f"{kind} %factor", *(f"ptr %{name}" for name in _ARRAYS)
    lines = []
    for i, value in enumerate(values):
        at = f"%place{i} = getelementptr %task, ptr %task, i64 0, i32 {i}"
        lines += [at, f"store {value}, ptr %place{i}"]
    return lines


def _assembly_text() -> str:
    own: list[str] = []
    add: list[str] = []
    for axis in range(3):
        for node, lines in (("a", own), ("b", add)):
            at = f"%{node}{axis}"
            lines += [f"{at}.at = getelementptr double, ptr %{node}.slopes, i64 {4 * axis}"]
            lines += [f"{at} = load <4 x double>, ptr {at}.at, align 8"]
        own += [f"%w{axis} = fmul <4 x double> %a{axis}, %w"]
    pairs = [(r, c) for r in range(3) for c in range(3)]
    total = "call reassoc double @llvm.vector.reduce.fadd.v4f64"
    for r, c in pairs:
        add += [f"%t{r}{c} = fmul <4 x double> %w{r}, %b{c}"]
        add += [f"%o{r}{c} = {total}(double 0.0, <4 x double> %t{r}{c})"]
    add += ["%o = fadd double %o00, %o11", "%trace = fadd double %o, %o22", "%s = fmul double %shear, %trace"]
    for r, c in pairs:
        name = f"{r}{c}"
        add += [
            f"%f{name} = fmul contract double %first, %o{name}",
            f"%g{name} = fmul contract double %shear, %o{c}{r}",
            f"%h{name} = fadd contract double %f{name}, %g{name}",
            f"%k{name} = fadd double %h{name}, {'%s' if r == c else '0.0'}",
            f"%v{name}.at = getelementptr double, ptr %block, i64 {3 * r + c}",
            f"%v{name} = load double, ptr %v{name}.at, align 8",
            f"%u{name} = fadd double %v{name}, %k{name}",
            f"store double %u{name}, ptr %v{name}.at, align 8",
        ]
    return _ASSEMBLY.format(own=_lines(own), add=_lines(add))


def _lines(lines: list[str]) -> str:
    return "\n".join(f"  {line}" for line in lines)
