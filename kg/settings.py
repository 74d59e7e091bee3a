"""Settings of `kg`, each declared once as a field of `Settings`.

A field named `max_file_bytes` is the flag `--max-file-bytes`, the environment variable `KG_MAX_FILE_BYTES`
and the key `max_file_bytes` of `kg.toml`, which is searched in the working folder and the folders above it.
Flags override the environment, which overrides the file, which overrides defaults. Relative paths in a file
are relative to that file. Each value has its origin.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from kg import forms
from kg.errors import Place, UsageError
from kg.forms import Form, FormError
from kg.lazily import lazily

with lazily():
    import tomllib

    from kg.similar import did_you_mean


__all__ = [
    "DECLARED",
    "FILE_NAME",
    "TABLES",
    "Declaration",
    "Origin",
    "Settings",
    "Table",
    "declared",
    "find_file",
    "load",
    "load_table",
    "own_folder",
    "setting",
    "table",
    "table_values",
    "toml_place",
    "user_paths",
]

FILE_NAME: Final = "kg.toml"
TABLES: Final = ("lint", "serve")
"""Tables of `kg.toml`, each with the settings of one command. `table` returns their other content."""
_OTHERS: Final = {"": TABLES, "lint": ("allow",)}
"""Keys of the top level and of tables that are not settings."""


@dataclass(frozen=True, slots=True)
class Declaration:
    """Declaration of a setting.

    `read` is the form of its values (`kg.forms`), `table` its table in `kg.toml`, "" for the top level. `option` is the
    public name if it differs from the field. A setting that is not `in_files` is only read from flags and variables:
    for example, a `kg.toml` in a checkout must not open a server.
    """

    name: str
    default: Any
    shown: str
    read: Form
    metavar: str
    sentence: str
    table: str = ""
    option: str = ""
    in_files: bool = True
    several: bool = False
    """Whether the flag may be repeated."""
    short: str = ""
    """The short flag, with its dash."""

    @property
    def key(self) -> str:
        """The key in its table of `kg.toml`."""
        return self.option or self.name

    @property
    def flag(self) -> str:
        """The flag on the command line."""
        return "--" + self.key.replace("_", "-")

    @property
    def variable(self) -> str:
        """The environment variable."""
        return "_".join(filter(None, ("KG", self.table, self.key))).upper()

    @property
    def switch(self) -> bool:
        """Whether the flag takes no value."""
        return self.default is False


@dataclass(frozen=True, slots=True)
class Origin:
    """Origin of the value of a setting: `kind` is flag, environment, file or default."""

    kind: str
    place: Place | None = None
    name: str = ""

    def __str__(self) -> str:
        return str(self.place) if self.place else self.name or self.kind


_DEFAULT: Final = Origin("default")


def setting(default: Any, read: Form, metavar: str, sentence: str, **more: Any) -> Any:
    """Return a dataclass field that declares a setting; `more` are fields of `Declaration`.

    A text as default is parsed like user input: `"4M"` for 4194304 bytes.
    """
    value = read(default, Path()) if isinstance(default, str) else default
    shown = "" if default is None or default is False or default == () else str(default)
    return field(
        default=value, metadata={"read": read, "metavar": metavar, "sentence": sentence, "shown": shown, **more}
    )


def declared(shape: type[Any], table: str = "") -> Mapping[str, Declaration]:
    """Return the settings declared by the fields of a dataclass, by name of field."""
    found = (Declaration(one.name, one.default, table=table, **one.metadata) for one in fields(shape) if one.metadata)
    return MappingProxyType({one.name: one for one in found})


@dataclass(frozen=True, slots=True)
class Settings:
    """Values of all settings with their origins."""

    store: Path | str | None = setting(
        None,
        forms.store,
        "FOLDER",
        "Folder of the store, or the address of a SPARQL server (docs/cluster.md); by default "
        "the nearest .kg in this folder or above.",
        short="-s",
    )
    base: str = setting(
        "https://w3id.org/rnkg/", forms.iri, "IRI", "What the IRIs of packages, nodes and topics start with."
    )
    jobs: int = setting(
        0, forms.whole(0), "N", "How many processes read packages at a time; 0 is one a processor.", short="-j"
    )
    cluster: str = setting(
        "",
        forms.cluster,
        "ADDRESS",
        "Read packages on a Dask cluster: tcp://HOST:PORT of its scheduler, or local[:N] for N workers here "
        "(docs/cluster.md).",
        in_files=False,
    )
    artifacts: str = setting(
        "",
        forms.folder_or_address,
        "FOLDER",
        "Where the machines of a cluster share results: a folder that all of them see, or an address that fsspec "
        "opens; by default in the store.",
        in_files=False,
    )
    max_file_bytes: int = setting(
        "4M", forms.size, "SIZE", "Source files larger than this (bytes, or 500K, 4M) are reported, not read."
    )
    memory: int = setting(
        0,
        forms.size_or_none,
        "SIZE",
        "Memory of a build or a run of rules, with all its processes; 0 is without limit.",
    )
    nlp_model: str = setting(
        "",
        forms.pipeline,
        "PIPELINE",
        "Name or path of the spaCy pipeline that tags descriptions; by default kg's own.",
    )
    timeout: float = setting(60.0, forms.number(0), "SECONDS", "How long a query may run; 0 is without end.")
    limit: int = setting(1000, forms.whole(0), "N", "How many rows a table shows; 0 shows all.", short="-n")
    format: str = setting(
        "auto", forms.word, "FORMAT", "How results are written; auto is a table on a terminal and TSV elsewhere."
    )
    color: str = setting(
        "auto",
        forms.one_of("auto", "always", "never"),
        "WHEN",
        "Colour: auto (on a terminal, unless NO_COLOR is set), always or never.",
    )
    queries: tuple[Path, ...] = setting(
        (), forms.paths, "FOLDERS", f"Folders with stored queries of your own, joined by {os.pathsep!r}."
    )
    rules: tuple[Path, ...] = setting(
        (),
        forms.paths,
        "FOLDERS",
        f"Folders with rules of your own, joined by {os.pathsep!r}; by default rules/ next to kg.toml or here.",
    )
    rule_families: tuple[str, ...] = setting(
        (),
        forms.words,
        "FAMILIES",
        "The families of rules in force, joined by commas; by default all but those marked optional, as owl-rl is. "
        "+FAMILY adds one to those.",
    )
    ontology: tuple[Path, ...] = setting(
        (),
        forms.paths,
        "FOLDERS",
        f"Folders with ontologies of your own, joined by {os.pathsep!r}; by default ontology/ next to kg.toml or here.",
    )
    calls: tuple[Path, ...] = setting(
        (),
        forms.paths,
        "FOLDERS",
        f"Folders with descriptions of framework calls of your own, joined by {os.pathsep!r}; by default calls/ "
        "next to kg.toml or here.",
    )
    installed: tuple[Path, ...] = setting(
        (),
        forms.paths,
        "FOLDERS",
        f"Folders of installed packages that launch files may include from, joined by {os.pathsep!r}; by default "
        "those that ROS_PACKAGE_PATH and AMENT_PREFIX_PATH name.",
    )
    robot: str = setting(
        "",
        forms.address,
        "ADDRESS",
        "The robot: ros1://HOST:PORT, dds://DOMAIN, rclpy://DOMAIN, zenoh://HOST:PORT, ws://HOST:PORT, or a recording, "
        "bag://FILE; by default what ROS_MASTER_URI or ROS_DOMAIN_ID names.",
    )
    places: str = setting(
        "", forms.file, "FILE", "Places that programs for robots call by their names (docs/programs.md)."
    )
    watchdog: float = setting(
        0.5,
        forms.number(0.1),
        "SECONDS",
        "A robot is stopped when the process that drives it sends no heartbeat for this long.",
    )
    origins: Mapping[str, Origin] = field(default_factory=dict)

    def origin(self, name: str) -> Origin:
        """Return the origin of the setting `name`."""
        return self.origins.get(name, _DEFAULT)

    def chosen(self) -> dict[str, Any]:
        """Return the settings that are not defaults, except the store, as plain flags for `load` in another process."""
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


DECLARED: Final = declared(Settings)


@dataclass(frozen=True, slots=True)
class Table:
    """A table of `kg.toml` before validation, and the whole text, to find lines in."""

    file: Path
    text: str
    content: Mapping[str, Any]


def table(name: str, folder: Path) -> Table | None:
    """Return a table of the `kg.toml` for `folder`; None if there is none.

    Raises:
        UsageError: KG002 if the file cannot be read, or the key is not a table.
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
    """Return the folder `name` next to the `kg.toml` that applies, else in the working folder."""
    here = Path.cwd()
    file = find_file(here)
    return Path(name) if file is None or file.parent == here else file.parent / name


def user_paths(settings: Settings, name: str) -> tuple[Path, ...]:
    """Return the folders and files of the setting `name`, by default the folder of that name if it exists.

    Raises UsageError KG002 for a path of the setting that does not exist.
    """
    default = own_folder(name)
    named: tuple[Path, ...] = getattr(settings, name) or ((default,) if default.is_dir() else ())
    for path in named:
        if not os.path.exists(path):  # noqa: PTH110 - False if unreadable, whereas Path raises
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
    """Return the settings for `folder` (default: the working folder).

    `flags` maps names of settings to values from the command line, None if absent. `UsageError` KG002 names the flag,
    variable or line with an invalid value.
    """
    values = _values(DECLARED, flags or {}, environment, folder or Path.cwd(), folder or Path.cwd())
    origins = {name: origin for name, (_, origin) in values.items()}
    return Settings(**{name: value for name, (value, _) in values.items()}, origins=MappingProxyType(origins))


def load_table(
    known: Mapping[str, Declaration],
    flags: Mapping[str, object],
    *,
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> dict[str, Any]:
    """Return the settings of a table that are not defaults, by names of fields.

    `folder` is where the search for `kg.toml` begins; paths of flags and variables are relative to the working folder.
    Otherwise as `load`.
    """
    found = _values(known, flags, environment, folder or Path.cwd(), Path())
    return {name: value for name, (value, _) in found.items()}


def table_values(known: Mapping[str, Declaration]) -> Iterator[tuple[Declaration, Any, Origin]]:
    """Yield each setting of a table with its value without flags, and its origin."""
    found = _values(known, {}, None, Path.cwd(), Path())
    for one in known.values():
        yield one, *found.get(one.name, (one.default, _DEFAULT))


def _values(
    known: Mapping[str, Declaration],
    flags: Mapping[str, object],
    environment: Mapping[str, str] | None,
    folder: Path,
    base: Path,
) -> dict[str, tuple[Any, Origin]]:
    """Return each value that is not a default with its origin; paths of flags and variables are relative to `base`."""
    environment = os.environ if environment is None else environment
    given = [
        *_from_file(known, folder),
        *(
            (one, environment[one.variable], Origin("environment", name=one.variable), base)
            for one in known.values()
            if environment.get(one.variable)
        ),
        *(
            (known[name], value, Origin("flag", name=known[name].flag), base)
            for name, value in flags.items()
            if value is not None and value != []
        ),
    ]
    return {one.name: (_read(one, value, origin, where), origin) for one, value, origin, where in given}


def _read(declaration: Declaration, value: object, origin: Origin, base: Path) -> object:
    try:
        return declaration.read(value, base)
    except FormError as problem:
        raise UsageError(
            "KG002",
            f"{origin.name or declaration.key} is {value!r}, which is not {problem}",
            place=origin.place,
            hint=declaration.sentence,
        ) from None


def _from_file(known: Mapping[str, Declaration], folder: Path) -> Iterator[tuple[Declaration, object, Origin, Path]]:
    """Yield the settings in the file, of one table or of the top level."""
    file = find_file(folder)
    if file is None:
        return
    name = next((one.table for one in known.values()), "")
    text, content = _parsed(file)
    if name:
        found = table(name, folder)
        content = dict(found.content) if found else {}
    by_key = {one.key: one for one in known.values()}
    for key, value in content.items():
        if key in _OTHERS.get(name, ()):
            continue
        place = Place(str(file), _line_of(key, text, name))
        if key not in by_key:
            hint = did_you_mean(key, by_key) or f"Valid settings: {', '.join(by_key)}."
            raise UsageError("KG002", f"unknown setting `{key}`", place=place, hint=hint)
        if not by_key[key].in_files:
            hint = f"Use {by_key[key].flag} or {by_key[key].variable}."
            raise UsageError("KG002", f"`{key}` cannot be set in a file", place=place, hint=hint)
        yield by_key[key], value, Origin("file", place), file.parent


def _parsed(file: Path) -> tuple[str, dict[str, Any]]:
    """Return the text and the parsed content of a file, cached until the file changes."""
    try:
        state = file.stat()
    except OSError as problem:
        raise _unreadable(file, problem) from None
    return _parsed_at(file, state.st_mtime_ns, state.st_ino, state.st_size)


@cache
def _parsed_at(file: Path, *_state: int) -> tuple[str, dict[str, Any]]:
    try:
        text = file.read_text(encoding="utf-8")
        return text, tomllib.loads(text)
    except (OSError, UnicodeDecodeError) as problem:
        raise _unreadable(file, problem) from None
    except tomllib.TOMLDecodeError as problem:
        message, line, column = toml_place(str(problem))
        raise UsageError("KG002", f"this is not TOML: {message}", place=Place(str(file), line, column)) from None


def _unreadable(file: Path, problem: Exception) -> UsageError:
    return UsageError("KG002", f"the file cannot be read: {problem}", place=Place(str(file)))


def toml_place(message: str) -> tuple[str, int | None, int | None]:
    """Split a message of tomllib, "Invalid value (at line 3, column 5)", into text, line and column."""
    text, _, where = message.partition(" (at ")
    numbers = [int(word) for word in where.rstrip(")").replace(",", " ").split() if word.isdigit()]
    return text, *(numbers if len(numbers) == 2 else (None, None))  # noqa: PLR2004 - line and column


def _line_of(name: str, text: str, table: str = "") -> int | None:
    """Return the line of a key, in a table of the file or before all tables, or of the header of a table."""
    inside = not table
    for number, line in enumerate(text.splitlines(), 1):
        key = line.split("=")[0].strip().strip("[]").split(".")[0].strip().strip("\"'")
        if line.lstrip().startswith("["):
            inside = key == table or not table
        if inside and key == name:
            return number
    return None
