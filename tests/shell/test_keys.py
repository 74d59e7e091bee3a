"""User-defined keys."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st
from shell.driving import current, make, until

from kg.errors import UsageError
from kg.shell.actions import ACTIONS, key_named, key_words
from kg.shell.app import Shell
from kg.shell.running import chosen_actions, keys_file
from kg.shell.screens.listing import HelpScreen

if TYPE_CHECKING:
    from pathlib import Path


@given(st.sampled_from([key for action in ACTIONS for key in action.keys]))
def test_keys_are_read_as_they_are_shown(key: str) -> None:
    """A file may name a key as shown by the help."""
    assert key_named(key_words(key)) == key
    assert key_named(key) == key


def test_without_a_file_the_keys_are_those_of_the_registry(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The file is in the settings folder, and is optional."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert keys_file() == tmp_path / "kg" / "keys.toml"
    assert chosen_actions(keys_file()) == ACTIONS


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[main", "cannot be read"),
        ("run = 'F5'", "`run` is not a table"),
        ("[mian]\nrun = 'F5'", "`mian` is not a table"),
        ("[main]\nrnu = 'F5'", "`main.rnu` is not an action"),
        ("[main]\nrun = 5", "are not text"),
        ("[main]\nrun = ''", "are not text"),
        ("[main]\nrun = 'F5 Strg+X'", "`Strg\\+X` is not a key"),
        ("[main]\nrun = 'x'", "`x` is text where something is typed"),
        ("[main]\nrun = 'F6'", "the key F6 would mean main.run and main.run_buffer"),
        ("[results]\nexport = 'y'", "the key y would mean results.copy_as and results.export"),
    ],
)
def test_wrong_keys_are_told(tmp_path: Path, text: str, message: str) -> None:
    """An error in the file of keys is reported before the terminal is used."""
    path = tmp_path / "keys.toml"
    path.write_text(text)
    with pytest.raises(UsageError, match=message) as raised:
        chosen_actions(path)
    assert raised.value.code == "KG554"


def test_chosen_keys_hold(store: Path, tmp_path: Path) -> None:
    """A user-defined key replaces the default, and help, palette and footer show it."""
    path = tmp_path / "keys.toml"
    path.write_text('[everywhere]\nhelp = "F6"\n[main]\nrun_buffer = "Ctrl+B"\n')

    async def press() -> tuple[list[str], str, str]:
        made = make(store, tmp_path / "state")
        app = Shell(made.settings, made.link.layout, made.state, chosen_actions(path))
        async with app.run_test() as pilot:
            await until(lambda: current(app).editor.has_focus)
            await pilot.press("f1")
            before = type(app.screen).__name__
            await pilot.press("f6")
            await until(lambda: isinstance(app.screen, HelpScreen))
            told = [command.help for command in app.get_system_commands(app.main) if command.title == "Help"]
            shown = [
                app.get_key_display(one.binding) for one in app.screen_stack[0].active_bindings.values()
                if one.binding.id == "everywhere.help"
            ]  # fmt: skip
            app.exit()
            return told, before, shown[0]

    told, before, shown = asyncio.run(press())
    assert told == ["Show every key, by place. (F6)"]
    assert (before, shown) == ("MainScreen", "F6")
