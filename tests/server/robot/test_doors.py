"""Access rights to the robot of a server, and the responses of its routes without one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final
from uuid import uuid4

import pytest
from serving import TOKEN, application

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from starlette.testclient import TestClient

BEARER: Final = {"Authorization": f"Bearer {TOKEN}"}
RUN: Final = {"program": {"body": [{"block": "stop"}]}}
MOVING: Final = {
    "/robot/run": RUN,
    "/robot/do": {"listener": "x", "capability": "drivingAtVelocity"},
    "/robot/pause": {},
    "/robot/resume": {},
}
SITES: Final = (
    {"Origin": "https://evil.example"},
    {"Sec-Fetch-Site": "cross-site"},
    {"Sec-Fetch-Site": "same-site", "Sec-Fetch-Mode": "navigate"},
)


@pytest.fixture(scope="module")
def robot(store: Path) -> Iterator[TestClient]:
    """A server with an unreachable robot, and a token."""
    with application(store, token=TOKEN, log="off", robot=f"memory://{uuid4().hex}") as found:
        yield found


def code(answer: Any) -> str:
    """Return the code of an error."""
    return str(answer.json()["code"])


@pytest.mark.parametrize("path", MOVING)
def test_moving_needs_the_token(robot: TestClient, path: str) -> None:
    """Every route that moves the robot rejects a missing or wrong token (C37)."""
    for headers in ({}, {"Authorization": "Bearer wrong-wrong-wrong-wrong"}):
        answer = robot.post(path, json=MOVING[path], headers=headers)
        assert (answer.status_code, code(answer)) == (401, "KG529")
        assert code(robot.post(f"{path}/", json=MOVING[path], headers=headers)) in {"KG529", "KG521"}
    assert robot.post(path, json=MOVING[path], headers=BEARER).status_code in {204, 409, 503}


@pytest.mark.parametrize("path", MOVING)
def test_without_a_token_nobody_moves_it(store: Path, path: str) -> None:
    """A server without a token never moves a robot, even with `--write` or open access (C37)."""
    with application(store, log="off", open_to_all=True, robot=f"memory://{uuid4().hex}") as client:
        answer = client.post(path, json=MOVING[path])
    assert (answer.status_code, code(answer)) == (403, "KG530")


@pytest.mark.parametrize("headers", SITES)
@pytest.mark.parametrize("path", [*MOVING, "/robot/stop", "/robot/read"])
def test_no_page_of_another_site_moves_it(robot: TestClient, path: str, headers: dict[str, str]) -> None:
    """A page of another site can neither move nor stop the robot, even if its browser has logged in (C37)."""
    robot.post("/login", data={"token": TOKEN})
    try:
        answer = robot.post(path, json=MOVING.get(path, {}), headers=headers)
        assert (answer.status_code, code(answer)) == (403, "KG528")
    finally:
        robot.cookies.clear()


def test_who_looks_on_may_stop(robot: TestClient) -> None:
    """Stopping needs no token (C38)."""
    assert robot.post("/robot/stop").status_code == 204


def test_who_looks_on_may_ask_why(robot: TestClient, client: TestClient) -> None:
    """A proof needs no token: KG520 without a name, KG846 while the robot is unreachable, KG845 without a proof."""
    assert [code(robot.get(f"/robot/why{asked}")) for asked in ("", "?capability=")] == ["KG520", "KG520"]
    answer = robot.get("/robot/why?capability=drivingAtVelocity")
    assert (answer.status_code, code(answer)) == (503, "KG846")
    assert code(client.get("/robot/why?capability=drivingAtVelocity")) == "KG845"


def test_bodies_are_read_strictly(robot: TestClient) -> None:
    """Invalid JSON, a wrong form, or a body too long or too deep is rejected with the reason, never a defect."""
    deep = '{"text": ' + "[" * 50_000 + "]" * 50_000 + "}"
    for body, kind, expected in (
        ("{", "application/json", "KG520"),
        ("[]", "application/json", "KG520"),
        ('{"text": 1}', "application/json", "KG520"),
        ('{"text": "stop", "more": 1}', "application/json", "KG520"),
        ("{}", "application/json", "KG520"),
        ('{"text": "stop", "program": {}}', "application/json", "KG520"),
        (deep, "application/json", "KG520"),
        ('{"text": "stop"}', "text/plain", "KG524"),
        ('{"text": "' + "x" * (1 << 18) + '"}', "application/json", "KG525"),
    ):
        answer = robot.post("/robot/check", content=body, headers={"Content-Type": kind})
        assert code(answer) == expected, body[:60]


@pytest.mark.parametrize("depth", [150, 900, 20_000])
def test_deep_programs_are_refused(robot: TestClient, depth: int) -> None:
    """A program nested more deeply than text allows is rejected, never a defect."""
    block = '{"block": "while", "condition": {"expression": "value", "value": true}, "body": ['
    body = '{"program": {"body": [' + block * depth + "]}" * depth + "]}}"
    for path in ("/robot/check", "/robot/convert", "/robot/run"):
        answer = robot.post(path, content=body, headers={**BEARER, "Content-Type": "application/json"})
        assert answer.status_code in {400, 413, 503}, path


def test_a_server_without_a_robot(client: TestClient) -> None:
    """Without a robot, the page and the language are available; other routes report the missing robot."""
    assert client.get("/api/robot").json() == {"address": None, "state": "none", "may_move": False, "capabilities": []}
    page = client.get("/robot").text
    assert "No robot is connected" in page
    assert "kg robot simulate office --port 11311" in page  # the path used by the second of the two commands
    for path in ("/robot/events", "/robot/view"):
        answer = client.get(path)
        assert (answer.status_code, code(answer)) == (404, "KG845")
    answer = client.post("/robot/stop")
    assert (answer.status_code, code(answer)) == (404, "KG845")


def test_programs_become_text_and_back(client: TestClient) -> None:
    """A program is returned as tree and as text, with the line of each statement; its identities are preserved."""
    tree = {"name": "try", "body": [
        {"block": "repeat", "id": "a", "times": {"expression": "value", "value": 2},
         "body": [{"block": "stop", "id": "b"}]},
        {"block": "log", "message": {"expression": "value", "value": "hello"}},
    ]}  # fmt: skip
    found = client.post("/robot/check", json={"program": tree}).json()
    assert found["text"].splitlines() == ['program "try"', "repeat 2 times", "  stop", "end", 'log "hello"']
    assert (found["lines"]["a"], found["lines"]["b"], found["problems"]) == (2, 3, [])
    again = client.post("/robot/check", json={"text": found["text"]}).json()
    assert [one["block"] for one in again["program"]["body"]] == ["repeat", "log"]
    assert client.post("/robot/convert", json={"program": tree}).json() == {"text": found["text"]}


def test_a_text_that_cannot_be_read_has_a_place(client: TestClient) -> None:
    """A syntax error has its line and column, and no program is returned."""
    found = client.post("/robot/check", json={"text": "log 1\nif then\n"}).json()
    assert found["program"] is None
    (problem,) = found["problems"]
    assert (problem["line"], problem["severity"]) == (2, "error")
    assert problem["column"] > 1
    assert problem["message"]
    assert problem["hint"]
