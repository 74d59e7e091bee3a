"""`kg doctor`, `explain`, `config` and `completions`: help with the installation, errors, settings and shells."""

import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer
from typer.completion import get_completion_script  # type: ignore[attr-defined]  # typer does not export it

from kg.cli.completion import codes
from kg.cli.diagnostics import colored, say
from kg.cli.options import Json, argument, session, with_settings
from kg.cli.output import Column, json_lines, print_table, write
from kg.errors import CATALOGUE, Exit, KgError, StoreError, UsageError
from kg.lazily import lazily
from kg.render.text import count, printable
from kg.resources import folder
from kg.settings import Settings
from kg.similar import did_you_mean, unknown
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from kg.store.layout import Layout


with lazily():
    from kg.language.annotating import prepare
    from kg.language.loading import describe
    from kg.lint import question
    from kg.server import options as server
    from kg.server.libraries import libraries
    from kg.settings import table_values
    from kg.store.locks import busy
    from kg.store.snapshot import EmbeddedSnapshot


_DISTRIBUTION: Final = "kg-ros"
_LEAST_FREE: Final = 200 << 20


@dataclass(frozen=True, slots=True)
class Check:
    """The result of a check: `state` is ok, note (something optional is missing) or wrong."""

    subject: str
    state: str
    finding: str
    way_out: str = ""


def checks(settings: Settings) -> "Iterator[Check]":
    """Yield the results of all checks, basic ones first."""
    from kg.server.libraries import HELP  # noqa: PLC0415 - start-up time

    yield Check("Python", "ok", f"{platform.python_version()} at {sys.executable}")
    yield from _dependencies()
    missing = [name for name in ("ontology", "rules", "queries", "examples") if not folder(name).is_dir()]
    if missing:
        yield Check("data files", "wrong", f"missing: {', '.join(missing)}", f"install {_DISTRIBUTION} again")
    else:
        yield Check("data files", "ok", str(folder("ontology").parent))
    if libraries():
        yield Check("pages", "ok", count(len(libraries()), "library", "libraries"))
    else:
        finding = "their libraries are missing: no pictures, and a plain text field as the editor"
        yield Check("pages", "note", finding, HELP)
    way_out = "install git: without it commits are not known and addresses cannot be cloned"
    yield _program("git", "--version", "wrong", way_out)
    yield _program("Java", "-version", "note", CATALOGUE["KG603"].way_out)
    yield _language(settings)
    yield from _store(settings)
    yield _disk(settings)
    for declaration, value, origin in settings.values():
        if origin.kind != "default":
            yield Check(f"setting {declaration.name}", "ok", f"{value} (from {origin})")


def _language(settings: Settings) -> "Check":
    if settings.nlp_model:
        try:
            prepare(settings.nlp_model)
        except KgError as error:
            return Check("tagger", "wrong", str(error), error.hint or "")
    return Check("tagger", "ok", describe(settings.nlp_model))


def _dependencies() -> "Iterator[Check]":
    try:
        own, needed = version(_DISTRIBUTION), requires(_DISTRIBUTION) or []
    except PackageNotFoundError:
        yield Check("kg", "note", "runs from a folder, not from an installation", "pip install .")
        return
    yield Check("kg", "ok", f"{own} at {Path(__file__).parents[2]}")
    for requirement in needed:
        name = requirement.split(";")[0].strip()
        bare = name.split("[")[0].split(">")[0].split("=")[0].split("<")[0].split("~")[0].split("!")[0].strip()
        extra = requirement.partition("extra ==")[2].strip(" '\"")
        if extra == "dev":
            continue
        try:
            yield Check(bare, "ok", version(bare))
        except PackageNotFoundError:
            way_out = (
                f"for some commands only: pip install '{_DISTRIBUTION}[{extra}]'" if extra else f"pip install '{name}'"
            )
            yield Check(bare, "note" if extra else "wrong", "not installed", way_out)


def _program(name: str, option: str, missing: str, way_out: str) -> "Check":
    """Check a program by the first line that it prints about its version; `missing` is the state without it."""
    path = shutil.which(name.lower())
    line = ""
    if path is not None:
        try:
            done = subprocess.run([path, option], capture_output=True, text=True, check=False, timeout=20)  # noqa: S603 - a fixed program of the system
            line = (done.stdout or done.stderr).partition("\n")[0] if done.returncode == 0 else ""
        except (OSError, subprocess.TimeoutExpired):
            pass
    return Check(name, "ok", line) if line else Check(name, missing, "not found", way_out)


def _store(settings: Settings) -> "Iterator[Check]":
    try:
        layout = layout_of(settings)
    except KgError as error:
        state = "note" if settings.store is None else "wrong"
        finding = "none in this folder or above" if settings.store is None else error.message
        yield Check("store", state, finding, CATALOGUE[error.code].way_out)
        return
    yield _content(layout)
    holder = busy(layout)
    if holder is None:
        yield Check("writer", "ok", "none at work")
    else:
        yield Check("writer", "note", holder.message, holder.hint or "")


def _content(layout: "Layout") -> "Check":
    try:
        with EmbeddedSnapshot(layout) as snapshot:
            quads, graphs = snapshot.count(), len(snapshot.graphs())
            generation = snapshot.generation
    except StoreError as error:
        state = "note" if error.code == "KG301" else "wrong"
        return Check("store", state, f"{layout.root}: {error.message}", error.hint or CATALOGUE[error.code].way_out)
    size = sum(file.stat().st_size for file in layout.generation(generation).rglob("*") if file.is_file())
    return Check(
        "store",
        "ok",
        f"{layout.root}: generation {generation} ({len(layout.numbers())} kept), "
        f"{count(quads, 'quad')} in {count(graphs, 'graph')}, {size / 1e6:,.1f} MB",
    )


def _disk(settings: Settings) -> "Check":
    place = Path(settings.store or Path.cwd())
    place = next(folder for folder in (place, *place.parents) if folder.exists())
    free = shutil.disk_usage(place).free
    finding = f"{free / 1e9:,.1f} GB free at {place}"
    if free < _LEAST_FREE:
        return Check("disk", "wrong", finding, "free some space, or put the store elsewhere with --store")
    return Check("disk", "ok", finding)


@with_settings("store")
def doctor(*, settings: Settings, json: Json = False) -> None:
    """Check the installation and the store.

    Checks Python and the packages that kg needs, git, Java, the disk, the store and the settings. Exits with 1 if a
    check fails.
    """
    wrong = 0
    marks = {"ok": "32", "note": "36", "wrong": "1;31"}
    for check in checks(settings):
        wrong += check.state == "wrong"
        if json:
            json_lines([asdict(check)])
            continue
        state = f"\x1b[{marks[check.state]}m{check.state:<5}\x1b[0m" if colored(sys.stdout) else f"{check.state:<5}"
        write(f"{state}  {check.subject:<18} {printable(check.finding)}")
        if check.way_out:
            write(f"{'':<26}{printable(check.way_out)}")
    if wrong:
        say(f"{count(wrong, 'thing is', 'things are')} wrong")
        raise typer.Exit(Exit.FOUND)


Code = Annotated[str | None, argument("CODE", "Code such as KG101; by default all are listed.", autocompletion=codes)]


def explain(code: Code = None, *, json: Json = False) -> None:
    """Explain an error code and how to fix the error.

    Without a code, lists all codes. For example:

        kg explain KG301
    """
    chosen = {code.upper(): CATALOGUE[code.upper()]} if code and code.upper() in CATALOGUE else CATALOGUE
    if code and len(chosen) != 1:
        raise unknown("code", code, CATALOGUE, otherwise="`kg explain` lists the codes.")
    if json:
        json_lines(
            {"code": key, "title": one.title, "explanation": one.explanation, "way_out": one.way_out}
            for key, one in chosen.items()
        )
    elif code:
        for key, one in chosen.items():
            write(f"{key}: {one.title}\n\n{one.explanation}\n\nFix: {one.way_out}")
    else:
        for key, one in chosen.items():
            write(f"{key}  {one.title}")


Shell = Annotated[str | None, argument("SHELL", "bash, zsh, fish or powershell; by default the shell in $SHELL.")]


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


def show_settings(context: typer.Context, *, json: Json = False) -> None:
    """Show all settings with their values and origins.

    A flag overrides the environment variable, which overrides the nearest kg.toml in this folder or above, which
    overrides the default:

        # kg.toml
        store = "/data/kg"
        jobs = 8
        [serve]
        port = 8080
    """
    entries = [*session(context).settings().values()]
    for table in (question.DECLARED, server.DECLARED):
        entries += table_values(table)
    shown = []
    for one, value, origin in entries:
        plain = [str(path) for path in value] if isinstance(value, tuple) else value
        plain = plain if isinstance(plain, int | float | str | list | None) else str(plain)
        name = ".".join(filter(None, (one.table, one.key)))
        if json:
            record = {"setting": name, "value": plain, "origin": str(origin)}
            json_lines([{**record, "flag": one.flag, "variable": one.variable, "about": one.sentence}])
        text = os.pathsep.join(plain) if isinstance(plain, list) else str(plain)
        shown.append((name, "-" if plain is None or plain == [] else text, str(origin), one.sentence))
    if not json:
        print_table(
            (Column("setting", "name"), Column("value"), Column("origin"), Column("about", "dim", spare=1)), shown
        )
