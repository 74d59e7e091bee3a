"""One engine on one file of N-Triples, in a process of its own: `python engines.py ENGINE DATA OUTPUT`.

Prints JSON: `seconds` from what the engine reads (RDF files; a store that is there already) to its result, `writing`
the seconds until the result is where it belongs (a file, a graph of the store), what of these counts for each phase,
`cpu` the processor time of all threads over both, and the peak of memory in megabytes. OUTPUT gets the inferred
triples as N-Triples.
"""

from __future__ import annotations

import json
import resource
import shutil
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import rule_sets

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pyoxigraph import NamedNode

__all__ = ["ENGINES", "OWL_ENGINES"]

PEERS: Final = Path(__file__).parent / "peers"
_BASE: Final = "https://w3id.org/rnkg/"
_RNKG: Final = "https://w3id.org/rnkg/ns#"

Figures = dict[str, float]


_CPU: Final[list[float]] = []
"""The processor time at each look at the clock."""


def _now() -> float:
    _CPU.append(time.process_time())
    return time.perf_counter()


def main() -> None:
    """Run the engine that the command line names."""
    name, data, output = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    figures = {**ENGINES, **OWL_ENGINES}[name](data, output)
    figures["cpu"] = _CPU[-1] - _CPU[0]
    figures["megabytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(json.dumps(figures))


def kg_files(data: Path, output: Path) -> Figures:
    """`kg`, from a file to a file."""
    from kg.rules.running import run_files  # noqa: PLC0415 - each engine loads its own

    rules, begin = rule_sets.seventeen(), _now()
    report = run_files([data], output, rules)
    return _of_report(report, _now() - begin)


def kg_store(data: Path, output: Path) -> Figures:
    """`kg`, in a store on disk that nothing was inferred in before."""
    from kg.rules.recording import Names  # noqa: PLC0415 - each engine loads its own
    from kg.rules.running import Runner  # noqa: PLC0415 - each engine loads its own

    store = _store(data, output)
    rules, names = rule_sets.seventeen(), Names.of(_BASE, _RNKG)
    begin = _now()
    report = Runner(names, store.layout.cache).run(store, rules)
    figures = _of_report(report, _now() - begin)
    with store.read() as snapshot:
        from pyoxigraph import RdfFormat  # noqa: PLC0415 - each engine loads its own

        output.write_bytes(snapshot.dump(RdfFormat.N_TRIPLES, graph=names.inferred))
    return figures


def kg_memory(data: Path, output: Path) -> Figures:
    """`kg`, in a store of the engine in memory."""
    import pyoxigraph as ox  # noqa: PLC0415 - each engine loads its own

    from kg.rules.columns import (  # noqa: PLC0415 - each engine loads its own
        lines,
        read_columns,
        wanted,
    )
    from kg.rules.engine.evaluate import Program, evaluate  # noqa: PLC0415 - each engine loads its own
    from kg.rules.engine.terms import Dictionary  # noqa: PLC0415 - each engine loads its own
    from kg.store import bulk  # noqa: PLC0415 - each engine loads its own

    db, rules = ox.Store(), rule_sets.seventeen()
    source, inferred = ox.NamedNode(f"{_BASE}graph/source"), ox.NamedNode(f"{_BASE}graph/inferred")
    db.bulk_load(data.read_bytes(), ox.RdfFormat.N_TRIPLES, to_graph=source)

    class Memory:
        def table(self, select: str, graph: NamedNode | None) -> bytes:
            return bulk.table(lambda: db, select, graph)

        def graphs(self) -> list[NamedNode]:
            return [source]

    begin = _now()
    program = Program(rules.rules)
    dictionary = Dictionary()
    asserted = read_columns(Memory(), wanted(rules.rules), [source], dictionary)
    read = _now()
    outcome = evaluate(program, dictionary, asserted)
    evaluated = _now()
    bulk.load(lambda: db, inferred, lines(outcome.inferred, dictionary))
    end = _now()
    output.write_bytes(db.dump(format=ox.RdfFormat.N_TRIPLES, from_graph=inferred) or b"")
    return _figures(end - begin, end - evaluated, read=read - begin, evaluate=evaluated - read)


def nemo(data: Path, output: Path) -> Figures:
    """Nemo, from a file of RDF: read, reason; `writing` is its own writer."""
    import nmo_python  # noqa: PLC0415 - each engine loads its own

    text = (PEERS / "rules.rls").read_text().replace("DATA", str(data))
    text += f'@export inferred :- ntriples {{ resource = "{output.name}" }} .\n'
    begin = _now()
    engine = nmo_python.NemoEngine(nmo_python.load_string(text))
    engine.reason()
    reasoned = _now()
    engine.write_result("inferred", nmo_python.NemoOutputManager(str(output.parent), overwrite=True))
    return _figures(_now() - begin, _now() - reasoned)


def pyshacl_rules(data: Path, output: Path) -> Figures:
    """PySHACL, on a graph of rdflib that is loaded already; each rule runs for one focus node, iterated."""
    import pyshacl  # noqa: PLC0415 - each engine loads its own
    import rdflib  # noqa: PLC0415 - each engine loads its own

    graph = rdflib.Graph().parse(data, format="nt")
    shapes = rdflib.Graph().parse(data=_shapes(), format="turtle")
    before = set(graph)
    begin = _now()
    found = pyshacl.shacl_rules(graph, shacl_graph=shapes, advanced=True, iterate_rules=True)
    seconds = _now() - begin
    _write(output, (f"{s.n3()} {p.n3()} {o.n3()} ." for s, p, o in _triples(found) - before))
    return _figures(seconds, 0.0)


def _triples(found: Any) -> set[tuple[Any, Any, Any]]:
    """Return the triples of a graph, or of a data set, whose statements have a fourth part."""
    return {(statement[0], statement[1], statement[2]) for statement in found}


def _shapes() -> str:
    """Return the seventeen rules as two shapes, the second for those that need the first to be finished."""
    text = [
        "@prefix sh: <http://www.w3.org/ns/shacl#> .",
        "@prefix ros: <http://data.mksmart.org/onto-ros/class#> .",
        "<urn:p> sh:declare",
        '  [ sh:prefix "ros" ; sh:namespace "http://data.mksmart.org/onto-ros/class#"^^<urn:u> ] ,',
        f'  [ sh:prefix "rnkg" ; sh:namespace "{_RNKG}"^^<urn:u> ] .',
    ]
    for order, late in enumerate((False, True)):
        text.append(f"<urn:shape{order}> a sh:NodeShape ; sh:order {order} ; sh:targetNode ros:Node .")
        for path in sorted(rule_sets.FOLDER.glob("*.rq")):
            if (path.stem in rule_sets.LATER) == late:
                body = path.read_text().partition("CONSTRUCT")[2].replace("\\", "\\\\")
                rule = f'[ a sh:SPARQLRule ; sh:prefixes <urn:p> ; sh:construct """CONSTRUCT{body}""" ]'
                text.append(f"<urn:shape{order}> sh:rule {rule} .")
    return "\n".join(text).replace("<urn:u>", "<http://www.w3.org/2001/XMLSchema#anyURI>")


def clingo_rules(data: Path, output: Path) -> Figures:
    """Clingo, from a file of RDF; terms are numbered here, as it has none of RDF."""
    import re  # noqa: PLC0415 - each engine loads its own

    import clingo  # noqa: PLC0415 - each engine loads its own

    begin = _now()
    numbers: dict[str, int] = {}
    facts = []
    for line in data.read_text().splitlines():
        subject, predicate, target = (numbers.setdefault(term, len(numbers)) for term in line[:-2].split(" ", 2))
        facts.append(f"t({subject},{predicate},{target}).")
    terms = list(numbers)
    matches = re.compile('^"(camera|lidar|imu)_(node|driver)')

    class Functions:
        def matches(self, name: clingo.Symbol) -> clingo.Symbol:
            return clingo.Number(int(bool(matches.match(terms[name.number]))))

    control = clingo.Control(
        ["--warn=none", *(f"-c{name}={numbers.get(term, -1)}" for name, term in _CONSTANTS.items())]
    )
    control.add("base", [], "".join(facts) + (PEERS / "rules.lp").read_text())
    control.ground([("base", [])], context=Functions())
    found: list[str] = []
    with control.solve(yield_=True) as handle:
        for model in handle:
            lines = (_clingo_line(symbol, terms) for symbol in model.symbols(atoms=True))
            found = [line for line in lines if line]
    reasoned = _now()
    _write(output, found)
    return _figures(_now() - begin, _now() - reasoned)


_ROS: Final = "http://data.mksmart.org/onto-ros/class#"
_CONSTANTS: Final = {
    "type": "<http://www.w3.org/1999/02/22-rdf-syntax-ns#type>",
    **{name.lower(): f"<{_ROS}{name}>" for name in ("Publisher", "Subscriber", "Node")},
    "has_component": f"<{_ROS}hasComponent>",
    "has_message": f"<{_ROS}hasMessage>",
    "evokes": f"<{_ROS}evokes>",
    "connects_to": f"<{_RNKG}connectsTo>",
    "depends_on": f"<{_RNKG}dependsOn>",
    **{name: f"<{_RNKG}{name}>" for name in ("broader", "contains", "runs", "name", "drives", "requires")},
}
_PAIRS: Final = {
    **{name: name for name in ("publishes", "subscribes", "handles", "feeds", "reaches")},
    **{name: name for name in ("provides", "can", "needs", "lacks")},
    "has_capability": "hasCapability",
    "has_hardware": "hasHardware",
}


def _clingo_line(symbol: Any, terms: list[str]) -> str | None:
    name = symbol.name
    if name in _PAIRS:
        subject, target = symbol.arguments
        return f"{terms[subject.number]} <{_RNKG}{_PAIRS[name]}> {terms[target.number]} ."
    if name in {"sensor", "unheard"}:
        kind = "SensorNode" if name == "sensor" else "UnheardTopic"
        return f"{terms[symbol.arguments[0].number]} {_CONSTANTS['type']} <{_RNKG}{kind}> ."
    if name == "listeners":
        topic, number = (argument.number for argument in symbol.arguments)
        literal = f'"{number}"^^<http://www.w3.org/2001/XMLSchema#integer>'
        return f"{terms[topic]} <{_RNKG}subscriberCount> {literal} ."
    return None


def kg_owl(data: Path, output: Path) -> Figures:
    """`kg` with a part of OWL 2 RL, from a file to a file."""
    from kg.rules.running import run_files  # noqa: PLC0415 - each engine loads its own

    rules, begin = rule_sets.owl_rules(), _now()
    report = run_files([data], output, rules)
    return _of_report(report, _now() - begin)


def reasonable_owl(data: Path, output: Path) -> Figures:
    """Reasonable, OWL 2 RL from a file of RDF; its result is a list of triples of rdflib."""
    import reasonable  # noqa: PLC0415 - each engine loads its own

    turtle = output.with_suffix(".ttl")
    shutil.copy(data, turtle)
    begin = _now()
    reasoner = reasonable.PyReasoner()
    reasoner.load_file(str(turtle))
    found = reasoner.reason()
    seconds = _now() - begin
    given = set(data.read_text().splitlines())
    lines = (
        f"{s.n3()} {p.n3()} {o.n3()} .".replace("^^<http://www.w3.org/2001/XMLSchema#string>", "") for s, p, o in found
    )
    _write(output, (line for line in lines if line not in given))
    return _figures(seconds, 0.0)


def owlrl_owl(data: Path, output: Path) -> Figures:
    """Owlrl, OWL 2 RL on a graph of rdflib that is loaded already."""
    import owlrl  # noqa: PLC0415 - each engine loads its own
    import rdflib  # noqa: PLC0415 - each engine loads its own

    graph = rdflib.Graph().parse(data, format="nt")
    before = set(graph)
    begin = _now()
    owlrl.DeductiveClosure(owlrl.OWLRL_Semantics).expand(graph)
    seconds = _now() - begin
    _write(output, (f"{s.n3()} {p.n3()} {o.n3()} ." for s, p, o in set(graph) - before))
    return _figures(seconds, 0.0)


def _store(data: Path, output: Path) -> Any:
    from pyoxigraph import NamedNode  # noqa: PLC0415 - each engine loads its own

    from kg.store.embedded import EmbeddedStore  # noqa: PLC0415 - each engine loads its own

    store = EmbeddedStore.create(output.with_suffix(".store"))
    with store.write("benchmark") as transaction:
        transaction.replace_graphs({NamedNode(f"{_BASE}graph/source/benchmark"): [data.read_bytes()]})
    return store


def _of_report(report: Any, seconds: float) -> Figures:
    phases = report.seconds
    return _figures(seconds, phases.write, read=phases.read, evaluate=phases.evaluate)


def _figures(seconds: float, writing: float, **phases: float) -> Figures:
    return {"seconds": seconds - writing, "writing": writing, **phases}


def _write(output: Path, lines: Iterable[str]) -> None:
    output.write_text("".join(f"{line}\n" for line in lines))


ENGINES: Final[dict[str, Callable[[Path, Path], Figures]]] = {
    "kg files": kg_files,
    "kg store": kg_store,
    "kg memory": kg_memory,
    "nemo": nemo,
    "clingo": clingo_rules,
    "pyshacl": pyshacl_rules,
}
OWL_ENGINES: Final[dict[str, Callable[[Path, Path], Figures]]] = {
    "kg owl": kg_owl,
    "reasonable": reasonable_owl,
    "owlrl": owlrl_owl,
}

if __name__ == "__main__":
    main()
