"""Stored queries in files: `queries/**/*.rq` of `kg` and of the user's folders.

A file is valid SPARQL with a header of comments:

    # Publishers of a topic                                     the title
    #
    # Nodes that publish a topic, with the line of code.        the description, any number of lines
    #
    # @param topic name "/cmd_vel" the topic                    name, type, example, description

A parameter is a variable of the query with a VALUES block, `VALUES ?topic { UNDEF }`. The text between the braces is
its default; `UNDEF` makes it optional (see `kg.query.binding`). Types are `string`, `name` (a ROS name, with or without
its leading slash), `integer`, `boolean` and `iri`.

The name of a query is its path in the folder without the suffix, `explore/who-publishes`. The last part is enough if it
is unique. The folder `internal` contains queries of `kg` itself.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Final

from pyoxigraph import Literal, NamedNode, RdfFormat, parse

from kg import resources
from kg.errors import Place, QueryError, UnknownNameError, UsageError
from kg.query.binding import defaults
from kg.similar import did_you_mean
from kg.syntax.names import PREFIXES
from kg.syntax.prologue import declared

_PARAMETER = re.compile(r'@param\s+(?P<name>\w+)\s+(?P<type>\w+)\s+"(?P<example>[^"]*)"\s+(?P<description>.+)')
_TYPES: Final = ("string", "name", "integer", "boolean", "iri")
_INTERNAL: Final = "internal"


class TermText(str):
    """The value of a parameter as a term in Turtle, where any other text is a value of the parameter's type."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class QueryParameter:
    """A parameter of a stored query; `default` is SPARQL, None if the parameter is optional."""

    name: str
    type: str
    example: str
    description: str
    default: str | None

    def term(self, value: str) -> NamedNode | Literal:
        """Return the term for a text; QueryError KG505 if the text is not of the parameter's type."""
        try:
            return _TERMS[self.type](value)
        except ValueError as error:
            message = f"`{value}` is not a valid {self.type} for the parameter {self.name}"
            raise QueryError("KG505", message, hint=f'For example {self.name}="{self.example}".') from error


def _boolean(value: str) -> Literal:
    words = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}
    if value.lower() not in words:
        raise ValueError(value)
    return Literal(words[value.lower()])


_TERMS: Final[dict[str, Callable[[str], NamedNode | Literal]]] = {
    "string": Literal,
    "name": lambda value: Literal("/" + value.strip().lstrip("/")),
    "integer": lambda value: Literal(int(value)),
    "boolean": _boolean,
    "iri": NamedNode,
}


@dataclass(frozen=True, slots=True)
class StoredQuery:
    """A query with its documentation; `text` is the whole file, so line numbers in errors are those of the file."""

    name: str
    path: Path
    title: str
    description: str
    parameters: tuple[QueryParameter, ...]
    text: str

    def bind(self, values: Mapping[str, str]) -> dict[str, NamedNode | Literal]:
        """Return the terms of parameters given as text; QueryError KG505 for an unknown name or a malformed value."""
        by_name = {parameter.name: parameter for parameter in self.parameters}
        for name in values:
            if name not in by_name:
                takes = f"It takes {', '.join(by_name)}." if by_name else "It takes none."
                hint = did_you_mean(name, by_name) or takes
                raise QueryError("KG505", f"the query {self.name} has no parameter `{name}`", hint=hint)
        return {
            name: self._term(name, value) if isinstance(value, TermText) else by_name[name].term(value)
            for name, value in values.items()
        }

    def _term(self, name: str, text: str) -> NamedNode | Literal:
        term = self.read_term(text)
        if term is None:
            hint = 'Write <iri>, prefix:name, a number, true, "text", "text"@en or "text"^^xsd:date.'
            raise QueryError("KG505", f"`{text}` is not a term for ?{name}", hint=hint)
        return term

    def read_term(self, text: str) -> NamedNode | Literal | None:
        """Return the IRI or literal that `text` is in Turtle, with known prefixes and those of the query, else None."""
        prefixes = {**PREFIXES, **declared(self.text)}
        prologue = "".join(f"PREFIX {prefix}: <{iri}>\n" for prefix, iri in prefixes.items() if f"{prefix}:" in text)
        try:
            terms = [quad.object for quad in parse(f"{prologue}<urn:s> <urn:p> {text}\n.", RdfFormat.TURTLE)]
        except SyntaxError:
            return None
        only = terms[0] if len(terms) == 1 else None
        return only if isinstance(only, NamedNode | Literal) else None


def read(path: Path, name: str) -> StoredQuery:
    """Return the query in a file.

    Raises:
        QueryError: KG505 if the header describes an unknown parameter or is malformed.
        UsageError: KG001 if the file cannot be read.
    """
    try:
        text = path.read_text("utf-8-sig")
    except OSError as error:
        message = f"the query cannot be read: {error.strerror}"
        raise UsageError("KG001", message, place=Place(str(path)), hint="Check the path.") from error
    except UnicodeDecodeError as error:
        message = f"the query is not in UTF-8 at byte {error.start}"
        raise UsageError("KG001", message, place=Place(str(path)), hint="Save it in UTF-8.") from error
    header = takewhile(lambda line: line.startswith("#"), text.splitlines())
    lines = [line.removeprefix("#").strip() for line in header]
    prose = [line for line in lines if not line.startswith("@")]
    title, *description = prose or [""]
    blocks = defaults(text)
    parameters = tuple(
        _parameter(path, number, line, blocks) for number, line in enumerate(lines, 1) if line.startswith("@")
    )
    return StoredQuery(name, path, title or name, "\n".join(description).strip(), parameters, text)


def _parameter(path: Path, number: int, line: str, blocks: Mapping[str, str]) -> QueryParameter:
    match = _PARAMETER.fullmatch(line)
    place = Place(str(path), number)
    if match is None or match["type"] not in _TYPES:
        hint = f'Write: @param NAME TYPE "EXAMPLE" DESCRIPTION, with a TYPE of {", ".join(_TYPES)}.'
        raise QueryError("KG505", f"`{line}` does not describe a parameter", place=place, hint=hint)
    if match["name"] not in blocks:
        message = f"the query has no block of data for its parameter {match['name']}"
        raise QueryError("KG505", message, place=place, hint=f"Add VALUES ?{match['name']} {{ UNDEF }} to the query.")
    default = blocks[match["name"]]
    given = None if default.upper() == "UNDEF" else default
    return QueryParameter(match["name"], match["type"], match["example"], match["description"], given)


def discover(folders: Iterable[Path] = ()) -> dict[str, StoredQuery]:
    """Return the queries of `kg` and of `folders` by name, sorted; later folders take precedence."""
    return {name: read(path, name) for name, path in _files(folders).items()}


def _files(folders: Iterable[Path]) -> dict[str, Path]:
    """Return the files of queries by name, sorted; later folders take precedence."""
    paths: dict[str, Path] = {}
    for folder in (resources.folder("queries"), *folders):
        for path in folder.rglob("*.rq"):
            parts = path.relative_to(folder).with_suffix("").parts
            if parts[0] != _INTERNAL:
                paths["/".join(parts)] = path
    return dict(sorted(paths.items()))


def find(name: str, folders: Iterable[Path] = ()) -> StoredQuery:
    """Return the query with this name, or this last part of its name.

    Raises UsageError: KG001 with suggestions, or with the queries that share the last part.
    """
    files = _files(folders)
    same = [name] if name in files else [path for path in files if path.rpartition("/")[2] == name]
    if len(same) == 1:
        return read(files[same[0]], same[0])
    if same:
        names = ", ".join(same)
        raise UsageError("KG001", f"several queries are called `{name}`: {names}", hint="Give the whole name.")
    hint = did_you_mean(name, [*files, *(path.rpartition("/")[2] for path in files)])
    raise UnknownNameError("KG001", f"unknown stored query `{name}`", hint=hint or "`kg query --list` lists them.")


def internal(name: str) -> str:
    """Return the text of an internal query."""
    return (resources.folder("queries") / _INTERNAL / f"{name}.rq").read_text("utf-8")
