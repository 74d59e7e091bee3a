"""The registry of actions, from which footer, keys, palette, help and docs/shell.md are generated."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from textual.binding import Binding, BindingType

CONTEXTS: Final = {
    "everywhere": "Everywhere",
    "main": "Main screen",
    "editor": "Editor",
    "results": "Results",
    "tree": "Tree",
    "page": "Pages of nodes, facts and proofs",
    "find": "Search",
    "list": "Lists (history, stored queries)",
    "rules": "Rules",
    "systems": "Systems",
}
"""Contexts of keys, with their titles in the help."""

TOGETHER: Final = (
    *(("everywhere", "main", one) for one in ("editor", "results", "tree")),
    *(("everywhere", one) for one in ("page", "find", "list", "rules", "systems")),
)
"""Contexts that are active at the same time, in which a key must be unique."""


@dataclass(frozen=True, slots=True)
class Action:
    """An action of the user: `name` is the method `action_NAME`; `_METHODS` says where it is defined.

    `keys` are named as in textual, the first is the one shown. `title` is for footer and palette, `help` one sentence.
    `footer` is whether the footer shows it, `priority` whether it precedes the focused widget's own keys.
    """

    name: str
    keys: tuple[str, ...]
    title: str
    help: str
    context: str
    footer: bool = False
    priority: bool = False

    @property
    def identity(self) -> str:
        """The name for remapping the action."""
        return f"{self.context}.{self.name}"

    @property
    def target(self) -> str:
        """The name of the action in bindings."""
        return _METHODS.get(self.context, "screen.") + self.name


def _of(context: str, *rows: tuple[str, str, str, str] | tuple[str, str, str, str, str]) -> tuple[Action, ...]:
    """Return the actions of a context from rows of name, keys, title, help and marks: `f` footer, `p` priority."""
    actions = []
    for name, keys, title, words, *marks in rows:
        signs = marks[0] if marks else ""
        actions.append(Action(name, tuple(keys.split()), title, words, context, "f" in signs, "p" in signs))
    return tuple(actions)


ACTIONS: Final[tuple[Action, ...]] = (
    *_of(
        "everywhere",
        ("help", "f1", "Help", "Show every key, by place.", "fp"),
        ("command_palette", "ctrl+p", "Palette", "Type the name of any action and run it.", "fp"),
        ("find", "f2", "Find", "Say what you need in words and see which nodes do it, with the reasons.", "fp"),
        ("rules", "f4", "Rules", "Read the rules by family, with their documentation.", "p"),
        ("systems", "f7", "Systems", "Show launch configurations and their findings.", "p"),
        ("change_theme", "f12", "Theme", "Choose colours; ansi-dark and ansi-light follow the terminal's own.", "p"),
        ("quit", "ctrl+q", "Quit", "Leave; buffers and history are kept.", "p"),
        ("interrupt", "ctrl+c", "Stop or copy", "Stop the query that runs; else copy the selected text.", "p"),
    ),
    *_of(
        "main",
        ("run", "f5 ctrl+j", "Run", "Run the selection, or the query at the cursor.", "fp"),
        ("run_buffer", "f6", "Run buffer", "Run the whole buffer as one query.", "p"),
        ("stop", "escape", "Stop", "Stop the query that runs; else go from results or tree to the editor."),
        ("next_problem", "ctrl+g", "Next problem", "Go to the next mark of a problem and show its message.", "p"),
        ("fix", "ctrl+f", "Fix", "Apply the suggested fix for the problem at the cursor.", "p"),
        ("stored", "f3", "Stored", "Choose a stored query, and give its parameters in a form.", "fp"),
        ("history", "ctrl+r", "History", "Search the history and open a query in a new buffer.", "fp"),
        ("new_buffer", "ctrl+n", "New buffer", "Open an empty buffer in a tab.", "p"),
        ("close_buffer", "f8", "Close buffer", "Close this buffer; the last one is emptied.", "p"),
        ("next_buffer", "ctrl+pagedown", "Next buffer", "Go to the tab on the right.", "p"),
        ("previous_buffer", "ctrl+pageup", "Previous buffer", "Go to the tab on the left.", "p"),
        ("toggle_tree", "f9", "Tree", "Show or hide the tree.", "p"),
        ("toggle_results", "f10", "Full results", "Give the results the whole screen, and back.", "p"),
        ("jump", "ctrl+o", "Jump", "Show a letter on each panel; type it to go there.", "p"),
    ),
    *_of(
        "editor",
        ("complete", "ctrl+space ctrl+@", "Complete", "Complete at the cursor with names from this store.", ""),
        ("comment", "ctrl+slash ctrl+underscore", "Comment", "Comment the lines out, or in again.", ""),
        ("leave", "ctrl+d", "Delete or leave", "Delete the character ahead; in an empty buffer, leave the shell.", ""),
    ),
    *_of(
        "results",
        ("open_row", "enter", "Evidence, why", "Open what the row rests on: lines of code, and why it holds.", "f"),
        ("edit_place", "o", "Open in editor", "Open the line that the row names in $VISUAL or $EDITOR.", "f"),
        ("open_cell", "r", "Resource", "Open the thing that the cell names.", "f"),
        ("copy_as", "y", "Copy as", "Copy the cell, or all rows as TSV, CSV, JSON, Markdown or Turtle.", "f"),
        ("export", "e", "Export", "Write the whole answer to a file, in any format.", "f"),
        ("next_page", "n", "Next page", "Show the next page of rows."),
        ("previous_page", "b", "Previous page", "Show the page of rows before."),
        ("all_rows", "a", "All rows", "Fetch the rows that the limit cut off."),
    ),
    *_of(
        "tree",
        ("open_entry", "enter", "Open", "Open the page of the entry; a folder opens and closes.", "f"),
        ("insert_entry", "i", "Insert", "Put the name of the entry into the query.", "f"),
        ("ask_entry", "q", "Query", "Write a query for the facts about the entry in a new buffer.", "f"),
        ("reload", "u", "Reload", "Read the tree again."),
    ),
    *_of(
        "page",
        ("follow", "enter", "Follow", "Open what the line names: a thing, a proof or a place.", "f"),
        ("edit_place", "o", "Open in editor", "Open the line of code in $VISUAL or $EDITOR.", "f"),
        ("why", "w", "Why", "Show why the fact holds, down to the line of code.", "f"),
        ("copy_entry", "y", "Copy", "Copy what the line names.", "f"),
        ("ask_page", "q", "Query", "Write a query for these facts in a new buffer.", "f"),
        ("back", "backspace", "Back", "Go back to the page before.", "f"),
        ("dismiss_screen", "escape", "Close", "Return to the main screen.", "f"),
    ),
    *_of(
        "find",
        ("open_hit", "enter", "Open", "Search for the text; on a hit, open its page.", "f"),
        ("edit_place", "ctrl+e", "Open in editor", "Open the line of the hit in $VISUAL or $EDITOR.", "f"),
        ("dismiss_screen", "escape", "Close", "Return to the main screen.", "f"),
    ),
    *_of(
        "list",
        ("choose", "enter", "Choose", "Take the chosen entry.", "f"),
        ("dismiss_screen", "escape", "Close", "Return without choosing.", "f"),
    ),
    *_of(
        "rules",
        ("edit_place", "o", "Open in editor", "Open the file of the rule in $VISUAL or $EDITOR.", "f"),
        ("dismiss_screen", "escape", "Close", "Return to the main screen.", "f"),
    ),
    *_of(
        "systems",
        ("edit_place", "o", "Open in editor", "Open the line of the finding in $VISUAL or $EDITOR.", "f"),
        ("dismiss_screen", "escape", "Close", "Return to the main screen.", "f"),
    ),
)
"""All actions, in the order of the help."""

_METHODS: Final = {"everywhere": "app.", "editor": ""}
"""Where the method of an action is defined, in textual's notation; by default on the screen."""

_SHOWN: Final = {
    "ctrl": "Ctrl",
    "alt": "Alt",
    "escape": "Esc",
    "pagedown": "PgDn",
    "pageup": "PgUp",
    "underscore": "_",
    "slash": "/",
    "plus": "+",
    "question_mark": "?",
    "space": "Space",
    "enter": "Enter",
    "backspace": "Backspace",
}


def actions_of(context: str) -> Iterator[Action]:
    """Yield the actions of a context."""
    return (action for action in ACTIONS if action.context == context)


def key_words(key: str) -> str:
    """Return a key for people, `Ctrl+R` for `ctrl+r`."""
    parts = key.split("+")
    return "+".join(_SHOWN.get(part) or (part.upper() if len(parts) > 1 or part[1:] else part) for part in parts)


def key_named(words: str) -> str:
    """Return a key's name in textual, from that name or the output of `key_words`."""
    named = {shown.lower(): name for name, shown in _SHOWN.items()}
    *modifiers, last = re.split(r"\+(?=.)", words.strip())
    plain = last if len(last) == 1 and not modifiers else last.lower()
    return "+".join([*(part.lower() for part in modifiers), named.get(plain.lower(), plain)])


def bindings(context: str) -> list[BindingType]:
    """Return the bindings of a context, for the `BINDINGS` of its focused class."""
    return [
        Binding(
            ",".join(action.keys),
            action.target,
            action.title,
            show=action.footer,
            priority=action.priority,
            tooltip=action.help,
            id=action.identity,
        )
        for action in actions_of(context)
    ]


def key_table() -> str:
    """Return the keys by context as Markdown, for docs/shell.md."""
    parts = []
    for context, title in CONTEXTS.items():
        rows = [
            f"| {', '.join(key_words(key) for key in action.keys)} | {action.title} | {action.help} |"
            for action in actions_of(context)
        ]
        parts.append("\n".join([f"### {title}", "", "| key | action | what it does |", "|---|---|---|", *rows, ""]))
    return "\n".join(parts)
