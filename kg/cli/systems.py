"""What commands about launch configurations share: their options, and the system that these choose."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.completion import launches

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.facts import System
    from kg.settings import Settings

__all__ = ["Arguments", "Environment", "Launch", "chosen_system"]

Launch = Annotated[
    str | None,
    typer.Option(
        "--launch",
        "-l",
        metavar="FILE",
        help="A launch file: its path, or `package/launch/x.launch`, or any end of these.",
        autocompletion=launches,
    ),
]
Arguments = Annotated[
    list[str] | None,
    typer.Option(
        "--arg", metavar="NAME:=VALUE", help="Evaluate the launch file anew with an argument; may be repeated."
    ),
]
Environment = Annotated[
    list[str] | None,
    typer.Option(
        "--env", metavar="NAME=VALUE", help="The same with an environment variable; the real ones are not read."
    ),
]


def chosen_system(
    settings: Settings, launch: str, arguments: Sequence[str] | None, environment: Sequence[str] | None
) -> System:
    """Return the system that the options choose; raises as `kg.pipeline.launching.chosen`."""
    from kg.pipeline.launching import chosen, pairs  # noqa: PLC0415 - start-up time
    from kg.store.opening import existing  # noqa: PLC0415 - start-up time

    given, variables = pairs(arguments or ()), pairs(environment or (), "=")
    return chosen(settings, existing(settings), launch, given, variables)
