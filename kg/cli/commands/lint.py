"""`kg lint`: what is wrong in the wiring of launch files, before anything runs."""

import sys
from contextlib import nullcontext
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from kg.cli.diagnostics import colored, note, say
from kg.cli.options import Form, Json, PackageName, require_valid, takes, with_settings
from kg.cli.output import json_lines, write
from kg.cli.systems import (
    Arguments,
    Environment,
    Launch,
    Variants,
    chosen_systems,
    given,
    report_left_out,
    report_left_out_parts,
)
from kg.errors import Exit, UsageError
from kg.lazily import lazily
from kg.lint.question import DECLARED, Question
from kg.render.text import count
from kg.settings import Settings, load_table
from kg.store.opening import reading

if TYPE_CHECKING:
    from kg.lint.running import Checked

with lazily():
    from kg.cli.build_view import left_out
    from kg.cli.commands.why import why as prove
    from kg.cli.links import Links
    from kg.cli.lint_view import LintView, gone_sources, leftovers, summary
    from kg.cli.progress import for_this_stream
    from kg.lint.baseline import written
    from kg.lint.objects import as_object, remark, spelled, suite_name, xunit
    from kg.lint.report import merged
    from kg.lint.running import check_store, read_folders
    from kg.render.sarif import annotation, document
    from kg.views.names import require_package

_OTHER_FORMATS: Final = dict.fromkeys(("xunit", "junit"), "Use `--xunit-file FILE`.")

Paths = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="PATH", help="Folders to read first, into a temporary store; by default the store is checked."
    ),
]
WriteBaseline = Annotated[
    str | None, typer.Option("--write-baseline", metavar="FILE", help="Write the findings to FILE, for --baseline.")
]
Why = Annotated[bool, typer.Option("--why", help="Prove each finding by its rule and source lines, like `kg why`.")]
Xunit = Annotated[
    str | None, typer.Option("--xunit-file", metavar="FILE", help="Also write the results as an ament test.")
]


@takes(DECLARED.values())
@with_settings("rules", "rule_families", "jobs", "store")
def lint(  # noqa: PLR0913 - the options of a command
    paths: Paths = None,
    *,
    settings: Settings,
    launch: Launch = None,
    arg: Arguments = None,
    env: Environment = None,
    variants: Variants = False,
    package: PackageName = None,
    form: Form = "text",
    write_baseline: WriteBaseline = None,
    xunit_file: Xunit = None,
    why: Why = False,
    json: Json = False,
    **chosen: Any,
) -> None:
    """Report problems in the wiring of launch files.

    Finds names that do not match, incompatible types and qualities of service, remappings and parameters without
    effect, and missing files, without running anything. Exits with 1 if there are errors or warnings. Accept known
    findings in kg.toml under [[lint.allow]], with a reason. For example:

        kg lint
        kg lint ~/catkin_ws/src --level error
        kg lint --launch husky_bringup/launch/base.launch
        kg lint --format sarif > lint.sarif
    """
    began = perf_counter()
    form = "json" if json else form
    require_valid(form, hints=_OTHER_FORMATS)
    arguments, environment = given(launch, arg, env)
    if why and (arg or env or variants or form != "text"):
        hint = "Remove --arg, --env, --variants and --format."
        raise UsageError("KG003", "--why works only on the store and with text output", hint=hint)
    folders = [Path(path) for path in paths or ()]
    own = load_table(DECLARED, chosen, folder=_folder(folders))
    question = Question(launch, package, arguments=arguments, environment=environment, variants=variants, **own)
    if folders:
        with for_this_stream() if sys.stderr.isatty() else nullcontext() as progress:
            settings, found = read_folders(folders, settings, progress)
        left_out(found.inferred)
    if package is not None:
        with reading(settings) as snapshot:
            require_package(snapshot, package)
    checked = check_store(settings, question, _folder(folders))
    if not write_baseline:
        _write(checked, form)
    for words in (*gone_sources(checked), *leftovers(checked.report)):
        note(words)
    for words in summary(checked):
        say(words)
    report_left_out(checked.left_out)
    if launch is not None and form == "text":
        for system in chosen_systems(settings, launch, (), ()):
            report_left_out_parts(system)
    for finding in checked.report.findings if why else ():
        write("")
        prove([f"<{finding.iri}>", "rdf:type", "rnkg:Finding"], settings=settings)
    if xunit_file:
        _write_xunit(checked, Path(xunit_file), perf_counter() - began)
    if write_baseline:
        # A baseline accepts the findings in it, so they do not fail the command.
        _save(Path(write_baseline), written(checked.report.raw))
        say(f"{count(len(merged(checked.report.raw)), 'finding')} written to {write_baseline}")
    elif checked.report.failed:
        raise typer.Exit(Exit.FOUND)


def _folder(folders: list[Path]) -> Path:
    """Return where `kg.toml` is looked for: the first of the folders, or the working folder."""
    return (folders[0] if folders and folders[0].is_dir() else Path.cwd()).absolute()


def _write(checked: "Checked", form: str) -> None:
    """Write the findings to standard output."""
    findings = checked.report.findings
    here = Path.cwd()
    if form == "json":
        json_lines(map(as_object, findings))
    elif form == "sarif":
        json_lines([document([remark(one, checked.roots, here) for one in findings])])
    elif form == "github":
        for one in findings:
            write(annotation(remark(one, checked.roots, here)))
    else:
        for line in LintView(checked, Links.of(checked.sources), here, color=colored(sys.stdout)).lines():
            write(line)


def _write_xunit(checked: "Checked", file: Path, seconds: float) -> None:
    findings = checked.report.findings
    spots = [
        f"{spelled(one.place, checked.roots, Path.cwd())}:{one.line or 1}" if one.place else one.system
        for one in findings
    ]
    _save(file, xunit(findings, suite_name(file), seconds, spots))


def _save(file: Path, text: str) -> None:
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    except OSError as problem:
        raise UsageError("KG003", f"{file} cannot be written: {problem.strerror}") from None
