"""`kg completions`: completion scripts for shells."""

import os
from pathlib import Path
from typing import Annotated

import typer
from typer.completion import get_completion_script  # type: ignore[attr-defined]  # typer does not export it

from kg.cli.output import write
from kg.errors import UsageError
from kg.similar import did_you_mean

Shell = Annotated[
    str | None,
    typer.Argument(metavar="SHELL", help="bash, zsh, fish or powershell; by default the shell in $SHELL."),
]


def completions(shell: Shell = None) -> None:
    """Print a shell completion script for commands, options and names.

    Completes nodes, packages, launch files, stored queries and rules of the working folder's store.

        kg completions bash > ~/.local/share/bash-completion/completions/kg
        kg completions zsh > ~/.zfunc/_kg        # a folder of $fpath
        kg completions fish > ~/.config/fish/completions/kg.fish
    """
    shells = ("bash", "zsh", "fish", "powershell", "pwsh")
    name = shell or Path(os.environ.get("SHELL", "")).name
    if name not in shells:
        message = f"no completions for the shell `{name}`" if name else "$SHELL is not set"
        hint = (did_you_mean(name, shells) if name else None) or f"Use one of {', '.join(shells)}."
        raise UsageError("KG001", message, hint=hint)
    write(get_completion_script(prog_name="kg", complete_var="_KG_COMPLETE", shell=name))
