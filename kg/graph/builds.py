"""What was read when, from which commit, with which version, with what left unresolved (PROV-O)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.facts import PackageFacts, Problem, Repository, Resolution
from kg.graph import vocabulary as v
from kg.graph.ntriples import Writer, boolean, literal, moment

if TYPE_CHECKING:
    from collections.abc import Iterable
    from datetime import datetime

    from kg.graph.iris import Iris


@dataclass(frozen=True, slots=True)
class Counts:
    """How much a reading of a source found; `unresolved` counts interfaces whose name is not or partly known.

    `bounded` counts nodes at which a limit ended the reading early.
    """

    packages: int = 0
    nodes: int = 0
    interfaces: int = 0
    parameters: int = 0
    definitions: int = 0
    files: int = 0
    problems: int = 0
    unresolved: int = 0
    bounded: int = 0
    triples: int = 0


COUNTS: Final = {
    "packages": v.PACKAGES,
    "nodes": v.NODES,
    "interfaces": v.INTERFACES,
    "parameters": v.PARAMETERS,
    "definitions": v.DEFINITIONS,
    "files": v.FILES,
    "problems": v.PROBLEMS,
    "unresolved": v.UNRESOLVED,
    "bounded": v.BOUNDED,
    "triples": v.TRIPLES,
}
"""The property that holds each of `Counts`."""


@dataclass(frozen=True, slots=True)
class BuildRecord:
    """A build of one source: times with their zone, the version of `kg`, and the number of facts."""

    repository: Repository
    started: datetime
    ended: datetime
    version: str
    counts: Counts


def count(packages: Iterable[PackageFacts], problems: Iterable[Problem] = (), triples: int = 0) -> Counts:
    """Return the counts of the facts of a source; `problems` are those that belong to none of its packages."""
    listed = tuple(packages)
    nodes = [node for facts in listed for node in facts.nodes]
    interfaces = [each for node in nodes for each in node.interfaces]
    unknown = (Resolution.PARTIAL, Resolution.UNRESOLVED)
    return Counts(
        packages=len(listed),
        nodes=len(nodes),
        interfaces=len(interfaces),
        parameters=sum(len(node.parameters) for node in nodes),
        definitions=sum(len(facts.definitions) for facts in listed),
        files=sum(len(facts.files) for facts in listed),
        problems=sum(len(facts.problems) for facts in listed) + len(tuple(problems)),
        unresolved=sum(each.resolution in unknown for each in interfaces),
        bounded=sum(bool(node.bounds) for node in nodes),
        triples=triples,
    )


def build_triples(record: BuildRecord, iris: Iris) -> bytes:
    """Return the N-Triples that one build adds to the graph `builds`."""
    repository, writer = record.repository, Writer()
    subject = f"<{iris.build(repository.name, record.started.isoformat())}>"
    source = f"<{iris.repository(repository.name)}>"
    writer.described(subject, f"{repository.name} at {record.started.isoformat()}", v.ACTIVITY, v.BUILD)
    writer.add(subject, v.STARTED, moment(record.started))
    writer.add(subject, v.ENDED, moment(record.ended))
    writer.add(subject, v.USED, source)
    writer.add(subject, v.GENERATED, f"<{iris.source_graph(repository.name)}>")
    agent = f"<{iris.software('kg', record.version)}>"
    writer.described(agent, f"kg {record.version}", v.SOFTWARE_AGENT)
    writer.add(agent, v.VERSION, literal(record.version))
    writer.add(subject, v.ASSOCIATED, agent)
    writer.text(subject, v.COMMIT, repository.commit)
    writer.text(subject, v.ROOT, repository.root)
    writer.add(subject, v.DIRTY, boolean(repository.dirty))
    writer.text(subject, v.KG_VERSION, record.version)
    for name, predicate in COUNTS.items():
        writer.number(subject, predicate, getattr(record.counts, name))
    return writer.encoded()
