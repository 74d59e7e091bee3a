"""Subclasses of typer's commands: help from `kg.cli.manual`, and every outcome as an exit code and a few lines of text.

An invalid command line becomes an error like all others, with a suggestion.
"""

from __future__ import annotations

import errno
import os
import re
import sys
from collections import UserDict
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any, Final, NamedTuple, TypeAlias

import typer
from typer import Abort
from typer.core import TyperCommand, TyperGroup
from typer.exceptions import TyperException
from typer.main import get_command

from kg.cli.diagnostics import defect, report, say
from kg.cli.main import was_interrupted
from kg.cli.manual import first_paragraph, page, plain
from kg.cli.supervising import MemoryLimitError, is_out_of_memory
from kg.errors import Exit, KgError, StoreError, UsageError
from kg.similar import did_you_mean, suggest

_EXTRA: Final = re.compile(r"^Got unexpected extra argument\(s\) \((\S+).*\)$")


def as_usage_error(error: TyperException) -> UsageError:
    """Return KG003 for an error of typer about the arguments."""
    context: Any = getattr(error, "ctx", None)
    see = f"See `{context.command_path} --help`." if context else "See `kg --help`."
    message = error.message if hasattr(error, "option_name") else error.format_message()
    near = getattr(error, "possibilities", None)
    hint = did_you_mean(getattr(error, "option_name", ""), near) if near else None
    sentence = _EXTRA.sub(r"unexpected argument `\1`", " ".join(message.split()).rstrip("."))
    lowered = sentence[:1].lower() + sentence[1:]
    return UsageError("KG003", lowered, hint="\n".join(filter(None, (hint, see))))


def guarded(work: Callable[[], object]) -> int:
    """Run a command and return the exit code of the process (`kg.errors.Exit`)."""
    try:
        result = work()
        sys.stdout.flush()
    except BrokenPipeError:
        return hang_up()
    except (KeyboardInterrupt, Abort):
        result = Exit.INTERRUPTED
    except Exception as error:  # noqa: BLE001 - the one place where everything ends
        if not was_interrupted(error):
            return _show(error)
        result = Exit.INTERRUPTED
    if result == Exit.INTERRUPTED:
        say("\ninterrupted")
    return int(result) if isinstance(result, int) else Exit.OK


def hang_up() -> int:
    """Stop writing to standard output: its reader has closed it, or the disk is full."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return Exit.OK


def _show(error: Exception) -> int:
    if isinstance(error, TyperException):
        error = as_usage_error(error)
    elif isinstance(error, OSError) and error.errno == errno.ENOSPC:
        if error.filename is None:
            hang_up()
        error = StoreError("KG304", f"no space left on the device ({error.filename or 'output'})")
    elif not isinstance(error, KgError) and is_out_of_memory(error):
        error = MemoryLimitError("KG004", "the command failed to allocate memory")
    if isinstance(error, KgError):
        report(error)
        return error.exit_code
    defect(error)
    return Exit.INTERNAL


CALLED: Final = {
    "init": ("build",),
    "scan": ("build",),
    "index": ("build",),
    "ask": ("search", "query"),
    "find": ("search",),
    "explore": ("shell", "serve"),
    "web": ("serve",),
    "tui": ("shell",),
    "check": ("lint",),
}
"""Names that other programs use for a command of `kg`."""


class _AsTyped:
    """Passes arguments to commands as typed.

    Commands take only texts, lists of texts and switches; `kg.settings` and the commands parse them. typer would load
    pydantic to validate texts, which doubles the start-up time.
    """

    def coerce(self, value: Any, param: Any, ctx: Any) -> Any:  # noqa: ARG002 - called by typer
        """Return the value; repeatable options are lists."""
        several = param.multiple or param.nargs == -1
        return list(value or ()) if several else value


def _as_typed(params: Any) -> Any:
    for param in params:
        vars(param)["_runtime_param"] = _AsTyped()
    return params


class KgCommand(TyperCommand):
    """A command."""

    def get_params(self, ctx: Any) -> Any:
        """Return the arguments and options, including `--help`."""
        return _as_typed(super().get_params(ctx))

    def get_help(self, ctx: Any) -> str:
        """Return the text of `--help`."""
        return plain(page(self, ctx))


class Later(NamedTuple):
    """A command whose module, of `kg.cli.commands`, is imported on first use."""

    panel: str
    name: str
    place: str
    """Its module and function: `lists:topics`."""
    sentence: str
    """The first paragraph of its help."""
    kind: str = ""
    """Its class, in the same module; `KgCommand` by default."""

    def load(self) -> Any:
        """Return the command."""
        module, _, function = self.place.partition(":")
        loaded = import_module(f"kg.cli.commands.{module}")
        alone = typer.Typer(add_completion=False, rich_markup_mode=None)
        kind = getattr(loaded, self.kind) if self.kind else KgCommand
        alone.command(self.name, cls=kind, rich_help_panel=self.panel)(getattr(loaded, function))
        return get_command(alone)


Panels: TypeAlias = Mapping[str, Mapping[str, tuple[str, str] | tuple[str, str, str]]]
"""Commands by panel and name, each with its place, sentence and class as `Later` has them."""


class _Commands(UserDict[str, Any]):
    """The commands of a group by name, imported on look-up, then subgroups."""

    def __getitem__(self, name: str) -> Any:
        command = self.data[name]
        # `kg --help` needs none of the modules of commands, so each is imported when its command is looked up.
        if isinstance(command, Later):
            command = self.data[name] = command.load()
        return command

    def entries(self) -> list[tuple[str, str, str]]:
        """Return panel, name and first paragraph of each command without importing any."""
        listed = []
        for name, command in self.data.items():
            if isinstance(command, Later):
                listed.append((command.panel, name, command.sentence))
            elif not command.hidden:
                listed.append((getattr(command, "rich_help_panel", None) or "Commands", name, first_paragraph(command)))
        return listed


class KgGroup(TyperGroup):
    """A group of commands, and `kg` itself."""

    later: Sequence[Later] = ()
    """The commands in it."""

    def __init__(self, *, commands: Any = None, **given: Any) -> None:
        super().__init__(**given)
        self.commands = _Commands({one.name: one for one in self.later} | (commands or {}))

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002 - called by typer
        """Return the names of the commands."""
        return list(self.commands)

    def get_params(self, ctx: Any) -> Any:
        """Return the options, including those for completion and `--help`."""
        return _as_typed(super().get_params(ctx))

    def get_help(self, ctx: Any) -> str:
        """Return the text of `--help`."""
        return plain(page(self, ctx))

    def invoke(self, ctx: Any) -> Any:
        """Run the command; typer would turn a broken pipe into a failure."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            return hang_up()

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find the command, or suggest the nearest one."""
        if args and not args[0].startswith("-") and self.get_command(ctx, args[0]) is None:
            candidates = [name for name in CALLED.get(args[0], ()) if name in self.commands]
            near = suggest(candidates) or did_you_mean(args[0], self.commands)
            hint = "\n".join(filter(None, (near, f"`{ctx.command_path} --help` lists the commands.")))
            raise UsageError("KG003", f"unknown command `{ctx.command_path} {args[0]}`", hint=hint)
        return super().resolve_command(ctx, args)

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command line and exit with a code of `kg.errors.Exit`."""
        kwargs |= {"standalone_mode": False, "prog_name": "kg"}
        sys.exit(guarded(lambda: super(KgGroup, self).main(*args, **kwargs)))
