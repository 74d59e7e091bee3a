"""Lists the folders, fixtures, tests and files of a run that take most time.

    PYTHONPATH=benchmarks/tests pytest -n 2 --dist worksteal -p processor --junitxml=report.xml
    python benchmarks/tests report.xml [--count 50]

Seconds are processor time where the plugin `processor` measured it, else wall clock; of setup, call and teardown
together. The fixtures that tests share are charged to the first test that requests them.
"""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree
from processor import FIXTURE, TEST

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

ROOT = Path(__file__).resolve().parents[2]


class Case(NamedTuple):
    """A test of a report: its file, its name, its seconds and those of the fixtures that were set up for it."""

    file: str
    name: str
    seconds: float
    fixtures: Mapping[str, float]

    @property
    def folder(self) -> str:
        """The folder below `tests/`, without those below it."""
        return str(Path(*Path(self.file).parts[:2])) if len(Path(self.file).parts) > 2 else "tests"  # noqa: PLR2004 - tests/FOLDER/FILE


def main() -> None:
    """Read the command line and the reports, and print the lists."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("report", nargs="+", help="what `pytest --junitxml` wrote")
    parser.add_argument("--count", type=int, default=50, help="number of rows of each list")
    options = parser.parse_args()
    cases = [case for report in options.report for case in read(report)]
    print(f"{len(cases)} tests: {sum(case.seconds for case in cases):.1f} s\n")
    print_sums("folders", ((case.folder, case.seconds) for case in cases), options.count)
    print_sums("fixtures", (item for case in cases for item in case.fixtures.items()), options.count)
    print_sums("tests", ((f"{case.file}::{case.name}", case.seconds) for case in cases), options.count)
    print_sums("files", ((case.file, case.seconds) for case in cases), options.count)


def read(report: str) -> list[Case]:
    """Return the tests of a report in the format of JUnit."""
    cases = etree.parse(report, etree.XMLParser(resolve_entities=False, huge_tree=True)).iter("testcase")
    return [_case(case) for case in cases]


def _case(case: etree._Element) -> Case:
    measured = {one.get("name", ""): float(one.get("value", 0)) for one in case.iter("property")}
    fixtures = {name.removeprefix(FIXTURE): spent for name, spent in measured.items() if name.startswith(FIXTURE)}
    seconds = measured.get(TEST, float(case.get("time", 0)))
    name = case.get("name", "")  # a module that is skipped as a whole has no class
    return Case(file_of(case.get("classname") or name), name, seconds, fixtures)


def file_of(dotted: str) -> str:
    """Return the path of a test file by the dotted name that pytest gives to the class of a test.

    The name is empty for a test that was interrupted.
    """
    parts = dotted.split(".")
    for end in range(len(parts), 0, -1):
        path = Path(*parts[: end - 1], f"{parts[end - 1]}.py")
        if (ROOT / path).is_file():
            return str(path)
    return dotted


def print_sums(title: str, items: Iterable[tuple[str, float]], count: int) -> None:
    """Print the names with most seconds in all, and how many times each occurs."""
    seconds, numbers = Counter[str](), Counter[str]()
    for name, spent in items:
        seconds[name] += spent  # type: ignore[assignment] # a Counter can hold floats
        numbers[name] += 1
    if not seconds:
        return
    print(f"{title}\n{'seconds':>8} {'number':>6}")
    for name, spent in seconds.most_common(count):
        print(f"{spent:8.2f} {numbers[name]:6}  {name}")
    print()


if __name__ == "__main__":
    main()
