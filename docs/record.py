"""Run benchmarks again and put their tables into the pages, with date and machine.

    python docs/record.py effects_cost die_cost

A page holds a table between `<!-- benchmark: NAME ARGUMENTS -->` and `<!-- end -->`; every block of a named
benchmark is written anew from what `python -m tests.benchmarks.NAME ARGUMENTS` prints.
"""

from __future__ import annotations

import datetime
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = ROOT / "docs" / "pages"
BLOCK = re.compile(r"(?s)<!-- benchmark: (?P<command>[^\n]*?) -->\n.*?<!-- end -->")


def machine() -> str:
    """Cores and processor of this machine."""
    info = Path("/proc/cpuinfo")
    text = info.read_text(encoding="utf-8") if info.is_file() else ""
    found = re.search(r"model name\s*: (.*)", text)
    return f"{os.cpu_count()} cores of {found[1] if found else platform.processor() or platform.machine()}"


def measured(command: str) -> str:
    """The block of a benchmark: heading and the tables that it prints."""
    name, *arguments = command.split()
    run = [sys.executable, "-m", f"tests.benchmarks.{name}", *arguments]
    done = subprocess.run(run, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    table = "\n".join(line for line in done.stdout.splitlines() if line.startswith("|"))
    today = datetime.date.today().isoformat()
    heading = f"Measured {today}, {machine()}: `python -m tests.benchmarks.{command}`"
    return f"<!-- benchmark: {command} -->\n{heading}\n\n{table}\n<!-- end -->"


def main(names: list[str]) -> None:
    """Measure the named benchmarks, or list those that pages show."""
    for page in sorted(PAGES.rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        for block in BLOCK.finditer(text):
            if not names:
                print(f"{page.name}: {block['command']}")
            elif block["command"].split()[0] in names:
                text = text.replace(block[0], measured(block["command"]))
                page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
