"""Ways into another user's account, tried by a second user: a sweep's scheduler, and compiled programs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import pytest

from cranktopo import sweep
from tests import sweep_cases
from tests.sweep_cases import WIDTH

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() != 0, reason="needs root to be two users"),
]
OTHER = 65534
# Python itself may lie in a folder that the other user cannot read, so all is loaded before he is he.
BECOME = f"""
import json, os, sys
def become():
    os.setgroups([])
    os.setresgid({OTHER}, {OTHER}, {OTHER})
    os.setresuid({OTHER}, {OTHER}, {OTHER})
"""
INTRUDER = (
    BECOME
    + """
import distributed
from distributed import Client, LocalCluster, Security
with LocalCluster(n_workers=1, processes=False, dashboard_address=":0") as own, Client(own) as client:
    assert client.submit(os.getuid).result() == 0  # loads what a client loads late
trusted = [None, Security.temporary()]
become()
found = []
for line in sys.stdin:
    for protocol in ("tcp", "tls"):
        for security in trusted:
            try:
                with Client(f"{protocol}://{line.strip()}", timeout=3, security=security) as client:
                    found.append([protocol, client.run_on_scheduler(os.getuid)])
            except Exception as error:
                found.append([protocol, type(error).__name__])
    print(json.dumps(found), flush=True)
    break
for folder, _, names in os.walk(sys.argv[1]):
    for name in names:
        try:
            if b"PRIVATE KEY" in open(os.path.join(folder, name), "rb").read():
                print(name)
        except OSError:
            pass
"""
)


def intrusion(place: str, readable: Path) -> tuple[list[Any], str]:
    """What the other user reaches at an address, and the private keys that he can read below a folder."""
    done = subprocess.run(
        [sys.executable, "-c", INTRUDER, str(readable)],
        input=place,
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    reached, _, keys = done.stdout.partition("\n")
    return json.loads(reached), keys


def opened(folder: Path) -> None:
    """Let the other user reach a folder that pytest makes for one alone."""
    for one in (folder, *folder.parents[:2]):
        one.chmod(0o755)


def address(cluster: Any) -> str:
    return str(cluster.scheduler_address).partition("://")[2]


def test_the_intruder_can_do_what_he_tries(tmp_path: Path) -> None:
    """A scheduler without credentials runs his code as the user who started it."""
    import distributed

    opened(tmp_path)
    (tmp_path / "left.pem").write_text("PRIVATE KEY")
    with distributed.LocalCluster(n_workers=1, dashboard_address=":0") as cluster:
        reached, keys = intrusion(address(cluster), tmp_path)
    assert ["tcp", 0] in reached
    assert keys == "left.pem\n"


def test_a_sweep_runs_no_code_of_another_user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import distributed

    usual, reached = distributed.LocalCluster, list[Any]()

    def watched(**settings: Any) -> Any:
        cluster = usual(**settings)
        found, keys = intrusion(address(cluster), tmp_path)
        reached.extend(found)
        assert keys == ""
        return cluster

    opened(tmp_path)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr("distributed.LocalCluster", watched)
    frame = sweep(vary={WIDTH: [50, 51]}, workers=1, out=tmp_path / "out", function=sweep_cases.empty)
    assert frame["status"].tolist() == ["done"] * 2
    assert len(reached) == 4
    assert all(isinstance(answer, str) for _, answer in reached), reached


PLANTED = "cranktopo", "cranktopo-0", "cranktopo-root", "cranktopo-code", ".cache"
PLANT = (
    BECOME
    + """
become()
for name in sys.argv[2:]:
    for inner in ("", "cranktopo", "code", "kernels", "programs"):
        folder = os.path.join(sys.argv[1], name, inner)
        os.makedirs(folder, mode=0o700, exist_ok=True)
"""
)
VICTIM = """
import json, os, sys
shared, seen = sys.argv[1], []
def heard(event, arguments):
    if event in ("open", "ctypes.dlopen", "os.listdir") and str(arguments[0]).startswith(shared):
        seen.append(str(arguments[0]))
sys.addaudithook(heard)
import jax.numpy as jnp
from cranktopo.base.machine import private_cache
from cranktopo.numerics.kernels.registry import why_no_kernels
from cranktopo.numerics.precision import cache_folder, double_precision
fault = why_no_kernels()
with double_precision():
    jnp.ones(3).sum().block_until_ready()
print(json.dumps([fault, str(private_cache("code")), str(cache_folder()), seen]))
"""


@pytest.mark.parametrize("given", ["nothing", "TMPDIR", "XDG_CACHE_HOME", "HOME"])
def test_no_program_of_another_user_is_loaded(given: str, tmp_path: Path) -> None:
    """Folders of every name that were made first, by the other user, in a folder that all may write."""
    shared = tmp_path / "shared"
    shared.mkdir()
    shared.chmod(0o1777)
    opened(tmp_path)
    subprocess.run([sys.executable, "-c", PLANT, str(shared), *PLANTED], check=True)
    assert (shared / "cranktopo" / "code").stat().st_uid == OTHER
    own = {name: value for name, value in os.environ.items() if name not in ("HOME", "XDG_CACHE_HOME")}
    named = {"HOME": "/nowhere"} | ({} if given == "nothing" else {given: str(shared)})
    done = subprocess.run(
        [sys.executable, "-c", VICTIM, str(shared)],
        env={**own, **named, "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    fault, code, programs, seen = json.loads(done.stdout.splitlines()[-1])
    assert fault == ""
    planted = [path for path in seen if any(f"/{name}" in path for name in PLANTED)]
    assert (planted, str(shared) in code, str(shared) in programs) == ([], False, False)
