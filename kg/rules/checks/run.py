"""Running the checks: files are read one by one; one that does not parse does not stop the others."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.codes.severities import SEVERITIES
from kg.errors import Place, RuleError
from kg.rules.checks import (
    always_fires,
    cartesian_product,
    documentation_missing,
    examples_malformed,
    examples_missing,
    head_never_read,
    never_fires,
    no_rule,
    subsumed,
    unknown_terms,
    variable_used_once,
)
from kg.rules.checks.examples_malformed import orphan
from kg.rules.checks.finding import Context, Finding, from_error
from kg.rules.files import NOTATIONS, RuleSet
from kg.rules.reading import read, rival, rule_files
from kg.rules.specialise import specialise
from kg.rules.stratify import failures

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator
    from pathlib import Path

    from kg.rules.checks.finding import Check
    from kg.rules.files import RuleFile
    from kg.rules.reading import Pack

__all__ = ["CHECKS", "Read", "beside", "check", "check_file", "read_all"]

CHECKS: Final[tuple[Check, ...]] = (
    no_rule,
    unknown_terms,
    cartesian_product,
    never_fires,
    always_fires,
    head_never_read,
    subsumed,
    variable_used_once,
    documentation_missing,
    examples_missing,
    examples_malformed,
)
"""Every check of a rule that could be read, in the order of their codes."""


@dataclass(frozen=True, slots=True)
class Read:
    """The rules of some folders: those that could be read, and the problems of the others.

    `paths` has every file with the name of its rule, whether it could be read or not.
    """

    rules: RuleSet
    findings: tuple[Finding, ...]
    paths: tuple[tuple[str, Path], ...] = ()


def read_all(folders: Iterable[Path], installed: Iterable[Pack] = (), families: Collection[str] = ()) -> Read:
    """Read every rule file below some folders and in some packs; `families` as for `kg.rules.reading.rule_files`."""
    files: dict[str, RuleFile] = {}
    findings: list[Finding] = []
    paths: list[tuple[str, Path]] = []
    for folder, pack in [*((each.folder, each.name) for each in installed), *((folder, "") for folder in folders)]:
        for path, name in rule_files(folder, families):
            place = Place(str(path), 1, 1)
            paths.append((name, path))
            if name in files:
                if problem := rival(path, name, files[name].path):
                    findings.append(Finding(problem.code, "error", name, problem.message, place, problem.hint))
                continue
            try:
                files[name] = read(path, name, pack=pack)
            except RuleError as error:
                findings.append(from_error(error, name, place))
        for path, name in _pages(folder):
            note = orphan(path, name)
            if note:
                paths.append((name, path))
                findings.append(note)
    return Read(RuleSet(tuple(files[name] for name in sorted(files))), tuple(findings), tuple(paths))


def _pages(folder: Path) -> Iterator[tuple[Path, str]]:
    """Yield the pages below a folder without a rule file next to them."""
    for path in sorted(folder.rglob("*.md")):
        below = path.relative_to(folder)
        rules = (path.with_suffix(ending) for ending in NOTATIONS)
        if not any(part.startswith(".") for part in below.parts) and not any(rule.exists() for rule in rules):
            yield path, below.with_suffix("").as_posix()


def check(found: Read, context: Context, names: Iterable[str] | None = None) -> list[Finding]:
    """Return the findings on the rules read, or on those called `names`, sorted by place.

    A cycle belongs to each of its rules, wherever its error stands. `context` is the input of the checks; its rules
    are those that were read.
    """
    context = beside(found.rules, context)
    wanted = None if names is None else set(names)
    findings = [finding for finding in found.findings if wanted is None or finding.rule in wanted]
    findings += _order(context, wanted)
    for file in found.rules.files:
        if wanted is None or file.name in wanted:
            findings += check_file(file, context)
    return sorted(findings, key=_place)


def beside(rules: RuleSet, context: Context) -> Context:
    """Return a context in which files are checked as parts of a rule set."""
    return replace(context, rules=rules, cut=specialise(rules.rules, context.schema))


def check_file(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield the findings of one file that could be read."""
    for each in CHECKS:
        yield from each.check(file, context)


def _order(context: Context, wanted: Collection[str] | None) -> Iterator[Finding]:
    """Yield why rules cannot be put in order: each cycle once, also where only one of its rules is wanted."""
    for failure in failures(context.cut):
        if wanted is None or any(rule.name in wanted for rule in failure.cycle):
            yield from_error(failure.error, failure.rule.name, failure.rule.place)


def _place(finding: Finding) -> tuple[str, int, int, int]:
    place = finding.place
    return place.path, place.line or 0, place.column or 0, SEVERITIES.index(finding.severity)
