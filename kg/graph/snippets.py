"""Lines of code on their way into the graph and out of it: one literal for each file that a package has facts from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.graph import vocabulary as v
from kg.graph.iris import DEFAULT_BASE, Iris
from kg.graph.ntriples import literal
from kg.graph.reading.queries import column

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.facts import Snippet
    from kg.graph.scope import Scope
    from kg.store.interface import Queryable

_BETWEEN: Final = ": "
_REPOSITORY: Final = "SELECT ?iri { ?iri a rnkg:Repository ; rnkg:name %s }"
_LINES: Final = "SELECT ?lines { ?snippet rnkg:quotes <%s> ; rnkg:quotedLines ?lines }"


def snippets(scope: Scope, package: str, lines: Iterable[Snippet]) -> None:
    """Write the snippets of a package, by its IRI: they are parts of it, so its change changes no others."""
    writer = scope.writer
    for one in lines:
        part = scope.part(package, "snippet", one.path)
        writer.add(f"<{package}>", v.HAS_SNIPPET, part)
        writer.add(part, v.TYPE, v.SNIPPET)
        writer.add(part, v.QUOTES, scope.file(one.path, one.repository))
        writer.add(part, v.QUOTED_LINES, literal("\n".join(f"{number}{_BETWEEN}{text}" for number, text in one.lines)))


def quoted_lines(graph: Queryable, repository: str, path: str) -> Mapping[int, str]:
    """Return the lines of a file that the snippets of all packages have, by number; none for an unknown source."""
    iri = min(column(graph, _REPOSITORY % literal(repository)), default=None)
    if iri is None:
        return {}
    default = Iris(DEFAULT_BASE)
    base = iri.removesuffix(default.repository(repository).removeprefix(DEFAULT_BASE))
    lines: dict[int, str] = {}
    for quoted in column(graph, _LINES % Iris(base).file(repository, path)):
        for line in quoted.split("\n"):
            number, _, text = line.partition(_BETWEEN)
            lines[int(number)] = text
    return lines
