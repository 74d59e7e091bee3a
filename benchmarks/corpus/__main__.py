"""The corpus of RNKG: the selection that comes closest to it, and one build of all its repositories.

    python benchmarks/corpus select repos_dataset_all.csv [--output found.json]
    python benchmarks/corpus build LIST --mirrors MIRRORS --into FOLDER [--first N] [--most-code BYTES]

`build` checks out each repository of a list (an address a line, as `kg corpus select --output` writes it) from MIRRORS,
a folder with a git directory for each, and builds them all into one store. Nothing has to be attended to, and the
command can be killed and given again at any time: checkouts that are complete stay, and the build finds the packages
that were read before in FOLDER. It prints processor time, wall time, the peak of memory of all processes together,
disk, and what failed. `--first` takes so many repositories, `--most-code` only those that are not larger; each
choice has a store of its own. `--kill-after` kills the build and all its processes once, and then builds again.

`select` searches for the selection of a table of projects that comes closest to the one that the paper describes.
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

from corpus.building import HEAD, build, failures, row, subset
from corpus.checkouts import check_out_all
from corpus.searching import Found, Search

from kg.corpus.fetching.wanted import read_wanted
from kg.corpus.selection.criteria import default_criteria, read_criteria
from kg.corpus.selection.data import read_dataset
from kg.corpus.selection.select import paper_figures

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
    """Run the part that the command line names."""
    options = _options()
    if options.part == "select":
        _select(options)
    else:
        _build(options)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parts = parser.add_subparsers(dest="part", required=True)
    select = parts.add_parser("select")
    select.add_argument("dataset", type=Path, help="the 598 projects: repos_dataset_all.csv")
    select.add_argument("--output", type=Path, help="a file for what was found, as JSON")
    building = parts.add_parser("build")
    building.add_argument("list", type=Path, help="addresses of repositories, one a line")
    building.add_argument("--mirrors", type=Path, required=True, help="a folder with a git directory for each")
    building.add_argument("--into", type=Path, required=True, help="a folder for checkouts, results and stores")
    building.add_argument("--first", type=int, help="build so many repositories only")
    building.add_argument("--most-code", type=int, help="leave out repositories with more bytes of C++ and Python")
    building.add_argument("--jobs", type=int, default=2, help="processes that read packages")
    building.add_argument("--kill-after", type=float, help="kill the build after so many seconds, and build again")
    return parser.parse_args()


def _select(options: argparse.Namespace) -> None:
    """Search, print, write."""
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


def _build(options: argparse.Namespace) -> None:
    """Check out and build; the table is printed, what each build printed is kept next to its store."""
    name = f"first-{options.first or 'all'}-{options.most_code or 'all'}"
    whole = check_out_all(read_wanted(options.list), options.mirrors, options.into)
    lock = subset(whole, options.first, options.most_code, name)
    store, artifacts = options.into / f"{name}.store", options.into / f"{name}.artifacts"
    print(HEAD, flush=True)
    for number, measured in enumerate(build(lock, store, artifacts, options.jobs, options.kill_after)):
        (options.into / f"{name}.{number}.log").write_text(measured.output + measured.words, encoding="utf-8")
        print(row(lock, store, artifacts, measured), flush=True)
    print(dict(failures(lock, measured.words)))


def _show(title: str, found: list[Found], tried: int) -> None:
    print(f"{title} ({tried:,} selections tried)")
    for one in found:
        print(f"  {one.distance:.5f}  {one.projects}  without {', '.join(one.without)}; {', '.join(one.bounds) or '-'}")


main()
