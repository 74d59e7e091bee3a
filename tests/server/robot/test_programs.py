"""Programs posted to a server with a robot: as text, and as behaviour trees."""

from __future__ import annotations

from typing import TYPE_CHECKING

import httpx
import pytest
from patience import patient
from serving import TOKEN, robot_told

if TYPE_CHECKING:
    from collections.abc import Iterator

TEXT = "move at a velocity  forward: 20 cm/s for 500 ms\n"


@pytest.fixture
def client(robot_site: str) -> Iterator[httpx.Client]:
    """A client with the token, once the robot is connected."""
    headers = {"Authorization": f"Bearer {TOKEN}"}
    with httpx.Client(base_url=robot_site, headers=headers, timeout=patient(20)) as found:
        robot_told(found, "connected", "robot")
        yield found
        found.post("/robot/stop")


def test_a_program_is_run_as_text(client: httpx.Client) -> None:
    """`POST /robot/run` takes the text of a program and runs it to its end."""
    assert client.post("/robot/run", json={"text": 'program "as text"\nwait 100 ms\n'}).status_code == 204
    assert robot_told(client, "done")["program"] == {"state": "done", "name": "as text", "running": []}


def test_a_text_that_is_no_program_is_not_run(client: httpx.Client) -> None:
    """A syntax error is reported with its line; a body with both forms, or with none, is rejected."""
    found = client.post("/robot/run", json={"text": "wait 1 s\nif then\n"}).json()
    assert (found["code"], found["line"]) == ("KG830", 2)
    unknown = client.post("/robot/run", json={"text": "forever\n  goingToPse x: 1 m\nend\n"}).json()
    assert (unknown["code"], unknown["line"], unknown["column"]) == ("KG832", 2, 3)
    for body in ({}, {"text": TEXT, "program": {"body": []}}):
        assert client.post("/robot/run", json=body).json()["code"] == "KG520"


def test_behaviour_trees_are_written_and_read(client: httpx.Client) -> None:
    """A program becomes a tree by the capabilities of the robot, and then the same program again."""
    program = client.post("/robot/check", json={"text": TEXT}).json()["program"]
    tree = client.post("/robot/convert", json={"program": program, "to": "bt"}).json()["text"]
    assert '<drivingAtVelocity forward="0.2" for_seconds="0.5"' in tree
    assert client.post("/robot/convert", json={"bt": tree}).json()["text"] == TEXT
    refused = client.post("/robot/convert", json={"bt": "<root/>"}).json()
    assert refused["code"] == "KG842"
