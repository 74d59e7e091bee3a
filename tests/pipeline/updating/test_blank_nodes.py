"""Property test: inferences refer to the blank nodes of the store, after any changes."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from hypothesis import given, settings
from hypothesis import strategies as st
from patience import examples
from pipeline.updating.changing import INFERRED, PREFIX, bench
from pyoxigraph import NamedNode

from kg.pipeline.inferring import Inference, run_on_store
from kg.pipeline.updating.restoring import restore
from kg.store.backups import back_up

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pipeline.updating.changing import Bench

Pair = tuple[str, str]
Step = tuple[str, str, list[Pair]]

CHAINS = st.tuples(st.integers(0, 3), st.integers(1, 20))
EDGES = CHAINS.map(lambda chain: [(f"_:b{one}", f"_:b{one + 1}") for one in range(chain[0], sum(chain))])
"""The closure of a chain is far larger than the chain, so a run may replace most of a store, or little."""
STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("graph"), st.sampled_from(["g", "h"]), EDGES),
        st.tuples(st.just("import"), st.sampled_from(["g", "h"]), EDGES),
        st.tuples(st.just("insert"), st.just(""), EDGES),
        st.sampled_from([("head", name, []) for name in ("within", "inside")]),
        st.sampled_from([("full", "", []), ("move", "", []), ("restore", "copy", []), ("restore", "copy.nq", [])]),
    ),
    min_size=1,
    max_size=5,
)


def lines(edges: Iterable[Pair]) -> bytes:
    """Return edges as N-Triples."""
    return "".join(f"{one} <urn:test:partOf> {other} .\n" for one, other in edges).encode()


def write_rule(here: Bench, head: str) -> None:
    """Write a rule that infers the closure, with this predicate."""
    rule = f"CONSTRUCT {{ ?x :{head} ?y }} WHERE {{ ?x :partOf+ ?y }}"
    (here.store.layout.root.parent / "rules" / "mine" / "within.rq").write_text(PREFIX + rule)


def change(here: Bench, kind: str, name: str, edges: list[Pair]) -> None:
    """Change a store in one way, including its inferences."""
    folder = here.store.layout.root.parent
    match kind:
        case "graph" | "import":
            inference, graph = Inference(here.store, here.settings), NamedNode(f"urn:test:{name}")
            with here.store.write("test") as transaction:
                if kind == "graph":
                    transaction.replace_graphs({graph: [lines(edges)]})
                else:
                    for file in (folder / "a.nt", folder / "b.nt"):
                        file.write_bytes(lines(edges))
                        transaction.load_file(file, graph=graph)
                inference.run(transaction)
                inference.remember(transaction.commit())
        case "insert":
            stated = " . ".join(f"{one} :partOf {other}" for one, other in [("?x", edges[0][0]), *edges])
            where = "SELECT ?x { GRAPH :h { ?x ?p ?y } } LIMIT 1"
            here.update(f"INSERT {{ GRAPH :g {{ {stated} }} }} WHERE {{ {where} }}")
        case "move":
            here.update("MOVE SILENT :g TO :h")
        case "head":
            write_rule(here, name)
            run_on_store(here.settings)
        case "full":
            run_on_store(here.settings, full=True)
        case _:
            target = folder / f"{len(list(folder.iterdir()))}-{name}"
            back_up(here.store.layout, target)
            here.update("CLEAR SILENT GRAPH :g")
            restore(here.store, target)
            run_on_store(here.settings)


def pairs(here: Bench, predicate: str, graph: str) -> set[Pair]:
    """Return the pairs of terms with a predicate in a graph."""
    found = (line.split(" ") for line in here.lines(graph))
    return {(cells[0], cells[2]) for cells in found if cells[1] == f"<urn:test:{predicate}>"}


def closed(edges: set[Pair]) -> set[Pair]:
    """Return the transitive closure."""
    found = set(edges)
    while further := {(x, z) for x, y in found for other, z in edges if other == y} - found:
        found |= further
    return found


@given(EDGES, EDGES, STEPS)
@settings(deadline=None, max_examples=examples(3, 12))
def test_what_is_inferred_names_the_nodes_of_the_store(
    first: list[Pair], second: list[Pair], steps: list[Step]
) -> None:
    """Inferred triples are the closure of the asserted ones, term by term, after changes of any kind and size."""
    with tempfile.TemporaryDirectory() as folder:
        here = bench(Path(folder))
        head = "within"
        write_rule(here, head)
        for kind, name, edges in [("graph", "g", first), ("graph", "h", second), *steps]:
            change(here, kind, name, edges)
            head = name if kind == "head" else head
            asserted = pairs(here, "partOf", "<urn:test:g>") | pairs(here, "partOf", "<urn:test:h>")
            assert pairs(here, head, INFERRED) == closed(asserted) - pairs(here, head, "<urn:test:g>")
