"""XLA's structs that a kernel reads, in version 0.3 of its interface, and a first call that checks them.

Source: xla/ffi/api/c_api.h of jaxlib 0.10.2, XLA_FFI_API_MAJOR 0 and XLA_FFI_API_MINOR 3. Kernels are told to
be of this version whatever JAX is installed: XLA then refuses them, or calls them as it did at that time. The
first call in a process compares the sizes of the structs, and the numbers with those of JAX code.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import jax
import numpy as np
from numpy.typing import NDArray

from cranktopo.numerics.grid.lattice import COUPLED

VERSION = 0, 3
METADATA = 1
"""Type of the extension that asks for the version, XLA_FFI_Extension_Metadata."""

_Fields = list[tuple[str, type]]
_HEAD: _Fields = [("struct_size", ctypes.c_size_t), ("extension_start", ctypes.c_void_p)]
_FUNCTIONS = (
    "Error_Create Error_GetMessage Error_Destroy Handler_Register Stream_Get Type_Register "
    "ExecutionContext_Get State_Set State_Get DeviceMemory_Allocate DeviceMemory_Free ThreadPool_Schedule "
    "ThreadPool_NumThreads Future_Create Future_SetAvailable Future_SetError RunId_Get DeviceOrdinal_Get"
)
"""Functions that XLA offers to handlers, in their order, without their prefix."""


def _struct(name: str, fields: _Fields) -> type[ctypes.Structure]:
    return type(name, (ctypes.Structure,), {"_fields_": fields})


def _pointers(*names: str) -> _Fields:
    return [(name, ctypes.c_void_p) for name in names]


# Head of whatever a struct is extended by; the extension that asks for the metadata and nothing else.
Extension = _struct(
    "Extension", [("struct_size", ctypes.c_size_t), ("type", ctypes.c_int), *_pointers("next")]
)
MetadataExtension = _struct("MetadataExtension", [("extension_base", Extension), *_pointers("metadata")])
ApiVersion = _struct("ApiVersion", [*_HEAD, ("major_version", ctypes.c_int), ("minor_version", ctypes.c_int)])
Metadata = _struct(
    "Metadata",
    [
        ("struct_size", ctypes.c_size_t),
        ("api_version", ApiVersion),
        ("traits", ctypes.c_uint32),
        ("state_type_id", ctypes.c_int64),
    ],
)
_offered = [f"XLA_FFI_{name}" for name in _FUNCTIONS.split()]
Api = _struct("Api", [*_HEAD, ("api_version", ApiVersion), *_pointers("internal_api", *_offered)])
# An array; arguments or results, which are all arrays (XLA_FFI_Args, XLA_FFI_Rets); constants, of which
# kernels have none.
Buffer = _struct(
    "Buffer",
    [*_HEAD, ("dtype", ctypes.c_int), *_pointers("data"), ("rank", ctypes.c_int64), *_pointers("dims")],
)
Buffers = _struct("Buffers", [*_HEAD, ("size", ctypes.c_int64), *_pointers("types", "buffers")])
Attributes = _struct("Attributes", [*_HEAD, ("size", ctypes.c_int64), *_pointers("types", "names", "attrs")])
# What a handler is called with.
_CALL: _Fields = [("stage", ctypes.c_int), ("args", Buffers), ("rets", Buffers), ("attrs", Attributes)]
CallFrame = _struct("CallFrame", [*_HEAD, *_pointers("api", "ctx"), *_CALL, *_pointers("future")])

# The header does not count what comes after these (XLA_FFI_DEFINE_STRUCT_TRAITS).
_LAST = {Metadata: "traits", CallFrame: "attrs"}


def offset(kind: type[ctypes.Structure], *path: str) -> int:
    """Return the place of a field in a struct, or of one in the struct that a field is, in bytes."""
    name, *inner = path
    place = int(getattr(kind, name).offset)
    inside: Any = dict(field[:2] for field in kind._fields_)[name]
    return place + offset(inside, *inner) if inner else place


def struct_size(kind: type[ctypes.Structure]) -> int:
    """Return the bytes of a struct as the header counts them, which XLA writes into its first field."""
    field = getattr(kind, _LAST.get(kind, kind._fields_[-1][0]))
    return int(field.offset + field.size)


def unknown_size(frame: int) -> str:
    """Tell which struct at the address of a call frame is of another size than here, empty if none is.

    Read from the outside in: what a struct of another size points to is not looked at.
    """
    for kind, address in _structs(frame):
        found = ctypes.c_size_t.from_address(address).value
        if found != struct_size(kind):
            return f"{kind.__name__} of XLA has {found} bytes, not {struct_size(kind)}"
    return ""


def _structs(address: int) -> Iterator[tuple[type[ctypes.Structure], int]]:
    yield CallFrame, address
    frame = CallFrame.from_address(address)
    place = frame.extension_start
    while place:
        extension = Extension.from_address(place)
        if extension.type == METADATA:  # there is nothing else in the frame
            yield MetadataExtension, place
            metadata = MetadataExtension.from_address(place).metadata
            yield Metadata, metadata
            yield ApiVersion, metadata + offset(Metadata, "api_version")
            return
        place = extension.next
    yield Api, frame.api
    yield Attributes, address + offset(CallFrame, "attrs")
    for name in ("args", "rets"):
        yield Buffers, address + offset(CallFrame, name)
        array = getattr(frame, name)
        addresses = (ctypes.c_void_p * array.size).from_address(array.buffers)
        yield from ((Buffer, buffer) for buffer in addresses)


Product = Callable[[jax.Array, jax.Array, jax.Array], jax.Array]
"""Nodal forces from blocks, moduli and displacements."""

# Load cases and cells: at least as many planes of nodes as threads, rows that end within a vector, and
# enough numbers in all for the threads to share them.
TRIAL = 7, (15, 3, 18)
_TOLERANCE = 1e-5  # of the largest number; float32 takes a hundredth of it
_QUICKLY = {"xla_backend_optimization_level": 0}
_HANDLER = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)
_watched: list[_Watched] = []  # XLA may call a handler as long as the process lives


def register(name: str, address: int) -> None:
    """Let XLA find the handler at an address under a name."""
    jax.ffi.register_ffi_target(name, jax.ffi.pycapsule(_HANDLER(address)), platform="cpu")


def first_line(error: Exception) -> str:
    """Return what an error says first."""
    return str(error).partition("\n")[0][:200] or type(error).__name__


def find_fault(address: int, product: Callable[[str], Product], expected: Product) -> str:
    """Tell what is wrong with the product of the kernel at an address, empty if it is that of JAX code.

    In a thread of its own: the caller may be tracing a program, for another device or several.
    """
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(_tried, address, product, expected).result()


class _Watched:
    """A handler that is called only as long as all structs have the sizes that are known."""

    def __init__(self, address: int) -> None:
        self.fault = ""
        self._handler = _HANDLER(address)
        self._own = _HANDLER(self._call)
        self.address = ctypes.cast(self._own, ctypes.c_void_p).value or 0

    def _call(self, frame: int) -> int | None:
        self.fault = self.fault or unknown_size(frame)
        return None if self.fault else self._handler(frame)


def _tried(address: int, product: Callable[[str], Product], expected: Product) -> str:
    watched, name = _Watched(address), f"cranktopo_trial_{len(_watched)}"
    _watched.append(watched)
    try:
        with jax.default_device(jax.local_devices(backend="cpu")[0]):
            register(name, watched.address)
            programs = (jax.jit(by, compiler_options=_QUICKLY) for by in (product(name), expected))
            numbers = [np.asarray(program(*_operands())) for program in programs]
    except Exception as error:  # of JAX or XLA, whatever they have against it
        return watched.fault or f"a first call failed: {first_line(error)}"
    with np.errstate(all="ignore"):  # what was not written may be any number
        miss = float(np.max(np.abs(numbers[0] - numbers[1])) / np.max(np.abs(numbers[1])))
    differs = "" if miss <= _TOLERANCE else f"a product differs from that of JAX by {100 * miss:.2g} %"
    return watched.fault or differs


def _operands() -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    cases, cells = TRIAL
    shapes = (8, 3, 3, cells[2]), cells, (cases, 3, *(n + 1 for n in cells))
    random = np.random.default_rng(0)
    blocks, moduli, field = (random.random(shape, np.float32) - np.float32(0.5) for shape in shapes)
    return (blocks * COUPLED[..., None]).astype(np.float32), moduli, field
