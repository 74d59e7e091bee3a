from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest
from typer.main import get_command

from kg.cli.app import app
from kg.cli.group import CALLED
from kg.cli.manual import first_paragraph

if TYPE_CHECKING:
    from pathlib import Path

    from cli.program import Program


def test_help_is_data_and_names_every_exit_code(kg: Program) -> None:
    """`kg --help` goes to standard output, says nothing on standard error and documents the contract."""
    run = kg("--help")
    assert (run.code, run.err) == (0, "")
    assert all(f"    {code}  " in run.out or f"  {code}  " in run.out for code in (0, 1, 2, 3, 4, 5, 6, 70, 130))


def test_kg_alone_shows_the_help(kg: Program) -> None:
    """Someone who types only `kg` is shown what there is."""
    assert kg().out == kg("--help").out


def test_help_fits_eighty_columns(kg: Program) -> None:
    """No line of the help is wider than the terminal."""
    assert max(map(len, kg("--help").out.splitlines())) <= 80


@pytest.mark.parametrize(
    ("arguments", "suggestion"),
    [(["explan"], "`explain`"), (["--stor", "x"], "`--store`"), (["explain", "--jsn"], "`--json`")],
)
def test_a_typing_error_gets_a_suggestion(kg: Program, arguments: list[str], suggestion: str) -> None:
    """Wrong commands and options end with 2, on standard error, with the nearest that exists."""
    run = kg(*arguments)
    assert (run.code, run.out) == (2, "")
    assert run.err.startswith("error[KG003]: ")
    assert suggestion in run.err
    assert "--help`" in run.err


def test_commands_are_found_by_what_other_programs_call_them(kg: Program) -> None:
    """Who scans or asks is led to what does that here, which no spelling is near of; each such command is there."""
    assert "Did you mean `build`?" in kg("scan", ".").err
    assert "Did you mean `search` or `query`?" in kg("ask").err
    listed = kg("--help").out
    assert [name for names in CALLED.values() for name in names if f"  {name} " not in listed] == []


def test_a_bad_setting_shows_its_line_with_the_error(kg: Program, tmp_path: Path) -> None:
    """An error in kg.toml comes with file, line and the line itself."""
    (tmp_path / "kg.toml").write_text("jobs = 2\nstroe = 'x'\n")
    run = kg("config", "show")
    assert run.code == 2
    assert f"--> {tmp_path}/kg.toml:2\n  |\n2 | stroe = 'x'\n" in run.err
    assert "help: Did you mean `store`?" in run.err


def test_a_defect_is_reported_in_two_lines_without_traceback(kg: Program) -> None:
    """What should not happen is KG900 with exit code 70; the traceback comes with KG_DEBUG only."""
    broken = "import kg.cli.commands.config as c; c.setting_rows = None; from kg.cli.main import run; run()"
    run = kg.python("-c", broken, "config", "show")
    assert run.code == 70
    assert run.err.startswith("error[KG900]: TypeError: ")
    assert "Traceback" not in run.err
    assert len(run.err.splitlines()) == 2
    assert "Traceback" in kg.python("-c", broken, "--traceback", "config", "show").err
    assert "Traceback" in kg.python("-c", broken, "config", "show", KG_DEBUG="1").err


@pytest.mark.parametrize(
    "where",
    [
        "raise KeyboardInterrupt",
        "exec('raise KeyboardInterrupt')",
        "raise RuntimeError('of a class that was being defined') from KeyboardInterrupt()",
    ],
)
def test_ctrl_c_is_an_exit_code_wherever_it_comes(kg: Program, tmp_path: Path, where: str) -> None:
    """Where it interrupts a text that Python executes or a class that is defined, the process ends with 130 too."""
    broken = f"import kg.cli.commands.config as c\ndef stop(*_):\n    {where}\nc.setting_rows = stop\n"
    (tmp_path / "stopped.py").write_text(f"{broken}from kg.cli.main import run\nrun()\n")
    run = kg.python("-m", "stopped", "config", "show")
    assert (run.code, run.err) == (130, "\ninterrupted\n")


def test_a_closed_pipe_ends_quietly() -> None:
    """`kg ... | head -1` does not mention the pipe."""
    command = f"{sys.executable} -m kg explain --json | head -c 1"
    run = subprocess.run(["bash", "-c", f"set -o pipefail; {command}"], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (0, "{", "")


def test_colour_follows_the_terminal_and_the_flag(kg: Program) -> None:
    """Off a terminal there is no escape unless asked for; NO_COLOR does not win over the flag."""
    assert "\x1b[" not in kg("explan").err
    assert "\x1b[" in kg("--color", "always", "explan", NO_COLOR="1").err
    assert "\x1b[" in kg("explan", KG_COLOR="always").err


def test_the_version_is_said(kg: Program) -> None:
    """`kg --version` is one line."""
    assert kg("--version").out.startswith("kg 0.")


def test_arguments_are_taken_without_loading_a_validator(kg: Program) -> None:
    """A command that needs no store starts without the modules that typer would check types with."""
    program = "import sys; from kg.cli.app import app; app(['explain', 'KG301'], standalone_mode=False)"
    listing = f"import atexit, sys; atexit.register(lambda: print(*sys.modules)); {program}"
    assert not {"pydantic", "rich", "pyoxigraph"} & set(kg.python("-c", listing).out.split())


@pytest.mark.parametrize("streams", [">&-", "2>&-", ">&- 2>&-", ">/dev/null 2>&1"])
def test_closed_streams_are_no_fault(streams: str) -> None:
    """A caller may close what it does not want."""
    command = f"{sys.executable} -m kg explain KG301 {streams}"
    run = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.parametrize("locale", ["C", "C.UTF-8", "POSIX"])
def test_a_full_disk_behind_the_output_is_said(locale: str) -> None:
    """What cannot be written is an error with a code, not a traceback."""
    command = f"LC_ALL={locale} {sys.executable} -m kg explain > /dev/full"
    run = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert run.returncode == 4
    assert run.stderr.startswith("error[KG304]: no space left")


def test_any_character_can_be_said(kg: Program) -> None:
    """A terminal that knows ASCII only gets escapes instead of a crash."""
    run = kg("explain", "KÄ1", PYTHONIOENCODING="ascii")
    assert run.code == 1
    assert "K\\xc41" in run.err


def test_help_says_of_each_command_what_the_command_says() -> None:
    """The lists in `--help` are made without importing the commands: their sentences are those of the commands."""
    pending: list[Any] = [get_command(app)]
    while pending:
        group = pending.pop()
        listed = {name: sentence for _, name, sentence in group.commands.entries()}
        loaded = dict(group.commands.items())
        assert listed == {name: first_paragraph(command) for name, command in loaded.items() if not command.hidden}
        pending += [command for command in loaded.values() if hasattr(command, "commands")]


def test_a_command_imports_no_other_command(kg: Program) -> None:
    """A command starts without the modules of all others."""
    program = "import sys; from kg.cli.app import app; app(['explain', 'KG301'], standalone_mode=False)"
    listing = f"import atexit, sys; atexit.register(lambda: print(*sys.modules)); {program}"
    loaded = {name for name in kg.python("-c", listing).out.split() if name.startswith("kg.cli.commands.")}
    assert loaded == {"kg.cli.commands.explain"}
