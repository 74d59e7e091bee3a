"""The language server as an editor speaks to it: a process, and JSON-RPC over its standard streams."""

from __future__ import annotations

import json
import subprocess
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

RULE = """\
CONSTRUCT { ?node rnkg:busy true }
WHERE { ?node rnkg:publishes ?topic ; rnkg:subscribs ?topic }
"""


class Editor:
    """The client's side of the protocol."""

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        self._process = process
        self._number = 0
        self.notifications: list[dict[str, Any]] = []

    def _send(self, message: dict[str, Any]) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self._process.stdin
        self._process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        self._process.stdin.flush()

    def _receive(self) -> dict[str, Any]:
        assert self._process.stdout
        length = 0
        while (line := self._process.stdout.readline().strip()) or not length:
            if line.lower().startswith(b"content-length:"):
                length = int(line.split(b":")[1])
            assert line, "the server ended"
        found: dict[str, Any] = json.loads(self._process.stdout.read(length))
        return found

    def notify(self, method: str, **params: Any) -> None:
        """Send a notification."""
        self._send({"method": method, "params": params})

    def ask(self, method: str, **params: Any) -> Any:
        """Send a request and return its result; messages of the server meanwhile are kept."""
        self._number += 1
        self._send({"id": self._number, "method": method, "params": params})
        while (message := self._receive()).get("id") != self._number:
            self.notifications.append(message)
        assert "error" not in message, message
        return message["result"]

    def diagnostics(self) -> list[dict[str, Any]]:
        """Return the next diagnostics that the server publishes."""
        while not self.notifications or "diagnostics" not in self.notifications[-1].get("params", {}):
            self.notifications.append(self._receive())
        found: list[dict[str, Any]] = self.notifications.pop()["params"]["diagnostics"]
        return found


@contextmanager
def running(folder: Path) -> Iterator[Editor]:
    """Start the server in a folder and greet it."""
    command = [sys.executable, "-m", "kg", "rules", "lsp", "--rules", str(folder)]
    with subprocess.Popen(command, cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        editor = Editor(process)
        try:
            editor.ask("initialize", processId=None, rootUri=folder.as_uri(), capabilities={})
            editor.notify("initialized")
            yield editor
            editor.ask("shutdown")
            editor.notify("exit")
            assert process.wait(patient(10)) == 0
        finally:
            process.kill()


def test_a_session(tmp_path: Path) -> None:
    """Opening reports errors; editing fixes them; completion, hover and definition answer; it ends cleanly."""
    pytest.importorskip("pygls", reason="the extra `lsp` is not installed")
    file = tmp_path / "mine" / "busy.rq"
    file.parent.mkdir()
    file.write_text(RULE)
    document = {"uri": file.as_uri()}
    with running(tmp_path) as editor:
        editor.notify(
            "textDocument/didOpen", textDocument={**document, "languageId": "sparql", "version": 1, "text": RULE}
        )
        found = {each["code"]: each for each in editor.diagnostics()}
        assert found["KG211"]["range"]["start"] == {"line": 1, "character": 38}
        assert "rnkg:subscribes" in found["KG211"]["message"]
        mended = RULE.replace("subscribs", "subscribes")
        editor.notify(
            "textDocument/didChange", textDocument={**document, "version": 2}, contentChanges=[{"text": mended}]
        )
        assert "rnkg:subscribs" not in json.dumps(editor.diagnostics())
        at = {"line": 1, "character": 22}
        items = editor.ask("textDocument/completion", textDocument=document, position={"line": 1, "character": 25})
        labels = [each["label"] for each in (items if isinstance(items, list) else items["items"])]
        assert "rnkg:publishes" in labels
        assert "publishes" in editor.ask("textDocument/hover", textDocument=document, position=at)["contents"]["value"]
        place = editor.ask("textDocument/definition", textDocument=document, position=at)
        assert place["uri"].endswith("ontology/rnkg.ttl")
