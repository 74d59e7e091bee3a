"""The options that come from settings, and those that several commands share."""

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Annotated, Any, TypeVar

import typer

from kg.cli.completion import launches, packages
from kg.settings import DECLARED, Declaration

_Command = TypeVar("_Command", bound=Callable[..., None])


def from_setting(name: str, *short: str, also: str = "", **more: Any) -> Any:
    """Return the option of a setting; its value stays text until `kg.settings.load` reads it.

    `also` is said after the sentence of the setting.
    """
    declaration = DECLARED[name]
    sentence = f"{declaration.sentence} {also}".rstrip()
    return _option(replace(declaration, sentence=sentence), *short, **more)


def takes(declared: Iterable[Declaration]) -> Callable[[_Command], _Command]:
    """Give a command an option for each setting; what the user gave is in its `**given`, by names of fields.

    Options that the user did not give are None there, so that `kg.settings.load_table` looks elsewhere.
    """
    return with_options({one.name: Annotated[_kind(one), _option(one)] for one in declared})


def with_options(options: Mapping[str, Any]) -> Callable[[_Command], _Command]:
    """Give a command options that are declared elsewhere; what the user gave is in its keyword arguments.

    `options` maps names of arguments to their types, `Annotated` with what typer has to know.
    """
    keyword = inspect.Parameter.KEYWORD_ONLY
    added = [inspect.Parameter(name, keyword, default=None, annotation=kind) for name, kind in options.items()]

    def add(command: _Command) -> _Command:
        signature = inspect.signature(command)
        own = [one for one in signature.parameters.values() if one.kind is not inspect.Parameter.VAR_KEYWORD]
        first = [one for one in own if one.kind is not keyword]
        vars(command)["__signature__"] = signature.replace(parameters=[*first, *added, *own[len(first) :]])
        return command

    return add


def _kind(declaration: Declaration) -> Any:
    if declaration.switch:
        return bool | None
    return list[str] | None if declaration.several else str | None


def _option(declaration: Declaration, *short: str, **more: Any) -> Any:
    default = f" [default: {declaration.shown}]" if declaration.table and declaration.shown else ""
    return typer.Option(
        declaration.flag,
        *filter(None, (declaration.short, *short)),
        metavar=declaration.metavar or None,
        help=f"{declaration.sentence}{default} [{declaration.variable}]",
        show_default=False,
        **more,
    )


Store = Annotated[str | None, from_setting("store", "-s")]
Stores = Annotated[
    list[str] | None, from_setting("store", "-s", also="May be repeated: the query sees the union of all stores.")
]
Base = Annotated[str | None, from_setting("base")]
Jobs = Annotated[str | None, from_setting("jobs", "-j")]
Cluster = Annotated[str | None, from_setting("cluster")]
Artifacts = Annotated[str | None, from_setting("artifacts")]
Calls = Annotated[str | None, from_setting("calls")]
MaxFileBytes = Annotated[str | None, from_setting("max_file_bytes")]
Memory = Annotated[str | None, from_setting("memory")]
NlpModel = Annotated[str | None, from_setting("nlp_model")]
Timeout = Annotated[str | None, from_setting("timeout")]
Limit = Annotated[str | None, from_setting("limit", "-n")]
Format = Annotated[str | None, from_setting("format")]
Robot = Annotated[str | None, from_setting("robot")]
Places = Annotated[str | None, from_setting("places")]
Exclusive = Annotated[
    bool, typer.Option("--exclusive", help="Refuse to move what another node also moves, and stop if one appears.")
]
WatchdogSeconds = Annotated[str | None, from_setting("watchdog")]
Queries = Annotated[str | None, from_setting("queries")]
Rules = Annotated[str | None, from_setting("rules")]
Families = Annotated[str | None, from_setting("rule_families")]
Json = Annotated[bool, typer.Option("--json", help="Write JSON Lines: one object per line.")]
NoRules = Annotated[bool, typer.Option("--no-rules", help="Do not run rules; the next build updates inferred triples.")]
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
