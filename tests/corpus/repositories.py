"""Git repositories created for tests, and servers that serve them, with optional faults."""

from __future__ import annotations

import os
import subprocess
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Final

from patience import patient

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

__all__ = ["MANIFESTS", "Behaviour", "commit_tree", "git", "plumb", "repository", "served"]

MANIFESTS: Final = {
    "1": "<package><name>p</name><buildtool_depend>catkin</buildtool_depend></package>",
    "2": "<package><name>p</name><export><build_type>ament_cmake</build_type></export></package>",
}
"""A package.xml for either version of ROS."""
_IDENTITY: Final = {
    f"GIT_{who}_{what}": value
    for who in ("AUTHOR", "COMMITTER")
    for what, value in (("NAME", "A"), ("EMAIL", "a@example.org"), ("DATE", "2020-01-01T00:00:00Z"))
}


def git(folder: Path, *arguments: str, given: bytes = b"") -> str:
    """Run git in a folder and return its output."""
    done = subprocess.run(
        ("git", "-C", str(folder), *arguments),
        check=True,
        capture_output=True,
        input=given,
        env={**os.environ, **_IDENTITY},
    )
    return done.stdout.decode().strip()


def repository(folder: Path, branches: Mapping[str, Mapping[str, str]]) -> Path:
    """Create a bare repository with branches, each a mapping of paths to texts; the first is the default."""
    folder.mkdir(parents=True)
    git(folder, "init", "--quiet", "--bare")
    git(folder, "symbolic-ref", "HEAD", f"refs/heads/{next(iter(branches))}")
    for branch, files in branches.items():
        git(folder, "update-ref", f"refs/heads/{branch}", commit_tree(folder, files))
    return folder


def commit_tree(folder: Path, files: Mapping[str, str]) -> str:
    """Write a commit of some files and return its name."""
    lines = []
    for path, text in files.items():
        mode, content = ("120000", text[2:]) if text.startswith("->") else ("100644", text)
        blob = git(folder, "hash-object", "-w", "--stdin", given=content.encode())
        lines.append(f"{mode} {blob}\t{path}\n")
    index = {**os.environ, "GIT_INDEX_FILE": str(folder / "index")}
    (folder / "index").unlink(missing_ok=True)
    for arguments, given in ((("update-index", "--add", "--index-info"), "".join(lines)), (("write-tree",), "")):
        done = subprocess.run(
            ("git", "-C", str(folder), *arguments), check=True, capture_output=True, input=given.encode(), env=index
        )
    return git(folder, "commit-tree", "-m", "x", done.stdout.decode().strip())


def plumb(folder: Path, entries: bytes) -> None:
    """Set the branch `main` to a tree of raw bytes that git itself would never write."""
    tree = git(folder, "hash-object", "-w", "-t", "tree", "--literally", "--stdin", given=entries)
    git(folder, "update-ref", "refs/heads/main", git(folder, "commit-tree", "-m", "x", tree))


class Behaviour:
    """The server's treatment of requests: a status by path, a number of initial failures, or a hang."""

    def __init__(self) -> None:
        self.moved: dict[str, str] = {}
        self.failures: dict[str, int] = {}
        self.hanging: set[str] = set()
        self.requests: list[str] = []
        self.over = threading.Event()


@contextmanager
def served(root: Path) -> Iterator[tuple[str, Behaviour]]:
    """Serve the repositories below a folder by git's smart HTTP; yield the address and the server's behaviour."""
    behaviour = Behaviour()

    class Handler(BaseHTTPRequestHandler):
        def _answer(self) -> None:
            path, _, query = self.path.partition("?")
            first = path.split("/")[1]
            behaviour.requests.append(self.path)
            if first in behaviour.hanging:
                behaviour.over.wait(patient(30))
                return
            if first in behaviour.moved:
                self.send_response(301)
                self.send_header("Location", behaviour.moved[first] + self.path[len(first) + 1 :])
                self.end_headers()
                return
            if behaviour.failures.get(first, 0) > 0:
                behaviour.failures[first] -= 1
                self.send_error(503)
                return
            if not (root / first).is_dir():
                self.send_error(404)
                return
            self._backend(path, query)

        do_GET = do_POST = _answer  # noqa: N815 - names that http.server calls

        def _backend(self, path: str, query: str) -> None:
            body = self.rfile.read(int(self.headers.get("Content-Length") or 0))
            variables = {
                "GIT_PROJECT_ROOT": str(root),
                "GIT_HTTP_EXPORT_ALL": "1",
                "PATH_INFO": path,
                "QUERY_STRING": query,
                "REQUEST_METHOD": self.command,
                "CONTENT_TYPE": self.headers.get("Content-Type", ""),
                "HTTP_CONTENT_ENCODING": self.headers.get("Content-Encoding", ""),
                "GIT_PROTOCOL": self.headers.get("Git-Protocol", ""),
            }
            done = subprocess.run(
                ("git", "http-backend"), input=body, capture_output=True, check=False, env={**os.environ, **variables}
            )
            head, _, content = done.stdout.partition(b"\r\n\r\n")
            fields = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
            self.send_response(int(fields.pop("Status", "200 OK").split()[0]))
            for name, value in fields.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *_: object) -> None:
            """Print nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}", behaviour
    finally:
        behaviour.over.set()
        server.shutdown()
        server.server_close()
