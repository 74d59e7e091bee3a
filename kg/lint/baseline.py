"""The baseline: existing findings, so that only new ones are reported.

A finding is identified by code, rule, system and subjects, which do not change when lines move. If several findings
share these, their number counts.
"""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from kg.errors import Place, UsageError

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from kg.lint.finding import Finding

_VERSION: Final = 1


@dataclass(frozen=True, slots=True, order=True)
class Entry:
    """An entry of a baseline: the fingerprint, and a description for people."""

    fingerprint: str
    code: str = ""
    system: str = ""
    subjects: tuple[str, ...] = ()


def written(findings: Iterable[Finding]) -> str:
    """Return the text of a baseline with these findings; deterministic."""
    ordered = sorted(findings, key=lambda one: (one.system, one.code, one.rule, one.subjects, one.fingerprint))
    counts = Counter(one.fingerprint for one in ordered)
    entries = {
        one.fingerprint: {
            "fingerprint": one.fingerprint,
            "code": one.code,
            "rule": one.rule,
            "system": one.system,
            "subjects": list(one.subjects),
            "count": counts[one.fingerprint],
        }
        for one in ordered
    }
    return json.dumps({"version": _VERSION, "findings": list(entries.values())}, indent=1, ensure_ascii=False) + "\n"


def read(file: Path) -> Counter[Entry]:
    """Return the findings of a baseline with their numbers.

    Raises:
        UsageError: KG420 the file is missing or not a baseline.
    """
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as problem:
        reason = getattr(problem, "strerror", None) or str(problem)
        raise UsageError("KG420", f"the baseline cannot be read: {reason}", place=Place(str(file))) from None
    except json.JSONDecodeError as problem:
        place = Place(str(file), problem.lineno, problem.colno)
        raise UsageError("KG420", f"invalid JSON: {problem.msg}", place=place) from None
    except RecursionError:
        raise UsageError("KG420", "not a baseline: it is nested too deeply", place=Place(str(file))) from None
    entries = content.get("findings") if isinstance(content, dict) and content.get("version") == _VERSION else None
    if not isinstance(entries, list):
        raise UsageError("KG420", f"not a baseline of version {_VERSION}", place=Place(str(file)))
    counts: Counter[Entry] = Counter()
    for entry in entries:
        counts[_entry(entry, file)] += max(1, entry["count"]) if isinstance(entry.get("count"), int) else 1
    return counts


def _entry(entry: Any, file: Path) -> Entry:
    if not isinstance(entry, dict) or not isinstance(entry.get("fingerprint"), str):
        raise UsageError("KG420", "an entry of the baseline has no fingerprint", place=Place(str(file)))
    subjects = entry.get("subjects")
    named = tuple(str(one) for one in subjects) if isinstance(subjects, list) else ()
    return Entry(entry["fingerprint"], str(entry.get("code", "")), str(entry.get("system", "")), named)


def compared(findings: Iterable[Finding], baseline: Counter[Entry]) -> tuple[list[Finding], list[Finding], list[Entry]]:
    """Return new findings, known findings, and stale entries of the baseline."""
    left = Counter({one.fingerprint: number for one, number in baseline.items()})
    new: list[Finding] = []
    old: list[Finding] = []
    for finding in sorted(findings, key=lambda one: one.order):
        if left[finding.fingerprint] > 0:
            left[finding.fingerprint] -= 1
            old.append(finding)
        else:
            new.append(finding)
    seen = {one.fingerprint for one in old}
    return new, old, sorted(one for one in baseline if one.fingerprint not in seen)
