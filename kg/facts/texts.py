"""Facts from texts (RNKG sections 3.2.3 and 3.2.4): descriptions of nodes and packages, and their words."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

# Imported at run time: property tests create facts from their annotations.
from kg.facts.places import Location  # noqa: TC001 - see above

_LONGEST: Final = 200
"""Largest number of characters of a line in a snippet."""


class DescriptionKind(StrEnum):
    """The source of a description."""

    COMMENT = "comment"
    """A comment of C++ or Python: at the head of a file, of a class or of the main function."""
    DOCSTRING = "docstring"
    MANIFEST = "manifest"
    """The description of a package.xml."""
    README = "readme"
    """A paragraph of a README, or of another page of documentation in the package or the repository."""
    LAUNCH = "launch"
    """A comment in a launch file next to the start of the node."""
    WIKI = "wiki"
    """Markup of the ROS wiki in the repository (`#!clearsilver CS/NodeAPI`)."""
    PLUGIN = "plugin"
    """The description of a nodelet, component or plugin in a plugin file."""
    USAGE = "usage"
    """A section of the README of a package, without what describes the package or a node: topics, parameters, steps."""


@dataclass(frozen=True, slots=True)
class Phrase:
    """A noun phrase that a pattern found in a description.

    `text` contains its lemmas in lower case, separated by single spaces (`laser range finder`). `pattern` is the name
    of the pattern in `ontology/hardware-patterns.toml`.
    """

    text: str
    pattern: str


@dataclass(frozen=True, slots=True)
class Description:
    """A paragraph about a node type, or about the package if `node` is None.

    `text` is plain prose, without comment signs, markup and line breaks. `node` is the `NodeType.name`. `heading` is
    that of its section. `location` is its first line. `words` contains the lemmas of its nouns, proper nouns, verbs and
    adjectives, in lower case, sorted, without duplicates. It and `phrases` are empty before tagging, and for usage.
    """

    text: str
    kind: DescriptionKind
    location: Location
    node: str | None = None
    heading: str | None = None
    words: tuple[str, ...] = ()
    phrases: tuple[Phrase, ...] = ()


@dataclass(frozen=True, slots=True)
class Snippet:
    """Lines of a file cited by facts of a package, with a few around them, as returned by `shortened`.

    `lines` contains pairs of line number, counted from one, and text, in order. `repository` is None for the source of
    the package, else the name of another source that contains the file.
    """

    path: str
    lines: tuple[tuple[int, str], ...]
    repository: str | None = None

    @staticmethod
    def shortened(line: str) -> str:
        """Return a line of a file for a snippet: without trailing whitespace, and cut if too long."""
        text = line.rstrip()
        return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
