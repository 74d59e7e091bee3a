"""Has clients ask a server, and says what they measured in a few figures."""

from __future__ import annotations

import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

__all__ = ["Figures", "figures", "quantile", "run_clients"]

LOAD: Final = Path(__file__).with_name("load.py")


class Figures(NamedTuple):
    """Answers a second; median, p99 and longest of their times in ms; how many had another status than 200."""

    rate: float
    median: float
    p99: float
    longest: float
    bad: int


def run_clients(plan: dict[str, Any], warm: float = 0.0) -> dict[str, Any]:
    """Return what the clients of a plan of `load.py` measured, after `warm` seconds that do not count."""
    said = b"{}"
    for seconds in filter(None, (warm, plan["seconds"])):
        with tempfile.NamedTemporaryFile("w", suffix=".json", prefix="kg-plan-") as file:
            json.dump({**plan, "seconds": seconds}, file)
            file.flush()
            said = subprocess.run([sys.executable, str(LOAD), file.name], check=True, capture_output=True).stdout
    result: dict[str, Any] = json.loads(said)
    return result


def quantile(seconds: Iterable[float], share: float) -> float:
    """Return the smallest of `seconds` that `share` of them do not exceed; NaN when there are none."""
    ordered = sorted(seconds)
    return ordered[min(len(ordered) - 1, math.ceil(share * len(ordered)) - 1)] if ordered else math.nan


def figures(runs: Sequence[dict[str, Any]]) -> Figures:
    """Return the figures of what was measured in some runs of the same plan."""
    results = [result for run in runs for result in run["results"]]
    times = [second * 1000 for result in results for second in result["seconds"]]
    bad = sum(count for result in results for status, count in result["statuses"].items() if status != "200")
    elapsed = sum(run["elapsed"] for run in runs)
    return Figures(len(times) / elapsed, quantile(times, 0.5), quantile(times, 0.99), quantile(times, 1), bad)
