"""Which rules a person means: by name, by family, by the last part of a name, by file or folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from kg.errors import UnknownNameError, UsageError
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
