"""Registry of the fatigue criteria of local stresses: one line each."""

from __future__ import annotations

from cranktopo.tasks.fatigue.criterion import FatigueCriterion
from cranktopo.tasks.fatigue.fkm import FKM
from cranktopo.tasks.fatigue.lsa import LSA

CRITERIA: dict[str, FatigueCriterion] = {criterion.name: criterion for criterion in (LSA, FKM)}
