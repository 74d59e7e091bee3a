"""`kg lint`: what is wrong in the wiring of launch files, before anything runs."""

import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Annotated, Any, Final

import typer

from kg.cli.diagnostics import colored, dim, excerpt, head, helps, linked, note, say
from kg.cli.options import Json, PackageName, argument, option, takes, with_settings
from kg.cli.output import write
from kg.cli.remarks import Form, require_valid, totals, write_remarks
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
from kg.codes import CATALOGUE
from kg.errors import Exit, Place, UsageError
from kg.facts import Location
from kg.lazily import lazily
from kg.lint.question import DECLARED, Question
from kg.render.text import count, printable, some
from kg.settings import Settings, load_table
from kg.store.opening import reading

with lazily():
    from kg.cli.commands.build import left_out
    from kg.cli.commands.why import why as prove
    from kg.cli.links import Links
    from kg.cli.progress import for_this_stream
    from kg.graph.chains import chain_of
    from kg.lint.baseline import written
    from kg.lint.finding import Evidence, Finding
    from kg.lint.lines import Lines
    from kg.lint.objects import as_object, remark, spelled, suite_name, xunit
    from kg.lint.report import Report, merged
    from kg.lint.running import Checked, check_store, read_folders
    from kg.views.names import require_package


_OTHER_FORMATS: Final = dict.fromkeys(("xunit", "junit"), "Use `--xunit-file FILE`.")

Paths = Annotated[
    list[str] | None,
    argument("PATH", "Folders to read first, into a temporary store; by default the store is checked."),
]
WriteBaseline = Annotated[str | None, option("--write-baseline FILE", "Write the findings to FILE, for --baseline.")]
Why = Annotated[bool, option("--why", "Prove each finding by its rule and source lines, like `kg why`.")]
Xunit = Annotated[str | None, option("--xunit-file FILE", "Also write the results as an ament test.")]


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
    for folder in folders:
        if folder.suffix in _LAUNCH_ENDINGS and not folder.is_dir():
            hint = f"`kg lint --launch {folder}` checks a launch file of the store."
            raise UsageError("KG003", f"`{folder}` is not a folder", hint=hint)
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
    findings, here = checked.report.findings, Path.cwd()
    view = LintView(checked, Links.of(checked.sources), here, color=colored(sys.stdout))
    remarks = (remark(one, checked.roots, here) for one in findings)
    write_remarks(form, lines=view.lines(), objects=map(as_object, findings), remarks=remarks)


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


_LAUNCH_ENDINGS: Final = frozenset({".launch", ".py", ".test", ".xml", ".yaml", ".yml"})
_MOST_EVIDENCE: Final = 4
"""Maximum number of evidence lines, and of further findings of a group; JSON has them all."""


class LintView:
    """Formats the findings of one report; paths are relative to `folder`."""

    def __init__(self, checked: "Checked", links: "Links", folder: Path, *, color: bool) -> None:
        self._checked = checked
        self._links = links
        self._lines = Lines(checked.roots)
        self._folder = folder
        self._color = color
        self._helped: set[str] = set()

    def lines(self) -> "Iterator[str]":
        """Yield the lines of all findings, separated by empty lines; findings of one kind are grouped."""
        for first, *others in _groups(self._checked.report.findings):
            yield from self._finding(first, others)
            yield ""

    def _finding(self, finding: "Finding", others: "Sequence[Finding]") -> "Iterator[str]":
        yield head(finding.severity, finding.code, finding.message, color=self._color)
        place = finding.place
        if place is not None:
            shown = Place(self._spelled(place), place.line, excerpt=self._lines.at(place, place.line) or "")
            yield from excerpt(shown, color=self._color, address=self._address(place))
        gutter = " " * len(str(finding.line or ""))
        sign = dim("=", color=self._color)
        yield from (f"{gutter} {sign} {words}" for words in self._remarks(finding))
        for one in others[:_MOST_EVIDENCE]:
            line = f" (line {one.line})" if one.line != finding.line else ""
            yield f"{gutter} {sign} and {printable(one.message)}{line}"
        if len(others) > _MOST_EVIDENCE:
            yield f"{gutter} {sign} and {len(others) - _MOST_EVIDENCE:,} more; --json has them all"
        yield from self._help(finding)

    def _remarks(self, finding: "Finding") -> "Iterator[str]":
        others = f", and in {count(len(finding.also), 'other system')}" if finding.also else ""
        if others or not finding.in_own_file:
            yield f"in {printable(finding.system)}{others}"
        if finding.place is not None and finding.place.chain:
            yield f"included by {' > '.join(self._steps(finding))}"
        for one in finding.evidence[:_MOST_EVIDENCE]:
            name = self._spelled(one) if one.line is None else f"{self._spelled(one)}:{one.line}"
            where = linked(name, self._address(one), color=self._color)
            yield f"{where} {printable(one.words)}".rstrip()
        if len(finding.evidence) > _MOST_EVIDENCE:
            yield f"and {count(len(finding.evidence) - _MOST_EVIDENCE, 'other line')}; --json has them all"

    def _steps(self, finding: "Finding") -> "Iterator[str]":
        """Yield the includes that lead to the line to fix."""
        for step in chain_of(finding.place.chain if finding.place else None):
            place = Evidence(step.path, step.line, step.repository or finding.source)
            yield linked(f"{printable(self._spelled(place))}:{place.line}", self._address(place), color=self._color)

    def _help(self, finding: "Finding") -> "Iterator[str]":
        """Yield the finding's own hint, or that of its code, the latter only once."""
        entry = CATALOGUE.get(finding.code)
        if finding.hint:
            yield from helps(finding.hint, color=self._color)
        elif entry is not None and finding.code not in self._helped:
            self._helped.add(finding.code)
            yield from helps(f"{entry.way_out} (`kg explain {finding.code}`)", color=self._color)

    def _spelled(self, place: "Evidence") -> str:
        return spelled(place, self._checked.roots, self._folder)

    def _address(self, place: "Evidence") -> str | None:
        return self._links.to(place.repository, Location(place.path, place.line or 1))


def _groups(findings: "Sequence[Finding]") -> "list[list[Finding]]":
    """Return findings in groups that are reported together, by their first ones."""
    groups: dict[object, list[Finding]] = {}
    for one in findings:
        groups.setdefault(_kind(one), []).append(one)
    return list(groups.values())


_BY_NODE: Final = "architecture/parameter-not-read"
"""The rule whose findings about one node in one file are one group: a node may read none of a file of parameters."""


def _kind(finding: "Finding") -> tuple[object, ...]:
    """Return the key by which findings are grouped: code, rule, severity, and line, or file, node and systems."""
    place = finding.place
    where: object = (place.repository, place.path, place.line) if place is not None else finding
    if place is not None and finding.rule == _BY_NODE:
        where = (place.repository, place.path, finding.subjects[1:], finding.system, finding.also)
    return finding.code, finding.rule, finding.severity, where


def summary(checked: "Checked") -> "Iterator[str]":
    """Yield the summary: number of findings, and stale entries of the allow-list and the baseline."""
    report = checked.report
    found = totals(one.severity for one in report.findings)
    groups = _groups(report.findings)
    if len(groups) < len(report.findings):
        found += f" in {count(len(groups), 'group')}"
    aside = [
        f"{len(group):,} {words}"
        for group, words in ((report.allowed, "allowed"), (report.baselined, "in the baseline"))
        if group
    ]
    found = found or ("nothing wrong" if checked.systems else "no launch files found")
    yield f"{count(checked.systems, 'system')} checked: {'; '.join([found, *aside])}"
    numbers = Counter(one.code for one in report.findings)
    repeated = sorted(code for code, number in numbers.items() if number > 1 and code in CATALOGUE)
    if repeated:
        yield f"{', '.join(f'`kg explain {code}`' for code in repeated)}: details and fixes"


def gone_sources(checked: "Checked") -> "Iterator[str]":
    """Yield notes about sources that no longer exist on disk, whose lines and comments cannot be read."""
    for one in checked.sources:
        if one.root and not Path(one.root).is_dir():
            consequence = "lines are not shown, and comments that allow are not read"
            yield f"{printable(one.name)} is not in {printable(one.root)} any more: {consequence}"


def leftovers(report: "Report") -> "Iterator[str]":
    """Yield notes about stale entries of kg.toml and of the baseline, and comments without a reason."""
    for allowance in report.unused:
        yield f"{_near(allowance.place)}: the entry for {allowance.code} matches no finding; remove it"
    for place, code in report.without_reason:
        way = "write the reason after the code"
        yield f"{_near(place)}: the comment gives no reason, so {code} is still reported; {way}"
    if report.gone:
        named = some([printable(f"{one.code} {', '.join(one.subjects)}".strip()) for one in report.gone], 3, "; ")
        entries = count(len(report.gone), "finding")
        yield f"{entries} of the baseline {'is' if len(report.gone) == 1 else 'are'} fixed: {named}"


def _near(place: Place) -> str:
    """Return a place relative to the working folder."""
    path, here = Path(place.path), Path.cwd()
    return str(replace(place, path=str(path.relative_to(here)))) if path.is_relative_to(here) else str(place)
