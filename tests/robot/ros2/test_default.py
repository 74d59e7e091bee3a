"""The default address in the environment of ROS 2."""

from __future__ import annotations

import pytest

from kg.robot.connecting import default_address


@pytest.mark.parametrize(
    ("environment", "address"),
    [
        ({}, "dds://0"),
        ({"ROS_DOMAIN_ID": "7", "ROS_DISTRO": "jazzy"}, "dds://7"),
        ({"ROS_DISTRO": "humble"}, "dds://0?distribution=humble"),
        ({"ROS_DOMAIN_ID": "7", "RMW_IMPLEMENTATION": "rmw_zenoh_cpp"}, "zenoh://localhost:7447?domain=7"),
    ],
)
def test_the_environment_names_it(environment: dict[str, str], address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Domain, middleware and distribution are those of a configured ROS 2 terminal."""
    for name in ("ROS_DOMAIN_ID", "ROS_DISTRO", "RMW_IMPLEMENTATION"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("ROS_VERSION", "2")
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert default_address() == address
