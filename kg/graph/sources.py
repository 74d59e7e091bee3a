"""The graph of one source: the repository itself and its packages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.graph import vocabulary as v
from kg.graph.ntriples import boolean, literal
from kg.graph.packages import package_triples, problem
from kg.graph.scope import Scope

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.facts import PackageFacts, Problem, Repository
    from kg.graph.iris import Iris


def repository_triples(repository: Repository, iris: Iris, problems: Iterable[Problem] = ()) -> bytes:
    """Return the N-Triples about a source itself; `problems` are those that belong to none of its packages."""
    scope = Scope(iris, repository.name, "")
    iri, writer = iris.repository(repository.name), scope.writer
    subject = f"<{iri}>"
    writer.described(subject, repository.name, v.REPOSITORY, v.SOURCE_CODE)
    writer.add(subject, v.NAME, literal(repository.name))
    writer.text(subject, v.COMMIT, repository.commit)
    writer.text(subject, v.BRANCH, repository.branch)
    writer.text(subject, v.REMOTE, repository.remote)
    writer.add(subject, v.DIRTY, boolean(repository.dirty))
    for each in problems:
        problem(scope, iri, each)
    return writer.encoded()


def source_triples(
    repository: Repository, packages: Iterable[PackageFacts], iris: Iris, problems: Iterable[Problem] = ()
) -> bytes:
    """Return the N-Triples of the whole graph of a source, the same bytes for the same facts in the same order."""
    return b"".join(
        (repository_triples(repository, iris, problems), *(package_triples(each, iris) for each in packages))
    )
