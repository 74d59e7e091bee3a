"""Tests of the output and the refusals of `kg serve` before it serves."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from typing import TYPE_CHECKING

import httpx
import pyoxigraph
import pytest
from cli.program import Program
from patience import patient
from serving import TOKEN

from kg.cli.commands.serve import announce, options
from kg.errors import UsageError
from kg.server import libraries
from kg.settings import load
from kg.store.layout import create

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def store(tmp_path: Path) -> Path:
    """A store without triples."""
    layout = create(tmp_path / ".kg")
    layout.generation(1).mkdir()
    pyoxigraph.Store(str(layout.generation(1))).flush()
    layout.switch(1)
    return tmp_path


def run(*arguments: str, cwd: Path, **environment: str) -> tuple[int, str]:
    """Return the exit code of `kg serve` and its standard error."""
    clean = {name: value for name, value in os.environ.items() if not name.startswith("KG_")}
    program = "from kg.cli.main import run; run()"
    command = [sys.executable, "-c", program, "serve", *arguments]
    found = subprocess.run(
        command, cwd=cwd, capture_output=True, text=True, timeout=patient(60), check=False, env={**clean, **environment}
    )
    return found.returncode, found.stderr


def test_no_store(tmp_path: Path) -> None:
    """Without a store, no port is opened."""
    code, said = run(cwd=tmp_path)
    assert code == 4
    assert "KG301" in said


@pytest.mark.parametrize("arguments", [["--write"], ["--store", "elsewhere"]])
def test_no_store_to_change_or_of_that_name(tmp_path: Path, arguments: list[str]) -> None:
    """A robot does not replace a store that was named or is to be changed."""
    code, said = run("--robot", "memory://none", *arguments, cwd=tmp_path, KG_TOKEN=TOKEN)
    assert code == 4
    assert "KG301" in said


def test_a_robot_needs_no_store(tmp_path: Path) -> None:
    """In a folder without a store, the robot pages are served with an empty one, which is removed afterwards."""
    program = "from kg.cli.main import run; run()"
    command = [sys.executable, "-c", program, "serve", "--port", "0", "--log", "off", "--robot", "memory://none"]
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    environment = {**os.environ, "TMPDIR": str(temporary)}
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stderr is not None
        assert "no store" in process.stderr.readline()
        address = process.stderr.readline().rpartition(" at ")[2].strip()
        with httpx.Client(base_url=address, timeout=patient(30)) as client:
            assert [client.get(path).status_code for path in ("/", "/robot", "/health")] == [200, 200, 200]
            assert client.get("/sparql", params={"query": "ASK { ?s ?p ?o }"}).json()["boolean"] is False
        process.send_signal(signal.SIGTERM)
        assert process.wait(patient(30)) == 0
    assert not (tmp_path / ".kg").exists()
    assert not any(entry.name.startswith("kg-") for entry in temporary.iterdir())


def test_port_in_use(store: Path) -> None:
    """A port in use is reported with instructions and without a traceback."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        code, said = run("--port", str(taken.getsockname()[1]), cwd=store)
    assert code == 2
    assert "KG542" in said
    assert "--port" in said
    assert "Traceback" not in said


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["--write"], "KG541"),
        (["--host", "0.0.0.0"], "KG540"),  # noqa: S104 - refused
        (["--port", "99999"], "KG002"),
        (["--timeout", "0"], "KG002"),
        (["--readers", "0"], "KG002"),
        (["--max-memory", "much"], "KG002"),
        (["--log", "loud"], "KG002"),
        (["--cors", "*"], "KG002"),
        (["--token-file", "missing"], "KG541"),
    ],
)
def test_refusals(store: Path, arguments: list[str], code: str) -> None:
    """Invalid options are reported before the port is opened."""
    refused = Program(store)("serve", *arguments)
    assert refused.code == 2
    assert code in refused.err


def test_it_serves(store: Path) -> None:
    """The server prints its address and its data, and exits cleanly on request."""
    program = "from kg.cli.main import run; run()"
    command = [sys.executable, "-c", program, "serve", "--port", "0", "--log", "off"]
    with subprocess.Popen(command, cwd=store, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        first = process.stderr.readline()
        assert str(store / ".kg") in first
        assert "http://127.0.0.1:" in first
        process.send_signal(signal.SIGTERM)
        assert process.wait(patient(30)) == 0


def test_without_libraries_it_says_so(store: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If the libraries of the pages were not built, the start reports the missing parts and how to get them."""
    monkeypatch.setattr(libraries, "libraries", tuple)
    said: list[str] = []
    announce(
        "http://x/",
        load({"store": str(store / ".kg")}, environment={}, folder=store),
        options({}),
        say=said.append,
        browse=False,
    )
    assert "python frontend/build.py" in said[-1]


def test_settings_come_from_flags_variables_and_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A flag wins over the variable, and that over `[serve]` in kg.toml; the token comes only from its variable."""
    (tmp_path / "kg.toml").write_text("[serve]\nport = 1\nmax_rows = 7\ntimeout = 2\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("KG_TOKEN", "from-the-environment")
    monkeypatch.setenv("KG_SERVE_PORT", "2")
    monkeypatch.setenv("KG_SERVE_TIMEOUT", "1.5")
    found = options({"port": "0", "memory": "3G", "slow": None, "write": True})
    assert (found.port, found.seconds, found.memory, found.rows, found.write) == (0, 1.5, 3 << 30, 7, True)
    assert found.token == "from-the-environment"  # noqa: S105 - of a test


@pytest.mark.parametrize(
    "line", ['host = "0.0.0.0"', "write = true", "no_auth = true", 'cors = ["https://evil.example"]']
)
def test_a_file_cannot_open_the_server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str) -> None:
    """Access is set by flags and variables; a kg.toml that sets it is rejected with its line."""
    (tmp_path / "kg.toml").write_text(f"[serve]\nport = 0\n{line}\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UsageError, match="cannot be set in a file") as caught:
        options({})
    assert str(caught.value.place).endswith("kg.toml:3")


@pytest.mark.parametrize("terminal", [True, False])
def test_a_link_logs_in_from_terminals_alone(store: Path, monkeypatch: pytest.MonkeyPatch, terminal: bool) -> None:  # noqa: FBT001 - of a parametrised test
    """The link has the token after the `#`, which no server receives; output to files omits it."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal, raising=False)
    monkeypatch.setenv("KG_TOKEN", TOKEN)
    said: list[str] = []
    settings = load({"store": str(store / ".kg")}, environment={})
    announce("http://127.0.0.1:7878/", settings, options({}), say=said.append, browse=False)
    assert (f"log in: http://127.0.0.1:7878/login#token={TOKEN}" in said) == terminal
    assert any(TOKEN in line for line in said) == terminal
