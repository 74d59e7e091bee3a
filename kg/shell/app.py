"""The application: one link to the store, a stack of screens, and the actions of the registry.

It also opens lines of code in the user's editor: `$VISUAL`, `$EDITOR`, or an installed one.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

from textual.app import App, SuspendNotSupported, SystemCommand
from textual.command import CommandList, CommandPalette
from textual.filter import LineFilter, NoColor
from textual.theme import ThemeProvider
from textual.widget import Widget
from textual.worker import WorkerFailed, get_current_worker

from kg.errors import KgError, UsageError
from kg.lazily import lazily
from kg.render.text import printable
from kg.shell.actions import ACTIONS, Action, bindings, key_words
from kg.shell.delivery import guard, is_late, is_open
from kg.shell.link import Link
from kg.shell.screens.base import UpperScreen
from kg.shell.screens.main import MainScreen
from kg.shell.state import State, state_folder

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from textual.binding import Binding, BindingType
    from textual.dom import DOMNode
    from textual.screen import Screen

    from kg.settings import Settings
    from kg.store.layout import Layout

with lazily():
    from kg.shell.screens.find import FindScreen, RulesScreen, SystemsScreen
    from kg.shell.screens.listing import HelpScreen

_THEME: Final = "textual-dark"
_MOST_FAILURES: Final = 50
"""Number of unexpected errors after which the shell exits: an error in drawing would recur with every notice."""

_LINE_BEHIND: Final = {"code", "code-insiders", "codium", "cursor", "windsurf"}  # editors that take `-g FILE:LINE`
_LINE_AFTER_COLON: Final = {"hx", "helix", "subl", "zed", "zeditor"}
_LINE_OPTION: Final = {"clion", "idea", "pycharm", "kate", "gedit"}
_FALLBACKS: Final = ("nano", "vim", "vi", "emacs")


class Palette(CommandPalette, UpperScreen[Any]):
    """The command palette, which finds actions by parts of words."""

    def _action_command_list(self, action: str) -> None:
        """Move in the list, or run the highlighted action, once the list is drawn."""
        if self.query_one(CommandList).scrollable_content_region:
            super()._action_command_list(action)


def editor_words() -> list[str]:
    """Return the command of the editor; UsageError KG551 without one."""
    for name in ("VISUAL", "EDITOR"):
        if words := shlex.split(os.environ.get(name, "")):
            return words
    editor = next((name for name in _FALLBACKS if shutil.which(name)), None)
    if editor is None:
        raise UsageError("KG551", "no editor was found", hint="Name one: export EDITOR=nano")
    return [editor]


def command_for(path: Path, line: int | None) -> list[str]:
    """Return the command that opens `path` at `line`, in the syntax of the editor.

    Raises UsageError: KG551 no editor, KG552 the file is not on this machine.
    """
    if not path.is_file():
        hint = "The source may have moved; `kg status` lists the sources."
        raise UsageError("KG552", f"the file is not here: {path}", hint=hint)
    words = editor_words()
    program = Path(words[0]).name
    if line is None:
        return [*words, str(path)]
    if program in _LINE_BEHIND:
        return [*words, "-g", f"{path}:{line}"]
    if program in _LINE_AFTER_COLON:
        return [*words, f"{path}:{line}"]
    if program in _LINE_OPTION:
        return [*words, "--line", str(line), str(path)]
    return [*words, f"+{line}", str(path)]


class Shell(App[None]):
    """The shell of one store; `state` defaults to the user's own; `actions` have the user's keys."""

    TITLE = "kg shell"
    CSS_PATH = "shell.tcss"
    BINDINGS: ClassVar[list[BindingType]] = bindings("everywhere")
    COMMAND_PALETTE_BINDING = "ctrl+p"
    ENABLE_COMMAND_PALETTE = True

    def __init__(
        self, settings: Settings, layout: Layout, state: State | None = None, actions: tuple[Action, ...] = ACTIONS
    ) -> None:
        # NO_COLOR: https://no-color.org
        colourless = settings.color == "never" or (settings.color == "auto" and bool(os.environ.get("NO_COLOR")))
        super().__init__()
        self.no_color = colourless
        self.settings = settings
        self.actions = actions
        self.link = Link(settings, layout)
        self.state = state or State(state_folder(), layout.name)
        self._opened = False
        self.failures: list[BaseException] = []
        """Unexpected errors that were shown instead of ending the shell; normally empty."""
        guard(self, self)

    def get_default_screen(self) -> MainScreen:
        """Return the main screen."""
        return MainScreen(self.link, self.state)

    def get_line_filters(self) -> Sequence[LineFilter]:
        """Return textual's line filters, none if colour is disabled."""
        filters = super().get_line_filters()
        return [*filters, NoColor()] if self.no_color else filters

    def get_key_display(self, binding: Binding) -> str:
        """Return a key for people."""
        return key_words(binding.key)

    async def on_mount(self) -> None:
        """Apply the saved theme, and start the readers."""
        self.state.tell = self._tell_unsaved
        theme = self.state.choice("theme", _THEME)
        self.theme = theme if theme in self.available_themes else _THEME
        self.set_keymap({one.identity: ",".join(one.keys) for one in self.actions if one not in ACTIONS})
        self.theme_changed_signal.subscribe(self, lambda chosen: self.state.keep_choice("theme", chosen.name))
        await self.link.open()
        self._opened = True

    async def on_unmount(self) -> None:
        """Stop the readers."""
        if self._opened:
            await self.link.close()

    def _register_child(self, parent: DOMNode, child: Widget, before: int | None, after: int | None) -> None:
        """Guard the handlers of every new widget and screen."""
        super()._register_child(parent, child, before, after)
        guard(child, self)

    async def _dispatch_action(self, namespace: DOMNode, action_name: str, params: Any) -> bool:
        """Ignore keys for screens and widgets that are not composed yet, or are closing."""
        if isinstance(namespace, Widget) and not is_open(namespace):
            return False
        return await super()._dispatch_action(namespace, action_name, params)

    def _handle_exception(self, error: Exception) -> None:
        """Show an unexpected error, for which textual would exit."""
        if isinstance(error, WorkerFailed):
            self.fail(error.error, get_current_worker().node)
        else:
            self.fail(error)

    def fail(self, error: BaseException, place: object = None) -> None:
        """Show an unexpected error of a widget and save its traceback.

        Before the first screen the shell exits as usual. Errors of closing widgets are ignored.
        """
        if not self._opened or len(self.failures) == _MOST_FAILURES:
            super()._handle_exception(error)  # type: ignore[arg-type]  # workers may fail by any
        elif self.is_running and not self._exit and not is_late(error, place):
            self.failures.append(error)
            path = self.state.keep_failure("".join(traceback.format_exception(error)))
            hint = f"The shell keeps running. Please report this with {path}."
            self.report(KgError("KG900", f"{type(error).__name__}: {error}".partition("\n")[0], hint=hint))

    @property
    def main(self) -> MainScreen:
        """The screen below all others."""
        screen = self.screen_stack[0]
        assert isinstance(screen, MainScreen)  # noqa: S101 - it is the default screen
        return screen

    def report(self, error: KgError) -> None:
        """Show an error on top of the current screen."""
        words = f"{error.message}\n{error.hint}" if error.hint else error.message
        self.notify(words, title=error.code, severity="error", timeout=10, markup=False)

    def _tell_unsaved(self, why: str) -> None:
        self.notify(f"Buffers, history and choices are not saved in {why}", severity="warning", markup=False)

    def edit(self, place: Mapping[str, Any] | None) -> None:
        """Open the place of a view in the editor, with this application suspended."""
        if not place or not (place.get("file") or place.get("path")):
            self.notify("This line has no source location.", severity="warning")
            return
        try:
            command = command_for(Path(place.get("file") or place["path"]), place.get("line"))
            self._start(command)
        except UsageError as error:
            self.report(error)

    def _start(self, command: list[str]) -> None:
        try:
            with self.suspend():
                subprocess.run(command, check=False)  # noqa: S603 - the person's own editor
        except SuspendNotSupported as error:
            raise UsageError("KG551", "this terminal cannot be given to an editor", hint="Open it yourself.") from error
        except OSError as error:
            raise UsageError("KG551", f"{command[0]} cannot be started: {error.strerror}") from error
        self.refresh()

    def copy(self, text: str, what: str) -> None:
        """Copy text to the terminal's clipboard and report it."""
        self.copy_to_clipboard(text)
        self.notify(f"Copied {printable(what)}.", markup=False, timeout=2)

    def get_system_commands(self, screen: Screen[Any]) -> Iterator[SystemCommand]:
        """Yield the actions of the current screen for the palette."""
        contexts = {"everywhere", *getattr(screen, "CONTEXTS", ())}
        for action in self.actions:
            if action.context in contexts and action.name != "command_palette":
                keys = ", ".join(key_words(key) for key in action.keys)
                yield SystemCommand(action.title, f"{action.help} ({keys})", _runner(self, screen, action.target))

    async def action_quit(self) -> None:
        """Exit; the main screen has saved its buffers."""
        self.main.keep()
        self.exit()

    def action_interrupt(self) -> None:
        """Stop running work; otherwise copy the selection."""
        if self.main.stop():
            return
        focused = self.focused
        chosen = getattr(focused, "selected_text", "") or self.screen.get_selected_text()
        if chosen:
            self.copy(chosen, "the selection")
        else:
            self.notify("Nothing runs. Ctrl+Q leaves the shell.", timeout=3)

    def action_command_palette(self) -> None:
        """Find actions by name."""
        if not isinstance(self.screen, Palette):
            self.push_screen(Palette())

    def search_themes(self) -> None:
        """Find themes by name."""
        self.push_screen(Palette([ThemeProvider], placeholder="Search for themes …"))

    def action_help(self) -> None:
        """Show every key."""
        if not isinstance(self.screen, (HelpScreen, CommandPalette)):
            self.push_screen(HelpScreen())

    def action_find(self) -> None:
        """Search for nodes by what they do."""
        self._above(FindScreen)

    def action_rules(self) -> None:
        """Show the rules."""
        self._above(RulesScreen)

    def action_systems(self) -> None:
        """Show launch configurations and findings."""
        self._above(SystemsScreen)

    def _above(self, kind: Any) -> None:
        if isinstance(self.screen, (kind, CommandPalette)):
            return
        while len(self.screen_stack) > 1:
            self.pop_screen()
        self.push_screen(kind())


def _runner(app: Shell, screen: Screen[Any], target: str) -> Any:
    async def run() -> None:
        await app.run_action(target, screen.focused or screen)

    return run
