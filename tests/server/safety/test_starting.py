"""Tests of the conditions for listening: C21."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from serving import EVERYWHERE, TOKEN, served

from kg.errors import UsageError
from kg.server.options import Options
from kg.server.running import check, listen

if TYPE_CHECKING:
    from pathlib import Path


def code(options: Options) -> str | None:
    """Return the code of the refusal, None if the server may start."""
    try:
        check(options)
    except UsageError as error:
        return error.code
    return None


def test_a_server_is_for_this_machine_unless_told() -> None:
    """By default a server listens on loopback, is read-only, and starts."""
    assert Options().host == "127.0.0.1"
    assert not Options().write
    assert code(Options()) is None


@pytest.mark.parametrize("host", [EVERYWHERE, "::", "192.168.0.7", "robot.lab", ""])
def test_other_machines_need_a_token(host: str) -> None:
    """A host reachable by others needs a token, unless public reading is enabled."""
    assert code(Options(host=host)) == "KG540"
    assert code(Options(host=host, token=TOKEN)) is None
    assert code(Options(host=host, open_to_all=True)) is None


def test_changes_need_a_token() -> None:
    """Writing without a token is always rejected, even with public reading."""
    assert code(Options(write=True)) == "KG541"
    assert code(Options(write=True, host=EVERYWHERE, open_to_all=True)) == "KG541"
    assert code(Options(write=True, token=TOKEN)) is None


@pytest.mark.parametrize("token", ["", "short", " " * 20, "with blanks in the middle", "umlaut-ü-" * 3])
def test_tokens_that_cannot_be_used(token: str) -> None:
    """A token that is short, or invalid in a header, is rejected at start."""
    assert code(Options(token=token)) == "KG541"


def test_a_file_without_a_token(tmp_path: Path) -> None:
    """The token file must exist and contain a token."""
    assert code(Options(token_file=tmp_path / "none")) == "KG541"
    (tmp_path / "token").write_text(TOKEN + "\n")
    assert code(Options(token_file=tmp_path / "token")) is None


@pytest.mark.parametrize("origin", ["*", "null", "https://", "https://*.example", "https://a.example/", "a.example"])
def test_only_whole_origins_are_listed(origin: str) -> None:
    """CORS takes origins one by one: no star, no pattern, no path."""
    assert code(Options(origins=(origin,))) == "KG002"


def test_an_address_that_is_taken() -> None:
    """A port in use is an error that names the address."""
    with listen(Options(port=0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(UsageError, match=f"127.0.0.1 port {port}") as caught:
            listen(Options(port=port))
    assert caught.value.code == "KG542"


@pytest.mark.parametrize("options", [Options(host="no.such.host.invalid"), Options(port=70_000)])
def test_an_address_that_cannot_be(options: Options) -> None:
    """An unknown host or an invalid port is an error of the same kind."""
    with pytest.raises(UsageError) as caught:
        listen(options)
    assert caught.value.code == "KG542"


def test_it_listens_on_loopback_only(store: Path) -> None:
    """By default a server is bound to 127.0.0.1."""
    with served(store, log="off") as server:
        assert server.address == f"http://127.0.0.1:{server.port}"
        assert server.stop()[0] == 0
