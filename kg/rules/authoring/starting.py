"""A new rule: a file that runs as it is, and examples of it that pass."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.errors import UnknownNameError, UsageError
from kg.rules.files import NOTATIONS
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.rules.authoring.library import Entry, Library


def find_rule(rules: Library, name: str) -> Entry:
    """Return the rule called `name`, whole or by its last part, or at that path.

    Raises UsageError: KG001 with suggestions, or with the rules that share the last part.
    """
    matches = _named(rules, name)
    if len(matches) == 1:
        return matches[0]
    if matches:
        names = ", ".join(file.name for file in matches)
        raise UsageError("KG001", f"several rules are called `{name}`: {names}", hint="Give the whole name.")
    raise _unknown(rules, name)


def choose(rules: Library, names: Iterable[str]) -> tuple[Entry, ...]:
    """Return the rules, families, files and folders named, each rule once; without any name those in force.

    Raises UnknownNameError: KG001 with suggestions.
    """
    wanted = list(names)
    if not wanted:
        return tuple(rules.in_force)
    chosen: dict[str, Entry] = {}
    for name in wanted:
        matches = _named(rules, name) or _below(rules, name)
        if not matches:
            raise _unknown(rules, name)
        chosen.update({file.name: file for file in matches})
    return tuple(chosen[name] for name in sorted(chosen))


def _named(rules: Library, name: str) -> list[Entry]:
    if name in rules.entries:
        return [rules.entries[name]]
    path = Path(name)
    if path.is_file():
        whole = path.resolve()
        return [one for one in rules.entries.values() if whole in {one.path.resolve(), one.examples.resolve()}]
    return [file for file in rules.entries.values() if file.name.rpartition("/")[2] == name]


def _below(rules: Library, name: str) -> list[Entry]:
    """Return the rules of a family, or those in a folder."""
    family = [file for file in rules.entries.values() if file.name.startswith(name.rstrip("/") + "/")]
    folder = Path(name).resolve()
    if family or not folder.is_dir():
        return family
    return [file for file in rules.entries.values() if file.path.resolve().is_relative_to(folder)]


def _unknown(rules: Library, name: str) -> UnknownNameError:
    names = list(rules.entries)
    lasts = (one.rpartition("/")[2] for one in names)
    hint = did_you_mean(name, [*names, *lasts, *(one.family for one in rules.entries.values())])
    return UnknownNameError("KG001", f"unknown rule `{name}`", hint=hint or "`kg rules list` lists them.")


_NAME: Final = re.compile(r"[a-z0-9][a-z0-9_-]*(/[a-z0-9][a-z0-9_-]*)+")


def start(name: str, folder: Path, notation: str = "rq") -> tuple[Path, Path]:
    """Write the rule `name` and its examples below `folder`, and return the two files.

    Raises:
        UsageError: KG003 for a name that is not `family/name`, an unknown notation, a rule that exists, and a
            folder that cannot be written.
    """
    ending = _ending(notation)
    if not _NAME.fullmatch(name):
        near = re.sub(r"[^a-z0-9/]+", "-", re.sub(r"\.(rq|ttl|srl|md)$", "", name).lower()).strip("-/")
        near = near if "/" in near else f"mine/{near}"
        hint = f"Did you mean `{near}`?" if _NAME.fullmatch(near) else "For example wiring/listens-to."
        message = (
            f"`{name}` is not a valid name of a rule; use a family and a name, of a-z, 0-9, - and _, joined by slashes"
        )
        raise UsageError("KG003", message, hint=hint)
    targets = folder / f"{name}{ending}", folder / f"{name}.md"
    existing = [path for path in (*(folder / f"{name}{each}" for each in NOTATIONS), targets[1]) if path.exists()]
    if existing:
        hint = "Choose another name, or edit that file."
        raise UsageError("KG003", f"the file {existing[0]} already exists", hint=hint)
    try:
        targets[0].parent.mkdir(parents=True, exist_ok=True)
        for path, template in zip(targets, (f"rule{ending}", "examples.md"), strict=True):
            path.write_text(_filled(template, name), encoding="utf-8")
    except OSError as error:
        message = f"{error.filename or folder} cannot be written: {error.strerror}"
        raise UsageError("KG003", message, hint="Name another folder with `--rules`.") from error
    return targets


def _ending(notation: str) -> str:
    ending = "." + notation.lower().lstrip(".")
    if ending not in NOTATIONS:
        names = [each.lstrip(".") for each in NOTATIONS]
        hint = did_you_mean(notation, names) or f"The notations are {', '.join(names)}."
        raise UsageError("KG003", f"unknown notation of rules `{notation}`", hint=hint)
    return ending


def _filled(template: str, name: str) -> str:
    family, _, last = name.rpartition("/")
    first, *rest = re.split(r"[-_]", last)
    return (
        (files("kg.rules.authoring") / "templates" / template)
        .read_text("utf-8")
        .format(
            name=name,
            title=" ".join([first.capitalize(), *rest]),
            property="".join([first if first[0].isalpha() else f"is{first}", *map(str.capitalize, rest)]),
            namespace=f"https://example.org/{family}#",
        )
    )
