"""For every table of the scene reference: a scene that has it, what reads it, other values of its keys."""

from __future__ import annotations

from tests.keys.aim_cases import AIM_CASES
from tests.keys.engine_cases import ENGINE_CASES
from tests.keys.kinds import Table
from tests.keys.part_cases import PART_CASES
from tests.keys.throw_cases import THROW_CASES

TABLES: dict[tuple[str, str], Table] = THROW_CASES | ENGINE_CASES | PART_CASES | AIM_CASES
