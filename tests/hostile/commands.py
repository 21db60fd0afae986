"""Hostile command lines, and the files around them."""

from __future__ import annotations

import json
import os
import random
from dataclasses import dataclass, field
from pathlib import Path

from cranktopo.design.loading import load_scene
from cranktopo.runs.manifest import new_manifest
from tests.hostile.scenes import hostile_text

DESIGN = "x.toml"
PLAIN = ("plan", "loads", "plan", "loads", "optimise", "evaluate", "shaft", "fatigue", "iterate")
MORE = (
    "balance", "film", "rod", "bolts", "balancer", "vibration", "modes", "drawing", "export", "shape",
    "bound", "designs copy",
)  # fmt: skip
"""Further commands of a design; those of `WITH_FILE` write one."""
WITH_FILE = {"drawing": "y.svg", "export": "y.stl", "designs copy": "y.toml"}
OPTIONS = {
    "--volume-fraction": ("optimise", "iterate"),
    "--resolution-mm": ("optimise", "iterate"),
    "--element-size-mm": ("evaluate", "shaft", "iterate"),
    "--accuracy": ("optimise", "evaluate"),
    "--budget": ("optimise", "evaluate"),
    "--speed": ("loads",),
    "--max-iterations": ("optimise",),
    "--steps": ("iterate",),
    "--process": ("optimise", "iterate"),
    "--cell-mm": ("iterate",),
    "--draft-deg": ("iterate",),
    "--min-radius-mm": ("iterate",),
    "--fillet-fraction": ("fatigue",),
    "--method": ("fatigue",),
    "--resume": ("optimise", "iterate"),
    "--out": ("optimise", "iterate", "fatigue"),
    "--csv": ("loads",),
    "--minimise": ("optimise", "plan"),
    "--maximise": ("optimise", "plan"),
    "--limit": ("optimise", "plan"),
    "--design": ("evaluate",),
    "--bearings": ("shaft",),
}
WORDS = (
    "nan", "inf", "-inf", "-1", "0", "", " ", "1e400", "1e-400", "3", "0.3", "1%", "5min", "٣", "0x10", "1,5",
    "x" * 5000, "9" * 5000, "x.toml", ".", "..", "/dev/zero", "/dev/null/x", "missing/x", "a\nb", "a\tb", "é",
    "--json", "--", "-h", "100:200:0", "1:2:3:4", "0:1e308:1", "free", "lsa", "x.step", "runs", "p.csv", "~",
    "\udcff", "%s", "{0}", "1:2", "nan:nan:nan", "run", "run/manifest.json",
    "mass", "torsion", "torsion >= 100 %", "mass <= 3 kg", "twist <= nan deg", "bending none", "mass=1",
)  # fmt: skip
CELLS = (
    "0", "100", "1,5", '"7', "nan", "1e300", "", "x", "360;1", "-1", " 3 ", "٣", "1_0", "'", '""', "\x00",
)  # fmt: skip
HEADERS = ("crank_angle_deg,pressure_bar", "angle_deg;p_MPa", "a,b", "", '"crank deg","p bar', "deg\tbar")


@dataclass(frozen=True)
class Case:
    """A command line and the files it finds: content, or what stands in the file's place."""

    arguments: list[str]
    files: dict[str, bytes | str] = field(default_factory=dict)

    def lay_out(self, folder: Path) -> None:
        for name, content in self.files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            if isinstance(content, bytes):
                path.write_bytes(content)
            else:
                {
                    "folder": path.mkdir,
                    "pipe": lambda path=path: os.mkfifo(path),
                    "loop": lambda path=path: path.symlink_to(path.name),
                    "device": lambda path=path: path.symlink_to("/dev/zero"),
                    "locked": lambda path=path: path.touch(mode=0),
                }[content]()


def case(seed: int) -> Case:
    """The case of a seed."""
    r = random.Random(seed)
    kind = r.choices([_scene, _option, _file, _csv, _run, _words], [10, 4, 1, 2, 4, 1])[0]
    return kind(r)


def _scene(r: random.Random) -> Case:
    command = r.choice(PLAIN if r.random() < 0.4 else MORE)
    extra = ["--resolution-mm", "4.4"] if command == "optimise" else []
    extra += [WITH_FILE[command]] if command in WITH_FILE else []
    json_flag = ["--json"] if r.random() < 0.3 and command not in WITH_FILE else []
    return Case([*command.split(), DESIGN, *extra, *json_flag], {DESIGN: hostile_text(r)})


def _option(r: random.Random) -> Case:
    option = r.choice(list(OPTIONS))
    command = r.choice(OPTIONS[option])
    value = r.choice(WORDS)
    words = [f"{option}={value}"] if r.random() < 0.3 else [option, value]
    return Case([command, *r.sample([["opposed-piston"], words], 2)[0], *words])


def _file(r: random.Random) -> Case:
    content = r.choice(
        ["folder", "pipe", "loop", "device", "locked", b"\0" * 99, b"ISO-10303-21;", b"solid x\n"]
    )
    name = r.choice([DESIGN, "x.step", "x.stl", "x", "x.png"])
    command = r.choice([*PLAIN, "designs copy", "export", "compare"]).split()
    more = {"designs": ["y.toml"], "export": ["y.step"], "compare": ["--baseline", "mikron-iiic-plain"]}
    design = ["--design", "mikron-iiic-plain"] if command == ["evaluate"] else []
    return Case([*command, name, *more.get(command[0], design)], {name: content})


def _csv(r: random.Random) -> Case:
    engine = "[engine.gas]\nindicator_csv = 'p.csv'\n"
    text = _mikron()
    head, tail = text.split("[engine.gas]")[0], text[text.index("[engine.masses]") :]
    mark = r.choice([",", ";", "\t", " "])
    rows = [f"{angle}{mark}{20 if angle == 10 else 1}.5" for angle in range(0, 720, 2)]
    for _ in range(r.randint(0, 4)):
        rows[r.randrange(len(rows))] = mark.join(r.choice(CELLS) for _ in range(r.randint(0, 4)))
    header = r.choice(HEADERS).replace(",", mark) if r.random() < 0.7 else HEADERS[0]
    content = "\n".join([header, *rows]).encode()
    if r.random() < 0.2:
        content = r.choice([content[:700], b"\xff\xfe" + content, content * 3, b"", r.randbytes(300)])
    place: bytes | str = r.choice(["pipe", "device", "folder"]) if r.random() < 0.1 else content
    return Case(
        [r.choice(["loads", "plan"]), DESIGN], {DESIGN: (head + engine + tail).encode(), "p.csv": place}
    )


def _run(r: random.Random) -> Case:
    """Run directories with a damaged manifest, result or checkpoint."""
    scene = load_scene("mikron-iiic-plain")
    manifest = new_manifest(
        run="run",
        design=scene.name,
        command=["cranktopo", "optimise"],
        scene=scene.model_dump(mode="json"),
        options=r.choice([{}, {"iterate": {}}, {"iterate": {"steps": 3}}]),
        inputs={},
    ).as_json()
    for _ in range(r.randint(0, 2)):
        key = r.choice(list(manifest))
        manifest[key] = r.choice([None, 1, "x", [], {}, [1], {"a": 1}, True, "running", "../x", "x" * 500])
        if r.random() < 0.2:
            del manifest[key]
    files: dict[str, bytes | str] = {"run/manifest.json": _damaged(r, json.dumps(manifest).encode())}
    for name in (
        "metrics.json",
        "iterate.json",
        "history.csv",
        "checkpoint/state.npz",
        "web.stl",
        "design.toml",
    ):
        if r.random() < 0.4:
            files[f"run/{name}"] = r.choice(
                [b"", b"{}", b"[]", b"{", b"PK\x03\x04x", b"a,b\n1\n", b"\xff", "device"]
            )
    command = r.choice(
        ["runs show", "runs list --root .", "runs clean --root .", "report", "extract", "remodel", "evaluate",
         "optimise --resume", "iterate --resume", "compare mikron-iiic-plain --baseline", "export", "plan"]
    )  # fmt: skip
    named = [] if "--root" in command else ["run"]
    return Case([*command.split(), *named, *(["y.stl"] if command == "export" else [])], files)


def _words(r: random.Random) -> Case:
    commands = (*PLAIN, "runs", "designs", "export", "report", "extract", "completion", "doctr", "--version")
    return Case([r.choice(commands), *(r.choice(WORDS) for _ in range(r.randint(0, 4)))])


def _damaged(r: random.Random, content: bytes) -> bytes:
    kind = r.random()
    if kind < 0.6:
        return content
    if kind < 0.7:
        return content[: r.randrange(len(content))]
    if kind < 0.8:
        return r.choice(
            [b"", b"null", b"[]", b"\0\0", b"[" * 100_000, b'{"a": NaN}', b'{"a": ' + b"9" * 5000 + b"}"]
        )
    changed = bytearray(content)
    for _ in range(3):
        changed[r.randrange(len(changed))] = r.randrange(256)
    return bytes(changed)


def _mikron() -> str:
    from tests.hostile.scenes import VALID

    return VALID["mikron-iiic-plain"]
