"""Rules whose body is a cycle, over a graph in which a few nodes have very many neighbours, beside DuckDB.

Half of the edges begin or end at one of twenty hubs; the others join any two of as many nodes as there are edges by
three. DuckDB gets the same edges as a table and the same question as a join; both count the pairs that they find.
"""

from __future__ import annotations

import random
import time
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["measure"]

_HUBS: Final = 20
_EDGE: Final = "<urn:benchmark:edge>"
_QUESTIONS: Final = {
    "triangles": (
        f"?x {_EDGE} ?y . ?y {_EDGE} ?z . ?z {_EDGE} ?x",
        "SELECT DISTINCT a.s, b.o FROM e a, e b, e c WHERE a.o = b.s AND b.o = c.s AND c.o = a.s",
    ),
    "4-cycles": (
        f"?x {_EDGE} ?y . ?y {_EDGE} ?z . ?z {_EDGE} ?w . ?w {_EDGE} ?x",
        "SELECT DISTINCT a.s, b.o FROM e a, e b, e c, e d WHERE a.o = b.s AND b.o = c.s AND c.o = d.s AND d.o = a.s",
    ),
}


def measure(edges: int, folder: Path) -> dict[str, Any]:
    """Measure a graph of so many edges, print, and return the processor seconds."""
    pairs = sorted(_edges(edges))
    path = folder / f"hubs{edges}.nt"
    path.write_text("".join(f"<urn:n{one}> {_EDGE} <urn:n{other}> .\n" for one, other in pairs))
    rows: dict[str, Any] = {"edges": len(pairs)}
    for name, (body, query) in _QUESTIONS.items():
        rules = folder / name
        rules.mkdir(exist_ok=True)
        text = f"# {name}\n\nCONSTRUCT {{ ?x <urn:benchmark:{name}> ?z }} WHERE {{ {body} }}\n"
        (rules / f"{name}.rq").write_text(text)
        ours, found = _kg(path, rules)
        theirs, expected = _duckdb(pairs, query)
        if expected is not None and found != expected:
            raise SystemExit(f"{name}: {found} pairs, and {expected} by DuckDB")
        rows[name] = {"pairs": found, "kg": ours, "duckdb": theirs}
        ratio = "" if theirs is None else f", DuckDB {theirs:.3f} s, ratio {ours / theirs:.2f}"
        print(f"{len(pairs):,} edges, {name}: {found:,} pairs, kg {ours:.3f} s{ratio}")
    return rows


def _edges(number: int) -> set[tuple[int, int]]:
    chance = random.Random(number)  # noqa: S311 - to be the same each time, not to be secret
    nodes = number // 3
    found: set[tuple[int, int]] = set()
    while len(found) < number:
        one, other = chance.randrange(nodes), chance.randrange(nodes)
        if len(found) % 2:
            one, other = (chance.randrange(_HUBS), other) if chance.random() < 0.5 else (one, chance.randrange(_HUBS))  # noqa: PLR2004 - as often
        found.add((one, other))
    return found


def _kg(path: Path, rules: Path) -> tuple[float, int]:
    """Return the processor seconds of evaluation alone, and how many pairs there are."""
    from pyoxigraph import NamedNode  # noqa: PLC0415 - each engine loads its own

    from kg.rules.engine.evaluate import Program, evaluate  # noqa: PLC0415 - each engine loads its own
    from kg.rules.reading import discover  # noqa: PLC0415 - each engine loads its own
    from kg.rules.written import Written  # noqa: PLC0415 - each engine loads its own

    graph = NamedNode("urn:benchmark:graph")
    rule_set = discover([rules])
    written = Written(path.parent)
    written.load(graph.value, path.read_bytes())
    dictionary, parts = written.take([graph])
    facts = parts[graph].copy()
    begin = time.process_time()
    found = evaluate(Program(rule_set.rules), dictionary, facts)
    return time.process_time() - begin, len(found.inferred)


def _duckdb(pairs: list[tuple[int, int]], query: str) -> tuple[float | None, int | None]:
    """Return the processor seconds of the join alone, and how many pairs it finds; None without DuckDB."""
    try:
        import duckdb  # noqa: PLC0415 - may be missing
        import numpy as np  # noqa: PLC0415 - for it
    except ImportError:
        return None, None
    connection = duckdb.connect()
    table = np.array(pairs)
    connection.register("ends", {"s": table[:, 0].copy(), "o": table[:, 1].copy()})
    connection.execute("CREATE TABLE e AS SELECT * FROM ends")
    begin = time.process_time()
    connection.execute(f"SELECT count(*) FROM ({query})")  # noqa: S608 - one of those above
    (found,) = connection.fetchone()
    return time.process_time() - begin, found
