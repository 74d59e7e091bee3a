"""`kg completions`: what lets a shell complete commands, options and names."""

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
    known = ("bash", "zsh", "fish", "powershell", "pwsh")
    asked = shell or Path(os.environ.get("SHELL", "")).name
    if asked not in known:
        message = f"no completions for the shell `{asked}`" if asked else "$SHELL is not set"
        hint = (did_you_mean(asked, known) if asked else None) or f"Use one of {', '.join(known)}."
        raise UsageError("KG001", message, hint=hint)
    write(get_completion_script(prog_name="kg", complete_var="_KG_COMPLETE", shell=asked))
