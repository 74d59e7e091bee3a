"""Tokens and attachments in the form of rmw_zenoh_cpp are parsed, and all others are rejected."""

from __future__ import annotations

import contextlib
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.facts import Qos, Role
from kg.robot.zenoh.ends import Attachment
from kg.robot.zenoh.tokens import Token, read_qos, written_qos

_QOS = st.builds(
    Qos,
    st.sampled_from(["reliable", "best_effort"]),
    st.sampled_from(["volatile", "transient_local"]),
    st.sampled_from(["keep_last", "keep_all"]),
    st.integers(1, 1000),
    liveliness=st.just("automatic"),
)


def test_a_token_of_the_documentation() -> None:
    """The example of the design document of rmw_zenoh is parsed."""
    digest = "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
    token = Token.read(
        "@ros2_lv/2/f9980ee0495eaafb3e38f0d19e2eae12/0/10/SS/%/%/add_two_ints_server/%add_two_ints/"
        f"example_interfaces::srv::dds_::AddTwoInts_/{digest}/::,10:,:,:,,"
    )
    assert (token.node, token.role, token.name) == ("/add_two_ints_server", Role.SERVICES, "/add_two_ints")
    assert (token.domain, token.kind, token.hash) == (2, "example_interfaces/AddTwoInts", digest)
    assert token.qos == Qos("reliable", "volatile", "keep_last", 10, liveliness="automatic")


@given(
    st.sampled_from([Role.PUBLISHES, Role.SUBSCRIBES, Role.SERVICES, Role.CLIENTS]),
    st.sampled_from(["/node", "/robot/base"]),
    st.sampled_from(["/topic", "/robot/front/scan"]),
    _QOS,
)
def test_tokens_are_read_back(role: Role, node: str, name: str, qos: Qos) -> None:
    """Tokens of our declarations are parsed to the same values."""
    token = Token(3, "aac3178e146ba6f1fc6e6a4085e77f21", node, role, name, "std_msgs/String", "RIHS01_0", qos, 7)
    assert Token.read(token.key) == token
    assert read_qos(written_qos(qos)) == qos


@given(st.text(alphabet="@ros2_lv/%0NMPS:,", max_size=60) | st.text(max_size=40))
def test_any_key_is_read_or_refused(key: str) -> None:
    """An invalid key is a ValueError."""
    for text in (key, f"@ros2_lv/0/a/0/0/MP/%/%/n/{key}", f"@ros2_lv/0/a/0/0/MP/%/%/n/%t/a::msg::dds_::B_/h/{key}"):
        with contextlib.suppress(ValueError):
            Token.read(text)


def test_attachments_of_both_forms() -> None:
    """The form with names of parts, of the first versions, is parsed like that without."""
    meant = Attachment(5, 1_700_000_000_000_000_000, bytes(range(16)))
    labelled = b"".join(
        bytes([len(label)]) + label + content
        for label, content in (
            (b"sequence_number", struct.pack("<q", 5)),
            (b"source_timestamp", struct.pack("<q", meant.time)),
            (b"source_gid", b"\x10" + meant.sender),
        )
    )
    assert Attachment.read(meant.write()) == Attachment.read(labelled) == meant


@given(st.binary(max_size=80))
def test_other_attachments_are_refused(content: bytes) -> None:
    """An invalid attachment is a ValueError."""
    with contextlib.suppress(ValueError):
        assert Attachment.read(content).write()


def test_what_a_depth_is() -> None:
    """An invalid number is rejected."""
    with pytest.raises(ValueError, match="not a number"):
        read_qos("::,x:,:,:,,")
