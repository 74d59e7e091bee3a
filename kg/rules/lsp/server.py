"""The language server over standard input and output; the features are in `kg.rules.lsp.language`."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Final

from lsprotocol import types
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path, to_fs_path

from kg.rules.files import NOTATIONS
from kg.rules.lsp.language import complete, diagnose, hover, term_at, width

if TYPE_CHECKING:
    from collections.abc import Callable

    from pygls.workspace import TextDocument

    from kg.rules.checks.finding import Context, Finding
    from kg.rules.lsp.language import Suggestion
    from kg.rules.lsp.terms import Terms

__all__ = ["Knowledge", "language_server"]

_SEVERITIES: Final = {
    "error": types.DiagnosticSeverity.Error,
    "warning": types.DiagnosticSeverity.Warning,
    "note": types.DiagnosticSeverity.Information,
}
_KINDS: Final = {
    "variable": types.CompletionItemKind.Variable,
    "term": types.CompletionItemKind.Property,
    "keyword": types.CompletionItemKind.Keyword,
    "function": types.CompletionItemKind.Function,
}


@dataclass(slots=True)
class Knowledge:
    """Knowledge of the server in addition to the text: loaded at the start and whenever a rule is saved."""

    folders: tuple[Path, ...]
    context: Callable[[], Context]
    terms: Callable[[], Terms]

    def name_of(self, path: Path) -> str:
        """Return the name that a rule file has: its path below a folder of rules, else its folder and its own name."""
        for folder in self.folders:
            if path.is_relative_to(folder.resolve()):
                return path.relative_to(folder.resolve()).with_suffix("").as_posix()
        return f"{path.parent.name}/{path.stem}"


class _Session:
    """The answers of one server to one editor."""

    def __init__(self, server: LanguageServer, knowledge: Knowledge) -> None:
        self._server = server
        self._knowledge = knowledge
        self.learn()

    def learn(self) -> None:
        """Read rules, ontologies and the store again."""
        self._context = self._knowledge.context()
        self._terms = self._knowledge.terms()

    def _document(self, uri: str) -> tuple[TextDocument, Path] | None:
        path = to_fs_path(uri)
        if path is None or Path(path).suffix not in NOTATIONS:
            return None
        return self._server.workspace.get_text_document(uri), Path(path).resolve()

    def publish(self, uri: str) -> None:
        """Publish the findings on a document as it is in the editor."""
        found = self._document(uri)
        if found is None:
            return
        document, path = found
        findings = diagnose(document.source, path, self._knowledge.name_of(path), self._context)
        here = [_diagnostic(each, document.source) for each in findings if Path(each.place.path).resolve() == path]
        self._server.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(uri=uri, diagnostics=here, version=document.version)
        )

    def completions(self, uri: str, position: types.Position) -> list[types.CompletionItem]:
        """Return the completions at a position."""
        found = self._document(uri)
        if found is None:
            return []
        document, path = found
        offset = document.offset_at_position(position)
        return [_item(each, offset, position) for each in complete(document.source, offset, path.suffix, self._terms)]

    def hover(self, uri: str, position: types.Position) -> types.Hover | None:
        """Return the documentation of the token at a position."""
        found = self._document(uri)
        if found is None:
            return None
        document, path = found
        offset = document.offset_at_position(position)
        text = hover(document.source, offset, path, self._knowledge.name_of(path), self._terms)
        return types.Hover(types.MarkupContent(types.MarkupKind.Markdown, text)) if text else None

    def definition(self, uri: str, position: types.Position) -> types.Location | None:
        """Return where the term at a position is defined."""
        found = self._document(uri)
        if found is None:
            return None
        document, _ = found
        term = term_at(document.source, document.offset_at_position(position), self._terms)
        if term is None or term.place is None:
            return None
        start = types.Position((term.place.line or 1) - 1, 0)
        address = from_fs_path(str(Path(term.place.path).resolve()))
        return types.Location(address, types.Range(start, start)) if address else None


def language_server(knowledge: Knowledge) -> LanguageServer:
    """Return a server that `start_io()` runs until the editor ends it."""
    server = LanguageServer("kg-rules", version("kg-ros"), text_document_sync_kind=types.TextDocumentSyncKind.Full)
    session = _Session(server, knowledge)

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def opened(params: types.DidOpenTextDocumentParams) -> None:
        session.publish(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def changed(params: types.DidChangeTextDocumentParams) -> None:
        session.publish(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    def saved(params: types.DidSaveTextDocumentParams) -> None:
        session.learn()
        session.publish(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions(trigger_characters=["?", ":"]))
    def completed(params: types.CompletionParams) -> list[types.CompletionItem]:
        return session.completions(params.text_document.uri, params.position)

    @server.feature(types.TEXT_DOCUMENT_HOVER)
    def hovered(params: types.HoverParams) -> types.Hover | None:
        return session.hover(params.text_document.uri, params.position)

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    def defined(params: types.DefinitionParams) -> types.Location | None:
        return session.definition(params.text_document.uri, params.position)

    return server


def _diagnostic(finding: Finding, source: str) -> types.Diagnostic:
    line = (finding.place.line or 1) - 1
    column = (finding.place.column or 1) - 1
    text = f"{finding.message}\n{finding.hint}" if finding.hint else finding.message
    return types.Diagnostic(
        range=types.Range(types.Position(line, column), types.Position(line, column + width(source, finding.place))),
        message=text,
        severity=_SEVERITIES[finding.severity],
        code=finding.code,
        source="kg",
    )


def _item(suggestion: Suggestion, offset: int, position: types.Position) -> types.CompletionItem:
    start = types.Position(position.line, position.character - (offset - suggestion.start))
    return types.CompletionItem(
        label=suggestion.text,
        kind=_KINDS[suggestion.kind],
        detail=suggestion.detail or None,
        documentation=types.MarkupContent(types.MarkupKind.Markdown, suggestion.documentation)
        if suggestion.documentation
        else None,
        text_edit=types.TextEdit(types.Range(start, position), suggestion.text),
    )
