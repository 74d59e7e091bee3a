"""Rule files from disk: one file of any notation, all of some folders, and installed packs of rules.

By default rules are in `rules/` next to kg.toml or in the working folder.
"""

from __future__ import annotations

import filecmp
import os
import sys
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from kg.errors import Place, RuleError, UsageError
from kg.lazily import lazily
from kg.resources import folder as shipped
from kg.rules.files import NOTATIONS, Documentation, RuleFile, RuleSet, family_of, parse_header
from kg.settings import Settings, user_paths
from kg.settings import own_folder as default_folder
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping
    from importlib.metadata import EntryPoint

    from pyoxigraph import Triple

    from kg.rules.form import Rule
    from kg.syntax.tree import RuleUnit

with lazily():
    from importlib.metadata import entry_points
    from inspect import getfile

    from kg.rules.decompose import decompose
    from kg.rules.notations import shacl, srl
    from kg.syntax.parser import parse_rq, parse_srl

_NAME: Final = "rules"


def user_folders(settings: Settings) -> tuple[Path, ...]:
    """Return the folders of rules in force in addition to those that `kg` ships; the default one only if it exists.

    Raises UsageError KG002 for a folder of the setting `rules` that does not exist.
    """
    named = user_paths(settings, _NAME)
    own = shipped(_NAME).resolve()
    return tuple(folder for folder in named if folder.resolve() != own)


def own_folder(settings: Settings) -> Path:
    """Return the folder that new rules are written to, whether it exists or not."""
    return settings.rules[0] if settings.rules else default_folder(_NAME)


def families_in_force(settings: Settings) -> tuple[str, ...]:
    """Return the families that the setting `rule_families` names, as `kg.rules.reading.rule_files` takes them.

    Raises UsageError KG002 for one without rules, with suggestions.
    """
    if not settings.rule_families:
        return ()
    families = all_families(settings)
    for name in settings.rule_families:
        plain = name.removeprefix("+")
        if plain not in families:
            origin = settings.origin("rule_families")
            message = f"{origin.name or 'the setting `rule_families`'} names an unknown family of rules, `{plain}`"
            hint = did_you_mean(plain, families) or f"The families are {', '.join(families)}."
            raise UsageError("KG002", message, place=origin.place, hint=hint)
    return settings.rule_families


def all_families(settings: Settings) -> list[str]:
    """Return the names of all families, those not in force too, sorted."""
    folders = (shipped(_NAME), *(pack.folder for pack in packs()), *user_folders(settings))
    return sorted({family_of(name) for folder in folders for _, name in rule_files(folder, every=True)} - {""})


ENTRY_POINTS: Final = "kg.rules"
"""The group of entry points that name packs of rules."""

OPTIONAL: Final = "optional"
"""A file of this name in the folder of a family says, and why, that the family is in force only where it is named."""

_CACHED: Final = 512
"""So many texts of rules are kept compiled: all that a store has in force, and some edits of them."""

_TWICE: Final = (
    "Rename one: no rule takes the place of another of its name, and files of two endings share a name too. "
    "The setting `rule_families` leaves out whole families."
)
"""What to do about two files of one name."""


@dataclass(frozen=True, slots=True)
class Pack:
    """An installed pack of rules: the name of its entry point and its folder."""

    name: str
    folder: Path


def read(path: Path, name: str, *, pack: str = "") -> RuleFile:
    """Return the rule file at `path`; `name` is `family/name`, `pack` the rule pack that brings it.

    Raises RuleError: KG201 where it does not parse, KG203 where it is unsafe, KG206 for its header, KG208 for what it
    imports, KG209 and KG230 for what rules cannot do, KG231 where it cannot be read.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        hint = "Save it as UTF-8."
        raise RuleError("KG201", "the file is not UTF-8", place=Place(str(path)), hint=hint) from None
    except OSError as error:
        raise RuleError("KG231", f"the file cannot be read: {error.strerror}", place=Place(str(path))) from None
    return read_text(text, path, name, pack=pack)


def read_text(text: str, path: Path, name: str, *, pack: str = "") -> RuleFile:
    """Return the rule file that `text` would be at `path`, as an editor has it before it is saved; errors as `read`."""
    documentation = parse_header(text, str(path))
    readers = {".rq": _read_rq, ".srl": _read_srl, ".ttl": _read_ttl}
    if path.suffix not in readers:
        hint = f"The endings of rules are {', '.join(NOTATIONS)}."
        raise RuleError("KG201", f"`{path.suffix}` is not the ending of a rule", place=Place(str(path)), hint=hint)
    return replace(readers[path.suffix](text, path, name, documentation), pack=pack)


def _read_rq(text: str, path: Path, name: str, documentation: Documentation) -> RuleFile:
    rules, prefixes = _compiled_rq(text, str(path), name)
    return RuleFile(name, path, text, documentation, rules, prefixes=prefixes)


@lru_cache(maxsize=_CACHED)
def _compiled_rq(text: str, path: str, name: str) -> tuple[tuple[Rule, ...], Mapping[str, str]]:
    """Return the rules and prefixes of a text, which nothing else decides; builds that follow each other ask again."""
    unit = parse_rq(text, path)
    return decompose(unit.rules[0], name, path, text), MappingProxyType(dict(unit.prefixes))


def _read_srl(text: str, path: Path, name: str, documentation: Documentation) -> RuleFile:
    unit, own, stated = _compiled_srl(text, str(path), name)
    rules, data = list(own), list(stated)
    parts = len(unit.rules)
    for file, inner, brought in srl.imported(unit, path, text):
        rules += srl.rules(brought, name, str(file), inner, first=parts + 1)
        data += srl.data(brought, str(file), inner)
        parts += len(brought.rules)
    return RuleFile(name, path, text, documentation, tuple(rules), tuple(data), MappingProxyType(unit.prefixes))


@lru_cache(maxsize=_CACHED)
def _compiled_srl(text: str, path: str, name: str) -> tuple[RuleUnit, tuple[Rule, ...], tuple[Triple, ...]]:
    """Return the tree, the rules and the data of a text, without those of rule sets that it imports."""
    unit = parse_srl(text, path)
    return unit, tuple(srl.rules(unit, name, path, text)), tuple(srl.data(unit, path, text))


def _read_ttl(text: str, path: Path, name: str, documentation: Documentation) -> RuleFile:
    rules = shacl.rules(text, name, path)
    return RuleFile(name, path, text, documentation, rules, prefixes=shacl.prefixes(text))


def discover(
    folders: Iterable[Path],
    installed: Iterable[Pack] = (),
    families: Collection[str] = (),
    broken: list[RuleError] | None = None,
) -> RuleSet:
    """Return all rules below some folders and in some packs, sorted by name.

    The name of a file is its path below the folder without the ending. A folder may also be one file, whose name is
    that of its folder and its own. What several files import comes once, and so do copies of a file under its name.
    `families` are those in force, by default all but the optional ones.

    Raises:
        RuleError: KG207 for two files of one name, and what `read` raises; with `broken` such files are left out, and
            the errors are added to it.
    """
    files = []
    for _, _, result in read_each(folders, installed, families):
        if isinstance(result, RuleFile):
            files.append(result)
        elif result:
            if broken is None:
                raise result
            broken.append(result)
    return RuleSet(tuple(_once(sorted(files, key=lambda file: file.name))))


def read_each(
    folders: Iterable[Path], installed: Iterable[Pack] = (), families: Collection[str] = ()
) -> Iterator[tuple[Path, str, RuleFile | RuleError | None]]:
    """Yield each rule file of some packs and folders, its name, and what it has or why it is not used.

    None for a copy of one before. Raises RuleError KG231 for a folder that is not there or is closed.
    """
    paths: dict[str, Path] = {}
    for folder, pack in sources(folders, installed):
        for path, name in rule_files(folder, families):
            if name in paths:
                yield path, name, rival(path, name, paths[name])
                continue
            try:
                file = read(path, name, pack=pack)
            except RuleError as error:
                yield path, name, error
            else:
                paths[name] = path
                yield path, name, file


def sources(folders: Iterable[Path], installed: Iterable[Pack]) -> list[tuple[Path, str]]:
    """Return folders of rules in the order in which they are read, each with the name of its pack, empty for none."""
    return [*((pack.folder, pack.name) for pack in installed), *((folder, "") for folder in folders)]


def rival(path: Path, name: str, other: Path) -> RuleError | None:
    """Return KG207 about a file whose name `other` has already.

    None for a copy of it: in a checkout with an installed `kg`, every rule exists twice.
    """
    with suppress(OSError):  # a file that cannot be compared is not a copy
        if path.suffix == other.suffix and filecmp.cmp(path, other, shallow=False):
            return None
    return RuleError("KG207", f"the rule `{name}` is in {other} already", place=Place(str(path)), hint=_TWICE)


def rule_files(folder: Path, families: Collection[str] = (), *, every: bool = False) -> Iterator[tuple[Path, str]]:
    """Yield the rule files below a folder, sorted, with their names; hidden files and folders are left out.

    So are families other than `families`; without these, those that are optional. A family with a plus sign before it
    is in force beside those that otherwise are; with `every` all are. Raises RuleError KG231 for a folder that is not
    there or is closed.
    """
    if folder.is_file():
        yield folder, f"{folder.absolute().parent.name}/{folder.stem}"
        return
    if not folder.is_dir():
        hint = "Folders of rules are named by the setting `rules`."
        raise RuleError("KG231", "the folder of rules does not exist", place=Place(str(folder)), hint=hint)
    for path in sorted(_visible(folder)):
        name = path.relative_to(folder).with_suffix("").as_posix()
        if path.suffix in NOTATIONS and (every or _in_force(path, family_of(name), families)):
            yield path, name


def _visible(folder: Path) -> Iterator[Path]:
    """Yield the files below a folder that are not hidden; one that is closed raises, instead of being skipped."""
    for inner, folders, names in os.walk(folder, onerror=_closed):
        folders[:] = [name for name in folders if not name.startswith(".")]
        yield from (Path(inner, name) for name in names if not name.startswith("."))


def _closed(error: OSError) -> None:
    message = f"the folder of rules cannot be read: {error.strerror}"
    raise RuleError("KG231", message, place=Place(str(error.filename))) from error


def _in_force(path: Path, family: str, families: Collection[str]) -> bool:
    if family in families or f"+{family}" in families:
        return True
    optional = os.path.isfile(path.parent / OPTIONAL)  # noqa: PTH113 - False for what is closed, where Path raises
    return not optional and all(one.startswith("+") for one in families)


def _once(files: list[RuleFile]) -> Iterator[RuleFile]:
    """Leave out imported rules that another file has, or that an earlier one imports too."""
    owners = {file.path.resolve(): file.name for file in files}
    for file in files:
        written = str(file.path)
        brought = {rule.place.path for rule in file.rules} - {written}
        foreign = {path for path in brought if owners.setdefault(Path(path).resolve(), file.name) != file.name}
        own = tuple(rule for rule in file.rules if rule.place.path not in foreign)
        yield replace(file, rules=own) if foreign else file


def packs() -> tuple[Pack, ...]:
    """Return the installed packs, sorted by name.

    An entry point of the group `kg.rules` names a package, whose folder it is, or a function that returns the folder.
    Raises RuleError KG208 for one that cannot be loaded.
    """
    places = tuple(map(Path, sys.path))
    return tuple(sorted(map(_pack, _declared(places, tuple(map(changed_at, places)))), key=lambda pack: pack.name))


@lru_cache(maxsize=1)
def _declared(_places: tuple[Path, ...], _times: tuple[int, ...]) -> tuple[EntryPoint, ...]:
    """Return the entry points of packs, looked for again when something was installed: every package is opened."""
    return tuple(entry_points(group=ENTRY_POINTS))


def changed_at(path: Path) -> int:
    """Return when a file or folder was changed last (ns); 0 for one that is not there."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


def _pack(entry: EntryPoint) -> Pack:
    hint = f"Reinstall or remove the package that declares it: {entry.value}."
    try:
        loaded = entry.load()
        folder = Path(loaded()) if callable(loaded) else Path(getfile(loaded)).parent
    except (ImportError, AttributeError, TypeError, OSError) as error:
        message = f"the rule pack `{entry.name}` cannot be loaded: {error}"
        raise RuleError("KG208", message, place=Place(entry.value), hint=hint) from error
    if not folder.is_dir():
        message = f"the rule pack `{entry.name}` has no folder {folder}"
        raise RuleError("KG208", message, place=Place(entry.value), hint=hint)
    return Pack(entry.name, folder)
