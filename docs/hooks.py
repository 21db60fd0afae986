"""What pages do not hold as text: references made of the code, pictures of designs, equations as MathML."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from results import result_tables, schema_files

import cranktopo
from cranktopo.app.main import COMMANDS, cli
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.design.material import material_library
from cranktopo.design.reference import SKETCHES, KeyReference, TableReference, scene_reference
from cranktopo.design.shaft import bearing_library

ROOT = Path(__file__).resolve().parents[1]
PAGES = ROOT / "docs" / "pages"
PICTURES = ("designs/mikron-iiic.png",)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pictures that are kept beside the designs, and the JSON schemas of results."""
    for path in PICTURES:
        picture = File.generated(config, f"images/{Path(path).name}", abs_src_path=str(ROOT / path))
        files.append(picture)
    for path, text in schema_files():
        files.append(File.generated(config, path, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Fill in `<!-- generated: NAME -->`; set `$...$` and `$$...$$` aside, which Markdown must not touch."""
    page.meta["equations"] = []
    parts = re.split(r"(?ms)(^```.*?^```$|`[^`\n]+`)", markdown)
    found = "".join(
        part if part.startswith("`") else _set_aside(part, page.meta["equations"]) for part in parts
    )
    return re.sub(r"<!-- generated: (\w+) -->", lambda name: GENERATED[name[1]](), found)


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Put the equations back as MathML, which browsers show by themselves."""
    return re.sub(r"@@equation-(\d+)@@", lambda number: page.meta["equations"][int(number[1])], html)


def _set_aside(text: str, equations: list[str]) -> str:
    def kept(found: re.Match[str]) -> str:
        equations.append(convert(found[2], display="block" if found[1] == "$$" else "inline"))
        return f"@@equation-{len(equations) - 1}@@"

    return re.sub(r"(?s)(\$\$?)([^$]+)\1", kept, text)


def scene_tables() -> str:
    """Every table of a scene with its keys."""
    return "\n\n".join(_scene_table(table) for table in scene_reference())


def _scene_table(table: TableReference) -> str:
    name = f"[[{table.path}]]" if table.repeated else f"[{table.path}]"
    if table.choice:
        first = table.keys[0]
        return f"**{first.name} = {first.kind}**: {_line(table.meaning)}\n\n{_key_rows(table.keys)}"
    anchor = table.path.replace(".", "-") or "top"
    heading = f"## `{name}` {{#{anchor}}}" if table.path else f"## The top of the file {{#{anchor}}}"
    needed = "Required." if table.required else "Optional."
    part = SKETCHES.get(table.path)
    sketch = f"![The keys of `{name}` on a throw](images/sketches/{part}.svg)" if part else ""
    return "\n\n".join(filter(None, (heading, f"{table.meaning} {needed}", sketch, _key_rows(table.keys))))


def _key_rows(keys: tuple[KeyReference, ...]) -> str:
    if not keys:
        return ""
    head = "| key | meaning | unit | value | default |\n|---|---|---|---|---|"
    return "\n".join([head, *(_key_row(key) for key in keys)])


def _key_row(key: KeyReference) -> str:
    value = " ".join(filter(None, (key.kind, key.allowed)))
    if key.unless:
        default = f"required unless {key.unless}"
    elif key.required:
        default = "required"
    else:
        default = "none" if key.default in (None, "", []) else f"`{key.default}`"
    return f"| `{key.name}` | {_line(key.meaning)} | {key.unit} | {_line(value)} | {default} |"


def _line(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def command_pages() -> str:
    """Every command with its arguments and options."""
    context = click.Context(cli, info_name="cranktopo")
    return "\n\n".join(
        part for name in COMMANDS for part in _command(cli.get_command(context, name), context, name, 2)
    )


def _command(command: click.Command | None, parent: click.Context, name: str, level: int) -> Iterator[str]:
    assert command is not None
    context = click.Context(command, info_name=name, parent=parent)
    usage = " ".join(command.collect_usage_pieces(context))
    text, _, example = (command.help or "").partition("Example: ")
    yield f"{'#' * level} {context.command_path}"
    yield f"```sh\n{context.command_path} {usage}\n```"
    yield "\n\n".join(" ".join(part.split()) for part in text.replace("\b", "").split("\n\n"))
    if example:
        yield f"```sh\n{' '.join(example.split())}\n```"
    options = [
        p for p in command.get_params(context) if isinstance(p, click.Option) and "--help" not in p.opts
    ]
    rows = [_option(option, context) for option in options if not option.hidden]
    if rows:
        yield "\n".join(["| option | meaning |", "|---|---|", *rows])
    for child in command.commands.values() if isinstance(command, click.Group) else ():
        yield from _command(child, context, str(child.name), level + 1)


def _option(option: click.Option, context: click.Context) -> str:
    names, meaning = option.get_help_record(context) or ("", "")
    return f"| `{names.replace('|', ' or ')}` | {_line(meaning).replace('[', chr(92) + '[')} |"


def exit_codes() -> str:
    """The table of exit codes."""
    codes = (cli.epilog or "").removeprefix("Exit codes: ").rstrip(".").split("; ")
    rows = [f"| {code.partition(' ')[0]} | {code.partition(' ')[2]} |" for code in codes]
    return "\n".join(["| code | meaning |", "|---|---|", *rows])


def public_names() -> str:
    """Every name of the Python interface with its documentation."""
    named = (cranktopo.__doc__ or "").partition("->")[0] + (cranktopo.__doc__ or "")
    order = sorted(cranktopo.__all__, key=lambda name: (name not in named, named.find(name)))
    return "\n\n".join(f"::: cranktopo.{name}" for name in order)


def libraries() -> str:
    """The materials and bearings that a name stands for, with their sources."""
    head = "| `name` | source |\n|---|---|"
    tables = [
        "\n".join(
            [head, *(f"| `{name}` | {_line(str(entry['source']))} |" for name, entry in library.items())]
        )
        for library in (material_library(), bearing_library())
    ]
    return f"### Materials\n\n{tables[0]}\n\n### Roller bearings\n\n{tables[1]}"


def goal_quantities() -> str:
    """Return a table of the quantities of goals and limits: meaning, better sense, units, load case."""
    head = "| quantity | meaning | better | units | load case |\n|---|---|---|---|---|"
    rows = (
        f"| `{q.name}` | {q.label} | {q.better if q.as_goal else f'{q.better}, as a limit only'} "
        f"| {', '.join(dict.fromkeys([*(name or 'no unit' for name in q.units), '%']))} "
        f"| {q.load_case or '-'} |"
        for q in QUANTITIES.values()
    )
    return "\n".join([head, *rows])


def examples() -> str:
    """Every example: its idea, its picture, its code."""
    return "\n\n".join(_example(script) for script in sorted((ROOT / "examples").glob("[0-9]*.py")))


def _example(script: Path) -> str:
    text = script.read_text(encoding="utf-8")
    idea = ast.get_docstring(ast.parse(text)) or ""
    topic, _, sentence = idea.partition(": ")
    (picture,) = (PAGES / "images" / "examples").glob(f"{script.stem}.*")
    code = text.replace(f'"""{idea}"""', "", 1).strip()
    return (
        f"## {topic}\n\n{sentence[:1].upper()}{sentence[1:]}\n\n"
        f"![{sentence.rstrip('.')}]({picture.relative_to(PAGES).as_posix()})\n\n"
        f'```python title="examples/{script.name}"\n{code}\n```'
    )


GENERATED: dict[str, Any] = {
    "scene": scene_tables,
    "libraries": libraries,
    "results": result_tables,
    "commands": command_pages,
    "exit_codes": exit_codes,
    "api": public_names,
    "quantities": goal_quantities,
    "examples": examples,
}
