"""A source, and each of its packages with all that was read of it, become the triples of the source's graph."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final

from kg.graph import vocabulary as v
from kg.graph.definitions import definition
from kg.graph.nodes import Stated, node
from kg.graph.ntriples import boolean, integer, literal
from kg.graph.scope import Scope
from kg.graph.snippets import snippets
from kg.graph.texts import descriptions
from kg.resources import table_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.facts import Package, PackageFacts, Person, Problem, Repository, SourceFile
    from kg.graph.iris import Iris


@cache
def _table() -> dict[str, str]:
    listed = table_of("ontology", "licenses.toml")
    licences = {
        key(name): f"{listed['base']}{identifier}" for identifier, names in listed["names"].items() for name in names
    }
    return licences | {key(identifier): f"{listed['base']}{identifier}" for identifier in listed["names"]}


def key(name: str) -> str:
    """Return `name` without what spellings of the same licence differ in: case, punctuation and spaces."""
    return "".join(character for character in name.casefold() if character.isalnum() or character == "+")


def spdx(name: str) -> str | None:
    """Return the IRI of the SPDX licence of `name`, None if it is ambiguous (`BSD`)."""
    return _table().get(key(name))


_ADDRESSES: Final = {"website": v.WEBSITE, "repository": v.CODE_REPOSITORY, "bugtracker": v.BUG_TRACKER}
_ROLES: Final = {"maintainer": v.MAINTAINER, "author": v.AUTHOR}


def package_triples(facts: PackageFacts, iris: Iris) -> bytes:
    """Return the N-Triples of one package: the same bytes for the same facts; a source's graph is their union."""
    return package_parts(facts, iris)[0]


def package_parts(facts: PackageFacts, iris: Iris) -> tuple[bytes, tuple[Stated, ...]]:
    """Return the N-Triples of one package, and its node types with the IRIs that they have there."""
    scope = Scope(iris, facts.repository, facts.package.name)
    iri = iris.package(facts.repository, facts.package.name)
    subject = f"<{iri}>"
    scope.writer.add(f"<{iris.repository(facts.repository)}>", v.CONTAINS, subject)
    _manifest(scope, subject, facts.package)
    for person in facts.package.people:
        _person(scope, subject, person)
    for dependency in facts.package.dependencies:
        part, name = scope.part(iri, dependency.kind, dependency.name), _package_name(scope, dependency.name)
        writer = scope.writer
        writer.once(f"<{iri}>", v.DEPENDS_ON, name)
        writer.add(f"<{iri}>", v.HAS_DEPENDENCY, part)
        writer.add(part, v.TYPE, v.DEPENDENCY)
        writer.add(part, v.ON_PACKAGE, name)
        writer.add(part, v.DEPENDENCY_KIND, literal(dependency.kind))
        writer.add(part, v.LINE, integer(dependency.line))
    for file in facts.files:
        _file(scope, subject, file)
    for each in facts.definitions:
        definition(scope, subject, each)
    for program in facts.programs:
        scope.writer.text(subject, v.INSTALLS, program)
    stated = tuple(node(scope, subject, each_node) for each_node in facts.nodes)
    descriptions(scope, iri, facts.descriptions)
    snippets(scope, iri, facts.snippets)
    for each_problem in facts.problems:
        problem(scope, iri, each_problem)
    return scope.writer.encoded(), stated


def _manifest(scope: Scope, subject: str, fact: Package) -> None:
    writer = scope.writer
    writer.described(subject, fact.name, v.PACKAGE, v.RNKG_PACKAGE, v.SOURCE_CODE)
    writer.add(subject, v.NAME, literal(fact.name))
    writer.add(subject, v.ROS_VERSION, integer(fact.ros))
    writer.text(subject, v.VERSION, fact.version)
    writer.text(subject, v.DESCRIPTION, fact.description)
    writer.number(subject, v.MANIFEST_FORMAT, fact.format)
    writer.text(subject, v.BUILD_TYPE, fact.build_type)
    writer.text(subject, v.DEPRECATED, fact.deprecated)
    writer.text(subject, v.FOLDER, fact.path)
    writer.add(subject, v.HAS_PACKAGE_NAME, _package_name(scope, fact.name))
    scope.evidence(subject, fact.location)
    for kind, url in fact.urls:
        writer.once(subject, _ADDRESSES.get(kind, v.WEBSITE), literal(url))
    for name in fact.licenses:
        writer.once(subject, v.LICENSE_NAME, literal(name))
        identifier = spdx(name)
        if identifier:
            writer.once(subject, v.LICENSE, f"<{identifier}>")


def _package_name(scope: Scope, name: str) -> str:
    iri = f"<{scope.iris.package_name(name)}>"
    scope.writer.described(iri, name, v.PACKAGE_NAME_CLASS)
    return iri


def _person(scope: Scope, subject: str, fact: Person) -> None:
    iri = f"<{scope.iris.person(fact.email or scope.repository, fact.name)}>"
    writer = scope.writer
    writer.once(subject, _ROLES.get(fact.role, v.AUTHOR), iri)
    if writer.described(iri, fact.name, v.PERSON):
        writer.add(iri, v.NAME, literal(fact.name))
        writer.text(iri, v.EMAIL, fact.email)


def _file(scope: Scope, package: str, fact: SourceFile) -> None:
    iri, writer = scope.file(fact.path), scope.writer
    writer.add(package, v.CONTAINS, iri)
    writer.add(iri, v.FILE_KIND, literal(fact.kind))
    writer.add(iri, v.BYTES, integer(fact.bytes))
    writer.add(iri, v.DIGEST, literal(fact.digest))
    writer.text(iri, v.CONTENT, fact.text)


def problem(scope: Scope, owner: str, fact: Problem) -> None:
    """Write something wrong in the sources of `owner`, the IRI of a package or of a repository."""
    part, writer = scope.part(owner, "problem", fact.path), scope.writer
    writer.add(f"<{owner}>", v.HAS_PROBLEM, part)
    writer.add(part, v.TYPE, v.PROBLEM)
    writer.add(part, v.CODE, literal(fact.code))
    writer.add(part, v.TEXT, literal(fact.message))
    writer.add(part, v.PATH, literal(fact.path))
    writer.add(part, v.DECLARED_IN, scope.file(fact.path))
    writer.number(part, v.LINE, fact.line)


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
