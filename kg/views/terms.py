"""Terms for interfaces: IRIs typed by users, and labels of things."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final
from urllib.parse import unquote

from pyoxigraph import NamedNode

from kg.errors import UsageError
from kg.graph.interfaces import SHAPES
from kg.query.rows import rows
from kg.store.terms import Term, of_spelling
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.facts import Role
    from kg.store.snapshot import EmbeddedSnapshot

_ROLES: Final = {shape.component: role for role, shape in SHAPES.items()}


def named_node(text: str) -> NamedNode:
    """Return the IRI that a text is: whole, in angle brackets, or with a known prefix; UsageError KG003 for others."""
    inner = text[1:-1] if text.startswith("<") and text.endswith(">") else text
    prefix, _, local = inner.partition(":")
    try:
        return NamedNode(PREFIXES[prefix] + local if prefix in PREFIXES and not local.startswith("//") else inner)
    except ValueError:
        hint = "Write the whole IRI, or begin with a known prefix such as rnkg:."
        raise UsageError("KG003", f"`{text}` is not an IRI", hint=hint) from None


def given_term(text: str) -> Term:
    """Return the term that N-Triples writes as `text`; UsageError KG003 where it writes none."""
    try:
        return of_spelling(text)
    except SyntaxError:
        raise UsageError("KG003", f"`{text}` is not an RDF term", hint="Use N-Triples syntax.") from None


def listing(iris: Iterable[str]) -> str:
    """Return IRIs as the rows of VALUES in SPARQL."""
    return " ".join(str(NamedNode(iri)) for iri in sorted(set(iris)))


def labels(snapshot: EmbeddedSnapshot, iris: Iterable[str]) -> dict[str, str]:
    """Return the labels of those things that have one; of several the least."""
    query = f"SELECT ?thing ?label {{ VALUES ?thing {{ {listing(iris)} }} GRAPH ?g {{ ?thing rdfs:label ?label }} }}"
    by_iri: dict[str, str] = {}
    for thing, label in rows(snapshot, query):
        by_iri[thing] = min(label, by_iri.get(thing, label))
    return by_iri


def called(snapshot: EmbeddedSnapshot, iris: Iterable[str]) -> dict[str, str]:
    """Return the label of each thing: its own, else its prefixed name, that of its whole with the part, or its IRI."""
    wanted = set(iris)
    own = labels(snapshot, wanted)
    wholes = labels(snapshot, {iri.partition("#")[0] for iri in wanted - own.keys() if "#" in iri})
    names = {}
    for iri in wanted:
        whole, _, part = iri.partition("#")
        name = shorten(iri).removeprefix("<").removesuffix(">")
        of_part = f"{wholes[whole]}#{unquote(part)}" if name == iri and whole in wholes else name
        names[iri] = own.get(iri) or of_part
    return names


def role_of(end: str) -> Role | None:
    """Return the role of a node at an interface, from the IRI of the interface (`kg.graph.iris.fragment`)."""
    return _ROLES.get(end.rpartition("#")[2].partition("/")[0])


def node_parts(node: str) -> tuple[str, str, str]:
    """Return the repository, the package and the name in the IRI of a node type, `<base>node/{...}/{...}/{...}`."""
    repository, package, name = node.partition("#")[0].partition("/node/")[2].rsplit("/", 2)
    return unquote(repository), unquote(package), unquote(name)
