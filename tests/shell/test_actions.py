from __future__ import annotations

import inspect
from importlib import import_module
from typing import Any, Final

import pytest
from repository import ROOT

from kg.shell.actions import ACTIONS, CONTEXTS, TOGETHER, Action, actions_of, key_table, key_words
from kg.shell.app import Shell
from kg.shell.editor import QueryEditor
from kg.shell.screens.main import MainScreen

_SCREENS: Final[dict[str, list[Any]]] = {
    "everywhere": [Shell],
    "main": [MainScreen],
    "editor": [QueryEditor],
    "results": [MainScreen],
    "tree": [MainScreen],
    "page": ["page.PageScreen"],
    "find": ["find.FindScreen"],
    "list": ["listing.ListScreen", "listing.ChoiceScreen", "listing.FormScreen", "listing.ExportScreen"],
    "rules": ["find.RulesScreen"],
    "systems": ["find.SystemsScreen"],
}


def resolved(kind: Any) -> Any:
    """Return a screen class by its name."""
    if not isinstance(kind, str):
        return kind
    module, name = kind.split(".")
    return getattr(import_module(f"kg.shell.screens.{module}"), name)


@pytest.mark.parametrize("action", ACTIONS, ids=lambda action: f"{action.context}-{action.name}")
def test_every_action_is_explained_and_there(action: Action) -> None:
    """Every action has a title, a sentence, a key, and a method in its context."""
    assert action.title
    assert action.help.endswith(".")
    assert action.keys
    for kind in _SCREENS[action.context]:
        assert inspect.isfunction(getattr(resolved(kind), f"action_{action.name}")), kind


@pytest.mark.parametrize("contexts", TOGETHER, ids="-".join)
def test_no_key_means_two_things(contexts: tuple[str, ...]) -> None:
    """No key has two actions valid at the same time."""
    keys = [key for context in contexts for action in actions_of(context) for key in action.keys]
    assert len(keys) == len(set(keys))


def test_every_action_has_a_context_with_a_title() -> None:
    """The contexts are those of the help."""
    assert {action.context for action in ACTIONS} == set(CONTEXTS)


@pytest.mark.parametrize(
    ("key", "words"),
    [("ctrl+r", "Ctrl+R"), ("f5", "F5"), ("o", "o"), ("ctrl+pagedown", "Ctrl+PgDn"), ("escape", "Esc")],
)
def test_keys_are_told_as_people_write_them(key: str, words: str) -> None:
    """Keys are written as on keyboards."""
    assert key_words(key) == words


def test_the_documentation_has_the_keys_of_the_registry() -> None:
    """docs/shell.md ends in the generated table; `python docs/generate.py` updates it."""
    assert (ROOT / "docs" / "shell.md").read_text("utf-8").endswith(key_table())
