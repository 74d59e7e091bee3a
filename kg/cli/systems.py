"""What commands about launch configurations share: their options, and the systems that these choose."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.completion import launches

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.facts import System
    from kg.settings import Settings

__all__ = ["Arguments", "Environment", "Launch", "chosen_systems", "given"]

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


def given(
    launch: str | None, arguments: Sequence[str] | None, environment: Sequence[str] | None
) -> tuple[dict[str, str], dict[str, str]]:
    """Return the arguments and the environment variables of the options; KG003 for those that cannot be used."""
    from kg.pipeline.launch_names import assignments, check_given  # noqa: PLC0415 - start-up time

    found = assignments(arguments or ()), assignments(environment or (), "=")
    check_given(launch, *found)
    return found


def chosen_systems(
    settings: Settings, launch: str | None, arguments: Sequence[str] | None, environment: Sequence[str] | None
) -> Sequence[System]:
    """Return the systems that the options choose, all without `launch`; raises as `kg.pipeline.launching.chosen`."""
    values = given(launch, arguments, environment)
    from kg.pipeline.launching import chosen  # noqa: PLC0415 - start-up time
    from kg.store.opening import existing  # noqa: PLC0415 - start-up time

    return chosen(settings, existing(settings), launch, *values)
