"""Lines that each part beside the crank needed: `python -m tests.studies.part_lines`, a table in Markdown."""

from __future__ import annotations

from pathlib import Path

import cranktopo

PARTS = {
    "rod": (
        "design/rod*.py",
        "design/checks/rod.py",
        "bodies/solid/rod.py",
        "bodies/mesh/rod_mesh.py",
        "engine/rod_forces.py",
        "engine/rod_split.py",
        "numerics/tetrahedra/surface_loads.py",
        "tasks/rod/*.py",
    ),
    "bolts": ("design/bolt.py", "design/checks/bolts.py", "tasks/bolts/*.py"),
    "balancer": (
        "design/balancer.py",
        "design/checks/balancer.py",
        "bodies/solid/balancer.py",
        "tasks/balancer/*.py",
    ),
}
"""Files of each part below the package; what they share, such as `numerics/stepped_beam.py` with the
crank on its bearings, is not theirs."""


def counted(part: str) -> tuple[int, int, int]:
    """Files of a part, their lines, and those with code."""
    folder = Path(cranktopo.__file__).parent
    files = [file for pattern in PARTS[part] for file in sorted(folder.glob(pattern))]
    lines = [line.strip() for file in files for line in file.read_text(encoding="utf-8").splitlines()]
    return len(files), len(lines), sum(bool(line) and not line.startswith("#") for line in lines)


def main() -> None:
    """Print the table."""
    print("| part | files | lines | without blank lines and comments |\n|---|---:|---:|---:|")
    for part in PARTS:
        print("| " + " | ".join(map(str, (part, *counted(part)))) + " |")


if __name__ == "__main__":
    main()
