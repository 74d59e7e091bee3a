"""Options that come from settings, and those that several commands share, with the forms of their values."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, Final, TypeVar

import typer

from kg import forms
from kg.cli.completion import launches, packages, rules
from kg.errors import UsageError
from kg.settings import DECLARED, Declaration, Settings, load
from kg.similar import did_you_mean
from kg.store.failure import remote_refusal

REMOTE: Final = frozenset(
    {
        "action",
        "actions",
        "build",
        "compose",
        "config",
        "export",
        "graph",
        "impact",
        "import",
        "instances",
        "lint",
        "mcp",
        "node",
        "nodes",
        "packages",
        "param",
        "publish",
        "query",
        "search",
        "serve",
        "shell",
        "stats",
        "service",
        "services",
        "show",
        "topic",
        "topics",
        "why",
        "why-not",
    }
)
"""Commands that give the same results over a SPARQL server as over an embedded store with the same graph."""


@dataclass(slots=True)
class Session:
    """One run of `kg`: the settings given before the command, and its name, empty until it is known."""

    flags: dict[str, object] = field(default_factory=dict)
    command: str = ""

    def settings(self, **flags: object) -> Settings:
        """Return the settings in force; `flags` are the command's own and override those before the command.

        Raises:
            UsageError: KG002 an invalid value.
            StoreError: KG309 a SPARQL server, but the command needs an embedded store.
        """
        given = {name: value for name, value in flags.items() if value is not None}
        settings = load({**self.flags, **given})
        if isinstance(settings.store, str) and self.command and self.command not in REMOTE:
            raise remote_refusal(settings.store)
        return settings


def session(context: Any) -> Session:
    """Return the session of a typer context."""
    stored = context.find_object(Session)
    return Session(stored.flags if isinstance(stored, Session) else {}, context.info_name or "")


_Command = TypeVar("_Command", bound=Callable[..., None])


def from_setting(name: str, *, also: str = "", **more: Any) -> Any:
    """Return the option of a setting; its value stays text until `kg.settings.load` reads it.

    `also` is said after the sentence of the setting.
    """
    declaration = DECLARED[name]
    return _option(replace(declaration, sentence=f"{declaration.sentence} {also}".rstrip()), **more)


def with_settings(*names: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command an option for each of these settings; its argument `settings` is the `Settings` in force.

    Callers from Python give `settings` themselves.
    """
    options = [_parameter(name, Annotated[str | None, from_setting(name)]) for name in names]
    context_parameter = inspect.Parameter("context", inspect.Parameter.KEYWORD_ONLY, annotation=typer.Context)

    def add(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def run(*words: Any, context: typer.Context | None = None, **given: Any) -> None:
            if context is not None:
                flags = {name: given.pop(name) for name in names}
                given["settings"] = session(context).settings(**flags)
            command(*words, **given)

        # typer makes the options from the signature, which therefore has those of the settings in place of `settings`.
        signature = inspect.signature(command)
        own = [one for one in signature.parameters.values() if one.name != "settings"]
        variadic = [own.pop()] if own and own[-1].kind is inspect.Parameter.VAR_KEYWORD else []
        vars(run)["__signature__"] = signature.replace(parameters=[*own, *options, context_parameter, *variadic])
        return run

    return add


def require_one_of(word: str, allowed: Iterable[str], what: str, hint: str = "") -> None:
    """Raise UsageError KG003 for an unknown `what`, by default with similar or all allowed words as the hint."""
    words = list(allowed)
    if word not in words:
        hint = hint or did_you_mean(word, words) or f"One of {', '.join(words)}."
        raise UsageError("KG003", f"unknown {what} `{word}`", hint=hint)


def is_given(settings: Settings, name: str) -> bool:
    """Tell whether a setting comes from an option of the command."""
    return settings.origin(name).kind == "flag"


def takes(declared: Iterable[Declaration]) -> Callable[[_Command], _Command]:
    """Give a command an option for each setting; what the user gave is in its `**given`, by names of fields.

    Options that the user did not give are None there, so that `kg.settings.load_table` looks elsewhere.
    """
    options: dict[str, Any] = {}
    for one in declared:
        kind: Any = bool if one.switch else list[str] if one.several else str
        options[one.name] = Annotated[kind | None, _option(one)]
    return with_options(options)


def with_options(options: Mapping[str, Any]) -> Callable[[_Command], _Command]:
    """Give a command options that are declared elsewhere; what the user gave is in its keyword arguments.

    `options` maps names of arguments to their types, `Annotated` with what typer needs.
    """
    added = [_parameter(name, kind) for name, kind in options.items()]

    def add(command: _Command) -> _Command:
        signature = inspect.signature(command)
        own = [one for one in signature.parameters.values() if one.kind is not inspect.Parameter.VAR_KEYWORD]
        first = [one for one in own if one.kind is not inspect.Parameter.KEYWORD_ONLY]
        vars(command)["__signature__"] = signature.replace(parameters=[*first, *added, *own[len(first) :]])
        return command

    return add


def _parameter(name: str, kind: Any) -> inspect.Parameter:
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind)


def _option(declaration: Declaration, **more: Any) -> Any:
    default = f" [default: {declaration.shown}]" if declaration.table and declaration.shown else ""
    return typer.Option(
        declaration.flag,
        *filter(None, [declaration.short]),
        metavar=declaration.metavar or None,
        help=f"{declaration.sentence}{default} [{declaration.variable}]",
        show_default=False,
        **more,
    )


def option(spec: str, sentence: str, **more: Any) -> Any:
    """Return an option of a command from its names and what its value is called, `--limit -n N`; a switch has none."""
    names = [word for word in spec.split() if word.startswith("-")]
    value = " ".join(word for word in spec.split() if not word.startswith("-"))
    return typer.Option(*names, metavar=value or None, help=sentence, **more)


def argument(value: str, sentence: str, **more: Any) -> Any:
    """Return an argument of a command from what its value is called."""
    return typer.Argument(metavar=value, help=sentence, **more)


Store = Annotated[str | None, from_setting("store")]
Via = Annotated[bool, option("--via", "Show the calls in wrappers and base classes, from the line to the framework.")]
OutputFile = Annotated[str | None, option("--output -o FILE", "Write to FILE.")]
Exclusive = Annotated[
    bool, option("--exclusive", "Refuse to move what another node also moves, and stop if one appears.")
]
All = Annotated[bool, option("--all -a", "Include what frameworks create implicitly (/rosout, /tf, ...).")]
Markdown = Annotated[bool, option("--markdown", "Write Markdown for a pull request.")]
Json = Annotated[bool, option("--json", "Write JSON Lines: one object per line.")]
NoRules = Annotated[bool, option("--no-rules", "Do not run rules; the next build updates inferred triples.")]
RuleName = Annotated[str, argument("RULE", "FAMILY/NAME, NAME alone, or a file.", autocompletion=rules)]
PackageName = Annotated[
    str | None, option("--package -p NAME", "Only this package (`name` or `repository:name`).", autocompletion=packages)
]
System = Annotated[
    str | None,
    option(
        "--system LAUNCH",
        "Only what these launch files start: a path, `package/launch/x.launch`, or a suffix of either.",
        autocompletion=launches,
    ),
]
UpdateUrl = Annotated[str | None, option("--update-url URL", "Address for updates of the server, if different.")]


def whole(text: str, option: str, least: int, most: int | None = None) -> int:
    """Return the integer of `option`; UsageError KG003 if it is invalid or out of bounds."""
    bounds = f"at least {least}" if most is None else f"from {least} to {most}"
    try:
        number = int(text)
    except ValueError:
        number = least - 1
    if number < least or (most is not None and number > most):
        raise UsageError(
            "KG003", f"`{option} {text}` is not a whole number {bounds}", hint="See the command's `--help`."
        )
    return number


def seconds(text: str, option: str) -> float:
    """Return the seconds of `option`; UsageError KG003 below 1 ms, or if it is invalid."""
    return _positive(text, option, "number of seconds", "Write 30 or 0.5.", 0.001)  # no timer is finer


def frequency(text: str, option: str) -> float:
    """Return the frequency of `option` in Hz; UsageError KG003 unless it is a positive number."""
    return _positive(text, option, "rate", "Write 10 or 0.5: so many times a second.")


def factor(text: str, option: str) -> float:
    """Return the factor of `option`; UsageError KG003 unless it is a positive number."""
    return _positive(text, option, "factor", "Write 2 or 0.5: so many times as much.")


def _positive(text: str, option: str, what: str, hint: str, least: float = 0.0) -> float:
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if number == 0 or not least <= number < float("inf"):
        raise UsageError("KG003", f"`{option} {text}` is not a {what}", hint=hint)
    return number


def size(text: str, option: str) -> int:
    """Return the number of bytes of `option` (`800`, `500K`, `4M`, `1G`); UsageError KG003 if it is invalid."""
    try:
        return forms.size(text, Path())
    except forms.FormError:
        raise UsageError("KG003", f"`{option} {text}` is not a size", hint="Write bytes, or 500K, 4M, 1G.") from None
