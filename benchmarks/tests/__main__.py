"""Lists the slowest tests and files of a run.

    pytest -n 2 --dist worksteal --junitxml=report.xml
    python benchmarks/tests report.xml [--count 50]

Seconds are wall clock, of setup, call and teardown together. The fixtures that tests share are charged to the first
test that requests them.
"""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from lxml import etree

if TYPE_CHECKING:
    from collections.abc import Iterable

ROOT = Path(__file__).resolve().parents[2]


def main() -> None:
    """Read the command line and the report, and print both lists."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("report", help="what `pytest --junitxml` wrote")
    parser.add_argument("--count", type=int, default=50, help="number of rows of each list")
    options = parser.parse_args()
    cases = read(options.report)
    files, numbers = Counter[str](), Counter[str]()
    for file, _, seconds in cases:
        files[file] += seconds  # type: ignore[assignment] # a Counter can hold floats
        numbers[file] += 1
    print(f"{len(cases)} tests in {len(files)} files: {sum(seconds for _, _, seconds in cases):.1f} s\n")
    print_rows("tests", ((seconds, f"{file}::{name}") for file, name, seconds in cases), options.count)
    print_rows("files", ((files[file], f"{file} ({numbers[file]} tests)") for file in files), options.count)


def read(report: str) -> list[tuple[str, str, float]]:
    """Return the file, the name and the seconds of each test of a report in the format of JUnit."""
    cases = etree.parse(report, etree.XMLParser(resolve_entities=False, huge_tree=True)).iter("testcase")
    return [(file_of(case.get("classname", "")), case.get("name", ""), float(case.get("time", 0))) for case in cases]


def file_of(dotted: str) -> str:
    """Return the path of a test file by the dotted name that pytest gives to the class of a test."""
    parts = dotted.split(".")
    for end in range(len(parts), 0, -1):
        path = Path(*parts[:end]).with_suffix(".py")
        if (ROOT / path).is_file():
            return str(path)
    return dotted


def print_rows(title: str, rows: Iterable[tuple[float, str]], count: int) -> None:
    """Print the rows with most seconds."""
    print(f"slowest {title}\n{'seconds':>8}")
    for seconds, name in sorted(rows, reverse=True)[:count]:
        print(f"{seconds:8.2f}  {name}")
    print()


if __name__ == "__main__":
    main()
