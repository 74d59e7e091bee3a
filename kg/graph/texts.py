"""What people wrote about nodes and packages as triples (RNKG, sections 3.2.3 and 3.2.4), and read back as facts."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, Final

from kg.facts import Description, DescriptionKind, Location
from kg.graph import vocabulary as v
from kg.graph.ntriples import literal
from kg.graph.reading.queries import texts

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.graph.scope import Scope
    from kg.store.interface import Queryable

_DESCRIPTIONS: Final = """
SELECT ?node ?text ?kind ?path ?line ?heading WHERE {
  %s
  ?node rnkg:hasDescription ?said .
  ?said rnkg:text ?text ; rnkg:descriptionKind ?kind ; rnkg:path ?path ; rnkg:line ?line .
  OPTIONAL { ?said rnkg:heading ?heading }
}"""

_BEST: Final = (
    DescriptionKind.PLUGIN,
    DescriptionKind.WIKI,
    DescriptionKind.DOCSTRING,
    DescriptionKind.README,
    DescriptionKind.COMMENT,
    DescriptionKind.LAUNCH,
    DescriptionKind.MANIFEST,
    DescriptionKind.USAGE,
)
"""Kinds of descriptions, those first that describe the purpose of a node."""
SENTENCE_END: Final = re.compile(r"(?<=[^.\s]{2}[.!?])\s+(?=[A-Z])")
"""Whitespace between two sentences; abbreviations such as `e.g.` end none."""


def descriptions_of(graph: Queryable, those: str) -> Mapping[str, tuple[Description, ...]]:
    """Return the descriptions of the nodes that a pattern for ?node chooses, the best first, by IRI."""
    by_node: defaultdict[str, list[Description]] = defaultdict(list)
    for node, text, kind, path, line, heading in texts(graph, _DESCRIPTIONS % those):
        by_node[node].append(Description(text, DescriptionKind(kind), Location(path, int(line)), heading=heading))
    return {node: tuple(sorted(of_node, key=_rank)) for node, of_node in by_node.items()}


def _rank(one: Description) -> tuple[int, str, int, str]:
    return _BEST.index(one.kind), one.location.path, one.location.line, one.text


def summary(ordered: Iterable[Description]) -> str | None:
    """Return the first sentence of the first description; None without one."""
    first = next(iter(ordered), None)
    return SENTENCE_END.split(first.text, maxsplit=1)[0] if first else None


_LABEL_LENGTH: Final = 60
"""Maximum length of a label in characters."""
_LONGEST_TERM: Final = 4
"""So many words has the longest term; names of devices are no longer."""


def descriptions(scope: Scope, package: str, facts: Iterable[Description]) -> None:
    """Write the descriptions of the package with the IRI `package` and of its nodes."""
    for fact in facts:
        owner = package if fact.node is None else scope.iris.node(scope.repository, scope.package, fact.node)
        _description(scope, owner, fact)


def terms(phrase: str) -> Iterator[str]:
    """Yield the terms of a phrase: each run of one to four of its words, every one once."""
    words = phrase.split()
    runs = (
        " ".join(words[start : start + length])
        for length in range(1, min(len(words), _LONGEST_TERM) + 1)
        for start in range(len(words) - length + 1)
    )
    yield from dict.fromkeys(runs)


def _description(scope: Scope, owner: str, fact: Description) -> None:
    writer, part = scope.writer, scope.part(owner, "description", fact.kind)
    writer.add(f"<{owner}>", v.HAS_DESCRIPTION, part)
    writer.described(part, _label(fact.text), v.DESCRIPTION_CLASS)
    writer.add(part, v.DESCRIPTION_KIND, literal(fact.kind))
    writer.add(part, v.DESCRIPTION_TEXT, literal(fact.text))
    writer.text(part, v.HEADING, fact.heading)
    for word in fact.words:
        writer.text(part, v.DESCRIPTION_WORD, word)
    for phrase in fact.phrases:
        writer.once(part, v.HAS_PHRASE, _phrase(scope, phrase.text))
    scope.evidence(part, fact.location)


def _phrase(scope: Scope, text: str) -> str:
    iri, writer = f"<{scope.iris.phrase(text)}>", scope.writer
    if writer.described(iri, text, v.PHRASE):
        writer.add(iri, v.DESCRIPTION_TEXT, literal(text))
        for term in terms(text):
            writer.add(iri, v.TERM, literal(term))
    return iri


def _label(text: str) -> str:
    if len(text) <= _LABEL_LENGTH:
        return text
    return text[:_LABEL_LENGTH].rpartition(" ")[0] + " …"
