"""Every setting of `kg`, declared once: the fields of `Settings`.

A field named `max_file_bytes` is the flag `--max-file-bytes`, the environment variable `KG_MAX_FILE_BYTES`
and the key `max_file_bytes` of `kg.toml`, which is looked for in the working folder and the folders above
it. A flag wins over the environment, that over the file, that over the default. Relative paths in a file
are relative to that file. Each value knows its origin.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from kg.errors import Place, UsageError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

__all__ = [
    "DECLARED",
    "FILE_NAME",
    "TABLES",
    "Declaration",
    "Origin",
    "Settings",
    "Table",
    "find_file",
    "load",
    "own_folder",
    "table",
    "toml_place",
    "user_paths",
]

FILE_NAME: Final = "kg.toml"
TABLES: Final = ("lint",)
"""Tables of `kg.toml` that hold no settings; `table` gives them to the room that reads them."""
_COLORS: Final = ("auto", "always", "never")


@dataclass(frozen=True, slots=True)
class Declaration:
    """What is known of a setting before it has a value.

    `read` turns what a flag, a variable or TOML holds into the value, and raises `ValueError` with a reason that
    completes "X, which is not ..."; its second argument is the folder that relative paths are relative to.
    """

    name: str
    default: Any
    read: Callable[[object, Path], Any]
    metavar: str
    sentence: str

    @property
    def flag(self) -> str:
        """The option of the command line."""
        return "--" + self.name.replace("_", "-")

    @property
    def variable(self) -> str:
        """The environment variable."""
        return "KG_" + self.name.upper()


@dataclass(frozen=True, slots=True)
class Origin:
    """Where the value of a setting comes from: `kind` is flag, environment, file or default."""

    kind: str
    place: Place | None = None
    name: str = ""

    def __str__(self) -> str:
        return str(self.place) if self.place else self.name or self.kind


_DEFAULT: Final = Origin("default")


class _FormError(ValueError):
    """A value is not of the form that its setting has; the text is that form."""


def _number(value: object, least: float) -> float:
    try:
        number = float(str(value).replace("_", ""))
    except ValueError:
        raise _FormError("a number") from None
    if isinstance(value, bool) or not least <= number < float("inf"):
        raise _FormError(f"a number of at least {least:g}")
    return number


def _seconds(value: object, _base: Path) -> float:
    return _number(value, 0)


def _silence(value: object, _base: Path) -> float:
    return _number(value, 0.1)


def _count(value: object, _base: Path) -> int:
    number = _number(value, 0)
    if number != int(number):
        raise _FormError("a whole number")
    return int(number)


def _bytes(value: object, _base: Path) -> int:
    text = str(value).strip()
    unit = {"k": 10, "m": 20, "g": 30}.get(text[-1:].lower())
    number = int(_number(text[:-1] if unit else text, 0) * (1 << (unit or 0)))
    if number < 1:
        raise _FormError("a size of at least 1 byte")
    return number


def _bytes_or_none(value: object, base: Path) -> int:
    return 0 if str(value).strip() == "0" else _bytes(value, base)


def _path(value: object, base: Path) -> Path:
    if not isinstance(value, str | Path) or not str(value).strip():
        raise _FormError("a path")
    return base / Path(value).expanduser()


def _paths(value: object, base: Path) -> tuple[Path, ...]:
    parts = [part for part in value.split(os.pathsep) if part] if isinstance(value, str) else value
    if not isinstance(parts, list | tuple):
        raise _FormError("a list of paths")
    return tuple(_path(part, base) for part in parts)


def _words(value: object, _base: Path) -> tuple[str, ...]:
    words = value.replace(",", " ").split() if isinstance(value, str) else value
    if not isinstance(words, list | tuple) or not all(isinstance(word, str) and word for word in words):
        raise _FormError("a list of words")
    return tuple(words)


def _pipeline(value: object, base: Path) -> str:
    if not isinstance(value, str):
        raise _FormError("the name or path of a spaCy pipeline")
    is_path = "/" in value or value.startswith((".", "~"))
    return str(_path(value, base)) if is_path else value.strip()


def _file(value: object, base: Path) -> str:
    return str(_path(value, base)) if value else ""


def _iri(value: object, _base: Path) -> str:
    text = str(value)
    host = text.partition("://")[2].partition("/")[0]
    if not text.startswith(("http://", "https://")) or not host or any(sign in text for sign in ' <>"{}|\\^`#?'):
        raise _FormError("an IRI that starts with http:// or https:// and has no # or ?")
    return text if text.endswith("/") else text + "/"


def _address(value: object, _base: Path) -> str:
    if not isinstance(value, str) or any(sign.isspace() for sign in value.strip()):
        raise _FormError("the address of a robot")
    return value.strip()


def _word(value: object, _base: Path) -> str:
    if not isinstance(value, str) or not value.strip():
        raise _FormError("a word")
    return value.strip().lower()


def _color(value: object, _base: Path) -> str:
    word = str(value).lower()
    if word not in _COLORS:
        raise _FormError("one of " + ", ".join(_COLORS))
    return word


def _about(read: Callable[[object, Path], Any], metavar: str, sentence: str) -> dict[str, Any]:
    return {"read": read, "metavar": metavar, "sentence": sentence}


@dataclass(frozen=True, slots=True)
class Settings:
    """The values in force, and for each its origin."""

    store: Path | None = field(
        default=None,
        metadata=_about(_path, "FOLDER", "Folder of the store; by default the nearest .kg in this folder or above."),
    )
    base: str = field(
        default="https://w3id.org/rnkg/",
        metadata=_about(_iri, "IRI", "What the IRIs of packages, nodes and topics start with."),
    )
    jobs: int = field(
        default=0,
        metadata=_about(_count, "N", "How many processes read packages at a time; 0 is one a processor."),
    )
    max_file_bytes: int = field(
        default=4 << 20,
        metadata=_about(_bytes, "SIZE", "Source files larger than this (bytes, or 500K, 4M) are reported, not read."),
    )
    memory: int = field(
        default=0,
        metadata=_about(
            _bytes_or_none, "SIZE", "Memory of a build or a run of rules, with all its processes; 0 is without limit."
        ),
    )
    nlp_model: str = field(
        default="",
        metadata=_about(
            _pipeline, "PIPELINE", "Name or path of the spaCy pipeline that tags descriptions; by default kg's own."
        ),
    )
    search_model: Path | None = field(
        default=None,
        metadata=_about(_path, "FOLDER", "Folder of a model of sentence embeddings, for searches by meaning too."),
    )
    timeout: float = field(
        default=60.0,
        metadata=_about(_seconds, "SECONDS", "How long a query may run; 0 is without end."),
    )
    limit: int = field(
        default=1000,
        metadata=_about(_count, "N", "How many rows a table shows; 0 shows all."),
    )
    format: str = field(
        default="auto",
        metadata=_about(_word, "FORMAT", "How results are written; auto is a table on a terminal and TSV elsewhere."),
    )
    color: str = field(
        default="auto",
        metadata=_about(_color, "WHEN", "Colour: auto (on a terminal, unless NO_COLOR is set), always or never."),
    )
    queries: tuple[Path, ...] = field(
        default=(),
        metadata=_about(_paths, "FOLDERS", f"Folders with stored queries of your own, joined by {os.pathsep!r}."),
    )
    rules: tuple[Path, ...] = field(
        default=(),
        metadata=_about(
            _paths,
            "FOLDERS",
            f"Folders with rules of your own, joined by {os.pathsep!r}; by default rules/ next to kg.toml or here.",
        ),
    )
    rule_families: tuple[str, ...] = field(
        default=(),
        metadata=_about(
            _words,
            "FAMILIES",
            "The families of rules in force, joined by commas; by default all but those marked optional, as owl-rl is. "
            "+FAMILY adds one to those.",
        ),
    )
    calls: tuple[Path, ...] = field(
        default=(),
        metadata=_about(
            _paths,
            "FOLDERS",
            f"Folders with descriptions of framework calls of your own, joined by {os.pathsep!r}; by default calls/ "
            "next to kg.toml or here.",
        ),
    )
    installed: tuple[Path, ...] = field(
        default=(),
        metadata=_about(
            _paths,
            "FOLDERS",
            f"Folders of installed packages that launch files may include from, joined by {os.pathsep!r}; by default "
            "those that ROS_PACKAGE_PATH and AMENT_PREFIX_PATH name.",
        ),
    )
    robot: str = field(
        default="",
        metadata=_about(
            _address,
            "ADDRESS",
            "The robot: ros1://HOST:PORT, dds://DOMAIN or zenoh://HOST:PORT; by default what ROS_MASTER_URI or "
            "ROS_DOMAIN_ID names.",
        ),
    )
    places: str = field(
        default="",
        metadata=_about(_file, "FILE", "Places that programs for robots call by their names (docs/programs.md)."),
    )
    watchdog: float = field(
        default=0.5,
        metadata=_about(
            _silence, "SECONDS", "A robot is stopped when the process that drives it sends no heartbeat for this long."
        ),
    )
    origins: Mapping[str, Origin] = field(default_factory=dict)

    def origin(self, name: str) -> Origin:
        """Return where the value of the setting `name` comes from."""
        return self.origins.get(name, _DEFAULT)

    def chosen(self) -> dict[str, Any]:
        """Return what somebody chose, the store apart, as flags that `load` in another process takes: plain values."""
        named = {one.name: value for one, value, origin in self.values() if origin.kind != _DEFAULT.kind}
        return {name: _plain(value) for name, value in named.items() if name != "store"}

    def values(self) -> Iterator[tuple[Declaration, Any, Origin]]:
        """Yield each setting with its value and origin, in the order of declaration."""
        for declaration in DECLARED.values():
            yield declaration, getattr(self, declaration.name), self.origin(declaration.name)


def _plain(value: object) -> object:
    if isinstance(value, tuple):
        return [_plain(one) for one in value]
    return value if isinstance(value, str | int | float) else str(value)


def _declarations() -> Iterator[Declaration]:
    for one in fields(Settings):
        if one.metadata:
            yield Declaration(one.name, one.default, **one.metadata)


DECLARED: Final[Mapping[str, Declaration]] = MappingProxyType({one.name: one for one in _declarations()})


@dataclass(frozen=True, slots=True)
class Table:
    """A table of `kg.toml` as it stands there, and the whole text, to find lines in."""

    file: Path
    text: str
    content: Mapping[str, Any]


def table(name: str, folder: Path) -> Table | None:
    """Return a table of the `kg.toml` in force in `folder`; None without one.

    Raises:
        UsageError: KG002 when the file cannot be read, or what has this name is no table.
    """
    file = find_file(folder)
    text, content = _parsed(file) if file else ("", {})
    if file is None or name not in content:
        return None
    if not isinstance(content[name], dict):
        place = Place(str(file), _line_of(name, text))
        raise UsageError("KG002", f"`{name}` is a table, not {content[name]!r}", place=place, hint=f"Write [{name}].")
    return Table(file, text, content[name])


def find_file(start: Path) -> Path | None:
    """Return the `kg.toml` of `start` or of the nearest folder above it."""
    return next((path for folder in (start, *start.parents) if (path := folder / FILE_NAME).is_file()), None)


def own_folder(name: str) -> Path:
    """Return the folder `name` next to the `kg.toml` in force, else in the working folder."""
    here = Path.cwd()
    file = find_file(here)
    return Path(name) if file is None or file.parent == here else file.parent / name


def user_paths(settings: Settings, name: str) -> tuple[Path, ...]:
    """Return the folders and files of the setting `name`, by default the folder of that name if it exists.

    Raises UsageError KG002 for one that the setting names and that does not exist.
    """
    default = own_folder(name)
    named: tuple[Path, ...] = getattr(settings, name) or ((default,) if default.is_dir() else ())
    for path in named:
        if not os.path.exists(path):  # noqa: PTH110 - False for what may not be looked at, where Path raises
            origin = settings.origin(name)
            message = f"{origin.name or f'the setting `{name}`'} names {path}, which is not there"
            raise UsageError("KG002", message, place=origin.place, hint=f"Name a folder of {name}, or a file.")
    return named


def load(
    flags: Mapping[str, object] | None = None,
    *,
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> Settings:
    """Return the settings in force in `folder` (default: the working folder).

    `flags` maps names of settings to what the command line gave, None where it gave nothing.
    `UsageError` KG002 names the flag, variable or line whose value cannot be used.
    """
    folder = folder or Path.cwd()
    environment = os.environ if environment is None else environment
    values: dict[str, Any] = {}
    origins: dict[str, Origin] = {}
    file = find_file(folder)
    given = [
        *(_from_file(file) if file else ()),
        *(
            (one, environment[one.variable], Origin("environment", name=one.variable), folder)
            for one in DECLARED.values()
            if environment.get(one.variable)
        ),
        *(
            (DECLARED[name], value, Origin("flag", name=DECLARED[name].flag), folder)
            for name, value in (flags or {}).items()
            if value is not None
        ),
    ]
    for declaration, value, origin, base in given:
        values[declaration.name] = _read(declaration, value, origin, base)
        origins[declaration.name] = origin
    return Settings(**values, origins=MappingProxyType(origins))


def _read(declaration: Declaration, value: object, origin: Origin, base: Path) -> object:
    try:
        return declaration.read(value, base)
    except ValueError as problem:
        raise UsageError(
            "KG002",
            f"{origin.name or declaration.name} is {value!r}, which is not {problem}",
            place=origin.place,
            hint=declaration.sentence,
        ) from None


def _from_file(file: Path) -> Iterator[tuple[Declaration, object, Origin, Path]]:
    text, content = _parsed(file)
    for name, value in content.items():
        if name in TABLES:
            continue
        place = Place(str(file), _line_of(name, text))
        if name not in DECLARED:
            from kg.similar import did_you_mean  # noqa: PLC0415 - start-up time

            hint = did_you_mean(name, DECLARED) or f"Valid settings: {', '.join(DECLARED)}."
            raise UsageError("KG002", f"unknown setting `{name}`", place=place, hint=hint)
        yield DECLARED[name], value, Origin("file", place), file.parent


@cache
def _parsed(file: Path) -> tuple[str, dict[str, Any]]:
    import tomllib  # noqa: PLC0415 - a third of a millisecond that only those with a kg.toml pay

    try:
        text = file.read_text(encoding="utf-8")
        return text, tomllib.loads(text)
    except (OSError, UnicodeDecodeError) as problem:
        raise UsageError("KG002", f"the file cannot be read: {problem}", place=Place(str(file))) from None
    except tomllib.TOMLDecodeError as problem:
        message, line, column = toml_place(str(problem))
        raise UsageError("KG002", f"this is not TOML: {message}", place=Place(str(file), line, column)) from None


def toml_place(message: str) -> tuple[str, int | None, int | None]:
    """Split a message of tomllib, "Invalid value (at line 3, column 5)", into text, line and column."""
    text, _, where = message.partition(" (at ")
    numbers = [int(word) for word in where.rstrip(")").replace(",", " ").split() if word.isdigit()]
    return text, *(numbers if len(numbers) == 2 else (None, None))  # noqa: PLR2004 - line and column


def _line_of(name: str, text: str) -> int | None:
    for number, line in enumerate(text.splitlines(), 1):
        key = line.split("=")[0].strip().strip("[]").split(".")[0].strip().strip("\"'")
        if key == name:
            return number
    return None
