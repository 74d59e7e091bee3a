"""The findings of `kg lint` as diagnostics of the files that they are about."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

from lsprotocol import types

from kg.codes import CATALOGUE, PAGE
from kg.editors.texts import Text, diagnostic, read, uri_of
from kg.lint.lines import Lines
from kg.lint.repairs import Repair, places, repairs, written

if TYPE_CHECKING:
    from pygls.workspace import Workspace

    from kg.lint.finding import Evidence, Finding
    from kg.lint.running import Checked


def diagnostics(checked: Checked, workspace: Workspace) -> dict[str, list[types.Diagnostic]]:
    """Return the findings whose lines are on this machine, by the address of the file."""
    lines = Lines(checked.roots)
    result: dict[str, list[types.Diagnostic]] = {}
    for each in checked.report.findings:
        for place in places(each, lines):
            file = lines.file(place.repository, place.path)
            text = read(file, workspace) if file is not None else None
            if file is not None and text is not None:
                of_file = result.setdefault(uri_of(file, workspace), [])
                of_file.append(_diagnostic(each, place, text, lines, workspace))
    return result


def _diagnostic(finding: Finding, place: Evidence, text: Text, lines: Lines, workspace: Workspace) -> types.Diagnostic:
    subject = finding.subjects[0] if finding.subjects else ""
    where = _range(place, written(place, subject, lines) if subject else None, text)
    others = f" (and in {len(finding.also)} more)" if finding.also else ""
    system = "" if finding.in_own_file and not others else f"\nin {finding.system}{others}"
    hint = f"\n{finding.hint}" if finding.hint else ""
    fixes = [fix for each in repairs(finding, lines) if (fix := _fix(each, place, where, lines, workspace))]
    result = diagnostic(where, f"{finding.message}{system}{hint}", finding.severity, finding.code, fixes)
    result.code_description = types.CodeDescription(page) if (page := page_of(finding.code)) else None
    result.related_information = [
        types.DiagnosticRelatedInformation(
            types.Location(uri_of(file, workspace), _range(each, None, other)), each.words or "see"
        )
        for each in (*([finding.place] if finding.place else ()), *finding.evidence)
        if each != place
        if (file := lines.file(each.repository, each.path)) and (other := read(file, workspace))
    ]
    return result


def _range(place: Evidence, name: tuple[int, int, str] | None, text: Text) -> types.Range:
    """Return the range of a name in the lines of a place, else that of the first line without its indentation."""
    if name is not None:
        line, column, text_of_name = name
        return types.Range(text.at(line - 1, column), text.at(line - 1, column + len(text_of_name)))
    number = (place.line or 1) - 1
    line_text = text.lines[number] if number < len(text.lines) else ""
    start = len(line_text) - len(line_text.lstrip())
    return types.Range(text.at(number, start), text.at(number, max(len(line_text.rstrip()), start)))


def _fix(
    repair: Repair, at: Evidence, marked: types.Range, lines: Lines, workspace: Workspace
) -> dict[str, Any] | None:
    """Return the edit of a repair; its title names the line unless that is what is marked."""
    file = lines.file(repair.place.repository, repair.place.path)
    text = read(file, workspace) if file is not None else None
    if file is None or text is None:
        return None
    here = repair.place.path == at.path and repair.line - 1 == marked.start.line
    elsewhere = "" if here else f" in {file.name}:{repair.line}"
    return {
        "title": f"Replace `{repair.written}` by `{repair.text}`{elsewhere}",
        "uri": uri_of(file, workspace),
        "range": types.Range(
            text.at(repair.line - 1, repair.column), text.at(repair.line - 1, repair.column + len(repair.written))
        ),
        "written": repair.written,
        "text": repair.text,
    }


def page_of(code: str) -> str | None:
    """Return the address of the documentation of a code, with its line in the form that editors open."""
    line = _lines_of_codes().get(code)
    return f"{PAGE.as_uri()}#L{line}" if line else None


@lru_cache(maxsize=1)
def _lines_of_codes() -> dict[str, int]:
    lines = PAGE.read_text("utf-8").splitlines()
    heads = ((line.removeprefix("### ").partition(":")[0], number) for number, line in enumerate(lines, 1))
    return {code: number for code, number in heads if code in CATALOGUE}
