"""Facts that texts give (RNKG sections 3.2.3 and 3.2.4): what people wrote about nodes and packages, and its words."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

# Imported when the module is, for property tests make facts from their annotations.
from kg.facts.places import Location  # noqa: TC001 - see above

_LONGEST: Final = 200
"""Characters of a line of a snippet."""


class DescriptionKind(StrEnum):
    """Where a description stands."""

    COMMENT = "comment"
    """A comment of C++ or Python: at the head of a file, of a class or of the main function."""
    DOCSTRING = "docstring"
    MANIFEST = "manifest"
    """The description of a package.xml."""
    README = "readme"
    """A paragraph of a README, or of another page of documentation in the package or the repository."""
    LAUNCH = "launch"
    """A comment in a launch file beside what starts the node."""
    WIKI = "wiki"
    """Markup of the ROS wiki that is kept in the repository (`#!clearsilver CS/NodeAPI`)."""
    PLUGIN = "plugin"
    """The description that a plugin file gives to a nodelet, component or plugin."""


@dataclass(frozen=True, slots=True)
class Phrase:
    """A noun phrase that a pattern found in a description.

    `text` holds its words in lower case as the dictionary has them, joined by single spaces (`laser range finder`).
    `pattern` names the pattern of `ontology/hardware-patterns.toml` that matched.
    """

    text: str
    pattern: str


@dataclass(frozen=True, slots=True)
class Description:
    """A paragraph that people wrote about a node type, or about the package where `node` is None.

    `text` is plain prose: comment signs, markup and line breaks inside of it are gone. `node` is the `NodeType.name`.
    `heading` is that of the section in which it stands. `location` is its first line. `words` and `phrases` are empty
    until the text was tagged: `words` are its nouns, proper nouns, verbs and adjectives as the dictionary has them, in
    lower case, sorted, each once.
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
    """The lines of a file that facts of a package rest on, with a few around them, as `shortened` gives them.

    `lines` are pairs of a number, counted from one, and the text, by number. `repository` is None for the source of the
    package, else the name of the other source that the file stands in.
    """

    path: str
    lines: tuple[tuple[int, str], ...]
    repository: str | None = None

    @staticmethod
    def shortened(line: str) -> str:
        """Return a line of a file as snippets have it: without blanks at its end, and cut where it is long."""
        text = line.rstrip()
        return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
