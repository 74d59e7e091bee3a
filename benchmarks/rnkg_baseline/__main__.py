"""Compares kg with extraction by strings, as the RNKG paper describes it, by facts that a person judges blind.

python benchmarks/rnkg_baseline sheet CHECKOUT... --nodes NODES.jsonl --sheet SHEET.csv --key KEY.csv
python benchmarks/rnkg_baseline score SHEET.csv KEY.csv
"""

from __future__ import annotations

import argparse
import csv
import json
import random
from pathlib import Path
from typing import TYPE_CHECKING, Final

from extracting import Fact, facts

from kg.evaluate.tables import wilson

if TYPE_CHECKING:
    from collections.abc import Iterator

_ROLES: Final = ("publishes", "subscribes", "services", "clients")
_COLUMNS: Final = (
    "number",
    "repository",
    "package",
    "node",
    "relation",
    "name",
    "type",
    "file",
    "line",
    "right",
    "as_written",
    "remark",
)


def main() -> None:
    """Run the part that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__)
    parts = parser.add_subparsers(dest="part", required=True)
    sheet = parts.add_parser("sheet", help="draw facts of both and mix them")
    sheet.add_argument("checkouts", nargs="+", type=Path)
    sheet.add_argument("--nodes", type=Path, required=True, help="what `kg nodes --json` prints of the same checkouts")
    sheet.add_argument("--sheet", type=Path, required=True)
    sheet.add_argument("--key", type=Path, required=True, help="which of both said each fact; not for who judges")
    sheet.add_argument("--size", type=int, default=50, help="facts of each")
    sheet.add_argument("--seed", type=int, default=1)
    score = parts.add_parser("score", help="print the precision of both")
    score.add_argument("sheet", type=Path)
    score.add_argument("key", type=Path)
    asked = parser.parse_args()
    if asked.part == "sheet":
        draw(asked)
    else:
        for line in scored(asked.sheet, asked.key):
            print(line)


def draw(asked: argparse.Namespace) -> None:
    """Write the sheet and the key. A fact that is drawn from both stands once."""
    said = {
        "kg": sorted(set(known(asked.nodes))),
        "strings": [one for checkout in asked.checkouts for one in facts(checkout)],
    }
    chance = random.Random(asked.seed)  # noqa: S311 - no secret
    origins: dict[Fact, list[str]] = {}
    for origin, listed in said.items():
        print(f"{origin}: {len(listed)} facts")
        for one in chance.sample(listed, min(asked.size, len(listed))):
            origins.setdefault(one, []).append(origin)
    mixed = sorted(origins)
    chance.shuffle(mixed)
    with asked.sheet.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(_COLUMNS)
        for number, one in enumerate(mixed, 1):
            cells = (one.repository, one.package, one.node, one.relation, one.name, one.type, one.file, one.line)
            writer.writerow([number, *cells, "", "", ""])
    with asked.key.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("number", "origin"))
        writer.writerows((number, " ".join(origins[one])) for number, one in enumerate(mixed, 1))


def known(path: Path) -> Iterator[Fact]:
    """Yield the same kinds of facts that kg has: of ROS 1 nodes, with a name and a type, not made by frameworks."""
    for line in path.read_text().splitlines():
        node = json.loads(line)
        for relation in _ROLES if node["ros"] == 1 else ():
            for one in node[relation]:
                if one["name"] and "{" not in one["name"] and one["type"] and not one["implicit"]:
                    repository = (one["file_repository"] or node["repository"]).removeprefix("local/")
                    name, written = node["node_name"] or node["node"], one["name"].replace("~/", "~")
                    yield Fact(
                        repository, node["package"], name, relation, written, one["type"], one["file"], one["line"]
                    )


def scored(sheet: Path, key: Path) -> list[str]:
    """Return the precision of both, with Wilson intervals of 95 %: of names at run time, and of names as written."""
    with sheet.open(newline="") as file:
        answers = {row["number"]: row for row in csv.DictReader(file)}
    with key.open(newline="") as file:
        origins = {row["number"]: row["origin"].split() for row in csv.DictReader(file)}
    lines = []
    for column in ("right", "as_written"):
        for origin in ("kg", "strings"):
            given = [answers[number][column].strip().lower() for number, named in origins.items() if origin in named]
            judged = [one for one in given if one in {"yes", "no"}]
            right = judged.count("yes")
            low, high = wilson(right, len(judged))
            lines.append(f"{column}, {origin}: {right} of {len(judged)}, {low:.3f} to {high:.3f}; {len(given)} drawn")
    return lines


if __name__ == "__main__":
    main()
