"""Machine code for products with symmetric matrices of 3x3 blocks: SciPy's take five times as long.

A product reads every block once and uses it twice, as it stands and transposed, for all columns at once.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any

_INDEX, _POINTER = ctypes.c_int64, ctypes.c_void_p
_KINDS = {"double": ctypes.c_double, "float": ctypes.c_float}
_engines: list[Any] = []  # machine code lives as long as its engine

_PRODUCT = """
define void @product(i64 %rows, double %factor, ptr noalias %start, ptr noalias %column, ptr noalias %value,
                     ptr noalias %field, ptr noalias %total) {{
entry:
  br label %row
row:
  %i = phi i64 [0, %entry], [%next, %finish]
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
"""
_SCATTER = """
define void @scatter(i64 %count, ptr noalias %slot, ptr noalias %block, ptr noalias %value) {
entry:
  br label %one
one:
  %i = phi i64 [0, %entry], [%next, %one]
  %next = add i64 %i, 1
  %slot.at = getelementptr i32, ptr %slot, i64 %i
  %slot.short = load i32, ptr %slot.at
  %place = sext i32 %slot.short to i64
  %from = getelementptr [9 x double], ptr %block, i64 %i
  %to = getelementptr [9 x double], ptr %value, i64 %place
  %more = load <9 x double>, ptr %from, align 8
  %had = load <9 x double>, ptr %to, align 8
  %sum = fadd <9 x double> %had, %more
  store <9 x double> %sum, ptr %to, align 8
  %again = icmp slt i64 %next, %count
  br i1 %again, label %one, label %exit
exit:
  ret void
}
"""


@cache
def product(width: int, kind: str = "double") -> Callable[..., None]:
    """Return `product(rows, factor, start, column, value, field, total)`: total += factor * matrix @ field.

    Arrays by address; field and total have `width` columns, all numbers are of a kind, "double" or "float".
    """
    arguments = _INDEX, _KINDS[kind], *(_POINTER,) * 5
    return _compiled(_product_text(width).replace("double", kind), "product", arguments)


@cache
def scatter() -> Callable[..., None]:
    """Return `scatter(count, slot, block, value)`, which adds blocks to those at their places, in order."""
    return _compiled(_SCATTER, "scatter", (_INDEX, *(_POINTER,) * 3))


def _compiled(text: str, name: str, arguments: tuple[Any, ...]) -> Callable[..., None]:
    import llvmlite.binding as llvm  # loads all of LLVM: only who solves needs it

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    features = llvm.get_host_cpu_features().flatten()
    target = llvm.Target.from_default_triple()
    machine = target.create_target_machine(cpu=llvm.get_host_cpu_name(), features=features, opt=3, jit=True)
    module = llvm.parse_assembly(text)
    module.triple, module.data_layout = machine.triple, str(machine.target_data)
    passes = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))
    passes.getModulePassManager().run(module, passes)
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.finalize_object()
    _engines.append(engine)
    return ctypes.CFUNCTYPE(None, *arguments)(engine.get_function_address(name))


def _product_text(width: int) -> str:
    vector = f"<{width} x double>"
    row = _loads(vector, width, "field", "x", "%i") + _loads(vector, width, "total", "own", "%i")
    row += _scaled(vector, width, "x")
    block = _loads(vector, width, "field", "z", "%j") + _loads(vector, width, "total", "other", "%j")
    block += _scaled(vector, width, "z")
    block += ["%block.at = getelementptr [9 x double], ptr %value, i64 %p"]
    for r in range(3):
        for c in range(3):
            block += _entry(vector, width, r, c)
    for c in range(3):
        block += [f"%told{c} = select i1 %aside, {vector} %turned{c}2, {vector} %other{c}"]
        block += [f"store {vector} %told{c}, ptr %other{c}.at, align 8"]
    return _PRODUCT.format(
        row=_lines(row),
        sums=_lines([f"%sum{r} = phi {vector} [%own{r}, %row], [%sum{r}2, %block]" for r in range(3)]),
        block=_lines(block),
        finish=_lines([f"store {vector} %sum{r}2, ptr %own{r}.at, align 8" for r in range(3)]),
    )


def _loads(vector: str, width: int, array: str, name: str, node: str) -> list[str]:
    """Lines that load the three rows of a node."""
    lines = []
    for axis in range(3):
        lines += [f"%{name}{axis}.node = mul i64 {node}, {3 * width}"]
        lines += [f"%{name}{axis}.place = add i64 %{name}{axis}.node, {axis * width}"]
        lines += [f"%{name}{axis}.at = getelementptr double, ptr %{array}, i64 %{name}{axis}.place"]
        lines += [f"%{name}{axis} = load {vector}, ptr %{name}{axis}.at, align 8"]
    return lines


def _scaled(vector: str, width: int, name: str) -> list[str]:
    lines = _spread(vector, width, f"{name}.by", "%factor")
    return lines + [f"%{name}{a}.s = fmul {vector} %{name}{a}, %{name}.by" for a in range(3)]


def _spread(vector: str, width: int, name: str, number: str) -> list[str]:
    return [
        f"%{name}.one = insertelement {vector} poison, double {number}, i64 0",
        f"%{name} = shufflevector {vector} %{name}.one, {vector} poison, <{width} x i32> zeroinitializer",
    ]


def _entry(vector: str, width: int, r: int, c: int) -> list[str]:
    """Lines that use an entry of a block for the row of nodes, and transposed for the column."""
    own = f"%sum{r}" if c == 0 else f"%sum{r}{c - 1}"
    other = f"%other{c}" if r == 0 else f"%turned{c}{r - 1}"
    return [
        f"%m{r}{c}.at = getelementptr double, ptr %block.at, i64 {3 * r + c}",
        f"%m{r}{c}.number = load double, ptr %m{r}{c}.at, align 8",
        *_spread(vector, width, f"m{r}{c}", f"%m{r}{c}.number"),
        f"%a{r}{c} = fmul contract {vector} %m{r}{c}, %z{c}.s",
        f"%sum{r}{c} = fadd contract {vector} {own}, %a{r}{c}",
        f"%b{r}{c} = fmul contract {vector} %m{r}{c}, %x{r}.s",
        f"%turned{c}{r} = fadd contract {vector} {other}, %b{r}{c}",
    ]


def _lines(lines: list[str]) -> str:
    return "\n".join(f"  {line}" for line in lines)
