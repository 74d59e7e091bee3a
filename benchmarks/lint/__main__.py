"""How many findings of `kg lint` are true: findings about many repositories, a sample, and what a reader judged.

    python benchmarks/lint find --mirrors MIRRORS --corpus CORPUS --workspaces FOLDER > findings.jsonl
    python benchmarks/lint sample findings.jsonl --seed 1 --count 100 > sheet.jsonl
    python benchmarks/lint table sheet.jsonl

CORPUS is a JSON object with a `commit` for each repository `owner/name`; each becomes a workspace and a store of its
own below FOLDER, kept for the next time. The sample takes one finding of each code and kind (notes are apart)
in turn, each drawn by chance, until it is large enough. In the sheet a reader writes `true` (or false) and `reason`
for each finding; the table counts them.
"""

from __future__ import annotations

import argparse
import json
import random
import subprocess
import sys
from collections import Counter, defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from bugs.commands import FINDINGS, build
from bugs.workspaces import MissingError, git_folder, unpack

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

Finding = dict[str, Any]
KEPT = ("severity", "code", "rule", "system", "file", "line", "message")


def main() -> None:
    """Run the part that the command line names, and print its lines."""
    options = _options()
    if options.part == "find":
        corpus = json.loads(options.corpus.read_text(encoding="utf-8"))
        for name, entry in corpus.items():
            for found in findings(name, entry["commit"], options.mirrors, options.workspaces):
                print(json.dumps(found), flush=True)
        return
    rows = [json.loads(line) for line in options.file.read_text(encoding="utf-8").splitlines()]
    lines = map(json.dumps, sample(rows, options.seed, options.count)) if options.part == "sample" else table(rows)
    print("\n".join(lines))


def findings(name: str, commit: str, mirrors: Path, workspaces: Path) -> Iterator[Finding]:
    """Yield what `kg lint` finds in a repository at a commit."""
    folder = workspaces / name.replace("/", "+")
    store = folder.with_name(f"{folder.name}.kg")
    if not folder.exists():
        try:
            unpack(git_folder(mirrors, name), commit, folder)
        except MissingError as missing:
            print(f"{name}: {missing}", file=sys.stderr)
            return
    build(folder, store)
    done = subprocess.run(
        [sys.executable, "-m", "kg", "lint", "--json", "--store", str(store)],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode not in (0, FINDINGS):
        raise SystemExit(f"kg lint of {name} ended with {done.returncode}:\n{done.stderr.strip()}")
    for line in done.stdout.splitlines():
        found = json.loads(line)
        yield {"repository": name, "commit": commit, **{key: found[key] for key in KEPT}}


def sample(rows: Iterable[Finding], seed: int, count: int) -> list[Finding]:
    """Return findings drawn by chance, from each code and kind in turn; the same for the same rows and seed."""
    groups: defaultdict[tuple[str, bool], list[Finding]] = defaultdict(list)
    for row in sorted(rows, key=lambda row: json.dumps(row, sort_keys=True)):
        groups[row["code"], row["severity"] == "note"].append(row)
    chance = random.Random(seed)  # noqa: S311 - a sample, no secret
    for group in groups.values():
        chance.shuffle(group)
    drawn: list[Finding] = []
    while len(drawn) < count and any(groups.values()):
        drawn += [groups[key].pop() for key in sorted(groups) if groups[key]]
    return sorted(drawn[:count], key=lambda row: (row["code"], row["severity"], row["repository"], row["message"]))


def table(rows: Iterable[Finding]) -> list[str]:
    """Return a table in Markdown: how many findings were judged and are true, by code and kind."""
    counts: defaultdict[tuple[str, str], Counter[bool]] = defaultdict(Counter)
    for row in rows:
        kind = "notes" if row["severity"] == "note" else "errors and warnings"
        for key in ((row["code"], kind), ("all", kind)):
            counts[key][row["true"]] += 1
    lines = ["| code | findings | judged | true | |", "|---|---|---|---|---|"]
    for (code, kind), found in sorted(counts.items(), key=lambda item: (item[0][0] == "all", item[0])):
        lines.append(f"| {code} | {kind} | {found.total()} | {found[True]} | {found[True] / found.total():.0%} |")
    return lines


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parts = parser.add_subparsers(dest="part", required=True)
    find = parts.add_parser("find", help="print what is found in all repositories, a finding a line")
    find.add_argument("--mirrors", type=Path, required=True, help="folder with a git directory for each repository")
    find.add_argument("--corpus", type=Path, required=True, help="repositories with their commits")
    find.add_argument("--workspaces", type=Path, required=True, help="folder for sources and stores")
    draw = parts.add_parser("sample", help="print a sample of findings")
    draw.add_argument("file", type=Path, help="findings")
    draw.add_argument("--seed", type=int, default=1)
    draw.add_argument("--count", type=int, default=100)
    show = parts.add_parser("table", help="print the table of a sheet")
    show.add_argument("file", type=Path, help="findings with `true`")
    return parser.parse_args()


if __name__ == "__main__":
    main()
