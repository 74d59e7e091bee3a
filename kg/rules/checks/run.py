"""Running the checks: files are read one by one; one that does not parse does not stop the others."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from kg.codes import SEVERITIES
from kg.errors import Place
from kg.rules.checks.documents import documentation_missing, examples_malformed, examples_missing, no_rule, orphan
from kg.rules.checks.finding import Context, Finding, from_error
from kg.rules.checks.firing import always_fires, never_fires
from kg.rules.checks.subsumed import subsumed
from kg.rules.checks.vocabulary import cartesian_product, head_never_read, unknown_terms, variable_used_once
from kg.rules.files import NOTATIONS, RuleFile, RuleSet
from kg.rules.reading import Pack, read_each, sources
from kg.rules.specialise import specialise
from kg.rules.stratify import failures

CHECKS: Final[Mapping[str, Callable[[RuleFile, Context], Iterator[Finding]]]] = {
    "KG201": no_rule,
    "KG211": unknown_terms,
    "KG212": cartesian_product,
    "KG213": never_fires,
    "KG214": always_fires,
    "KG215": head_never_read,
    "KG216": subsumed,
    "KG217": variable_used_once,
    "KG218": documentation_missing,
    "KG219": examples_missing,
    "KG221": examples_malformed,
}
"""Every check of a rule that could be read, by its code, in their order."""


@dataclass(frozen=True, slots=True)
class Read:
    """The rules of some folders: those that could be read, and the problems of the others.

    `paths` has every file with the name of its rule, whether it could be read or not.
    """

    rules: RuleSet
    findings: tuple[Finding, ...]
    paths: tuple[tuple[str, Path], ...] = ()

    def named(self, word: str) -> list[str]:
        """Return the rules that a word means: one by its name, a family, a file or a folder; files with errors too."""
        path = Path(word).resolve()
        family = f"{word.rstrip('/')}/"
        return [
            name
            for name, file in self.paths
            if name == word or name.startswith(family) or file.resolve().is_relative_to(path)
        ]

    def outside(self, words: Iterable[str]) -> list[Path]:
        """Return the files among `words` that have the ending of a rule and were not read."""
        read = {file.resolve() for _, file in self.paths}
        files = (Path(word) for word in words)
        return [file for file in files if file.suffix in NOTATIONS and file.is_file() and file.resolve() not in read]

    def others_than(self, shipped: Path) -> list[str]:
        """Return the rules outside the folder `shipped`."""
        folder = shipped.resolve()
        return [name for name, file in self.paths if not file.resolve().is_relative_to(folder)]


def read_all(folders: Iterable[Path], installed: Iterable[Pack] = (), families: Collection[str] = ()) -> Read:
    """Read every rule file below some folders and in some packs; `families` as for `kg.rules.reading.rule_files`."""
    files: dict[str, RuleFile] = {}
    findings: list[Finding] = []
    paths: list[tuple[str, Path]] = []
    folders, installed = tuple(folders), tuple(installed)
    for path, name, result in read_each(folders, installed, families):
        paths.append((name, path))
        if isinstance(result, RuleFile):
            files[name] = result
        elif result:
            place = Place(str(path), 1, 1)
            finding = from_error(result, name, place)
            findings.append(replace(finding, place=place) if result.code == "KG207" else finding)
    for folder, _ in sources(folders, installed):
        for path, name in _pages(folder):
            if note := orphan(path, name):
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


def check(loaded: Read, context: Context, names: Iterable[str] | None = None) -> list[Finding]:
    """Return the findings on the rules read, or on those called `names`, sorted by place.

    A cycle belongs to each of its rules, wherever its error stands, and is reported once. `context` is the input of the
    checks; its rules are those that were read.
    """
    context = with_rules(loaded.rules, context)
    wanted = None if names is None else set(names)
    findings = [finding for finding in loaded.findings if wanted is None or finding.rule in wanted]
    findings += (
        from_error(failure.error, failure.rule.name, failure.rule.place)
        for failure in failures(context.cut)
        if wanted is None or any(rule.name in wanted for rule in failure.cycle)
    )
    for file in loaded.rules.files:
        if wanted is None or file.name in wanted:
            findings += check_file(file, context)

    def place(finding: Finding) -> tuple[str, int, int, int]:
        at = finding.place
        return at.path, at.line or 0, at.column or 0, SEVERITIES.index(finding.severity)

    return sorted(findings, key=place)


def with_rules(rules: RuleSet, context: Context) -> Context:
    """Return a context in which files are checked as parts of a rule set."""
    return replace(context, rules=rules, cut=specialise(rules.rules, context.schema))


def check_file(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield the findings of one file that could be read."""
    for each in CHECKS.values():
        yield from each(file, context)
