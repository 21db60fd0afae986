"""XLA's structs that a kernel reads, in version 0.3 of its interface.

Source: xla/ffi/api/c_api.h of jaxlib 0.10.2, XLA_FFI_API_MAJOR 0 and XLA_FFI_API_MINOR 3. Kernels are told to
be of this version whatever JAX is installed: XLA then refuses them, or calls them as it did at that time. The
first call in a process compares the sizes of the structs (`first_call`).
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from typing import Any

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
