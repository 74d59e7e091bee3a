"""The language server over standard input and output: its features, and when what is published."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from functools import lru_cache
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, Final

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer

from kg.codes import CATALOGUE, PAGE
from kg.editors.facts import Facts
from kg.editors.rules import Rules
from kg.editors.texts import Text, actions, diagnostic, document_of, path_of, read, uri_of
from kg.errors import KgError
from kg.lint.lines import Lines
from kg.lint.repairs import Repair, places, repairs, written

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from pygls.workspace import Workspace

    from kg.editors.source import Source
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


_WATCHED: Final = ("**/.kg/current", "**/kg.toml")
"""Files that change what the server reports: the pointer to the generation of the store, and settings."""
_EXCUSED: Final = frozenset({"KG301", "KG302"})
"""Errors that are usual while one edits: no store yet, and a store that another process writes."""


class _Session:
    """The state of one editor: open rules, published findings, the build that runs."""

    def __init__(self, server: LanguageServer, source: Source) -> None:
        self._server = server
        self._source = source
        self._published: dict[Path | None, list[types.Diagnostic]] = {}
        self._wired: set[str] = set()
        self._commands: dict[tuple[str, ...], None] = {}
        self._building = asyncio.Lock()
        self.builds = True

    def begin(self, params: types.InitializeParams) -> None:
        """Work in the folder that the editor has open, with its options."""
        options = params.initialization_options
        self.builds = not isinstance(options, dict) or bool(options.get("build", True))
        folders = [each.uri for each in params.workspace_folders or ()] or [params.root_uri or ""]
        folder = path_of(folders[0])
        if folder is not None and folder.is_dir():
            self._attempt(lambda: self._source.enter(folder))
        self.facts = Facts(self._server.workspace, self._source)
        self.learn()

    async def watch(self) -> None:
        """Ask the editor to report changes of the store and of settings, where it can."""
        workspace = self._server.client_capabilities.workspace
        watching = workspace.did_change_watched_files if workspace else None
        if watching is None or not watching.dynamic_registration:
            return
        options = types.DidChangeWatchedFilesRegistrationOptions(
            [types.FileSystemWatcher(glob_pattern=each) for each in _WATCHED]
        )
        wanted = types.Registration("kg", types.WORKSPACE_DID_CHANGE_WATCHED_FILES, options)
        await self._server.client_register_capability_async(types.RegistrationParams([wanted]))

    def learn(self) -> None:
        """Read rules, ontologies and the store's vocabulary again."""
        self.rules = Rules(self._server.workspace, self._source.knowledge())

    def _attempt(self, action: Callable[[], None]) -> None:
        """Do something whose errors the user is shown."""
        try:
            action()
        except KgError as error:
            self._show(error)

    def _show(self, error: KgError) -> None:
        text = f"{error}\n{error.hint}" if error.hint else str(error)
        if error.code in _EXCUSED:
            self._server.window_log_message(types.LogMessageParams(types.MessageType.Info, text))
        else:
            self._server.window_show_message(types.ShowMessageParams(types.MessageType.Warning, text))

    def publish(self, uri: str) -> None:
        """Publish the findings on a rule as it is in the editor."""
        diagnostics_of_rule = self.rules.diagnostics(uri)
        if diagnostics_of_rule is not None:
            self._send(uri, diagnostics_of_rule)

    def _send(self, uri: str, published: list[types.Diagnostic]) -> None:
        path = path_of(uri)
        self._published[path] = published
        document = document_of(path, self._server.workspace) if path else None
        self._server.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(
                uri=uri, diagnostics=published, version=document.version if document else None
            )
        )

    def forget(self, uri: str) -> None:
        """Remove the findings on a rule that was closed."""
        if self.rules.diagnostics(uri) is not None:
            self._send(uri, [])

    async def check(self) -> None:
        """Publish the findings of `kg lint` in all files, and remove those that are gone."""
        try:
            checked = await asyncio.to_thread(self._source.findings)
        except KgError as error:
            self._show(error)
            return
        by_file = diagnostics(checked, self._server.workspace) if checked else {}
        for uri in sorted(self._wired - by_file.keys()):
            self._send(uri, [])
        for uri, each in by_file.items():
            self._send(uri, each)
        self._wired = set(by_file)

    async def saved(self, uri: str) -> None:
        """Read a saved rule, or the source that a saved file belongs to, and check again.

        Files saved during a build are read by one more build after it.
        """
        path = path_of(uri)
        if self.rules.diagnostics(uri) is not None:
            self._attempt(self.learn)
            self.publish(uri)
        elif self.builds and path is not None:
            with suppress(KgError):
                if command := self._source.build(path):
                    self._commands[tuple(command)] = None
        async with self._building:
            commands, self._commands = self._commands, {}
            for each in commands:
                await self._build(each)
            await self.check()

    async def _build(self, command: tuple[str, ...]) -> None:
        """Run a build in a process of its own; the streams of this one belong to the editor."""
        process = await asyncio.create_subprocess_exec(
            *command,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
        )
        try:
            _, words = await process.communicate()
        finally:
            if process.returncode is None:
                process.kill()
        text = words.decode("utf-8", "replace").strip()
        if process.returncode not in {0, 1}:
            self._server.window_log_message(types.LogMessageParams(types.MessageType.Warning, f"kg build: {text}"))

    def actions(self, params: types.CodeActionParams) -> list[types.CodeAction]:
        """Return the quick fixes of what was published at a range."""
        published = self._published.get(path_of(params.text_document.uri), ())
        start, end = params.range.start, params.range.end
        here = [each for each in published if each.range.start <= end and start <= each.range.end]
        return actions(here, self._server.workspace)


def language_server(source: Source) -> LanguageServer:
    """Return a server that `start_io()` runs until the editor ends it."""
    server = LanguageServer("kg", version("kg-ros"), text_document_sync_kind=types.TextDocumentSyncKind.Full)
    session = _Session(server, source)
    _documents(server, session)
    _features(server, session)
    return server


def _documents(server: LanguageServer, session: _Session) -> None:
    @server.feature(types.INITIALIZE)
    def initialize(params: types.InitializeParams) -> None:
        session.begin(params)

    @server.feature(types.INITIALIZED)
    async def initialized(_params: types.InitializedParams) -> None:
        await session.watch()
        await session.check()

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def opened(params: types.DidOpenTextDocumentParams) -> None:
        session.publish(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def changed(params: types.DidChangeTextDocumentParams) -> None:
        session.publish(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def closed(params: types.DidCloseTextDocumentParams) -> None:
        session.forget(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    async def saved(params: types.DidSaveTextDocumentParams) -> None:
        await session.saved(params.text_document.uri)

    @server.feature(types.WORKSPACE_DID_CHANGE_WATCHED_FILES)
    async def watched(_params: types.DidChangeWatchedFilesParams) -> None:
        await session.check()


def _features(server: LanguageServer, session: _Session) -> None:
    @server.feature(types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions(trigger_characters=["?", ":"]))
    def completed(params: types.CompletionParams) -> list[types.CompletionItem]:
        return session.rules.completions(params.text_document.uri, params.position)

    @server.feature(types.TEXT_DOCUMENT_HOVER)
    def hovered(params: types.HoverParams) -> types.Hover | None:
        uri, position = params.text_document.uri, params.position
        return session.rules.hover(uri, position) or session.facts.hover(uri, position)

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    def defined(params: types.DefinitionParams) -> types.Location | list[types.Location]:
        uri, position = params.text_document.uri, params.position
        return session.rules.definition(uri, position) or session.facts.definition(uri, position)

    @server.feature(
        types.TEXT_DOCUMENT_CODE_ACTION, types.CodeActionOptions(code_action_kinds=[types.CodeActionKind.QuickFix])
    )
    def mended(params: types.CodeActionParams) -> list[types.CodeAction]:
        return session.actions(params)

    @server.feature(types.TEXT_DOCUMENT_REFERENCES)
    def referred(params: types.ReferenceParams) -> list[types.Location]:
        declaration = params.context.include_declaration
        uri, position = params.text_document.uri, params.position
        found = session.rules.references(uri, position, declaration=declaration)
        return found or session.facts.references(uri, position, declaration=declaration)

    @server.feature(types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT)
    def highlighted(params: types.DocumentHighlightParams) -> list[types.DocumentHighlight]:
        return session.rules.highlights(params.text_document.uri, params.position)

    @server.feature(types.TEXT_DOCUMENT_PREPARE_RENAME)
    def renamable(params: types.PrepareRenameParams) -> types.PrepareRenamePlaceholder | None:
        try:
            return session.rules.renamable(params.text_document.uri, params.position)
        except KgError as error:
            raise JsonRpcInvalidParams(_sentence(error)) from None

    @server.feature(types.TEXT_DOCUMENT_RENAME, types.RenameOptions(prepare_provider=True))
    def renamed(params: types.RenameParams) -> types.WorkspaceEdit | None:
        try:
            workspace = server.client_capabilities.workspace
            edit = workspace.workspace_edit if workspace else None
            files = types.ResourceOperationKind.Rename in ((edit.resource_operations if edit else None) or ())
            return session.rules.rename(params.text_document.uri, params.position, params.new_name, files=files)
        except KgError as error:
            raise JsonRpcInvalidParams(_sentence(error)) from None


def _sentence(error: KgError) -> str:
    return f"{error.message}. {error.hint}" if error.hint else error.message
