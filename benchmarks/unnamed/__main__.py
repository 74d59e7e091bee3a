"""Counts the interfaces of nodes whose name extraction does not find, by repository and by reason.

    python benchmarks/unnamed --mirrors MIRRORS --corpus CORPUS
    python benchmarks/unnamed CHECKOUT...

CORPUS is a JSON object with a `commit` for each repository `owner/name`. Each repository is checked out at its commit
from its git directory below MIRRORS. A CHECKOUT is a folder. All sources are one build, as for `kg build CORPUS`;
`--apart` makes one build of each. Interfaces that a framework makes (`implicit`) do not count.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import tempfile
from collections import Counter, defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from accuracy.checkouts import check_out
from accuracy.reading import read_sources
from accuracy.scoring import INTERFACES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


def main() -> None:
    """Read the command line and the sources that it names, and print the tables."""
    options = _options()
    with tempfile.TemporaryDirectory(prefix="kg-benchmark-") as folder:
        if options.corpus:
            corpus = json.loads(options.corpus.read_text(encoding="utf-8"))
            named = [{"repo": name, "commit": entry["commit"]} for name, entry in corpus.items()]
            options.sources += check_out(named, options.mirrors, Path(folder))
        readings = read_sources(options.sources, together=not options.apart, workers=options.workers, package=None)
    records = [record for reading in readings for record in reading.records]
    if options.records:
        options.records.write_text("".join(json.dumps(record) + "\n" for record in records), encoding="utf-8")
    print("\n".join([*by_repository(records), "", *by_reason(records)]))
    if options.list:
        options.list.write_text("".join(f"{line}\n" for line in listed(records)), encoding="utf-8")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sources", nargs="*", type=Path, help="checkouts")
    parser.add_argument("--corpus", type=Path, help="repositories with their commits; needs --mirrors")
    parser.add_argument("--mirrors", type=Path, help="folder with a git directory for each repository")
    parser.add_argument("--apart", action="store_true", help="one build for each source")
    parser.add_argument("--workers", type=int, default=2, help="processes (default 2)")
    parser.add_argument("--list", type=Path, metavar="FILE", help="write each interface without a name with its place")
    parser.add_argument("--records", type=Path, metavar="FILE", help="write all records, as kg nodes --json has them")
    options = parser.parse_args()
    if bool(options.corpus) != bool(options.mirrors):
        parser.error("--corpus and --mirrors need each other")
    return options


def explicit(records: Iterable[dict[str, Any]]) -> Iterator[tuple[dict[str, Any], str, dict[str, Any]]]:
    """Yield record, role and interface of each interface that the code of a node creates."""
    for record in records:
        for role in INTERFACES:
            for one in record[role]:
                if not one["implicit"]:
                    yield record, role, one


def by_repository(records: Iterable[dict[str, Any]]) -> list[str]:
    """Return the counts of each repository as a table in Markdown, the total last."""
    counts: dict[str, Counter[str]] = defaultdict(Counter)
    for record, _, one in explicit(records):
        state = "none" if one["name"] is None else "partial" if one["resolution"] == "partial" else "whole"
        counts[record["repository"]][state] += 1
    total = Counter[str]()
    for found in counts.values():
        total.update(found)
    rows = [*sorted(counts.items(), key=lambda row: -row[1]["none"]), ("all", total)]
    head = ["| repository | interfaces | without a name | partial name |", "| --- | --- | --- | --- |"]
    return head + [
        f"| {name} | {found.total()} | {_share(found, 'none')} | {_share(found, 'partial')} |" for name, found in rows
    ]


def by_reason(records: Iterable[dict[str, Any]]) -> list[str]:
    """Return how many interfaces lack a name for each reason as a table in Markdown; names in reasons are left out."""
    reasons = Counter(
        re.sub(r"\b\w*[_:A-Z]\w*[\w:]*(\(\))?", "...", one["reason"] or "no reason")
        for _, _, one in explicit(records)
        if one["name"] is None
    )
    head = ["| reason | interfaces without a name |", "| --- | --- |"]
    return head + [f"| {reason} | {count} |" for reason, count in reasons.most_common()]


def listed(records: Iterable[dict[str, Any]]) -> list[str]:
    """Return a line for each interface without a name: place, role, type, node and reason."""
    return sorted(
        f"{record['repository']} {one['file']}:{one['line']}: {role} {one['type']} of {record['package']}/"
        f"{record['node']}: {one['reason']}"
        for record, role, one in explicit(records)
        if one["name"] is None
    )


def _share(counts: Counter[str], state: str) -> str:
    return f"{100 * counts[state] / counts.total():.1f} % ({counts[state]})"


if __name__ == "__main__":
    main()
