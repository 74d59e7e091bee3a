"""What is attached to messages, requests and responses: their number, the time and who sent them.

Two forms are read: that since version 0.2.4 of rmw_zenoh_cpp, and the one before, which names each part. The numbers
are little endian; lists and texts have their length before them (serialisation of Zenoh's own, `zenoh-ext`).
"""

from __future__ import annotations

import struct
from typing import Final, NamedTuple

__all__ = ["Attachment"]

_GID: Final = 16
_FORM: Final = struct.Struct("<qqB16s")
_LABELS: Final = (b"sequence_number", b"source_timestamp", b"source_gid")


class Attachment(NamedTuple):
    """The number of a message, nanoseconds since 1970, and the identity of its sender."""

    number: int
    time: int
    sender: bytes

    def write(self) -> bytes:
        """Return it as it is attached."""
        return _FORM.pack(self.number, self.time, _GID, self.sender)

    @classmethod
    def read(cls, content: bytes) -> Attachment:
        """Return what is attached; ValueError when it is of neither form."""
        plain = content
        for label in _LABELS:
            plain = plain.replace(bytes([len(label)]) + label, b"", 1)
        if len(plain) != _FORM.size or plain[16] != _GID:
            raise ValueError(f"{len(content)} bytes are not an attachment of ROS 2")
        number, time, _, sender = _FORM.unpack(plain)
        return cls(number, time, sender)
