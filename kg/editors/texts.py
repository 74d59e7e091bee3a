"""Texts as editors have them: documents by path, and positions as the editor counts them (LSP 3.17)."""

from __future__ import annotations

from bisect import bisect_right
from functools import lru_cache
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from lsprotocol import types
from pygls.uris import to_fs_path

from kg.syntax.lexer import normalise

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from pygls.workspace import TextDocument, Workspace

    from kg.errors import Place

_SEVERITIES: Final = {
    "error": types.DiagnosticSeverity.Error,
    "warning": types.DiagnosticSeverity.Warning,
    "note": types.DiagnosticSeverity.Information,
}


class Text:
    """A text with the positions of an editor; lines are those of the protocol, offsets count characters."""

    def __init__(self, source: str, workspace: Workspace) -> None:
        self.source = source
        self.lines = source.splitlines(keepends=True)
        self._codec = workspace.position_codec
        self._starts = [0, *accumulate(map(len, self.lines))]

    def offset(self, position: types.Position) -> int:
        """Return the offset of a position; one behind the text is its end."""
        if position.line >= len(self.lines):
            return len(self.source)
        converted = self._codec.position_from_client_units(self.lines, position)
        return self._starts[converted.line] + converted.character

    def position(self, offset: int) -> types.Position:
        """Return the position of an offset."""
        line = min(bisect_right(self._starts, offset) - 1, max(len(self.lines) - 1, 0))
        return self.at(line, offset - self._starts[line])

    def at(self, line: int, column: int) -> types.Position:
        """Return the position of a column of a line, both from zero."""
        text = self.lines[line][:column] if line < len(self.lines) else ""
        return types.Position(line, self._codec.client_num_units(text))

    def range(self, start: int, end: int) -> types.Range:
        """Return the range of two offsets."""
        return types.Range(self.position(start), self.position(end))

    def span(self, place: Place, characters: int) -> types.Range:
        """Return the range of a place: to its end if it has one, else of so many characters."""
        line, column = (place.line or 1) - 1, (place.column or 1) - 1
        if place.end_line is not None and place.end_column is not None:
            return types.Range(self.at(line, column), self.at(place.end_line - 1, place.end_column - 1))
        return types.Range(self.at(line, column), self.at(line, column + characters))

    def has(self, where: types.Range, written: str) -> bool:
        """Return whether a text is written at a range."""
        return normalise(self.source[self.offset(where.start) : self.offset(where.end)]) == written


@lru_cache(maxsize=1024)
def path_of(uri: str) -> Path | None:
    """Return the path of the file that an address names, without links; None for other addresses."""
    path = to_fs_path(uri)
    return Path(path).resolve() if path and uri.startswith("file:") else None


def uri_of(path: Path, workspace: Workspace) -> str:
    """Return the address of a file: that by which the editor has it open, where it has."""
    document = document_of(path, workspace)
    return document.uri if document else path.absolute().as_uri()


def document_of(path: Path, workspace: Workspace) -> TextDocument | None:
    """Return the open document of a file; editors spell addresses in different ways."""
    return next((each for each in workspace.text_documents.values() if path_of(each.uri) == path.resolve()), None)


def read(path: Path, workspace: Workspace) -> Text | None:
    """Return the text of a file, as the editor has it if it is open there; None if it cannot be read."""
    document = document_of(path, workspace)
    try:
        return Text(document.source if document else path.read_text("utf-8-sig"), workspace)
    except (OSError, UnicodeDecodeError):
        return None


def diagnostic(
    where: types.Range, message: str, severity: str, code: str, fixes: Sequence[dict[str, Any]] = ()
) -> types.Diagnostic:
    """Return a diagnostic of `kg`; `fixes` are its edits, as `actions` reads them."""
    return types.Diagnostic(
        range=where,
        message=message,
        severity=_SEVERITIES[severity],
        code=code,
        source="kg",
        data={"fixes": list(fixes)} if fixes else None,
    )


def actions(diagnostics: Iterable[types.Diagnostic], workspace: Workspace) -> list[types.CodeAction]:
    """Return the quick fixes of diagnostics: the edits in their data that still fit the texts."""
    result = []
    for each in diagnostics:
        fixes = []
        for fix in (each.data or {}).get("fixes", ()):
            path = path_of(fix["uri"])
            text = read(path, workspace) if path else None
            if text is not None and text.has(fix["range"], fix["written"]):
                fixes.append(fix)
        for fix in fixes:
            edit = types.TextEdit(fix["range"], fix["text"])
            result.append(
                types.CodeAction(
                    title=fix["title"],
                    kind=types.CodeActionKind.QuickFix,
                    diagnostics=[each],
                    is_preferred=len(fixes) == 1,
                    edit=types.WorkspaceEdit(changes={fix["uri"]: [edit]}),
                )
            )
    return result
