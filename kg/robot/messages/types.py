"""Message types of one version of ROS, by `rosbags`: their fields, and encoding and decoding of values.

Names are `package/Type`; the two messages of a service are `package/Type_Request` and `package/Type_Response`, those of
an action `_Goal`, `_Result` and `_Feedback`. Definitions of an installed ROS 2 take precedence over those that come
with kg. Types are also learned from definitions in recordings and of bridges: `.msg` texts with names of ROS 2, and
IDL.
"""

from __future__ import annotations

import os
import re
import struct
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from hashlib import md5
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from rosbags.interfaces import Nodetype
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_typestore

from kg.errors import RobotError
from kg.robot.messages import definitions
from kg.robot.messages.definitions import PARTS, Definition, check_size, derived, is_type, library, parts
from kg.robot.messages.values import MEMBER_OF_NOTHING, plain, shaped

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.robot.connection import Value

_STORES: Final = {1: Stores.ROS1_NOETIC, 2: Stores.ROS2_JAZZY}
_ENCAPSULATION: Final = 4  # bytes before the first field in CDR


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message.

    `type` is a base type (`float64`, `string`, ...) or the name of a message. `length` is None for a single value, the
    number of elements of an array, 0 for a list. `most` is the maximum length of a list, `bound` that of a text; 0 for
    unlimited.
    """

    name: str
    type: str
    length: int | None = None
    most: int = 0
    bound: int = 0

    @property
    def is_message(self) -> bool:
        """Whether its values are messages."""
        return "/" in self.type


class Types:
    """The types of one version of ROS: common ones, those of an installed ROS 2, and those defined at run time."""

    def __init__(self, ros: int) -> None:
        self.ros = ros
        self._store = get_typestore(_STORES[ros])
        self._standard = frozenset(self._store.fielddefs)
        self._library = library(ros)
        self._installed = installed(os.environ.get("AMENT_PREFIX_PATH", "") if ros == 2 else "")  # noqa: PLR2004 - ROS 2
        self._looked: set[str] = set()
        self._read: dict[str, Definition] = {}
        self._defined: set[str] = set()

    def has(self, name: str) -> bool:
        """Return whether a message type is known."""
        message = self._message(name)
        loaded = _full(message) in self._store.fielddefs or message in self._library
        return loaded or self._installed.get(message) is not None

    def names(self) -> list[str]:
        """Return the sorted names of the message types that come with kg, including parts of services and actions."""
        return sorted({short(name) for name in self._store.fielddefs} | self._library.keys())

    def sort(self, name: str) -> str | None:
        """Return `msg`, `srv` or `action`, or None for an unknown type."""
        if self.has(name):
            return "msg"
        for sort, suffixes in PARTS.items():
            if all(self.has(name + suffix) for suffix in suffixes):
                return sort
        return None

    def fields(self, name: str) -> tuple[Field, ...]:
        """Return the fields of a type in order; RobotError KG804 if it is unknown."""
        members = self._store.fielddefs[self._resolved(name)][1]
        return tuple(_field(one, kind) for one, kind in members if one != MEMBER_OF_NOTHING)

    def define(self, name: str, text: str, sort: str = "msg") -> None:
        """Define a type from a text, with nested types after lines of `=` (the text of a connection header).

        `sort` is `msg`, `srv` or `action`; the parts of the last two are separated by lines of `---`. Such a definition
        replaces that of kg, since the robot may have another version.

        Raises:
            RobotError: KG810 an invalid definition, KG806 a definition that differs from that of every distribution or
                from an earlier one.
        """
        try:
            read = [
                definitions.read(self._message(one), part)
                for full, whole in definitions.split(name, text)
                for one, part in parts(full, sort if full == name else "msg", whole, self.ros)
            ]
            self._learn(read, from_peer=True)
        except (TypesysError, ValueError) as error:
            raise RobotError("KG810", f"the definition of `{name[:80]}` cannot be read: {error}") from None

    def md5(self, name: str) -> str:
        """Return the MD5 sum that ROS 1 peers compare, also of a service; RobotError KG804 for an unknown type."""
        parts = [name + part for part in PARTS["srv"]] if self.sort(name) == "srv" else [name]
        whole = "".join(definitions.sum_text(self._definition(one), self.md5) for one in parts)
        return md5(whole.encode(), usedforsecurity=False).hexdigest()

    def definition(self, name: str) -> str:
        """Return the text of a definition with those of nested types; RobotError KG804 for an unknown type."""
        self._resolved(name)
        used = self._used(self._message(name), {})
        first, *others = used
        return used[first] + "".join(f"{'=' * 80}\nMSG: {one}\n{used[one]}" for one in others)

    def encode(self, name: str, value: Value) -> bytes:
        """Return the encoded value; missing fields have their defaults.

        Raises:
            RobotError: KG804 an unknown type, KG805 a value that does not fit, with the field.
        """
        kind = self._resolved(name)
        shape = shaped(self._store, kind, value)
        try:
            written = (
                self._store.serialize_ros1(shape, kind) if self.ros == 1 else self._store.serialize_cdr(shape, kind)
            )
        except (struct.error, UnicodeEncodeError, SerdeError, OverflowError) as error:
            raise RobotError("KG805", f"the value is not a {name}: {error}") from None
        return bytes(written)

    def decode(self, name: str, content: bytes) -> Value:
        """Return the decoded value; RobotError KG810 for invalid bytes, KG804 for an unknown type."""
        kind = self._resolved(name)
        try:
            read = self._store.deserialize_ros1 if self.ros == 1 else self._store.deserialize_cdr
            return plain(self._store, kind, read(content, kind))
        except Exception as error:  # noqa: BLE001 - the generated code of rosbags raises whatever the bytes lead it to
            raise RobotError("KG810", f"{len(content)} bytes are not a {name}: {error}") from None

    def trimmed(self, name: str, content: bytes) -> bytes:
        """Return a value in CDR without the bytes that a library left behind it; errors as `decode`."""
        kind = self._resolved(name)
        message = self._store.get_msgdef(kind)
        try:
            read = message.deserialize_cdr_le if content[1] else message.deserialize_cdr_be
            return content[: _ENCAPSULATION + read(content[_ENCAPSULATION:], 0, message.cls, self._store)[1]]
        except Exception as error:  # noqa: BLE001 - the generated code of rosbags raises whatever the bytes lead it to
            raise RobotError("KG810", f"{len(content)} bytes are not a {name}: {error}") from None

    def complete(self, name: str, value: Value) -> Value:
        """Return the value with defaults for missing fields; errors as those of `encode`."""
        kind = self._resolved(name)
        return plain(self._store, kind, shaped(self._store, kind, value))

    def _message(self, name: str) -> str:
        """Return the name of a part of an action in ROS 1: `TypeGoal` for `Type_Goal`; other names are unchanged."""
        for suffix in PARTS["action"]:
            if self.ros == 1 and name.endswith(suffix):
                return name.removesuffix(suffix) + suffix[1:]
        return name

    def _resolved(self, name: str) -> str:
        message = self._message(name)
        full = _full(message)
        if full not in self._looked:
            self._looked.add(full)
            self._take_installed(message, full)
        if full not in self._store.fielddefs:
            if message.rpartition("/")[2].startswith("wstring"):
                why = "strings of 16-bit characters (`wstring`) are not supported"
                raise RobotError("KG804", why, hint="Leave such topics out; no library that kg uses has them.")
            if message not in self._library:
                raise RobotError("KG804", f"the message type `{name[:80]}` is not known")
            self._learn([definitions.read(message, self._library[message])], from_peer=False)
        return full

    def _take_installed(self, name: str, full: str) -> None:
        """Learn a type from the installed ROS 2, unless a peer has defined it; raises if nothing else defines it."""
        own = None if name in self._defined else self._installed.get(name)
        if own is None:
            return
        try:
            self._learn([own], from_peer=False)
        except (RobotError, ValueError) as error:  # a nested type is unknown, or it is too large
            if full in self._store.fielddefs or name in self._library:
                return
            self._looked.discard(full)
            why = error.message if isinstance(error, RobotError) else str(error)
            raise RobotError("KG804", f"the installed definition of `{name}` cannot be used: {why}") from None

    def _learn(self, learned: Iterable[Definition], *, from_peer: bool) -> None:
        new = {one.name: one for one in learned}
        for one in list(new.values()):
            if not definitions.is_type(one.name):
                raise ValueError(f"`{one.name[:80]}` is not a type name")
            if from_peer and self._is_registered(one):
                del new[one.name]
        self._derive(new)
        check_size(self._store, new, self._resolved)
        # The store refuses to redefine a type, and caches the code that encodes those that contain it.
        for full in [_full(name) for name in new if _full(name) in self._store.fielddefs]:
            del self._store.fielddefs[full], self._store.types[full]
            self._store.cache.clear()
        self._store.register({_full(one.name): ([], [(f.name, f.kind) for f in one.fields]) for one in new.values()})
        self._read |= new
        self._defined.update(new if from_peer else ())

    def _is_registered(self, one: Definition) -> bool:
        if _full(one.name) not in self._store.fielddefs:
            return False
        fields = [(name, kind) for name, kind in self._store.fielddefs[_full(one.name)][1] if name != MEMBER_OF_NOTHING]
        same = fields == [(field.name, field.kind) for field in one.fields]
        given = one.name in self._library or _full(one.name) not in self._standard
        if not same and (one.name in self._defined or not given):
            raise RobotError("KG806", f"`{one.name}` is defined with fields that differ from the known definition")
        return same and self._definition(one.name).constants == one.constants

    def _derive(self, new: dict[str, Definition]) -> None:
        """Add the messages of an action's topics and services, once its goal, result and feedback are known."""
        suffixes = [part.removeprefix("_") if self.ros == 1 else part for part in PARTS["action"]]
        for name in sorted({one.removesuffix(part) for one in new for part in suffixes if one.endswith(part)}):
            if self.ros == 1 and name.endswith("Action"):
                continue  # `TypeActionGoal` is derived from an action, not a part of one
            if all(self._message(name + part) in new or self.has(name + part) for part in PARTS["action"]):
                for one, text in derived(name, self.ros):
                    if not self.has(one):
                        new.setdefault(one, definitions.read(one, text))

    def _definition(self, name: str) -> Definition:
        full = self._resolved(name)
        message = self._message(name)
        if message not in self._read:
            text = self._store.generate_msgdef(full, ros_version=self.ros)[0]
            self._read[message] = definitions.read(message, text.partition("=" * 80)[0])
        return self._read[message]

    def _used(self, name: str, texts: dict[str, str]) -> dict[str, str]:
        one = self._definition(name)
        texts[one.name] = one.text
        for field in one.fields:
            builtin = self.ros == 1 and field.type.startswith("builtin_interfaces/")
            if "/" in field.type and field.type not in texts and not builtin:
                self._used(field.type, texts)
        return texts


def _full(name: str) -> str:
    package, _, kind = name.partition("/")
    return f"{package}/msg/{kind}"


def _field(name: str, kind: Any) -> Field:
    sort, inner = kind
    if sort in {Nodetype.ARRAY, Nodetype.SEQUENCE}:
        element = _field(name, inner[0])
        length, most = (inner[1], 0) if sort is Nodetype.ARRAY else (0, inner[1])
        return Field(name, element.type, length, most, element.bound)
    return Field(name, inner[0], bound=inner[1]) if sort is Nodetype.BASE else Field(name, short(inner))


_HEADING: Final = re.compile(r"^(MSG: \w+)/msg/", re.MULTILINE)
_FAMILY: Final = re.compile(r"/(?:msg|srv|action)/")
_SEPARATOR: Final = "=" * 80 + "\n"


def short(kind: str) -> str:
    """Return `package/Type` for the name of a type in ROS 2 (`package/msg/Type`) or ROS 1."""
    return _FAMILY.sub("/", kind)


def learn(types: Types, kind: str, text: str, *, idl: bool = False) -> None:
    """Define a type with its nested types; RobotError as `Types.define`."""
    types.define(kind, _HEADING.sub(r"\1/", _of_idl(kind, text) if idl else text))


def learn_all(types: Types, texts: Mapping[str, str]) -> None:
    """Define types that use each other from `.msg` texts; known types are unchanged.

    Raises as `Types.define`.
    """
    new = {name: text for name, text in texts.items() if not types.has(name)}
    for name, own in new.items():
        others = (f"{_SEPARATOR}MSG: {one}\n{text}" for one, text in new.items() if one != name)
        types.define(name, own + "".join(others))


def _of_idl(kind: str, text: str) -> str:
    """Return the definition of a type in `.msg` form; RobotError KG810 for invalid IDL."""
    store = get_typestore(Stores.EMPTY)
    try:
        parts = (
            [one.partition("\n")[2] for one in text.split(_SEPARATOR)[1:]] if text.startswith(_SEPARATOR) else [text]
        )
        for part in parts:
            store.register(get_types_from_idl(part))
        return store.generate_msgdef(kind.replace("/", "/msg/"), ros_version=2)[0]
    except Exception as error:  # noqa: BLE001 - the grammar raises errors of several kinds
        raise RobotError("KG810", f"the definition of `{kind[:80]}` cannot be read: {error}") from None


_ROS: Final = 2
_SORTS: Final = ("msg", "srv", "action")
_LONGEST: Final = 1 << 20  # bytes of a definition up to which it is read


@cache
def installed(prefixes: str) -> Installed:
    """Return the definitions below the prefixes of an installed ROS 2, in the form of `AMENT_PREFIX_PATH`."""
    return Installed(tuple(Path(one) for one in prefixes.split(os.pathsep) if one))


class Installed:
    """Definitions of types: `share/PACKAGE/{msg,srv,action}/NAME` below prefixes; read when they are needed."""

    def __init__(self, prefixes: tuple[Path, ...]) -> None:
        self._prefixes = prefixes
        self._definitions: dict[str, Mapping[str, Definition]] = {}

    def get(self, name: str) -> Definition | None:
        """Return the definition of a message, or of a part of a service or action; None if no valid one is installed.

        A package of the name `package` is the first one below the prefixes, as for ROS 2.
        """
        if not is_type(name):
            return None
        package, _, own = name.partition("/")
        whole = own.partition("_")[0]  # names of types have no underscores, except before their parts
        key = f"{package}/{whole}"
        if key not in self._definitions:
            self._definitions[key] = self._read(package, whole)
        return self._definitions[key].get(name)

    def _read(self, package: str, whole: str) -> Mapping[str, Definition]:
        shares = (prefix / "share" / package for prefix in self._prefixes)
        share = next((one for one in shares if one.is_dir()), None)
        definitions_by_name: dict[str, Definition] = {}
        if share is None:
            return definitions_by_name
        for sort in _SORTS:
            with suppress(OSError, ValueError):  # no such file, or a type that kg does not support
                with (share / sort / f"{whole}.{sort}").open(encoding="utf-8") as file:
                    text = file.read(_LONGEST)
                texts = parts(f"{package}/{whole}", sort, text, _ROS)
                definitions_by_name |= {name: definitions.read(name, part) for name, part in texts}
        return definitions_by_name
