"""Measures `kg` beside other rule engines on the same graph and rules, and prints one table with the ratios.

    python benchmarks/rules [--sizes 1000 10000] [--engines nemo "kg store"] [--repeat 3] [--output figures.json]
    python benchmarks/rules --write 100000 FILE        # only the graph, as N-Triples
    python benchmarks/rules --changes [--sizes 100000] # the cost of changes beside that of a full run
    python benchmarks/rules --why [--sizes 1000000]    # the cost of explanations
    python benchmarks/rules --cyclic [--sizes 60000]   # triangles and cycles of four edges, beside DuckDB
    python benchmarks/rules --equal [--sizes 400]      # a chain of owl:sameAs with the family owl-rl
    python benchmarks/rules --on-demand [--sizes 100000]  # queries on demand beside a run of the rules

Every measurement is a process of its own; of several the smallest time counts, since whatever else the machine does
only adds. All engines have to infer the same triples: what each inferred is compared by a digest over its sorted lines.
A peer that is not installed is left out, and so is one that takes too long for a size (`LARGEST`).
"""

from __future__ import annotations

import argparse
import hashlib
import json
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import changing
import cyclic
import demanding
import equal
import explaining
import generating
from engines import ENGINES, OWL_ENGINES

LARGEST: Final = {"pyshacl": 10_000, "owlrl": 10_000, "clingo": 1_000_000}
"""The largest graph that an engine is measured on, where that is not any."""

MODULES: Final = {"nemo": "nmo_python"}
"""The module that an engine needs, where its name is another."""


def main() -> None:
    """Read the command line, measure, print, write."""
    options = _options()
    if options.write:
        generating.write(Path(options.write[1]), int(options.write[0]))
        return
    with tempfile.TemporaryDirectory(prefix="kg-benchmark-") as folder:
        if options.on_demand:
            rows = [demanding.measure(size, Path(folder)) for size in options.sizes]
        elif options.cyclic:
            rows = [cyclic.measure(size, Path(folder)) for size in options.sizes]
        elif options.equal:
            rows = [equal.measure(size, Path(folder)) for size in options.sizes]
        elif options.why:
            rows = [explaining.measure(size, Path(folder)) for size in options.sizes]
        elif options.changes:
            rows = [changing.measure(size, Path(folder)) for size in options.sizes]
        else:
            rows = [row for size in options.sizes for row in _size(size, Path(folder), options)]
    if options.output:
        options.output.write_text(json.dumps(rows, indent=2) + "\n")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=[1_000, 10_000, 100_000], help="triples of the graphs")
    parser.add_argument("--engines", nargs="+", default=[*ENGINES, *OWL_ENGINES], help="which ones")
    parser.add_argument("--repeat", type=int, default=3, help="how often each is measured")
    parser.add_argument("--output", type=Path, help="a file for the figures, as JSON")
    parser.add_argument("--write", nargs=2, metavar=("SIZE", "FILE"), help="only write the graph of a size")
    parser.add_argument("--changes", action="store_true", help="measure changes instead")
    parser.add_argument("--why", action="store_true", help="measure explanations instead")
    parser.add_argument("--on-demand", action="store_true", help="measure queries that derive what they need instead")
    parser.add_argument("--cyclic", action="store_true", help="measure bodies that are cycles instead")
    parser.add_argument("--equal", action="store_true", help="measure chains of equal terms instead")
    return parser.parse_args()


def _size(size: int, folder: Path, options: argparse.Namespace) -> list[dict[str, Any]]:
    """Measure all engines on one size, print the table of it."""
    plain, with_schema = folder / f"{size}.nt", folder / f"{size}.owl.nt"
    generating.write(plain, size)
    with_schema.write_text("".join(generating.schema()) + plain.read_text())
    rows = []
    for engines, data, base in ((ENGINES, plain, "nemo"), (OWL_ENGINES, with_schema, "reasonable")):
        chosen = [name for name in engines if name in options.engines and _possible(name, size)]
        found = [_engine(name, data, folder, size, options.repeat) for name in chosen]
        _print(found, base)
        rows += found
    return rows


def _possible(name: str, size: int) -> bool:
    module = MODULES.get(name, name.split(" ", maxsplit=1)[0])
    return find_spec(module) is not None and size <= LARGEST.get(name, size)


def _engine(name: str, data: Path, folder: Path, size: int, repeat: int) -> dict[str, Any]:
    output = folder / "inferred.nt"
    runs = []
    for number in range(repeat):
        here = folder / f"{name}{size}{number}".replace(" ", "")
        here.mkdir()
        output = here / "inferred.nt"
        command = [sys.executable, str(Path(__file__).parent / "engines.py"), name, str(data), str(output)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise SystemExit(f"{name} on {size} triples ended with {done.returncode}:\n{done.stderr}")
        runs.append(json.loads(done.stdout.splitlines()[-1]))
    best = min(runs, key=lambda run: run["seconds"] + run["writing"])
    lines = _canonical(output)
    digest = hashlib.blake2b("\n".join(lines).encode(), digest_size=8).hexdigest()
    return {"engine": name, "asserted": size, "inferred": len(lines), "digest": digest, **best}


def _canonical(path: Path) -> list[str]:
    """Return the lines of what was inferred, sorted; Nemo says `xsd:int` for what it counts, the others `xsd:integer`.

    Of what OWL 2 RL gives, statements that hold of every term or of every graph are left out, as that things are
    themselves, or are things; and domains and ranges (only owlrl has scm-dom2 and scm-rng2).
    """
    lines = {line.replace("XMLSchema#int>", "XMLSchema#integer>") for line in path.read_text().splitlines()}
    return sorted(line for line in lines if not _says_nothing(line))


def _says_nothing(line: str) -> bool:
    subject, predicate, target = line[:-2].split(" ", 2)
    if subject.startswith(("<http://www.w3.org/", '"', "_:")) or "owl#" in predicate + target:
        return True
    if predicate.endswith(("schema#domain>", "schema#range>")):
        return True
    return subject == target or (target.startswith("<http://www.w3.org/") and predicate.endswith("#type>"))


def _print(rows: list[dict[str, Any]], base: str) -> None:
    reference = next((row for row in rows if row["engine"] == base), None)
    digests = {row["digest"] for row in rows}
    if rows:
        print(f"\n{rows[0]['asserted']:,} triples; all infer the same: {'yes' if len(digests) == 1 else digests}")
        print("ratios: the time to the result, that with writing, and the processor time, each by that of", base)
        print(f"{'engine':12} {'inferred':>10} {'result s':>9} {'writing s':>9} {'CPU s':>8}  ratios {'B/triple':>20}")
    for row in rows:
        ratios = "".join(
            f"{one / other:7.2f}" for one, other in zip(_times(row), _times(reference or row), strict=True)
        )
        size = row["megabytes"] * 1e6 / (row["asserted"] + row["inferred"])
        print(
            f"{row['engine']:12} {row['inferred']:>10,} {row['seconds']:>9.3f} {row['writing']:>9.3f} "
            f"{row['cpu']:>8.3f} {ratios} {size:>6.0f}"
        )


def _times(row: dict[str, Any]) -> tuple[float, float, float]:
    return row["seconds"], row["seconds"] + row["writing"], row["cpu"]


main()
