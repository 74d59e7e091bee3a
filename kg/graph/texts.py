"""What people wrote about nodes and packages becomes triples (RNKG, sections 3.2.3 and 3.2.4)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.graph import vocabulary as v
from kg.graph.ntriples import literal

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.facts import Description
    from kg.graph.scope import Scope

__all__ = ["descriptions", "terms"]

_LABEL_LENGTH: Final = 60
"""So many characters of a text stand in its label."""
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
