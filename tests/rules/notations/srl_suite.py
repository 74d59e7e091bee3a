"""The W3C's tests of SPARQL 1.2 RL, from a folder of its suite: `python -m rules.notations.srl_suite FOLDER`.

FOLDER is `shacl12-test-suite/tests/sparql-rl` of github.com/w3c/data-shapes; the suite is not part of this repository.
"""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final
from urllib.parse import unquote, urlsplit

from pyoxigraph import NamedNode, RdfFormat, Store
from rules.notations.srl_running import canonical, infer, load

from kg.errors import KgError
from kg.rules.reading import read
from kg.rules.stratify import stratify
from kg.syntax.parser import parse_srl

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

__all__ = ["Entry", "entries", "failure", "main"]

_TESTS: Final = "http://www.w3.org/ns/sparql-rl-tests#"
_ENTRIES: Final = f"""
PREFIX mf: <http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#>
PREFIX srlt: <{_TESTS}>
PREFIX rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#>
SELECT ?test ?type ?rules ?data ?result WHERE {{
  ?manifest mf:entries/rdf:rest*/rdf:first ?test .
  ?test rdf:type ?type ; mf:action ?action .
  OPTIONAL {{ ?action srlt:ruleset ?set }}
  BIND(COALESCE(?set, ?action) AS ?rules)
  OPTIONAL {{ ?action srlt:data ?data }}
  OPTIONAL {{ ?test mf:result ?result }}
}} ORDER BY STR(?rules) STR(?test)
"""


@dataclass(frozen=True)
class Entry:
    """One test of a manifest; `kind` is Syntax, WellFormedness, Stratification or Eval; `good` if it should pass."""

    name: str
    kind: str
    good: bool
    rules: Path
    data: Path | None
    result: Path | None

    @property
    def missing(self) -> list[str]:
        """The files missing from the folder."""
        return [path.name for path in (self.rules, self.data, self.result) if path and not path.exists()]


def entries(folder: Path) -> Iterator[Entry]:
    """Yield the tests of all manifests below a folder."""
    for manifest in sorted(folder.rglob("manifest*.ttl")):
        store = Store()
        text = manifest.read_text(encoding="utf-8")
        store.load(text, format=RdfFormat.TURTLE, base_iri=manifest.absolute().as_uri())
        for test, kind, *files in _rows(store):
            short = (kind or "").removeprefix(_TESTS + "Rules").removesuffix("Test")
            good = not short.startswith("Negative")
            rules, data, result = map(_path, files)
            if rules is not None:
                name = f"{manifest.parent.name}/{(test or '').rpartition('#')[2].rpartition('/')[2]} {rules.name}"
                yield Entry(name, short.removeprefix("Negative").removeprefix("Positive"), good, rules, data, result)


def _rows(store: Store) -> Iterable[list[str | None]]:
    solutions = store.query(_ENTRIES)
    for solution in solutions:  # type: ignore[union-attr]  # a SELECT has solutions
        yield [term.value if isinstance(term, NamedNode) else None for term in solution]


def _path(iri: str | None) -> Path | None:
    return Path(unquote(urlsplit(iri).path)) if iri else None


def failure(entry: Entry) -> str | None:
    """Run a test; return the reason of its failure, or None."""
    if entry.missing:
        return f"missing: {', '.join(entry.missing)}"
    if entry.kind == "Eval":
        return _evaluation(entry)
    checks: dict[str, Callable[[Path], object]] = {
        "Syntax": lambda path: parse_srl(path.read_text(encoding="utf-8"), str(path)),
        "WellFormedness": lambda path: read(path, path.stem),
        "Stratification": lambda path: stratify(read(path, path.stem).rules),
    }
    try:
        checks[entry.kind](entry.rules)
    except KgError as error:
        return str(error) if entry.good else None
    return None if entry.good else "it is accepted"


def _evaluation(entry: Entry) -> str | None:
    try:
        found = canonical(infer(entry.rules, load(entry.data) if entry.data else ()))
    except KgError as error:
        return str(error)
    wanted = canonical(load(entry.result)) if entry.result else set()
    if found == wanted:
        return None
    return "\n".join(
        [
            "",
            *(f"    + {line}" for line in sorted(found - wanted)),
            *(f"    - {line}" for line in sorted(wanted - found)),
        ]
    )


def main(arguments: Sequence[str]) -> int:
    """Run the suite of a folder, print the failures and the count of each kind; return 1 if a test fails."""
    (folder,) = arguments
    passed: Counter[str] = Counter()
    every: Counter[str] = Counter()
    for entry in entries(Path(folder)):
        why = failure(entry)
        every[entry.kind] += 1
        passed[entry.kind] += why is None
        if why is not None:
            sys.stdout.write(f"FAILED {entry.kind} {entry.name}: {why}\n")
    for kind, count in sorted(every.items()):
        sys.stdout.write(f"{kind}: {passed[kind]} / {count}\n")
    sys.stdout.write(f"all: {passed.total()} / {every.total()}\n")
    return int(passed != every)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
