"""Start of `kg shell`: it checks for a terminal and a store first, and reads the user's keys.

keys.toml has a table for each context of the registry of actions (`kg.shell.actions`):

    [main]
    run = "F5 Ctrl+Enter"

    [results]
    export = "x"

The keys of an action replace those of the registry.
"""

from __future__ import annotations

import os
import sys
import tomllib
import unicodedata
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from textual.keys import Keys

from kg.errors import Place, StoreError, UsageError
from kg.lazily import lazily
from kg.shell.actions import ACTIONS, CONTEXTS, TOGETHER, Action, key_named, key_words
from kg.similar import did_you_mean
from kg.store.following import Following
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kg.settings import Settings

with lazily():
    from kg.shell.app import Shell

_TYPING: Final = frozenset({"everywhere", "main", "editor", "find", "list"})
"""Contexts with text input, where a single character cannot be a key."""
_MODIFIERS: Final = frozenset({"ctrl", "alt", "shift", "super", "hyper", "meta"})
_NAMES: Final = frozenset(key.value for key in Keys)


def keys_file() -> Path:
    """Return the file of keys below `$XDG_CONFIG_HOME` or `~/.config`; it may not exist."""
    given = Path(os.environ.get("XDG_CONFIG_HOME", ""))
    return (given if given.is_absolute() else Path.home() / ".config") / "kg" / "keys.toml"


def chosen_actions(path: Path) -> tuple[Action, ...]:
    """Return the actions with the keys of a file; those of the registry without one.

    Raises UsageError: KG554 an unreadable file, an unknown action or key, an ambiguous key.
    """
    try:
        given = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return ACTIONS
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise _wrong(path, f"the file of keys cannot be read: {error}") from None
    keys = dict(_pairs(given, path))
    actions = tuple(replace(one, keys=keys.get(one.identity, one.keys)) for one in ACTIONS)
    for contexts in TOGETHER:
        uses = Counter(key for one in actions if one.context in contexts for key in one.keys)
        for key in (key for key, number in uses.items() if number > 1):
            names = " and ".join(one.identity for one in actions if one.context in contexts and key in one.keys)
            raise _wrong(path, f"the key {key_words(key)} would mean {names}", "Give one of them another key.")
    return actions


def _pairs(given: Mapping[str, Any], path: Path) -> Iterator[tuple[str, tuple[str, ...]]]:
    identities = [action.identity for action in ACTIONS]
    for context, table in given.items():
        if context not in CONTEXTS or not isinstance(table, dict):
            hint = did_you_mean(context, CONTEXTS) or f"The tables are {', '.join(CONTEXTS)}."
            raise _wrong(path, f"`{context}` is not a table of keys", hint)
        for name, words in table.items():
            identity = f"{context}.{name}"
            if identity not in identities:
                ours = ", ".join(one.name for one in ACTIONS if one.context == context)
                raise _wrong(
                    path, f"`{identity}` is not an action", did_you_mean(identity, identities) or f"It has {ours}."
                )
            if not isinstance(words, str) or not words.split():
                raise _wrong(
                    path, f"the keys of `{identity}` are not text", 'Write them with blanks between: "F5 Ctrl+J".'
                )
            yield identity, tuple(_key(one, context, path) for one in words.split())


def _key(words: str, context: str, path: Path) -> str:
    key = key_named(words)
    *modifiers, last = key.split("+")
    if not _MODIFIERS.issuperset(modifiers) or not (len(last) == 1 or last in _NAMES or _is_character(last)):
        raise _wrong(path, f"`{words}` is not a key", "Keys are written as F1 in the shell shows them: F5, Ctrl+J, n.")
    if context in _TYPING and not set(modifiers) - {"shift"} and (len(last) == 1 or _is_character(last)):
        raise _wrong(path, f"`{words}` is text where something is typed", "Take it with Ctrl or Alt, or a key as F6.")
    return key


def _is_character(name: str) -> bool:
    """Return whether a name is that of a character, in textual's notation of punctuation."""
    try:
        unicodedata.lookup(name.replace("_", " "))
    except KeyError:
        return False
    return True


def _wrong(path: Path, message: str, hint: str = "") -> UsageError:
    return UsageError("KG554", message, place=Place(str(path)), hint=hint or None)


def run(settings: Settings) -> int:
    """Run the shell until the user exits; return the exit code.

    Raises:
        UsageError: KG550 no terminal, KG554 an invalid file of keys.
        StoreError: KG301 no store, or an empty one.
    """
    layout = layout_of(settings)
    if layout.address is not None:
        Following(layout).check()
    if layout.current() is None:
        raise StoreError("KG301", f"the store {layout.root} is empty", hint="Run `kg build FOLDER` first.")
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        hint = "In scripts ask with `kg shell --once 'QUERY'`, or with `kg query`."
        raise UsageError("KG550", "the shell needs a terminal, but standard input or output is not one", hint=hint)

    shell = Shell(settings, layout, actions=chosen_actions(keys_file()))
    shell.run()
    return shell.return_code or 0
