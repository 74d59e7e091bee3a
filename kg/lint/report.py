"""The report of `kg lint`: findings selected, allowed, and merged."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from kg.codes import SEVERITIES
from kg.lint.allowing import Allowance, Comments, allowed_by
from kg.lint.baseline import Entry, compared

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from kg.errors import Place
    from kg.lint.finding import Finding


@dataclass(frozen=True, slots=True)
class Choice:
    """The selection: findings of these `systems` (None: all), of these `codes`, of at least `level`.

    With `every`, also those that presume the whole in configurations that others include.
    """

    systems: frozenset[str] | None = None
    codes: frozenset[str] = frozenset()
    level: str = "note"
    every: bool = False

    def wants(self, finding: Finding, included: Collection[str]) -> bool:
        """Return whether a finding is selected; `included` are the names of configurations that others include."""
        rank = SEVERITIES.index(finding.severity) if finding.severity in SEVERITIES else len(SEVERITIES)
        if rank > SEVERITIES.index(self.level) or (self.codes and finding.code not in self.codes):
            return False
        if self.systems is not None:
            return finding.system in self.systems
        return self.every or not (finding.presumes_whole and finding.system in included)


@dataclass(frozen=True, slots=True)
class Report:
    """The report: `findings` sorted by severity, file and line, with those of several systems merged.

    `allowed` are those that kg.toml or a comment allows, `baselined` those of the baseline, `unused` entries of kg.toml
    that allow nothing, `gone` stale entries of the baseline, `without_reason` comments that allow nothing because they
    lack a reason. `raw` has all findings that are not allowed, one for each system, for a baseline.
    """

    findings: tuple[Finding, ...] = ()
    raw: tuple[Finding, ...] = ()
    allowed: tuple[Finding, ...] = ()
    baselined: tuple[Finding, ...] = ()
    unused: tuple[Allowance, ...] = ()
    gone: tuple[Entry, ...] = ()
    without_reason: tuple[tuple[Place, str], ...] = field(default=())

    @property
    def failed(self) -> bool:
        """Whether it has errors or warnings."""
        return any(one.severity != "note" for one in self.findings)


def report(  # noqa: PLR0913 - what findings are compared with
    findings: Iterable[Finding],
    choice: Choice,
    *,
    included: Collection[str],
    entries: Sequence[Allowance],
    comments: Comments,
    baseline: Counter[Entry] | None = None,
) -> Report:
    """Return the report: findings of the `choice` that are not allowed and not in the baseline.

    An entry counts as unused only if it allows none of all findings, whatever the selection.
    """
    every, judge = list(findings), allowed_by(entries, comments)
    verdicts = [(one, judge(one)) for one in every]
    used = {id(verdict) for _, verdict in verdicts if isinstance(verdict, Allowance)}
    wanted = [(one, verdict) for one, verdict in verdicts if choice.wants(one, included)]
    raw = [one for one, verdict in wanted if verdict is False]
    new, baselined, gone = compared(raw, baseline or Counter())
    narrowed = choice.systems is not None or bool(choice.codes) or choice.level != SEVERITIES[-1]
    return Report(
        findings=tuple(merged(new)),
        raw=tuple(raw),
        allowed=tuple(merged([one for one, verdict in wanted if verdict is not False])),
        baselined=tuple(merged(baselined)),
        unused=tuple(one for one in entries if id(one) not in used),
        gone=() if narrowed else tuple(gone),
        without_reason=tuple(sorted(comments.without_reason.items(), key=lambda item: str(item[0]))),
    )


def merged(findings: Iterable[Finding]) -> list[Finding]:
    """Return sorted findings, with the same fault at the same line in several systems merged.

    The merged finding is that of the system whose own file has the line, if there is one.
    """
    groups: defaultdict[object, list[Finding]] = defaultdict(list)
    for one in findings:
        place = one.place and (one.place.repository, one.place.path, one.place.line)
        groups[one.code, one.rule, one.severity, place or one.system, one.subjects].append(one)
    return sorted(_folded(map(_one, groups.values())), key=lambda one: one.order)


_BY_FILE: Final = "architecture/undeclared-argument"
"""The rule whose notes about one file are one: an included file can read tens of arguments that others declare."""
_NAMED: Final = 4


def _folded(findings: Iterable[Finding]) -> Iterator[Finding]:
    """Yield findings, with the notes of a rule about the lines of one file as one note at its first line."""
    notes: defaultdict[object, list[Finding]] = defaultdict(list)
    for one in findings:
        if one.rule == _BY_FILE and one.severity == "note" and one.place is not None:
            notes[one.place.repository, one.place.path].append(one)
        else:
            yield one
    for group in notes.values():
        first, *rest = sorted(group, key=lambda one: one.order)
        subjects = tuple(dict.fromkeys(name for one in (first, *rest) for name in one.subjects))
        names = ", ".join(f"'{name}'" for name in subjects[:_NAMED])
        more = ", ..." if len(subjects) > _NAMED else ""
        yield replace(
            first,
            message=f"{len(subjects)} arguments are read and not declared: {names}{more}" if rest else first.message,
            subjects=subjects,
            evidence=(*first.evidence, *(one.place for one in rest if one.place is not None)),
            also=tuple(sorted({name for one in group for name in (one.system, *one.also)} - {first.system})),
        )


def _one(group: list[Finding]) -> Finding:
    first = min(group, key=lambda one: (not one.in_own_file, one.system, one.message))
    return replace(first, also=tuple(sorted({one.system for one in group} - {first.system})))
