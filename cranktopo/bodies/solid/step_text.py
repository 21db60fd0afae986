"""What a STEP file says about itself: product, author, organisation and date, where OCC leaves its own.

ISO 10303-21 (clear text encoding); the schema stays as OCC writes it, AP214 (automotive_design).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode

_TEXT = r"'(?:[^']|'')*'"
_HEADER = re.compile(r"(?s)\AISO-10303-21;\s*HEADER;.*?(FILE_SCHEMA\s*\(.*?\);)\s*ENDSEC;")
_SYSTEM = re.compile(rf"FILE_NAME\s*\((?:[^;']|{_TEXT})*?({_TEXT})\s*,\s*{_TEXT}\s*,\s*{_TEXT}\s*\);")
_PRODUCT = re.compile(rf"(=\s*PRODUCT\s*\(\s*){_TEXT}(\s*,\s*){_TEXT}(\s*,\s*){_TEXT}")
_SOLID = re.compile(rf"(=\s*MANIFOLD_SOLID_BREP\s*\(\s*){_TEXT}")


@dataclass(frozen=True)
class StepLabel:
    """What a reader shows of a STEP file.

    Attributes:
        product: name of the product and of its one solid.
        description: of the product, one line.
        program, version: that made it.
        written: time in UTC.
    """

    product: str
    description: str
    program: str
    version: str
    written: datetime


def label_step(path: Path, label: StepLabel) -> None:
    """Write the label into a STEP file of one solid that OCC wrote.

    Raises:
        CranktopoError: the file does not hold exactly one product with one solid.
    """
    path.write_text(labelled(path.read_text(encoding="ascii"), label), encoding="ascii")


def labelled(text: str, label: StepLabel) -> str:
    """Return the text of a STEP file with the label in its header, its product and its solid.

    Raises:
        CranktopoError: the text does not hold exactly one product with one solid.
    """
    product, description = step_string(label.product), step_string(label.description)
    system = _SYSTEM.search(text)
    header = (
        "ISO-10303-21;\nHEADER;\n"
        f"FILE_DESCRIPTION(({description}),'2;1');\n"
        f"FILE_NAME({product},'{label.written.isoformat(timespec='seconds')}',\n"
        f"  ({step_string(f'{label.program} {label.version}')}),({step_string(label.program)}),\n"
        f"  {system[1] if system else repr('')},{step_string(f'{label.program} {label.version}')},'');\n"
    )
    text, headers = _HEADER.subn(lambda found: f"{header}{found[1]}\nENDSEC;", text)
    text, products = _PRODUCT.subn(lambda m: f"{m[1]}{product}{m[2]}{product}{m[3]}{description}", text)
    text, solids = _SOLID.subn(lambda m: f"{m[1]}{product}", text)
    if (headers, products, solids) != (1, 1, 1):
        raise CranktopoError(
            f"STEP file: holds {products} products with {solids} solids instead of one each.",
            hint="Export STL, or change the dimensions slightly.",
            code=ExitCode.SOLVER,
        )
    return text


def step_string(text: str) -> str:
    """A string of ISO 10303-21, quotes included: quotes and backslashes doubled, other alphabets as UTF-16.

    Source: ISO 10303-21, 6.4.3.
    """

    def coded(match: re.Match[str]) -> str:
        return f"\\X2\\{match[0].encode('utf-16-be').hex().upper()}\\X0\\"

    plain = text.replace("\\", "\\\\").replace("'", "''")
    return "'" + re.sub(r"[^\x20-\x7e]+", coded, plain) + "'"
