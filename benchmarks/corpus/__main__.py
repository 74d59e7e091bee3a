"""Searches for the selection of a table of projects that comes closest to the one that RNKG describes.

    python benchmarks/corpus repos_dataset_all.csv [--output found.json]

Every subset of the criteria is tried. A project is in the group of the criterion that it violates; those that violate
none are always taken, those that nobody decided about are a group of their own. Each subset is tried with and without
a bound on one figure from below, and with and without the paper's maxima as bounds from above.

The distance of a selection is the root of the mean square, over the number of projects and all figures that the paper
prints, of (ours - paper's) / paper's. Listed are the closest of all and the closest of those with exactly as many
projects as the paper has, with the standard deviation of a sample and with that of a population.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Final

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from corpus.searching import Found, Search

from kg.corpus.selection_criteria import default_criteria, read_criteria
from kg.corpus.selection_data import read_dataset
from kg.corpus.selection_figures import paper_figures

LEAST: Final = {
    "commits": (101, 102, 103, 105, 110),
    "contributors": (2, 3, 4, 5),
    "branches": (3, 4),
    "issues": (1, 2),
    "pull_requests": (1, 2),
    "launch_files": (1, 2, 3, 4, 5),
}
"""The bounds from below that are tried, one at a time."""
SHOWN: Final = 8


def main() -> None:
    """Read the command line, search, print, write."""
    options = _options()
    criteria = read_criteria(default_criteria())
    search = Search(read_dataset(options.dataset), criteria, paper_figures())
    report: dict[str, list[dict[str, object]]] = {}
    for spread in ("sample", "population"):
        found = sorted(search.run(LEAST, population=spread == "population"), key=lambda one: one.distance)
        same = [one for one in found if one.projects == paper_figures().projects]
        for title, ones in (("all", found), ("of 503", same)):
            name = f"{title}, deviation of a {spread}"
            report[name] = [one.plain() for one in ones[:SHOWN]]
            _show(name, ones[:SHOWN], search.tried)
    if options.output:
        options.output.write_text(json.dumps(report, indent=2) + "\n")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("dataset", type=Path, help="the 598 projects: repos_dataset_all.csv")
    parser.add_argument("--output", type=Path, help="a file for what was found, as JSON")
    return parser.parse_args()


def _show(title: str, found: list[Found], tried: int) -> None:
    print(f"{title} ({tried:,} selections tried)")
    for one in found:
        print(f"  {one.distance:.5f}  {one.projects}  without {', '.join(one.without)}; {', '.join(one.bounds) or '-'}")


main()
