"""The balance of a design's engine: what its command prints, and its page."""

from __future__ import annotations

from pathlib import Path

from cranktopo.base.files import as_path
from cranktopo.engine.balance.whole_engine import EngineBalance
from cranktopo.report.report_file import write_report
from cranktopo.runs.manifest import timestamp
from cranktopo.tasks.balance.page import balance_page
from cranktopo.tasks.balance.proposal import ProposedCounterweight


def report_balance(
    balance: EngineBalance, path: Path | str, proposal: ProposedCounterweight | None = None
) -> None:
    """Write the page of a balance as HTML or Markdown, by the ending of its name.

    Raises:
        CranktopoError: another ending, no such folder, or it cannot be written.
    """
    path = as_path(path)
    write_report(balance_page(balance, timestamp()[:10], proposal), path)
