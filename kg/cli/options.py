"""The options that come from settings, and those that several commands share."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import wraps
from typing import Annotated, Any, Final, TypeVar

import typer

from kg.cli.completion import launches, packages, rules
from kg.cli.session import session
from kg.codes import SEVERITIES
from kg.errors import UsageError
from kg.settings import DECLARED, Declaration, Settings
from kg.similar import did_you_mean

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


Store = Annotated[str | None, from_setting("store")]
Via = Annotated[
    bool, typer.Option("--via", help="Show the calls in wrappers and base classes, from the line to the framework.")
]
OutputFile = Annotated[str | None, typer.Option("--output", "-o", metavar="FILE", help="Write to FILE.")]
Exclusive = Annotated[
    bool, typer.Option("--exclusive", help="Refuse to move what another node also moves, and stop if one appears.")
]
All = Annotated[
    bool, typer.Option("--all", "-a", help="Include what frameworks create implicitly (/rosout, /tf, ...).")
]
Markdown = Annotated[bool, typer.Option("--markdown", help="Write Markdown for a pull request.")]
Json = Annotated[bool, typer.Option("--json", help="Write JSON Lines: one object per line.")]
NoRules = Annotated[bool, typer.Option("--no-rules", help="Do not run rules; the next build updates inferred triples.")]
RuleName = Annotated[
    str, typer.Argument(metavar="RULE", help="FAMILY/NAME, NAME alone, or a file.", autocompletion=rules)
]
PackageName = Annotated[
    str | None,
    typer.Option(
        "--package",
        "-p",
        metavar="NAME",
        help="Only this package (`name` or `repository:name`).",
        autocompletion=packages,
    ),
]
System = Annotated[
    str | None,
    typer.Option(
        "--system",
        metavar="LAUNCH",
        help="Only what these launch files start: a path, `package/launch/x.launch`, or a suffix of either.",
        autocompletion=launches,
    ),
]
UpdateUrl = Annotated[
    str | None, typer.Option("--update-url", metavar="URL", help="Address for updates of the server, if different.")
]


_FORMATS: Final = ("text", "json", "sarif", "github")

Form = Annotated[str, typer.Option("--format", "-f", metavar="FORMAT", help=f"One of {', '.join(_FORMATS)}.")]
Level = Annotated[
    str, typer.Option("--level", metavar="SEVERITY", help="Lowest severity to show: error, warning or note.")
]


def require_valid(form: str, level: str = SEVERITIES[-1], hints: Mapping[str, str] | None = None) -> None:
    """Raise UsageError KG003 for an unknown format or severity; `hints` maps some words to a hint."""
    require_one_of(form, _FORMATS, "format", (hints or {}).get(form, ""))
    require_one_of(level, SEVERITIES, "severity")
