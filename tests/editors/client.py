"""The protocol side of an editor: a server process, and JSON-RPC over its standard streams."""

from __future__ import annotations

import json
from contextlib import contextmanager
from pathlib import Path
from subprocess import PIPE
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import unquote, urlsplit

from forks import start
from patience import patient

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable, Iterator

    from forks import Forked

__all__ = ["Editor", "editing"]

_MODULES: Final = ("kg.editors.server", "kg.lint.running")
"""Modules that a server imports at its start."""
CAPABILITIES = {"workspace": {"workspaceEdit": {"documentChanges": True, "resourceOperations": ["rename"]}}}


class Editor:
    """The client's side of the protocol; `texts` are the open documents by address."""

    def __init__(self, process: Forked | subprocess.Popen[str]) -> None:
        streams: tuple[Any, Any] = process.stdin, process.stdout
        self._input, self._output = (stream.buffer for stream in streams)
        self._number = 0
        self.texts: dict[str, str] = {}
        self._versions: dict[str, int] = {}
        self.waiting: list[dict[str, Any]] = []
        """Unread messages of the server."""
        self.read: list[dict[str, Any]] = []
        """Messages that tests have read or skipped."""

    def _send(self, message: dict[str, Any]) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self._input.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        self._input.flush()

    def _receive(self) -> dict[str, Any]:
        length = 0
        while (line := self._output.readline().strip()) or not length:
            if line.lower().startswith(b"content-length:"):
                length = int(line.split(b":")[1])
            assert line, "the server ended"
        found: dict[str, Any] = json.loads(self._output.read(length))
        return found

    def notify(self, method: str, **params: Any) -> None:
        """Send a notification."""
        self._send({"method": method, "params": params})

    def request(self, method: str, **params: Any) -> dict[str, Any]:
        """Send a request and return the response; other messages of the server are stored."""
        self._number += 1
        self._send({"id": self._number, "method": method, "params": params})
        while (message := self._receive()).get("id") != self._number:
            self.waiting.append(message)
        return message

    def ask(self, method: str, **params: Any) -> Any:
        """Send a request and return its result."""
        message = self.request(method, **params)
        assert "error" not in message, message
        return message["result"]

    def at(self, method: str, file: Path, needle: str, **params: Any) -> Any:
        """Send a request about the first character of `needle` in an open document; return its result."""
        return self.ask(f"textDocument/{method}", **self.place(file, needle), **params)

    def place(self, file: Path, needle: str) -> dict[str, Any]:
        """Return the position parameters of `needle` in an open document."""
        before = self.texts[file.as_uri()].partition(needle)[0]
        position = {"line": before.count("\n"), "character": len(before.rpartition("\n")[2])}
        return {"textDocument": {"uri": file.as_uri()}, "position": position}

    def open(self, file: Path, text: str | None = None) -> None:
        """Open a document, by default with the text of the file."""
        text = file.read_text() if text is None else text
        if file.as_uri() in self.texts:
            self.notify("textDocument/didClose", textDocument={"uri": file.as_uri()})
        self.texts[file.as_uri()] = text
        document = {"uri": file.as_uri(), "languageId": "any", "version": self._next(file), "text": text}
        self.notify("textDocument/didOpen", textDocument=document)

    def edit(self, file: Path, text: str) -> None:
        """Change the text of an open document."""
        self.texts[file.as_uri()] = text
        document = {"uri": file.as_uri(), "version": self._next(file)}
        self.notify("textDocument/didChange", textDocument=document, contentChanges=[{"text": text}])

    def close(self) -> None:
        """Close all documents, so that the server reads the files."""
        for uri in self.texts:
            self.notify("textDocument/didClose", textDocument={"uri": uri})
        self.texts.clear()

    def _next(self, file: Path) -> int:
        self._versions[file.as_uri()] = self._versions.get(file.as_uri(), 0) + 1
        return self._versions[file.as_uri()]

    def save(self, file: Path) -> None:
        """Write an open document to its file."""
        file.write_text(self.texts[file.as_uri()])
        self.notify("textDocument/didSave", textDocument={"uri": file.as_uri()})

    def diagnostics(
        self, file: Path, *, until: Callable[[list[dict[str, Any]]], bool] = lambda _: True
    ) -> list[dict[str, Any]]:
        """Return the next matching diagnostics of the current text of an open file."""
        while True:
            message = self._next_message()
            params = message.get("params")
            if not isinstance(params, dict) or params.get("uri") != file.as_uri() or "diagnostics" not in params:
                continue
            found: list[dict[str, Any]] = params["diagnostics"]
            # Findings of `kg lint` that were read before the file was opened have no version.
            if params.get("version") in {None, self._versions.get(file.as_uri())} and until(found):
                return found

    def _next_message(self) -> dict[str, Any]:
        self.read.append(self.waiting.pop(0) if self.waiting else self._receive())
        return self.read[-1]

    def message(self, method: str) -> dict[str, Any]:
        """Return the parameters of the first message of the server with a method, including messages already read."""
        for each in self.read:
            if each.get("method") == method:
                return dict(each["params"])
        while (message := self._next_message()).get("method") != method:
            pass
        return dict(message["params"])

    def fixes(self, file: Path, diagnostic: dict[str, Any]) -> dict[str, dict[str, Any]]:
        """Return the quick fixes of a diagnostic by their titles."""
        context = {"diagnostics": [diagnostic]}
        found = self.ask(
            "textDocument/codeAction",
            textDocument={"uri": file.as_uri()},
            range=diagnostic["range"],
            context=context,
        )
        return {each["title"]: each["edit"] for each in found if diagnostic in each["diagnostics"]}

    def applied(self, edit: dict[str, Any]) -> tuple[dict[Path, str], dict[Path, Path]]:
        """Return the texts and names of files after an edit, without applying it."""
        plain = [{"textDocument": {"uri": uri}, "edits": edits} for uri, edits in (edit.get("changes") or {}).items()]
        texts, moved = {}, {}
        for change in [*plain, *(edit.get("documentChanges") or ())]:
            if change.get("kind") == "rename":
                moved[_path(change["oldUri"])] = _path(change["newUri"])
            else:
                uri = change["textDocument"]["uri"]
                text = self.texts[uri] if uri in self.texts else _path(uri).read_text()
                texts[_path(uri)] = _edited(text, change["edits"])
        return texts, moved


def _edited(text: str, edits: list[dict[str, Any]]) -> str:
    """Return a text without characters beyond the basic plane after some edits."""
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    spans = [
        (*(starts[each["range"][end]["line"]] + each["range"][end]["character"] for end in ("start", "end")), each)
        for each in edits
    ]
    for begin, end, each in sorted(spans, key=lambda one: -one[0]):
        text = text[:begin] + each["newText"] + text[end:]
    return text


def _path(uri: str) -> Path:
    return Path(unquote(urlsplit(uri).path))


@contextmanager
def editing(folder: Path, options: dict[str, Any] | None = None) -> Iterator[Editor]:
    """Start the server like an editor with an open folder, and initialise it with the given options."""
    with start(
        *("-m", "kg", "rules", "lsp"), folder=Path("/"), streams=(PIPE, PIPE, None), modules=_MODULES, builds=True
    ) as process:
        editor = Editor(process)
        try:
            editor.ask(
                "initialize",
                processId=None,
                rootUri=folder.as_uri(),
                capabilities=CAPABILITIES,
                initializationOptions=options,
            )
            editor.notify("initialized")
            yield editor
            editor.ask("shutdown")
            editor.notify("exit")
            assert process.wait(patient(10)) == 0
        finally:
            process.kill()
