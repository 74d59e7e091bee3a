"""Rules in editors: the features of `kg.rules.lsp` at positions of documents."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from lsprotocol import types

from kg.editors.texts import Text, diagnostic, path_of, read, uri_of
from kg.errors import Fix, UsageError
from kg.rules.files import NOTATIONS
from kg.rules.lsp.symbols import (
    Occurrence,
    Suggestion,
    Symbol,
    Terms,
    complete,
    diagnose,
    hover,
    occurrences,
    renamed,
    symbol_at,
    term_at,
    width,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from pygls.workspace import Workspace

    from kg.rules.checks.finding import Context

_KINDS: Final = {
    "variable": types.CompletionItemKind.Variable,
    "term": types.CompletionItemKind.Property,
    "keyword": types.CompletionItemKind.Keyword,
    "function": types.CompletionItemKind.Function,
}


@dataclass(frozen=True, slots=True)
class Knowledge:
    """Knowledge of the server about rules in addition to their text.

    `names` has the rule files in force by the name of the rule. `own` are the files of the user that may name a rule or
    a term: rules, pages of examples, ontologies, stored queries, kg.toml. `shipped` are rules and ontologies of others.
    """

    folders: tuple[Path, ...]
    context: Context
    terms: Terms
    names: Mapping[str, Path]
    own: tuple[Path, ...] = ()
    shipped: tuple[Path, ...] = ()

    def name_of(self, path: Path) -> str:
        """Return the name that a rule file has: its path below a folder of rules, else its folder and its own name."""
        for folder in self.folders:
            if path.is_relative_to(folder.resolve()):
                return path.relative_to(folder.resolve()).with_suffix("").as_posix()
        return f"{path.parent.name}/{path.stem}"


class Rules:
    """The answers about rules to one editor; None and empty answers are for files that are not rules."""

    def __init__(self, workspace: Workspace, knowledge: Knowledge) -> None:
        self._workspace = workspace
        self._knowledge = knowledge

    def _document(self, uri: str) -> tuple[Text, Path] | None:
        path = path_of(uri)
        if path is None or path.suffix not in NOTATIONS:
            return None
        return Text(self._workspace.get_text_document(uri).source, self._workspace), path

    def diagnostics(self, uri: str) -> list[types.Diagnostic] | None:
        """Return the findings on a document as it is in the editor."""
        document = self._document(uri)
        if document is None:
            return None
        text, path = document
        result = []
        for each in diagnose(text.source, path, self._knowledge.name_of(path), self._knowledge.context):
            if Path(each.place.path).resolve() == path:
                where = text.span(each.place, width(text.source, each.place))
                message = f"{each.message}\n{each.hint}" if each.hint else each.message
                fixes = [_fix(fix, where, text, uri) for fix in each.fixes]
                result.append(diagnostic(where, message, each.severity, each.code, fixes))
        return result

    def completions(self, uri: str, position: types.Position) -> list[types.CompletionItem]:
        """Return the completions at a position."""
        document = self._document(uri)
        if document is None:
            return []
        text, path = document
        offset = text.offset(position)
        suggestions = complete(text.source, offset, path.suffix, self._knowledge.terms)
        return [_item(each, text.range(each.start, offset)) for each in suggestions]

    def hover(self, uri: str, position: types.Position) -> types.Hover | None:
        """Return the documentation of the token at a position."""
        document = self._document(uri)
        if document is None:
            return None
        text, path = document
        name = self._knowledge.name_of(path)
        words = hover(text.source, text.offset(position), path, name, self._knowledge.terms)
        return types.Hover(types.MarkupContent(types.MarkupKind.Markdown, words)) if words else None

    def definition(self, uri: str, position: types.Position) -> types.Location | None:
        """Return where the term at a position is defined, or the file of the rule that is named there."""
        document = self._document(uri)
        if document is None:
            return None
        text, path = document
        symbol = self._symbol(text, path, position)
        if symbol is not None and symbol.kind == "rule":
            return self._location(self._knowledge.names[symbol.name], 0)
        term = term_at(text.source, text.offset(position), self._knowledge.terms)
        if term is None or term.place is None:
            return None
        return self._location(Path(term.place.path), (term.place.line or 1) - 1)

    def references(self, uri: str, position: types.Position, *, declaration: bool) -> list[types.Location]:
        """Return all places that mean what is at a position; with `declaration` also where a prefix or rule begins."""
        at_position = self._symbol_at(uri, position)
        if at_position is None:
            return []
        _, own, symbol = at_position
        places = [
            types.Location(uri_of(path, self._workspace), text.range(each.start, each.end))
            for path, text, each in self._occurrences(symbol, own)
            if declaration or not each.declares
        ]
        if symbol.kind == "rule" and declaration:
            places.insert(0, self._location(self._knowledge.names[symbol.name], 0))
        return places

    def highlights(self, uri: str, position: types.Position) -> list[types.DocumentHighlight]:
        """Return the places in the document itself that mean what is at a position."""
        at_position = self._symbol_at(uri, position)
        if at_position is None:
            return []
        text, path, symbol = at_position
        return [
            types.DocumentHighlight(text.range(each.start, each.end)) for each in occurrences(symbol, text.source, path)
        ]

    def renamable(self, uri: str, position: types.Position) -> types.PrepareRenamePlaceholder | None:
        """Return the part of the text that a renaming at a position replaces, and the name that it has.

        Raises UsageError KG003 for what cannot be renamed.
        """
        at_position = self._symbol_at(uri, position)
        if at_position is None:
            return None
        text, path, symbol = at_position
        self._require_own(symbol, path)
        shown = symbol.name if symbol.kind == "rule" else text.source[symbol.start : symbol.end]
        return types.PrepareRenamePlaceholder(text.range(symbol.start, symbol.end), shown)

    def rename(self, uri: str, position: types.Position, new: str, *, files: bool) -> types.WorkspaceEdit | None:
        """Return the edits that rename what is at a position; `files` is whether the editor can rename files.

        Raises UsageError KG003 for a new name of another form or one that is taken, and for what cannot be renamed.
        """
        at_position = self._symbol_at(uri, position)
        if at_position is None:
            return None
        text, path, symbol = at_position
        self._require_own(symbol, path)
        name = renamed(symbol, new, text.source, path)
        if symbol.kind == "term":
            whole = symbol.name.removesuffix(text.source[symbol.start : symbol.end]) + name
            if any(self._occurrences(symbol._replace(name=whole), path)) or whole in self._knowledge.terms.by_iri:
                raise UsageError("KG003", f"there is a term <{whole}> already", hint="Choose another name.")
        moved = list(self._moved(symbol, name, files=files)) if symbol.kind == "rule" else []
        edits: dict[str, list[types.TextEdit | types.AnnotatedTextEdit | types.SnippetTextEdit]] = {}
        for file, written, each in self._occurrences(symbol, path):
            # A rule set imports another by a path relative to itself.
            new_text = name if each.path is None else os.path.relpath(self._file(symbol, name, ".srl"), file.parent)
            edits.setdefault(uri_of(file, self._workspace), []).append(
                types.TextEdit(written.range(each.start, each.end), new_text)
            )
        changes = [
            types.TextDocumentEdit(types.OptionalVersionedTextDocumentIdentifier(uri=one), each)
            for one, each in edits.items()
        ]
        return types.WorkspaceEdit(document_changes=[*changes, *moved])

    def _moved(self, symbol: Symbol, name: str, *, files: bool) -> Iterator[types.RenameFile]:
        """Yield the renaming of the file of a rule, and of its examples."""
        if not files:
            raise UsageError("KG003", "the editor cannot rename files", hint="Rename the file of the rule yourself.")
        if name in self._knowledge.names:
            raise UsageError("KG003", f"there is a rule `{name}` already", hint="Choose another name.")
        path = self._knowledge.names[symbol.name]
        for each in (path, path.with_suffix(".md")):
            if each.is_file():
                target = self._file(symbol, name, each.suffix)
                yield types.RenameFile(uri_of(each, self._workspace), uri_of(target, self._workspace))

    def _file(self, symbol: Symbol, name: str, suffix: str) -> Path:
        root = str(self._knowledge.names[symbol.name].with_suffix("")).removesuffix(symbol.name)
        return Path(root, f"{name}{suffix}")

    def _location(self, path: Path, line: int) -> types.Location:
        start = types.Position(line, 0)
        return types.Location(uri_of(path.resolve(), self._workspace), types.Range(start, start))

    def _symbol_at(self, uri: str, position: types.Position) -> tuple[Text, Path, Symbol] | None:
        """Return the document with its path, and the symbol at a position; None if there is none."""
        document = self._document(uri)
        symbol = self._symbol(*document, position) if document else None
        return (*document, symbol) if document and symbol else None

    def _symbol(self, text: Text, path: Path, position: types.Position) -> Symbol | None:
        names = self._knowledge.names
        return symbol_at(text.source, text.offset(position), path, self._knowledge.name_of(path), names.keys())

    def _occurrences(self, symbol: Symbol, path: Path) -> Iterator[tuple[Path, Text, Occurrence]]:
        """Yield file, text and place of each occurrence; those of variables and prefixes are in one file."""
        everywhere = symbol.kind in {"rule", "term"}
        files = dict.fromkeys([path, *self._knowledge.own, *self._knowledge.shipped]) if everywhere else [path]
        for file in files:
            text = read(file, self._workspace)
            if text is None:
                continue
            for each in occurrences(symbol, text.source, file):
                if each.path is None or each.path.resolve() == self._knowledge.names[symbol.name].resolve():
                    yield file, text, each

    def _require_own(self, symbol: Symbol, path: Path) -> None:
        """Refuse to rename what files of others name."""
        if symbol.kind not in {"rule", "term"}:
            return
        own = {path, *self._knowledge.own}
        if symbol.kind == "rule":
            named = [self._knowledge.names[symbol.name]]
        else:
            named = [file for file, _, _ in self._occurrences(symbol, path)]
        foreign = next((file for file in named if file.resolve() not in own), None)
        if foreign is not None:
            what = f"the {symbol.kind} is used in {foreign}, which is not part of your rules"
            raise UsageError("KG003", what, hint="Rename your own terms and rules only.")


def _fix(fix: Fix, where: types.Range, text: Text, uri: str) -> dict[str, Any]:
    there = text.span(fix.place, 0) if fix.place is not None else where
    written = text.source[text.offset(there.start) : text.offset(there.end)]
    title = fix.title or f"Replace `{written}` by `{fix.text}`"
    return {"title": title, "uri": uri, "range": there, "written": written, "text": fix.text}


def _item(suggestion: Suggestion, where: types.Range) -> types.CompletionItem:
    return types.CompletionItem(
        label=suggestion.text,
        kind=_KINDS[suggestion.kind],
        detail=suggestion.detail or None,
        documentation=types.MarkupContent(types.MarkupKind.Markdown, suggestion.documentation)
        if suggestion.documentation
        else None,
        text_edit=types.TextEdit(where, suggestion.text),
    )
