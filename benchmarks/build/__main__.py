"""Measures what a build costs, beside only parsing the same files, and prints the ratios.

    python benchmarks/build CHECKOUT [--repeat 3] [--output figures.json] [--stages | --parts | --growth]

With `--stages` it measures extraction alone: processor seconds of each stage in one process, their ratio to parsing,
and the memory of that process. Without texts, wiring, rules and the store. With `--parts` it measures the parts of a
whole cold build in one process, texts, wiring, rules and the store among them. With `--growth` it extracts growing
parts of the checkout, and a generated package of growing size, and prints the exponents of their processor times.

Every measurement is a process of its own; of several the smallest counts, since whatever else the machine does only
adds. CPU is that of the process and of all it started, user and system. Memory is the largest sum, over all
processes of a build at one moment, of what they hold (pages that several share are counted once).
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import tempfile
from pathlib import Path

from growth import growth
from measuring import Measurement, measure, python

PARSE = """
import sys
from pathlib import Path
import tree_sitter_cpp, tree_sitter_python
from tree_sitter import Language, Parser
from kg.corpus.workspace import scan_tree
from kg.facts import FileKind
parsers = {
    FileKind.CPP: Parser(Language(tree_sitter_cpp.language())),
    FileKind.PYTHON: Parser(Language(tree_sitter_python.language())),
}
files = size = 0
for source in scan_tree(Path(sys.argv[1])):
    for entry in (entry for package in source.packages for entry in package.files):
        if entry.kind in parsers:
            content = (source.root / entry.path).read_bytes()
            parsers[entry.kind].parse(content)
            files, size = files + 1, size + len(content)
print(files, size)
"""
"""The least that reading code can cost: each file is read and parsed once, and nothing is done with it."""


def main() -> None:
    """Read the command line, measure, print, write."""
    options = _options()
    with tempfile.TemporaryDirectory(prefix="kg-benchmark-") as folder:
        checkout = options.checkout.absolute()
        if options.growth:
            figures = growth(checkout, Path(folder), options.repeat)
        elif options.stages:
            figures = _stages(checkout, options.repeat)
        elif options.parts:
            figures = _parts(checkout, options.repeat)
        else:
            figures = _figures(checkout, Path(folder), options.repeat)
    for name, value in figures.items():
        print(f"{name:32} {value}")
    if options.output:
        options.output.write_text(json.dumps(figures, indent=2) + "\n")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("checkout", type=Path, help="a checkout, for example of autoware.universe at b8ce82e")
    parser.add_argument("--repeat", type=int, default=3, help="how often each is measured")
    parser.add_argument("--stages", action="store_true", help="measure the stages of extraction alone")
    parser.add_argument("--parts", action="store_true", help="measure the parts of a cold build in one process")
    parser.add_argument("--growth", action="store_true", help="measure how extraction grows with the sources")
    parser.add_argument("--output", type=Path, help="a file for the figures, as JSON")
    return parser.parse_args()


def _stages(checkout: Path, repeat: int) -> dict[str, object]:
    parse = _least([measure(python("-c", PARSE, str(checkout))) for _ in range(repeat)], "cpu")
    programs = [str(Path(__file__).with_name("stages.py")), str(checkout)]
    whole = [json.loads(measure(python(*programs, "--whole")).output) for _ in range(repeat)]
    # The clock of the stages costs time itself, so the total is measured without it.
    staged = json.loads(measure(python(*programs)).output)
    total = round(min(one["seconds"]["rest"] for one in whole), 2)
    parsing = min(one["parsing"] for one in whole)
    return {
        "checkout": checkout.name,
        "python": platform.python_version(),
        "reading and parsing, with start, CPU s": parse,
        "only parsing, CPU s": round(parsing, 2),
        "extraction, CPU s": total,
        "extraction / parsing (at most 5)": round(total / parsing, 1),
        **{f"{stage}, CPU s": round(seconds, 2) for stage, seconds in staged["seconds"].items()},
        "peak MB (at most 350)": round(max(one["megabytes"] for one in whole)),
    }


def _parts(checkout: Path, repeat: int) -> dict[str, object]:
    parse = _least([measure(python("-c", PARSE, str(checkout))) for _ in range(repeat)], "cpu")
    program = python(str(Path(__file__).with_name("parts.py")), str(checkout))
    runs = [json.loads(measure(program).output) for _ in range(repeat)]
    best = min(runs, key=lambda run: sum(run["seconds"].values()))
    total = round(sum(best["seconds"].values()), 2)
    return {
        "checkout": checkout.name,
        "reading and parsing, with start, CPU s": parse,
        "build, CPU s": total,
        "build / parse": round(total / parse, 1),
        **{f"{part}, CPU s": round(seconds, 2) for part, seconds in best["seconds"].items()},
        "peak MB of the one process": round(max(run["megabytes"] for run in runs)),
    }


def _figures(checkout: Path, folder: Path, repeat: int) -> dict[str, object]:
    parse = [measure(python("-c", PARSE, str(checkout))) for _ in range(repeat)]
    files, size = parse[0].output.split()
    one = [_build(checkout, folder / f"one{number}", 1) for number in range(repeat)]
    two = [_build(checkout, folder / f"two{number}", 2) for number in range(repeat)]
    warm = [_build(checkout, folder / "two0", 2) for _ in range(repeat)]
    cold = [*one, *two]
    return {
        "checkout": checkout.name,
        "processors": os.cpu_count(),
        "python": platform.python_version(),
        "files of code": int(files),
        "megabytes of code": round(int(size) / 1e6, 1),
        "nodes found": json.loads(two[0].output)["counts"]["nodes"],
        "triples": json.loads(two[0].output)["counts"]["triples"],
        "parse CPU s": _least(parse, "cpu"),
        "cold build CPU s": _least(cold, "cpu"),
        "cold / parse (at most 4)": round(_least(cold, "cpu") / _least(parse, "cpu"), 2),
        "cold build, 1 worker, s": _least(one, "seconds"),
        "cold build, 2 workers, s": _least(two, "seconds"),
        "1 worker / 2 (at least 1.7)": round(_least(one, "seconds") / _least(two, "seconds"), 2),
        "warm build CPU s": _least(warm, "cpu"),
        "warm build s": _least(warm, "seconds"),
        "warm / cold CPU (at most 0.05)": round(_least(warm, "cpu") / _least(cold, "cpu"), 4),
        "warm / cold time": round(_least(warm, "seconds") / _least(two, "seconds"), 4),
        "peak MB, 1 worker": _least(one, "megabytes"),
        "peak MB, 2 workers (at most 600)": _least(two, "megabytes"),
    }


def _build(checkout: Path, store: Path, jobs: int) -> Measurement:
    command = ("-m", "kg", "--store", str(store), "build", str(checkout), "--jobs", str(jobs), "--json")
    found = measure(python(*command))
    defects = found.output.count('"KG121"')
    if defects:
        raise SystemExit(f"{defects} packages could not be read (KG121), so the figures would say nothing")
    return found


def _least(measurements: list[Measurement], what: str) -> float:
    return round(min(float(getattr(one, what)) for one in measurements), 2)


main()
