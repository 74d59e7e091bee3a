"""The commands of `kg`, in the order that `kg --help` lists them."""

from typing import Annotated, Any, Final

import typer

from kg.cli.commands import config, explain
from kg.cli.diagnostics import MODE, Mode
from kg.cli.group import KgCommand, KgGroup
from kg.cli.options import Color, Store
from kg.cli.output import write
from kg.cli.session import Session
from kg.errors import Exit
from kg.settings import DECLARED

__all__ = ["COMMANDS", "app"]

EPILOGUE: Final = """
Data goes to standard output, words go to standard error. Exit codes:

    0  it worked                          4  the store is missing, busy, damaged or full
    1  it worked; something was found,    5  a query was refused or failed
       or what was asked for was not      6  a deadline or a limit ended the work
    2  the command or a setting is wrong  70  a defect in kg
    3  a source could not be read         130  interrupted

Start with `kg demo`, or with `kg build FOLDER` and then `kg nodes`.
"""

COMMANDS: Final[tuple[tuple[str, str, Any], ...]] = (("Look after it", "explain", explain.explain),)

app = typer.Typer(
    cls=KgGroup,
    epilog=EPILOGUE,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(value: bool) -> None:  # noqa: FBT001 - the signature of typer's callbacks
    if value:
        from importlib.metadata import version  # noqa: PLC0415 - start-up time

        write(f"kg {version('kg-ros')}")
        raise typer.Exit(Exit.OK)


Version = Annotated[
    bool, typer.Option("--version", "-V", callback=_print_version, is_eager=True, help="Print the version and exit.")
]
Traceback = Annotated[
    bool, typer.Option("--traceback", envvar="KG_DEBUG", help="Show errors with Python's traceback. [KG_DEBUG=1]")
]


@app.callback(invoke_without_command=True)
def kg(
    context: typer.Context,
    *,
    store: Store = None,
    color: Color = None,
    traceback: Traceback = False,
    version: Version = False,  # noqa: ARG001 - its callback does the work
) -> None:
    """Know the ROS nodes of a workspace: what they publish, subscribe, offer and need, and on which line."""
    flags: dict[str, object] = {
        name: value for name, value in (("store", store), ("color", color)) if value is not None
    }
    context.obj = Session(flags)
    MODE.set(Mode(_color(color), traceback))
    MODE.set(Mode(context.obj.settings().color, traceback))
    if context.invoked_subcommand is None:
        write(context.get_help())


def _color(flag: str | None) -> str:
    """Return how to show an error in the settings themselves."""
    return flag if flag in {"always", "never"} else DECLARED["color"].default


config_app = typer.Typer(cls=KgGroup, rich_markup_mode=None)
config_app.callback(invoke_without_command=True)(config.config)
config_app.command("show", cls=KgCommand)(config.show)
for _panel, _name, _function in COMMANDS:
    app.command(_name, cls=KgCommand, rich_help_panel=_panel)(_function)
app.add_typer(config_app, name="config", rich_help_panel="Look after it")
