"""The one error of `kg`, its subclasses by cause, and the catalogue of codes.

Every error that reaches a person carries a code, the place it is about and the way out. The codes
stand in `CATALOGUE`, so that `kg explain KG101`, the documentation and the pages print one text.
Hundreds name the room: 0 usage and settings, 1 reading sources, 2 rules, 3 the store, 4 findings in
an architecture, 5 queries, 6 graph and ontology, 7 robots, 9 inside `kg` itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

__all__ = [
    "CATALOGUE",
    "CodeEntry",
    "Exit",
    "GraphError",
    "KgError",
    "Place",
    "QueryError",
    "SourceError",
    "StoreError",
    "UnknownNameError",
    "UsageError",
]


class Exit(IntEnum):
    """What the process returns; a contract with scripts."""

    OK = 0
    FOUND = 1
    """It worked and there is something to report, or what was asked for was not found."""
    USAGE = 2
    """The command, an option or a setting is wrong."""
    SOURCE = 3
    """A source could not be read at all."""
    STORE = 4
    """The store is missing, busy, damaged or full."""
    QUERY = 5
    """A query was refused or failed."""
    TIMEOUT = 6
    """A deadline or a limit ended the work."""
    INTERNAL = 70
    """A defect in `kg`."""
    INTERRUPTED = 130
    """Ctrl-C."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where something is: a file with an optional line and column, both counted from one.

    `excerpt` is the text of that line, for places that no file can be read for (a query typed by hand).
    """

    path: str
    line: int | None = None
    column: int | None = None
    excerpt: str | None = None

    def __str__(self) -> str:
        return ":".join(str(part) for part in (self.path, self.line, self.column) if part is not None)


@dataclass(frozen=True, slots=True)
class CodeEntry:
    """What a code means, for every face that explains it."""

    title: str
    explanation: str
    way_out: str


class KgError(Exception):
    """The base of all errors that `kg` raises on purpose.

    `code` is a key of `CATALOGUE`, `message` says what is wrong with the values in it, `place` where,
    `hint` what to do about it here and now.
    """

    exit_code: Exit = Exit.INTERNAL

    def __init__(self, code: str, message: str, *, place: Place | None = None, hint: str | None = None) -> None:
        """Raise `LookupError` for a code that the catalogue does not have."""
        if code not in CATALOGUE:
            raise LookupError(code)
        super().__init__(message)
        self.code = code
        self.message = message
        self.place = place
        self.hint = hint

    def __str__(self) -> str:
        where = f"{self.place}: " if self.place else ""
        return f"{where}{self.code}: {self.message}"


class UsageError(KgError):
    """The command line, a setting or a name typed by the user is wrong."""

    exit_code = Exit.USAGE


class UnknownNameError(UsageError):
    """What was asked for by name is not there."""

    exit_code = Exit.FOUND


class SourceError(KgError):
    """A source (folder, repository, list of sources) cannot be read at all."""

    exit_code = Exit.SOURCE


class StoreError(KgError):
    """The store is missing, held by another process, damaged, or cannot be written."""

    exit_code = Exit.STORE


class QueryError(KgError):
    """A query is malformed, refused by a guard, or failed."""

    exit_code = Exit.QUERY


class GraphError(KgError):
    """RDF that was given to `kg` (an ontology, an import) cannot be used."""

    exit_code = Exit.FOUND


CATALOGUE: dict[str, CodeEntry] = {
    "KG001": CodeEntry(
        "unknown name",
        "A node, package, query or other name is not in the store.",
        "Use one of the names suggested, or list them with `kg nodes` or `kg query --list`.",
    ),
    "KG002": CodeEntry(
        "bad setting",
        "A flag, an environment variable or a line of kg.toml has a value that cannot be used.",
        "Correct the value; `kg config show` tells where each value comes from.",
    ),
    "KG003": CodeEntry(
        "bad argument",
        "The command was called with arguments that do not go together.",
        "See the command's `--help`.",
    ),
    "KG101": CodeEntry(
        "source not found",
        "A folder, repository address or list of sources does not exist or cannot be opened.",
        "Check the path or address.",
    ),
    "KG102": CodeEntry(
        "no package",
        "Nothing below the folder looks like a ROS package: there is no package.xml.",
        "Give the `src` folder of a workspace or the root of a repository.",
    ),
    "KG103": CodeEntry(
        "checkout failed",
        "git could not clone or update a repository.",
        "Read git's message; check the network, the address and your rights.",
    ),
    "KG110": CodeEntry(
        "unreadable file",
        "A file could not be opened: its permissions, a broken link, or the disk.",
        "Mend the file or leave it; the rest was built.",
    ),
    "KG111": CodeEntry(
        "file too large",
        "A file is larger than the limit for one source file and was not read.",
        "Raise the limit with `max_file_bytes` if it really is source code.",
    ),
    "KG112": CodeEntry(
        "binary file",
        "A file with the name of a source file holds binary data.",
        "Remove or rename it; the rest was built.",
    ),
    "KG113": CodeEntry(
        "encoding",
        "A file is not UTF-8; bytes that are not were read as Latin-1.",
        "Convert the file to UTF-8.",
    ),
    "KG114": CodeEntry(
        "nested too deep",
        "A file is nested deeper than code written by people is; the part below was not read.",
        "Nothing to do unless facts are missing from that file.",
    ),
    "KG115": CodeEntry(
        "syntax error",
        "Part of a file does not parse; what could be recovered was read.",
        "Mend the file at the line given.",
    ),
    "KG116": CodeEntry(
        "malformed XML",
        "An XML file (package.xml, plugin description) is not well-formed, or uses entities, which are refused.",
        "Mend the file at the line given.",
    ),
    "KG117": CodeEntry(
        "malformed CMake",
        "A CMakeLists.txt does not parse at the line given; the commands before it were read.",
        "Mend the file at the line given.",
    ),
    "KG118": CodeEntry(
        "malformed interface definition",
        "A msg, srv or action file does not follow the grammar of interface definitions.",
        "Mend the file at the line given.",
    ),
    "KG119": CodeEntry(
        "malformed YAML",
        "A YAML file does not parse.",
        "Mend the file at the line given.",
    ),
    "KG120": CodeEntry(
        "duplicate package",
        "Two packages of one name stand in the same source; the second is kept under its folder.",
        "Remove or ignore (COLCON_IGNORE, CATKIN_IGNORE) one of them.",
    ),
    "KG121": CodeEntry(
        "extraction failed",
        "A defect in `kg` stopped the extraction of one package; the rest was built.",
        "Please report it with the message and, if you can, the package.",
    ),
    "KG122": CodeEntry(
        "too much to evaluate",
        "A CMakeLists.txt computes more than is followed while reading; what it declared until then was read.",
        "Nothing to do unless nodes of that package are missing.",
    ),
    "KG301": CodeEntry(
        "no store",
        "No store was found in this folder or the folders above it.",
        "Run `kg build FOLDER` or `kg demo`, or name the store with `--store`.",
    ),
    "KG302": CodeEntry(
        "store busy",
        "Another process is writing the store.",
        "Wait for the process named, or stop it.",
    ),
    "KG303": CodeEntry(
        "store damaged",
        "The store cannot be opened.",
        "`kg doctor` says what is wrong; `kg build` makes a new one from the sources.",
    ),
    "KG304": CodeEntry(
        "disk full",
        "The disk filled up while the store was written; the store is as it was before.",
        "Free some space and run the command again.",
    ),
    "KG305": CodeEntry(
        "store of another version",
        "The store was written by a version of `kg` with another layout.",
        "Build it again with `kg build`.",
    ),
    "KG306": CodeEntry(
        "store not writable",
        "The folder of the store cannot be written: its permissions, or a file system that is read-only.",
        "Change the permissions, or name another folder with `--store`.",
    ),
    "KG501": CodeEntry(
        "query does not parse",
        "The query is not SPARQL 1.1 at the place given.",
        "Correct the query there.",
    ),
    "KG502": CodeEntry(
        "query refused",
        "The query nests too deep or asks the store to call another server (SERVICE, LOAD).",
        "Simplify the query; calls to other servers are off.",
    ),
    "KG503": CodeEntry(
        "deadline",
        "The query ran longer than its deadline.",
        "Make the query more specific or raise `--timeout`.",
    ),
    "KG504": CodeEntry(
        "format",
        "The result cannot be written in the format asked for.",
        "Use one of the formats named.",
    ),
    "KG505": CodeEntry(
        "query parameter",
        "A stored query was called with a parameter it does not have, without one it needs, or with a bad value.",
        "`kg query NAME --help-query` lists the parameters.",
    ),
    "KG506": CodeEntry(
        "query failed",
        "The engine could not evaluate the query.",
        "Read the engine's message; `kg doctor` checks the store.",
    ),
    "KG601": CodeEntry(
        "RDF does not parse",
        "A file of RDF is not valid in the format it was read as.",
        "Mend the file at the line given or name its format.",
    ),
    "KG602": CodeEntry(
        "ontology inconsistent",
        "The reasoner found a contradiction or an unsatisfiable class in the ontologies.",
        "Read the explanation and correct the ontology.",
    ),
    "KG603": CodeEntry(
        "reasoner missing",
        "The OWL DL reasoner needs Java, which was not found.",
        "Install a Java runtime (Debian: default-jre-headless).",
    ),
    "KG604": CodeEntry(
        "shape violated",
        "Data in the store does not conform to a SHACL shape.",
        "The report names the node, the shape and the value.",
    ),
    "KG605": CodeEntry(
        "optional part missing",
        "What was asked for needs Python packages that `kg` does not install by itself.",
        "Install them: pip install 'kg-ros[ontology]'.",
    ),
    "KG900": CodeEntry(
        "defect",
        "Something happened in `kg` that should not.",
        "Please report it with what you ran.",
    ),
}
