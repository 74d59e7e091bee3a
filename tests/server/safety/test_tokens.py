"""Tests of the token, C25, and of logging in with it."""

from __future__ import annotations

import logging
import os
from typing import TYPE_CHECKING, Any

import pytest
from serving import EVERYWHERE, TOKEN, application

from kg.server.options import Options
from kg.server.safety.tokens import Tokens

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from starlette.testclient import TestClient

OPEN = "http://robot.lab:7878"
WRONG = "x" * len(TOKEN)


def bearer(token: str = TOKEN) -> dict[str, str]:
    """Return the header with a token."""
    return {"Authorization": f"Bearer {token}"}


@pytest.fixture(scope="module")
def guarded(store: Path) -> Iterator[TestClient]:
    """A server reachable from other machines, which always requires the token."""
    with application(store, OPEN, host=EVERYWHERE, hosts=("robot.lab",), token=TOKEN, log="off") as found:
        yield found


@pytest.fixture
def browser(guarded: TestClient) -> Iterator[TestClient]:
    """The same server, with a browser without cookies as client."""
    guarded.cookies.clear()
    yield guarded
    guarded.cookies.clear()


def login(client: TestClient, token: str, **named: Any) -> Any:
    """Send the login form."""
    return client.post("/login", data={"token": token, **named}, headers={"Sec-Fetch-Site": "same-origin"})


def test_all_needs_the_token_where_others_reach(guarded: TestClient) -> None:
    """Without the token, or with a wrong one, no data is revealed: 401 with instructions."""
    for path in ("/", "/sparql?query=ASK{}", "/metrics", "/api/overview", "/openapi.json", "/jobs", "/nothing"):
        for headers in ({}, bearer(WRONG), bearer(""), {"Authorization": "Basic " + TOKEN}, bearer(TOKEN + " x")):
            answer = guarded.get(path, headers=headers)
            assert answer.status_code == 401, (path, headers)
            assert answer.json()["code"] == "KG529"
            assert answer.headers["www-authenticate"].startswith("Bearer")
    assert guarded.get("/sparql", headers=bearer()).status_code == 200


def test_a_server_without_a_token_has_nothing_to_log_in_to(client: TestClient) -> None:
    """Its login page reports that instead of asking for a token that does not exist."""
    page = client.get("/login")
    assert (page.status_code, 'id="token"' in page.text) == (200, False)
    assert "This server has no token" in page.text


def test_whether_it_lives_is_open(guarded: TestClient) -> None:
    """Health checks need no token, nor does the login page."""
    assert guarded.get("/health").status_code == 200
    assert guarded.get("/login").status_code == 200


def test_names_that_only_begin_as_what_is_open(guarded: TestClient) -> None:
    """An address that only begins like an open one is protected."""
    assert guarded.get("/healthy").status_code == 401
    assert guarded.get("/login/../metrics").status_code == 401


def test_reading_needs_no_token_on_this_machine(store: Path) -> None:
    """On loopback the token is for changes only."""
    with application(store, write=True, token=TOKEN, log="off") as client:
        assert client.get("/sparql").status_code == 200
        assert client.post("/update", data={"update": "CLEAR ALL"}).status_code == 401
        assert client.put("/store?default", content=b"").status_code == 401
        assert client.delete("/store?default", headers=bearer(WRONG)).status_code == 401


def test_a_browser_is_led_to_the_page_and_back(browser: TestClient) -> None:
    """A page without token redirects to the form; the token becomes a cookie hidden from scripts and other sites."""
    led = browser.get("/query?query=ASK%7B%7D&x=1", headers={"Accept": "text/html"})
    assert led.status_code == 303
    assert led.headers["location"] == "/login?next=%2Fquery%3Fquery%3DASK%257B%257D%26x%3D1"
    page = browser.get(led.headers["location"])
    assert 'value="/query?query=ASK%7B%7D&amp;x=1"' in page.text
    answer = login(browser, TOKEN, next="/query?query=ASK%7B%7D&x=1")
    assert answer.status_code == 303
    assert answer.headers["location"] == "/query?query=ASK%7B%7D&x=1"
    cookie = answer.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "samesite=strict" in cookie.lower()
    assert TOKEN not in cookie
    assert browser.get("/sparql").status_code == 200
    out = browser.post("/logout", headers={"Sec-Fetch-Site": "same-origin"})
    assert out.status_code == 303
    assert browser.get("/sparql").status_code == 401


def test_pages_let_out_who_logged_in(browser: TestClient) -> None:
    """After login, pages have a logout button; after logout, a new login is required."""
    login(browser, TOKEN)
    assert 'action="/logout"' in browser.get("/query").text
    assert browser.post("/logout").headers["location"] == "/login"
    assert browser.get("/query").status_code == 401


def test_a_wrong_token_logs_nobody_in(browser: TestClient) -> None:
    """The form is shown again, without the typed text and without a cookie."""
    answer = login(browser, WRONG)
    assert answer.status_code == 401
    assert "set-cookie" not in answer.headers
    assert WRONG not in answer.text
    assert 'role="alert"' in answer.text


@pytest.mark.parametrize(
    "following", ["https://evil.example/", "//evil.example", "/\\evil.example", "/\t/evil.example", "javascript:1", ""]
)
def test_logging_in_leads_to_this_server_only(browser: TestClient, following: str) -> None:
    """A login redirects only within this server."""
    assert login(browser, TOKEN, next=following).headers["location"] == "/"
    assert "evil" not in browser.get("/login", params={"next": following}).text


def test_forms_that_are_none(browser: TestClient) -> None:
    """A login without token, or with a foreign form, is an ordinary error."""
    assert browser.post("/login", data={"other": "x"}).json()["code"] == "KG520"
    assert browser.post("/login", data={"token": TOKEN}, headers={"Origin": "http://evil.example"}).status_code == 403


def test_the_token_changes_with_its_file(tmp_path: Path) -> None:
    """A change of the file takes effect at once; if it is missing or too short, no token is accepted."""
    file = tmp_path / "token"
    file.write_text("first-token-of-the-file\n")
    tokens = Tokens(None, file)
    first = tokens.proof
    assert first
    assert tokens.matches("first-token-of-the-file")
    file.write_text("second-token-of-the-file\n")
    assert tokens.matches("second-token-of-the-file")
    assert not tokens.matches("first-token-of-the-file")
    assert not tokens.proves(first)
    assert tokens.proves(tokens.proof or "")
    file.write_text("short")
    assert not tokens.matches("short")
    file.unlink()
    assert not tokens.matches("second-token-of-the-file")
    assert not tokens.matches("")
    assert not tokens.proves("")


def test_a_cookie_ends_with_the_server() -> None:
    """Two servers with one token reject each other's cookies."""
    assert Tokens(TOKEN).proof != Tokens(TOKEN).proof


@pytest.mark.parametrize("candidate", ["", "\x00", "ü" * 20, "\ud800", TOKEN[:-1], TOKEN + "x", TOKEN.upper()])
def test_what_is_not_the_token(candidate: str) -> None:
    """Only the whole token matches, and any text can be compared."""
    assert not Tokens(TOKEN).matches(candidate)
    assert not Tokens(None).matches(candidate)


def test_the_token_is_never_told(store: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Logs, errors and options never contain the token, for any request."""
    caplog.set_level(logging.DEBUG)
    said = [repr(Options(token=TOKEN))]
    with application(store, write=True, token=TOKEN) as client:
        for path in ("/health", "/nothing", "/sparql?query=nonsense", "/metrics", f"/login?next=/{os.sep}"):
            said += [client.get(path, headers=bearer()).text]
        said += [login(client, TOKEN).text, client.post("/update", headers=bearer()).text]
    assert TOKEN not in "".join(said)
    assert TOKEN not in caplog.text
