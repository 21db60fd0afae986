"""Every command with too little address space, or on a disk of a few kilobytes: a line and an exit code.

Never an internal error, a signal, or 30 s of work without a line.
`python -m tests.hostile.test_little_memory_or_disk TRIES [COMMAND...]` prints the counts by exit code.
"""

from __future__ import annotations

import os
import random
import resource
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.hostile.test_kills_of_commands import COMMANDS, prepared
from tests.hostile.watched import watched

ADDRESSES_MB = 700, 2500
DISK_KB = 16, 4000
TRIES = 100
_MAY_END = {0, 3, 4, 5, 6, 7}
_TELLS_ON_STDOUT = {"doctor"}
"""Commands whose answer is what is missing: their table has it."""


def attempt(name: str, folder: Path, limit: Callable[[], None] | None) -> tuple[int, list[str]]:
    """Exit code of a command, and what is wrong."""
    ended = watched(COMMANDS[name], folder, limit)
    faults = [ended.fault] if ended.fault else []
    if ended.code not in _MAY_END and not faults:
        faults.append(f"exit code {ended.code}")
    faults += ["Traceback"] if "Traceback" in ended.told else []
    silent = ended.code not in (0, 5, 6) and not ended.told and name not in _TELLS_ON_STDOUT
    faults += ["says nothing"] if silent else []
    return ended.code, [f"{fault}: {ended.told[-600:]}" for fault in faults]


@contextmanager
def disk(kilobytes: int, source: Path, parent: Path) -> Iterator[Path]:
    """A disk of so many kilobytes, in memory, with what commands take; needs root."""
    folder = parent / "disk"
    folder.mkdir(exist_ok=True)
    size = f"size={kilobytes}k"
    subprocess.run(["mount", "-t", "tmpfs", "-o", size, "tmpfs", str(folder)], check=True)
    try:
        for name in ("run", "body.step"):
            (folder / name).symlink_to(source / name)
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def campaign(
    names: list[str], tries: int, folder: Path, draw: random.Random
) -> tuple[list[str], Counter[int]]:
    """Faults, and number of tries by exit code; every second one has a small disk, where one can be made."""
    prepared(folder)
    faults, codes = list[str](), Counter[int]()
    for number in range(tries):
        name = names[number % len(names)]
        if os.getuid() == 0 and (number // len(names)) % 2:
            kilobytes = round(DISK_KB[0] * (DISK_KB[1] / DISK_KB[0]) ** draw.random())
            what = f"{name} on {kilobytes} kB"
            with disk(kilobytes, folder, folder) as place:
                code, found = attempt(name, place, None)
        else:
            most = draw.randint(*ADDRESSES_MB) * 1_000_000
            what = f"{name} with {most / 1e6:.0f} MB"
            with tempfile.TemporaryDirectory(dir=folder) as own:
                for one in ("run", "body.step"):
                    (Path(own) / one).symlink_to(folder / one)
                code, found = attempt(name, Path(own), limited(most))
        codes[code] += 1
        faults += [f"{what}: {fault}" for fault in found]
        print(what, code, *found, flush=True)
    return faults, codes


def limited(most: int) -> Callable[[], None]:
    """What limits a process that is about to begin to so many bytes of addresses."""
    return lambda: resource.setrlimit(resource.RLIMIT_AS, (most, most))


@pytest.mark.slow
def test_a_hundred_tries(tmp_path: Path) -> None:
    faults, codes = campaign(list(COMMANDS), TRIES, tmp_path, random.Random(7))
    assert not faults, "\n".join(faults)
    assert codes.total() == TRIES


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as where:
        told, by_code = campaign(
            sys.argv[2:] or list(COMMANDS), int(sys.argv[1]), Path(where), random.Random(7)
        )
    print("\n".join(told))
    print(f"{by_code.total()} tries, {len(told)} faults; by exit code: {dict(sorted(by_code.items()))}")
