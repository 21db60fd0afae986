"""Kernels are called by an XLA that they know, compute what JAX code does, and come from nobody else."""

from __future__ import annotations

import ctypes
import json
import logging
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import click
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from click.testing import CliRunner

from cranktopo.cli.verbosity import verbosity_options
from cranktopo.numerics import machine_code
from cranktopo.numerics.grid import operator, slab_product
from cranktopo.numerics.grid.operator import restrict
from cranktopo.numerics.kernels import catalogue, first_call, frames
from cranktopo.numerics.kernels import registry as processor
from cranktopo.numerics.kernels import xla_ffi as foreign
from cranktopo.numerics.kernels.frames import (
    Api,
    ApiVersion,
    Attributes,
    Buffer,
    Buffers,
    CallFrame,
    Extension,
    Metadata,
    MetadataExtension,
    struct_size,
)
from cranktopo.tasks.doctor import stage as doctor

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no kernels there")

SOLVE = """
import json
import jax.numpy as jnp
import numpy as np
from cranktopo.numerics.kernels.registry import kernels_usable
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density.response import compliances, solve
from tests.studies.cantilever import cantilever

with double_precision():
    model, _ = cantilever((16, 8, 8))
    moduli = jnp.asarray(np.random.default_rng(0).uniform(0.1, 1, model.lattice.cells))
    work = compliances(model, solve(model, moduli, tolerance=1e-9).displacements)
print(json.dumps({"usable": kernels_usable(), "work": float(work[0])}))
"""
FINE, COARSE = (1, 3, 3, 3, 3), (1, 3, 2, 2, 2)


class Call:
    """A call frame as XLA fills it in for a restriction, and what it points to."""

    def __init__(self) -> None:
        self.fine = np.random.default_rng(0).random(FINE, np.float32)
        self.coarse = np.full(COARSE, -1, np.float32)
        self.structs = {kind: kind() for kind in (CallFrame, Api, Metadata, MetadataExtension)}
        for kind, struct in self.structs.items():
            (struct.extension_base if kind is MetadataExtension else struct).struct_size = struct_size(kind)
        # Of another type, with a pointer where the question has one.
        self.behind_other = Metadata()
        self.other = MetadataExtension(Extension(32, 7, None), ctypes.addressof(self.behind_other))
        self.kept: list[object] = []
        frame, metadata = self.structs[CallFrame], self.structs[Metadata]
        metadata.api_version.struct_size = struct_size(ApiVersion)
        self.structs[MetadataExtension].metadata = ctypes.addressof(metadata)
        self.structs[MetadataExtension].extension_base.type = frames.METADATA
        frame.api = ctypes.addressof(self.structs[Api])
        frame.stage, frame.attrs.struct_size = 3, struct_size(Attributes)
        for buffers, array in ((frame.args, self.fine), (frame.rets, self.coarse)):
            self._fill(buffers, array)

    def _fill(self, buffers: Buffers, array: np.ndarray) -> None:
        sizes = (ctypes.c_int64 * array.ndim)(*array.shape)
        buffer = Buffer(struct_size(Buffer), None, 11, array.ctypes.data, array.ndim, ctypes.addressof(sizes))
        addresses = (ctypes.c_void_p * 1)(ctypes.addressof(buffer))
        buffers.struct_size, buffers.size = struct_size(Buffers), 1
        buffers.buffers = ctypes.addressof(addresses)
        self.kept += [sizes, buffer, addresses]

    def extend(self, *extensions: MetadataExtension) -> None:
        """Chain extensions behind the frame."""
        before = self.structs[CallFrame]
        for extension in extensions:
            link = "extension_start" if before is self.structs[CallFrame] else "next"
            setattr(before, link, ctypes.addressof(extension))
            before = extension.extension_base

    @property
    def address(self) -> int:
        return ctypes.addressof(self.structs[CallFrame])

    @property
    def version(self) -> tuple[int, int]:
        answer = self.structs[Metadata].api_version
        return answer.major_version, answer.minor_version


@pytest.fixture
def restriction(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[[int], object]:
    """Handler of a restriction, written where a newer JAX is installed."""
    header = tmp_path / "xla/ffi/api/c_api.h"
    header.parent.mkdir(parents=True)
    header.write_text("#define XLA_FFI_API_MAJOR 0\n#define XLA_FFI_API_MINOR 9\n")
    monkeypatch.setattr(jax.ffi, "include_dir", lambda: str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    text = catalogue.text_of(catalogue.KERNELS["restriction"], "float32", 8, 1)
    return first_call._HANDLER(machine_code.address_of("handler", text, lambda: text))


@pytest.fixture
def anew() -> Iterator[None]:
    """The next question for kernels is answered by a trial of its own."""
    processor._fault.cache_clear()
    yield
    processor._fault.cache_clear()


def test_sizes_are_those_of_the_interface() -> None:
    """As XLA of jaxlib 0.10.2 writes them into what it calls handlers with."""
    kinds = CallFrame, Api, Buffers, Buffer, MetadataExtension, Metadata, ApiVersion, Attributes
    assert [struct_size(kind) for kind in kinds] == [168, 192, 40, 48, 32, 36, 24, 48]
    assert frames.offset(CallFrame, "rets", "buffers") == 112
    assert frames.offset(Api, "XLA_FFI_ThreadPool_Schedule") == 136


def test_the_version_is_that_of_the_offsets(restriction: Callable[[int], object]) -> None:
    """Not that of the header that is installed: XLA must know for which structs the code was written."""
    call = Call()
    call.extend(call.structs[MetadataExtension])
    assert restriction(call.address) is None
    assert call.version == frames.VERSION == (0, 3)
    assert np.all(call.coarse == -1)


def test_the_question_may_come_after_other_extensions(restriction: Callable[[int], object]) -> None:
    call = Call()
    call.extend(call.other, call.structs[MetadataExtension])
    restriction(call.address)
    assert call.version == (0, 3)
    assert np.all(call.coarse == -1)
    assert call.behind_other.api_version.minor_version == 0


def test_another_extension_is_no_question(restriction: Callable[[int], object]) -> None:
    call = Call()
    call.extend(call.other)
    restriction(call.address)
    assert call.behind_other.api_version.minor_version == 0
    expected = restrict(jnp.asarray(call.fine), COARSE[2:])
    np.testing.assert_allclose(call.coarse, expected, rtol=1e-6)


def test_frames_as_they_are_known() -> None:
    call = Call()
    assert frames.unknown_size(call.address) == ""
    call.extend(call.other, call.structs[MetadataExtension])
    assert frames.unknown_size(call.address) == ""


@pytest.mark.parametrize("kind", [CallFrame, Api, Attributes, Buffers, Buffer])
@pytest.mark.parametrize("step", [-8, 8])
def test_structs_of_another_size(kind: type[ctypes.Structure], step: int) -> None:
    call = Call()
    frame = call.structs[CallFrame]
    others = {Attributes: frame.attrs, Buffers: frame.rets, Buffer: call.kept[-2]}
    (others | call.structs)[kind].struct_size += step
    assert frames.unknown_size(call.address).startswith(f"{kind.__name__} of XLA has ")


@pytest.mark.parametrize("kind", [MetadataExtension, Metadata, ApiVersion])
def test_questions_of_another_size(kind: type[ctypes.Structure]) -> None:
    call = Call()
    call.extend(call.structs[MetadataExtension])
    structs = {
        MetadataExtension: call.structs[MetadataExtension].extension_base,
        Metadata: call.structs[Metadata],
        ApiVersion: call.structs[Metadata].api_version,
    }
    structs[kind].struct_size += 4
    assert frames.unknown_size(call.address).startswith(f"{kind.__name__} of XLA has ")


def test_kernels_are_used_here(anew: None, caplog: pytest.LogCaptureFixture) -> None:
    assert processor.why_no_kernels() == ""
    assert not caplog.records
    assert _calls_kernels()


@pytest.mark.parametrize("changed", [(CallFrame, "future"), (Metadata, "state_type_id"), (Buffer, "rank")])
def test_another_size_disables_the_kernels(
    changed: tuple[type[ctypes.Structure], str],
    anew: None,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """In XLA's own frames: at the question for the version, and at the call."""
    monkeypatch.setitem(frames._LAST, *changed)
    caplog.set_level("INFO", logger="cranktopo")
    for _ in range(2):
        assert not _calls_kernels()
    (record,) = caplog.records
    assert f"kernels are not used, JAX code computes the same in more time: {changed[0].__name__} of XLA" in (
        record.getMessage()
    )


def test_the_trial_is_shared_out() -> None:
    """It calls XLA's threads as products of large grids do."""
    cases, (nx, ny, nz) = first_call.TRIAL
    assert 3 * cases * (nx + 1) * (ny + 1) * (nz + 1) >= foreign.LEAST_SHARED
    assert nx + 1 >= catalogue.MOST_THREADS


def test_a_wrong_product_disables_the_kernels(
    anew: None, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    other = slab_product.apply_by_slabs
    monkeypatch.setattr(slab_product, "apply_by_slabs", lambda *arrays: 1.0001 * other(*arrays))
    caplog.set_level(logging.INFO)
    assert not processor.kernels_usable()
    assert "a product differs from that of JAX by 0.01 %" in caplog.text


def test_a_product_that_is_not_written() -> None:
    nothing = first_call._HANDLER(_answer_alone)
    address = ctypes.cast(nothing, ctypes.c_void_p).value or 0
    found = first_call.find_fault(address, processor._stiffness_product, slab_product.apply_by_slabs)
    assert found.startswith("a product differs")


@pytest.mark.parametrize("name", ["find_fault", "address"])
def test_a_first_call_that_fails(
    name: str, anew: None, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("no such version\nand more")

    monkeypatch.setattr(*((first_call, "register") if name == "find_fault" else (processor, name)), fail)
    caplog.set_level(logging.INFO)
    assert not _calls_kernels()
    (record,) = caplog.records
    assert "no such version" in record.getMessage()
    assert "\n" not in record.getMessage()


def test_the_note_obeys_quiet(caplog: pytest.LogCaptureFixture) -> None:
    @click.command()
    @verbosity_options
    def command() -> None:
        processor._log.info("note: kernels are not used")

    for arguments, count in (([], 1), (["-q"], 1), ([], 2)):
        assert CliRunner().invoke(command, arguments).exit_code == 0
        assert len(caplog.records) == count


@pytest.mark.slow
def test_switched_off() -> None:
    """The same solve, without kernels."""
    found = []
    for switch in ("", "off"):
        here = os.environ | {catalogue.SWITCH: switch}
        done = subprocess.run(
            [sys.executable, "-c", SOLVE], env=here, capture_output=True, text=True, check=True
        )
        assert done.stderr == ""
        found.append(json.loads(done.stdout))
    assert [one["usable"] for one in found] == [True, False]
    assert found[0]["work"] == pytest.approx(found[1]["work"], rel=1e-8)


def test_doctor_tells_of_the_switch(monkeypatch: pytest.MonkeyPatch) -> None:
    assert doctor._jax_device().value.endswith(", own kernels")
    monkeypatch.setenv("CRANKTOPO_KERNELS", "off")
    assert doctor._jax_device().value.endswith(", no own kernels: switched off by CRANKTOPO_KERNELS=off")


def _calls_kernels() -> bool:
    """Whether a product that is traced now is a kernel's."""
    operands = first_call._operands()
    return "ffi_call" in str(jax.make_jaxpr(lambda *arrays: operator.apply_stiffness(*arrays))(*operands))


def _answer_alone(address: int) -> None:
    """What a handler does that computes nothing."""
    extension = CallFrame.from_address(address).extension_start
    if extension:
        metadata = Metadata.from_address(MetadataExtension.from_address(extension).metadata)
        metadata.api_version.major_version, metadata.api_version.minor_version = frames.VERSION
