"""`kg completions`: what lets a shell complete commands, options and names."""

from pathlib import Path
from typing import Annotated

import typer
from typer.completion import get_completion_script  # type: ignore[attr-defined]  # typer does not export it

from kg.cli.output import write
from kg.errors import UsageError
from kg.similar import did_you_mean

__all__ = ["completions"]

Shell = Annotated[
    str | None,
    typer.Argument(metavar="SHELL", help="bash, zsh, fish or powershell; by default the one that $SHELL names."),
]


def completions(shell: Shell = None) -> None:
    """Print what lets a shell complete commands, options, and names of the store.

    Nodes, packages, launch files, stored queries and rules are those of the store that the working folder has.

        kg completions bash > ~/.local/share/bash-completion/completions/kg
        kg completions zsh > ~/.zfunc/_kg        # a folder of $fpath
        kg completions fish > ~/.config/fish/completions/kg.fish
    """
    import os  # noqa: PLC0415 - start-up time

    known = ("bash", "zsh", "fish", "powershell", "pwsh")
    asked = shell or Path(os.environ.get("SHELL", "")).name
    if asked not in known:
        message = f"`{asked}` is no shell that completions are known for" if asked else "$SHELL names no shell"
        hint = (did_you_mean(asked, known) if asked else None) or f"Give one of {', '.join(known)}."
        raise UsageError("KG001", message, hint=hint)
    write(get_completion_script(prog_name="kg", complete_var="_KG_COMPLETE", shell=asked))
