"""Calls of XML-RPC as bytes and back; what peers send is bounded, and none of it is expanded (xmlrpc.com/spec.md)."""

from __future__ import annotations

from typing import Any, Final
from xml.parsers import expat
from xmlrpc import client

from kg.errors import RobotError

__all__ = ["answer", "fault", "read", "request"]

_ODD: Final = (expat.ExpatError, client.Error, ValueError, TypeError, LookupError, AttributeError, OverflowError)


def request(method: str, arguments: tuple[Any, ...]) -> bytes:
    """Return the bytes of a call; RobotError KG805 for arguments that XML-RPC cannot carry."""
    try:
        return client.dumps(arguments, method, encoding="utf-8").encode()
    except (TypeError, OverflowError, UnicodeEncodeError) as error:
        raise RobotError("KG805", f"XML-RPC cannot carry a value: {error}") from None


def answer(value: Any) -> bytes:
    """Return the bytes of a response; RobotError KG805 for a value that XML-RPC cannot carry."""
    try:
        return client.dumps((value,), methodresponse=True).encode()
    except (TypeError, OverflowError, UnicodeEncodeError) as error:
        raise RobotError("KG805", f"XML-RPC cannot carry a value: {error}") from None


def fault(message: str) -> bytes:
    """Return the bytes of a response that says what is wrong."""
    return client.dumps(client.Fault(1, message)).encode()


def read(content: bytes) -> tuple[str | None, list[Any]]:
    """Return the method and the values that bytes carry; for a response the method is None.

    Raises:
        RobotError: KG810 for other bytes, and for a document type, with which a few bytes become many;
            KG813 for a fault.
    """
    target = client.Unmarshaller(use_builtin_types=True)
    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = _refuse
    parser.StartElementHandler = target.start
    parser.EndElementHandler = target.end
    parser.CharacterDataHandler = target.data
    target.xml(None, None)  # type: ignore[arg-type]  # no encoding: expat gives texts, as in xmlrpc.client.ExpatParser
    try:
        parser.Parse(content, True)
        values = list(target.close())
    except client.Fault as error:
        raise RobotError("KG813", f"a peer refused a call: {error.faultString!s:.200}") from None
    except _ODD as error:
        raise RobotError("KG810", f"{len(content)} bytes are not XML-RPC: {error!s:.200}") from None
    return target.getmethodname(), values


def _refuse(*_: object) -> None:
    raise ValueError("it declares a document type")
