"""Files of a session for other processes and users: designs, commands that write, the steps as a script."""

from __future__ import annotations

import shlex
from pathlib import Path

from cranktopo.base.files import write_text
from cranktopo.design.loading import load_scene
from cranktopo.tasks.bench.design_files import changed_files
from cranktopo.tasks.bench.project import Project
from cranktopo.tasks.bench.writes import Written

SCRIPT_ENDING = "-steps.py"
_SCRIPT = """\
\"\"\"A session of the bench, step by step: mass and both stiffnesses of each, the last as STEP.\"\"\"

from cranktopo import Target, evaluate_target, export_solid, load_scene

STEPS = {{
{steps}
}}

for file, what in STEPS.items():
    scene = load_scene(file)
    found = evaluate_target(Target(what, scene))
    torsion, bending = found.torsion_Nm_per_rad / 1e3, found.bending_N_per_mm / 1e3
    print(f"{{what}}: {{found.throw_kg:.4g}} kg, {{torsion:.4g}} kN m/rad, {{bending:.4g}} kN/mm")
export_solid(scene, "throw", {step_file})
"""


def portable(project: Project, text: str, name: str) -> Path:
    """Return a file with a design that is valid, its files by absolute names: for another process."""
    path = project.place / "written" / f"{name}.toml"
    path.parent.mkdir(exist_ok=True)
    write_text(path, changed_files(text, project.folder))
    load_scene(path, whole=True)
    return path


def write_lines(project: Project, kind: Written, path: Path) -> tuple[list[str], str]:
    """Return the command that writes a file here, and the one that a user would type."""
    name, original = project.name, f"{project.name}-original"
    if kind.compares:
        original = str(portable(project, project.text_of(project.original), original))
    words = kind.line(str(portable(project, project.text, name)), original, str(path))
    files = project.runnable(project.at), project.runnable(project.original)
    command = shlex.join(["cranktopo", *kind.line(*files, path.name)])
    return words, command + (f" > {path.name}" if kind.printed else "")


def session_script(project: Project) -> str:
    """Return a Python script that repeats a session as far as the step in hand."""
    done = enumerate(project.as_steps(-1, project.at))
    steps = {project.runnable(number): step.what for number, step in done}
    lines = "\n".join(f"    {file!a}: {what!a}," for file, what in steps.items())
    return _SCRIPT.format(steps=lines, step_file=ascii(f"{project.name}-steps.step"))
