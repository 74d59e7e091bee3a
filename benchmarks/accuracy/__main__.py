"""Measures how much of what is known of real nodes `kg` reads from their sources, as one table.

    python benchmarks/accuracy SOURCE... --truth DIR_OR_FILE --scorer score_interfaces.py [--misses DIR]
    python benchmarks/accuracy --mirrors MIRRORS --truth DIR_OR_FILE --scorer score_interfaces.py

A SOURCE is a checkout (a folder); each is a build of its own unless `--together` is given, which lets packages of one
source use those of another. With `--mirrors`, a folder with a git directory for each repository (`owner+name`,
`owner/name`, bare or not), the repositories are checked out at the commits that the truth names. `--truth` is a
folder of `*.jsonl` truth files or one of them, `--scorer` the scoring program. A truth record counts when it names a
package and its repository is among the sources at the commit that it names. Typical uses:

    # the whole table
    python benchmarks/accuracy checkouts/* --truth truth --scorer score_interfaces.py
    # one repository, with all that was missed of it in misses/TRUTH.LEVEL.jsonl
    python benchmarks/accuracy checkouts/* --only husky/husky --truth truth --scorer score_interfaces.py --misses misses
    # names of launched systems count, too: those that `kg instances --json` printed for the same checkout
    python benchmarks/accuracy checkouts/universe --instances instances.jsonl --truth truth --scorer score_interfaces.py
    # one package, its records as `kg nodes --json` prints them in records.jsonl
    python benchmarks/accuracy checkouts/husky --package husky_base --truth ... --scorer ... --records records.jsonl
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from accuracy.checkouts import check_out
from accuracy.reading import Reading, read_sources
from accuracy.scoring import (
    INTERFACES,
    LEVELS,
    Record,
    Scores,
    in_root,
    load_scorer,
    score_file,
    that_sources_hold,
    without_command_line,
)

if TYPE_CHECKING:
    from types import ModuleType

TARGETS = {
    "observed-ros1": ("node", "name+type", 90),
    "static-models": ("node", "name", 95),
    "ros2-readme": ("package", "name+type", 80),
    "node-docs": ("package", "mean name+type", 85),
}
"""Truth files by the beginning of their names: level, measure and the percentage to reach."""


def main() -> None:
    """Read the command line, check out what it names, measure."""
    options = _options()
    scorer = load_scorer(options.scorer)
    files = sorted(options.truth.glob("*.jsonl")) if options.truth.is_dir() else [options.truth]
    truths = {file: [truth for truth in scorer.lines(file) if truth.get("package")] for file in files}
    with tempfile.TemporaryDirectory(prefix="kg-benchmark-") as folder:
        if options.mirrors:
            named = [truth for records in truths.values() for truth in records]
            options.sources += check_out(named, options.mirrors, Path(folder))
        _measure(options, scorer, truths)


def _measure(options: argparse.Namespace, scorer: ModuleType, by_file: dict[Path, list[Record]]) -> None:
    roots = [root for root in options.sources if root.is_dir() and _wanted(root, options.only)]
    if not roots:
        raise SystemExit("none of the sources is a folder (that --only names)")
    readings = read_sources(roots, together=options.together, workers=options.workers, package=options.package)
    _report_reading(readings)
    for instance in scorer.lines(options.instances) if options.instances else ():
        _add_instance(instance, readings)
    if options.records:
        _write(options.records, [record for reading in readings for record in reading.records])
    if options.problems:
        options.problems.write_text("\n".join(line for reading in readings for line in reading.problems) + "\n")
    rows = []
    for file, named in by_file.items():
        truths = [truth for truth in named if options.package in (None, truth["package"])]
        for level in LEVELS:
            scores = score_file(scorer, truths, readings, level)
            if not scores.by_source:
                continue
            rows.append(_row(file.stem, level, scores))
            if any(truth.get("args") for truth in truths):
                written = [without_command_line(truth) for truth in truths]
                scores = score_file(scorer, written, [in_root(reading) for reading in readings], level)
                rows.append(_row(f"{file.stem}, start undone", level, scores))
            entries = (one for truth in truths for key in INTERFACES for one in truth.get(key, ()))
            if any(isinstance(one, dict) and one.get("corroborated") == "none" for one in entries):
                held = score_file(scorer, [that_sources_hold(truth) for truth in truths], readings, level)
                rows.append(_row(f"{file.stem}, names that the sources hold", level, held))
            if options.by_source:
                rows.extend(
                    _row(f"  {name}", level, Scores({name: counts})) for name, counts in scores.by_source.items()
                )
            if options.misses:
                options.misses.mkdir(parents=True, exist_ok=True)
                _write(options.misses / f"{file.stem}.{level}.jsonl", scores.misses)
    table = "\n".join([*_HEAD, *rows])
    print(table)
    if options.table:
        options.table.write_text(table + "\n")


def _add_instance(instance: Record, readings: list[Reading]) -> None:
    """Add the names that a launched node has to what was read of its package."""
    ends = {
        role: [{**end, "name": end["resolved"]} for end in instance[role] if end["resolved"]] for role in INTERFACES
    }
    for reading in readings:
        of = next((one for one in reading.records if _identity(one) == _identity(instance)), None)
        if of is not None:
            reading.records.append({**of, **ends, "parameters": []})


def _identity(record: Record) -> tuple[str, str]:
    return record["package"], record["node"]


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sources", nargs="*", type=Path, help="folders to read, each one checkout")
    parser.add_argument("--mirrors", type=Path, help="git directories to check out what the truth names")
    parser.add_argument("--truth", type=Path, required=True, help="folder of truth files (*.jsonl), or one file")
    parser.add_argument("--scorer", type=Path, required=True, help="the scoring program, score_interfaces.py")
    parser.add_argument("--only", metavar="REPO", help="only the sources whose folder or remote has this in its name")
    parser.add_argument("--package", help="only this package of the sources")
    parser.add_argument("--together", action="store_true", help="all sources are one build")
    parser.add_argument("--instances", type=Path, metavar="FILE", help="what `kg instances --json` printed of these")
    parser.add_argument("--workers", type=int, default=2, help="processes (default 2)")
    parser.add_argument("--by-source", action="store_true", help="a row for each source as well")
    parser.add_argument("--misses", type=Path, metavar="DIR", help="write what was missed to DIR/TRUTH.LEVEL.jsonl")
    parser.add_argument("--records", type=Path, metavar="FILE", help="write all records, as kg nodes --json has them")
    parser.add_argument("--problems", type=Path, metavar="FILE", help="write all problems found in the sources")
    parser.add_argument("--table", type=Path, metavar="FILE", help="write the table, which is Markdown, here too")
    return parser.parse_args()


def _wanted(root: Path, only: str | None) -> bool:
    return only is None or only.replace("/", "+").lower() in str(root).replace("/", "+").lower()


def _report_reading(readings: list[Reading]) -> None:
    nodes = sum(len(reading.records) for reading in readings)
    failed = [line for reading in readings for line in reading.problems if " KG121 " in line]
    seconds = {name: spent for reading in readings for name, spent in reading.seconds.items()}
    slowest = ", ".join(f"{name} {seconds[name]:.1f} s" for name in sorted(seconds, key=lambda n: -seconds[n])[:5])
    words = f"{len(readings)} sources, {nodes} nodes, {sum(seconds.values()):.1f} s CPU in extraction ({slowest})"
    print(words, f"{len(failed)} packages failed", *failed[:10], sep="\n", file=sys.stderr)


_COLUMNS = (
    "truth",
    "level",
    "name",
    "name+type",
    "mean name+type",
    "+line",
    "parameters",
    "name incl. parameters",
    "precision",
    "to reach",
)
_HEAD = [f"| {' | '.join(_COLUMNS)} |", "|" + " --- |" * len(_COLUMNS)]


def _row(title: str, level: str, scores: Scores) -> str:
    target = next((goal for start, goal in TARGETS.items() if title.startswith(start)), None)
    goal = f"{target[1]} {target[2]} %" if target and target[0] == level else ""
    mean = scores.mean("typed", "wanted_typed", INTERFACES)
    cells = (
        title,
        level,
        _percent(*scores.share("named", "wanted", INTERFACES)),
        _percent(*scores.share("typed", "wanted_typed", INTERFACES)),
        f"{100 * mean:.1f} %" if mean is not None else "-",
        _percent(*scores.share("lined", "wanted_line", INTERFACES)),
        _percent(*scores.share("named", "wanted", ("parameters",))),
        _percent(*scores.share("named", "wanted")),
        _percent(*scores.share("right", "claimed")),
        goal,
    )
    return f"| {' | '.join(cells)} |"


def _percent(part: int, whole: int) -> str:
    return f"{100 * part / whole:.1f} % ({part}/{whole})" if whole else "-"


def _write(path: Path, records: list[dict[str, object]]) -> None:
    path.write_text("".join(json.dumps(record, ensure_ascii=False) + "\n" for record in records), encoding="utf-8")


if __name__ == "__main__":
    main()
