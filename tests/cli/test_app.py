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
    """`kg --help` prints to standard output, prints nothing on standard error and documents the exit codes."""
    run = kg("--help")
    assert (run.code, run.err) == (0, "")
    assert all(f"    {code}  " in run.out or f"  {code}  " in run.out for code in (0, 1, 2, 3, 4, 5, 6, 70, 130))


def test_kg_alone_shows_the_help(kg: Program) -> None:
    """`kg` without arguments shows the help."""
    assert kg().out == kg("--help").out


def test_help_fits_eighty_columns(kg: Program) -> None:
    """No line of the help is wider than eighty columns."""
    assert max(map(len, kg("--help").out.splitlines())) <= 80


@pytest.mark.parametrize(
    ("arguments", "suggestion"),
    [(["explan"], "`explain`"), (["--stor", "x"], "`--store`"), (["explain", "--jsn"], "`--json`")],
)
def test_a_typing_error_gets_a_suggestion(kg: Program, arguments: list[str], suggestion: str) -> None:
    """A wrong command or option exits with 2 and suggests the nearest existing one on standard error."""
    run = kg(*arguments)
    assert (run.code, run.out) == (2, "")
    assert run.err.startswith("error[KG003]: ")
    assert suggestion in run.err
    assert "--help`" in run.err


def test_an_argument_too_many_is_named(kg: Program) -> None:
    """The error names the first superfluous argument."""
    assert "error[KG003]: unexpected argument `nav2_amcl`\n" in kg("files", "nav2_amcl", "more").err


def test_commands_are_found_by_what_other_programs_call_them(kg: Program) -> None:
    """Common names of other programs' commands suggest the existing equivalent, although their spelling differs."""
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
    """A defect is KG900 with exit code 70; the traceback is shown only with KG_DEBUG."""
    broken = "import kg.cli.commands.doctor as c; c.table_values = None; from kg.cli.main import run; run()"
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
    """Ctrl-C during text executed by Python or a class definition exits with 130, too."""
    broken = f"import kg.cli.commands.doctor as c\ndef stop(*_):\n    {where}\nc.table_values = stop\n"
    (tmp_path / "stopped.py").write_text(f"{broken}from kg.cli.main import run\nrun()\n")
    run = kg.python("-m", "stopped", "config", "show")
    assert (run.code, run.err) == (130, "\ninterrupted\n")


def test_a_closed_pipe_ends_quietly() -> None:
    """`kg ... | head -1` prints no error about the pipe."""
    command = f"{sys.executable} -m kg explain --json | head -c 1"
    run = subprocess.run(["bash", "-c", f"set -o pipefail; {command}"], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (0, "{", "")


def test_colour_follows_the_terminal_and_the_flag(kg: Program) -> None:
    """Without a terminal there is no escape unless requested; NO_COLOR does not override the flag."""
    assert "\x1b[" not in kg("explan").err
    assert "\x1b[" in kg("--color", "always", "explan", NO_COLOR="1").err
    assert "\x1b[" in kg("explan", KG_COLOR="always").err


def test_the_version_is_said(kg: Program) -> None:
    """`kg --version` prints one line."""
    assert kg("--version").out.startswith("kg 0.")


def test_arguments_are_taken_without_loading_a_validator(kg: Program) -> None:
    """A command without a store starts without the modules that typer uses to validate types."""
    program = "import sys; from kg.cli.app import app; app(['explain', 'KG301'], standalone_mode=False)"
    listing = f"import atexit, sys; atexit.register(lambda: print(*sys.modules)); {program}"
    assert not {"pydantic", "rich", "pyoxigraph"} & set(kg.python("-c", listing).out.split())


@pytest.mark.parametrize("streams", [">&-", "2>&-", ">&- 2>&-", ">/dev/null 2>&1"])
def test_closed_streams_are_no_fault(streams: str) -> None:
    """The caller may close unused streams."""
    command = f"{sys.executable} -m kg explain KG301 {streams}"
    run = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.parametrize("locale", ["C", "C.UTF-8", "POSIX"])
def test_a_full_disk_behind_the_output_is_said(locale: str) -> None:
    """Output that cannot be written is an error with a code and no traceback."""
    command = f"LC_ALL={locale} {sys.executable} -m kg explain > /dev/full"
    run = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert run.returncode == 4
    assert run.stderr.startswith("error[KG304]: no space left")


def test_any_character_can_be_said(kg: Program) -> None:
    """An ASCII terminal gets escapes instead of a crash."""
    run = kg("explain", "KÄ1", PYTHONIOENCODING="ascii")
    assert run.code == 1
    assert "K\\xc41" in run.err


def test_help_says_of_each_command_what_the_command_says() -> None:
    """The lists in `--help` are built without importing the commands, and match the commands' own sentences."""
    pending: list[Any] = [get_command(app)]
    while pending:
        group = pending.pop()
        listed = {name: sentence for _, name, sentence in group.commands.entries()}
        loaded = dict(group.commands.items())
        assert listed == {name: first_paragraph(command) for name, command in loaded.items() if not command.hidden}
        pending += [command for command in loaded.values() if hasattr(command, "commands")]


def test_a_command_imports_no_other_command(kg: Program) -> None:
    """A command starts without importing the modules of the others."""
    program = "import sys; from kg.cli.app import app; app(['explain', 'KG301'], standalone_mode=False)"
    listing = f"import atexit, sys; atexit.register(lambda: print(*sys.modules)); {program}"
    loaded = {name for name in kg.python("-c", listing).out.split() if name.startswith("kg.cli.commands.")}
    assert loaded == {"kg.cli.commands.doctor"}
