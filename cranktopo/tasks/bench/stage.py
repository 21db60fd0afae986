"""The bench from its start to Ctrl-C: what is put on it, the server, its end."""

from __future__ import annotations

import asyncio
import shlex
import signal
from collections.abc import Callable
from functools import partial
from pathlib import Path

from cranktopo.base.child import in_child
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import design_text, load_scene, resolve_design
from cranktopo.design.writing import toml_text
from cranktopo.tasks.bench.access import Password
from cranktopo.tasks.bench.design_files import changed_files
from cranktopo.tasks.bench.forms import BODIES, read_upload
from cranktopo.tasks.bench.server import HOST, Server
from cranktopo.tasks.bench.session import Bench
from cranktopo.tasks.designs.run_webs import parametric_scene, web_target


def run_bench(
    folder: Path,
    target: str | None,
    port: int,
    ready: Callable[[str], None],
    host: str = HOST,
    password: Password | None = None,
) -> None:
    """Serve a bench on 127.0.0.1, or on another address with a password, until Ctrl-C.

    Args:
        folder: where designs are read and files are written; nothing outside it is.
        target: what is put on the bench: a design, a run, or a crank from CAD.
        port: 0 takes a free one.
        ready: called with the address of the page.

    Raises:
        CranktopoError: no such target, or a port that is taken.
    """
    begin = _beginning(target) if target else None
    server = partial(Server, port=port, host=host, password=password)
    asyncio.run(_serve(folder, target or "", begin, server, ready))


async def _serve(
    folder: Path,
    target: str,
    begin: tuple[str, str] | None,
    serving: Callable[[Bench], Server],
    ready: Callable[[str], None],
) -> None:
    server = serving(Bench(folder))
    ended = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, ended.set)
    try:
        if begin is not None:
            line = shlex.join(["cranktopo", "bench", target])
            server.bench.open_text(*begin, what=f"opened {target}", command=line)
        ready(server.address)
        await ended.wait()
    finally:
        server.close()


def _beginning(target: str) -> tuple[str, str]:
    """Return the text of what is put on the bench, and a file name for it."""
    path = Path(target)
    if path.suffix.lower() in BODIES:
        text, source = in_child(f"'{target}'", read_upload, path)
        assert text is not None
        return text, source
    try:
        design = resolve_design(target)
    except CranktopoError as error:
        return _of_run(target, error)
    load_scene(target, whole=True)
    return changed_files(design_text(target), design.resolve().parent), design.name


def _of_run(target: str, refused: CranktopoError) -> tuple[str, str]:
    if not refused.message.endswith("is a run, not a design."):
        raise refused
    scene = parametric_scene(target, web_target(target))
    return toml_text(scene, f"{scene.name}, the web of {target}"), f"{scene.name}.toml"
