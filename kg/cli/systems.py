"""Shared parts of commands about launch configurations: options, and the systems that they select."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final

from kg.cli.completion import launches
from kg.cli.diagnostics import note, report
from kg.cli.options import argument, option
from kg.errors import KgError, Place, UsageError
from kg.lazily import lazily

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.settings import Settings

with lazily():
    from kg.cli.commands.build import near
    from kg.facts import LaunchProblemKind, System
    from kg.pipeline.launch_names import assignments, check_given
    from kg.pipeline.launching import chosen, unread
    from kg.pipeline.variants import united, variants
    from kg.render.text import count, some
    from kg.store.opening import existing, reading
    from kg.views.evidence import places

Launch = Annotated[
    str | None,
    option(
        "--launch -l FILE",
        "A launch file: its path, or `package/launch/x.launch`, or any end of these.",
        autocompletion=launches,
    ),
]
File = Annotated[
    list[str] | None,
    argument(
        "FILE",
        "A launch file: `FILE` or `PACKAGE FILE`, then `NAME:=VALUE` for its arguments; as --launch and --arg.",
        autocompletion=launches,
    ),
]
Arguments = Annotated[
    list[str] | None, option("--arg NAME:=VALUE", "Evaluate the launch file with this argument; may be repeated.")
]
Variants = Annotated[
    bool,
    option("--variants", "Also each boolean argument the other way, and branches that environment variables turn on."),
]
Environment = Annotated[
    list[str] | None, option("--env NAME=VALUE", "The same with an environment variable; the real ones are not read.")
]


def named(
    words: Sequence[str] | None, launch: str | None, arguments: Sequence[str] | None
) -> tuple[str | None, list[str]]:
    """Return the launch file and the arguments from words and options; KG003 if both name a file."""
    files = [word for word in words or () if ":=" not in word]
    if files and launch is not None:
        raise UsageError("KG003", f"`{' '.join(files)}` and --launch both name a launch file", hint="Leave out one.")
    most = 2
    if len(files) > most:
        hint = "A launch file is named by `FILE` or by `PACKAGE FILE`; its arguments are written `NAME:=VALUE`."
        raise UsageError("KG003", f"`{' '.join(files)}` names no launch file", hint=hint)
    return " ".join(files) or launch, [*(word for word in words or () if ":=" in word), *(arguments or ())]


def given(
    launch: str | None, arguments: Sequence[str] | None, environment: Sequence[str] | None
) -> tuple[dict[str, str], dict[str, str]]:
    """Return the arguments and environment variables of the options; KG003 for invalid ones."""
    pairs = assignments(arguments or ()), assignments(environment or (), "=")
    check_given(launch, *pairs)
    return pairs


def chosen_systems(
    settings: Settings,
    launch: str | None,
    arguments: Sequence[str] | None,
    environment: Sequence[str] | None,
    *,
    with_variants: bool = False,
) -> Sequence[System]:
    """Return the selected systems, all without `launch`, or that of `launch` including the content of its variants.

    Raises as `kg.pipeline.launching.chosen`; UsageError KG003 for variants of no launch file.
    """
    if with_variants and launch is None:
        raise UsageError("KG003", "--variants needs a launch file", hint="Name it: `--launch FILE`.")
    values = given(launch, arguments, environment)
    if with_variants and launch is not None:
        evaluated = variants(settings, existing(settings), launch, *values)
        report_left_out(evaluated.left_out)
        return (united(evaluated),)
    systems = chosen(settings, existing(settings), launch, *values)
    if values[1]:
        report_unread(settings, systems, values[1])
    return systems


def report_left_out(labels: Sequence[str]) -> None:
    """Report variants of a launch file that were not evaluated."""
    if labels:
        note(f"{len(labels)} variants skipped: {', '.join(labels)}; choose them with --arg or --env")


def report_unread(settings: Settings, systems: Sequence[System], environment: Mapping[str, str]) -> None:
    """Report given environment variables that no file of the systems reads."""
    for name in unread(settings, systems, environment):
        note(f"no file of {systems[0].configuration.name} reads the environment variable `{name}`")


_MOST: Final = 3


def report_left_out_parts(system: System) -> None:
    """Report what a launch file includes or starts that is unknown, so that its nodes are missing."""
    kinds = (LaunchProblemKind.UNKNOWN_PACKAGE, LaunchProblemKind.UNKNOWN_PART, LaunchProblemKind.LIMIT)
    every = [one for one in system.configuration.problems if one.kind in kinds]
    for one in every[:_MOST]:
        note(f"{one.location}: {one.message}; nodes may be missing")
    if len(every) > _MOST:
        note(f"{len(every) - _MOST} more parts of {system.configuration.name} are unknown")


def report_unknown_ends(system: System) -> None:
    """Report nodes whose topics, services and actions are unknown, which may be at ends where `nobody` is."""
    names = [one.name for one in system.instances if one.reason and not one.interfaces]
    if names:
        few, where = count(len(names), "node"), f"`kg instances {system.configuration.name}` shows why"
        note(f"{few} with unknown topics may be where `nobody` is: {some(names, _MOST)} ({where})")


def report_malformed(settings: Settings, system: System) -> bool:
    """Report each line of a system's files that launch refuses, as KG415; return whether there is any."""
    every = system.configuration.problems
    problems = {(one.location, one.message): None for one in every if one.kind is LaunchProblemKind.MALFORMED}
    if not problems:
        return False
    with reading(settings) as snapshot:
        sources = places(snapshot)
    for location, message in problems:
        file = sources.file(system.configuration.repository, location)
        place = Place(near(file) if file else location.path, location.line or None)
        report(KgError("KG415", message, place=place))
    return True
