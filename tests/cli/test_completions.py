from __future__ import annotations

import shutil
import subprocess
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from cli.program import Program


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish", "powershell"])
def test_each_shell_gets_a_script_that_asks_the_program(kg: Program, shell: str) -> None:
    """`kg completions SHELL` prints a script that calls `kg` with its completion variable."""
    assert "_KG_COMPLETE" in kg("completions", shell).out


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_bash_takes_the_script(kg: Program) -> None:
    """Bash can read its script, which registers a completion of `kg`."""
    script = kg("completions", "bash").out + "\ncomplete -p kg\n"
    ran = subprocess.run(["bash", "--norc", "-c", script], capture_output=True, text=True, check=True)
    assert ran.stdout.rstrip().endswith(" kg")


def test_an_unknown_shell_is_told_with_the_one_meant(kg: Program) -> None:
    """A misspelt shell is a usage error that suggests the right one."""
    result = kg("completions", "bahs")
    assert result.code == 2
    assert "Did you mean `bash`?" in result.err
