"""Every built-in design through every command at its defaults: a result, or a line that says why not.

Never an internal error, a solver failure, a signal, or 30 s of work without a line. Commands that take a run
get that of `optimise`. `python -m tests.hostile.test_every_design_by_every_command [DESIGN|COMMAND|GROUP...]`
prints a table; words choose designs, commands, or one of the groups `cheap`, `run` and `dear`.
"""

from __future__ import annotations

import re
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from cranktopo.base.errors import ExitCode
from cranktopo.design.loading import builtin_designs
from tests.every_command import every_command
from tests.hostile.watched import ENVIRONMENT, Ended, watched

DESIGNS = tuple(builtin_designs())
D, RUN = "DESIGN", "run"
CHEAP: dict[str, list[str]] = {
    "designs copy": ["designs", "copy", D, "copy.toml", "--force"],
    "plan": ["plan", D],
    "loads": ["loads", D],
    "balance": ["balance", D],
    "film": ["film", D],
    "bolts": ["bolts", D],
    "rod": ["rod", D],
    "balancer": ["balancer", D],
    "drawing": ["drawing", D, "crank.pdf", "--force"],
    "export": ["export", D, "throw.step", "--force"],
    "import": ["import", "throw.step", "--out", "imported"],
    "evaluate": ["evaluate", D],
    "vibration": ["vibration", D],
    "modes": ["modes", D],
    "shaft": ["shaft", D],
    "fatigue": ["fatigue", D],
}
OF_A_RUN: dict[str, list[str]] = {
    "optimise": ["optimise", D, "--out", RUN],
    "extract": ["extract", RUN, "--out", "extracted.stl", "--force"],
    "evaluate RUN": ["evaluate", RUN],
    "report": ["report", RUN],
    "compare": ["compare", RUN, "--baseline", D],
    "runs list": ["runs", "list", "--root", "."],
    "runs show": ["runs", "show", RUN],
}
DEAR: dict[str, list[str]] = {
    "remodel": ["remodel", RUN],
    "bound": ["bound", D],
    "accuracy": ["accuracy", D, "--out", "accuracy"],
    "sweep": ["sweep", D, "--vary", "material.E_GPa=200,210", "--out", "sweep"],
    "shape": ["shape", D, "--out", "shape"],
    "iterate": ["iterate", D, "--out", "iterate"],
}
GROUPS = {"cheap": CHEAP, "run": OF_A_RUN, "dear": DEAR}
COMMANDS = CHEAP | OF_A_RUN | DEAR
APART = {
    "bench",
    "completion",
    "designs list",
    "designs new",
    "designs pair",
    "designs sketch",
    "doctor",
    "runs clean",
}
"""Commands without a design or a run; the bench, which serves until it is ended; a pair needs two webs."""
LEFT = {
    "import": "throw.step",
    "runs show": RUN,
    "extract": f"{RUN}/checkpoint",
    **dict.fromkeys(["report", "remodel"], f"{RUN}/metrics.json"),
    **dict.fromkeys(["evaluate RUN", "compare"], f"{RUN}/web.stl"),
}
"""What must be there: a command whose own input another one refused is left out."""
ENDLESS_S = {"cheap": 900.0, "run": 1800.0, "dear": 7200.0}
REFUSED = {
    "balance": "engine = None: must be given",
    "vibration": r"\[engine\] is missing|engine\.gas: is missing",
    "modes": r"\[engine\] is missing",
    "shaft": r"\[engine\] is missing",
    "fatigue": "engine: is missing",
    "film": r"\[bearings\] is missing",
    "bolts": "has no bolted joint",
    "rod": r"\[rod\] is missing",
    "balancer": r"\[balancer\] is missing",
    **dict.fromkeys(["optimise", "bound", "shape", "iterate"], "envelope = None: an? .*optimisation needs"),
}
"""Why a command may refuse a design by exit code 3: what the last line says."""


@dataclass(frozen=True)
class Row:
    """One command on one design."""

    design: str
    command: str
    ended: Ended

    @property
    def fault(self) -> str:
        """What is wrong; empty where it behaved."""
        code, told = self.ended.code, self.ended.told
        if self.ended.fault:
            return self.ended.fault
        if "Traceback" in told:
            return "shows a traceback"
        if code == ExitCode.INVALID_INPUT:
            reason = REFUSED.get(self.command)
            return "" if reason and re.search(reason, self.ended.last_line) else "refused without a reason"
        return "" if code in (0, 5, 6) else f"exit code {code}"

    def __str__(self) -> str:
        lost = (line for line in self.ended.told.splitlines() if " was lost" in line)
        told = next(lost, self.ended.last_line)[:300] if self.ended.code or self.fault else ""
        cells = self.design, self.command, str(self.ended.code), f"{self.ended.seconds:.0f}", told, self.fault
        return f"| {' | '.join(cells)} |"


def rows(
    design: str, names: Sequence[str], folder: Path, more: Mapping[str, Sequence[str]] | None = None
) -> Iterator[Row]:
    """Run the commands on a design in a folder, one after the other.

    Args:
        more: options of some commands, by name.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        needed = LEFT.get(name)
        if needed and not (folder / needed).exists():
            continue
        words = [design if word == D else word for word in COMMANDS[name]]
        words += (more or {}).get(name, ())
        group = next(group for group, commands in GROUPS.items() if name in commands)
        yield Row(design, name, watched(words, folder, endless_s=ENDLESS_S[group]))


def chosen(words: list[str]) -> tuple[list[str], list[str]]:
    """Return the designs and the commands that words choose, all where they choose none."""
    known = {*DESIGNS, *COMMANDS, *GROUPS}
    unknown = [word for word in words if word not in known]
    if unknown:
        sys.exit(f"neither design nor command: {', '.join(unknown)}")
    designs = [name for name in DESIGNS if name in words]
    groups = [name for group, names in GROUPS.items() if group in words for name in names]
    commands = [name for name in COMMANDS if name in words or name in groups]
    if any(name in LEFT and LEFT[name].startswith(RUN) for name in commands) and "optimise" not in commands:
        commands = ["optimise", *commands]
    return designs or list(DESIGNS), commands or list(COMMANDS)


def test_every_command_is_tried() -> None:
    tried = {" ".join(words[: len(name.split())]) for name in every_command() for words in COMMANDS.values()}
    assert set(every_command()) - tried == APART


@pytest.mark.slow
@pytest.mark.parametrize("design", DESIGNS)
def test_a_design_by_every_cheap_command(design: str, tmp_path: Path) -> None:
    told = list(rows(design, [*CHEAP, *OF_A_RUN], tmp_path))
    assert not [str(row) for row in told if row.fault]


if __name__ == "__main__":
    chosen_designs, chosen_commands = chosen(sys.argv[1:])
    found = list[Row]()
    print("| design | command | exit code | s | last line | fault |\n|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as where:
        ENVIRONMENT["XDG_CACHE_HOME"] = str(Path(where) / "cache")  # `accuracy` keeps its studies there
        for one in chosen_designs:
            for row in rows(one, chosen_commands, Path(where) / one):
                print(row, flush=True)
                found.append(row)
    print(f"{len(found)} tries, {sum(bool(row.fault) for row in found)} faults")
