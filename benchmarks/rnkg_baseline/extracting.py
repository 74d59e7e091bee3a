"""Facts about ROS 1 nodes by strings, as the RNKG paper describes it (section 3.2.1, Table 3; figures 3 and 4).

A snippet is a call whose text has one of the strings. The name of a topic or service is its first argument; the type is
the template argument, or that of the callback, looked for by its name in the same file. Nothing is run and no call or
include is followed. Where the paper leaves a choice, the one that favours it is taken: a variable counts as a name only
where a parameter with a default is read into it in the same file, and a file without `init` belongs to the only node of
its package, or to none.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["Fact", "facts"]

_ENDINGS: Final = {".cpp", ".cc", ".cxx", ".h", ".hpp", ".py"}
_PACKAGE: Final = re.compile(r"<name>\s*([^<\s]+)")
_COMMENT: Final = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_INIT: Final = re.compile(r"ros::init\s*\([^;]*?\"([^\"]+)\"|rospy\.init_node\s*\(\s*['\"]([^'\"]+)['\"]")
_CALLS: Final = (
    ("publishes", re.compile(r"advertise\s*<\s*([\w:]+)\s*>\s*\(\s*([^,;]+),")),
    ("subscribes", re.compile(r"subscribe\s*(?:<\s*([\w:]+)[^>]*>)?\s*\(\s*([^,;]+),\s*[^,;]+,\s*&?([\w:]+)")),
    ("clients", re.compile(r"serviceClient\s*<\s*([\w:]+)\s*>\s*\(\s*([^,;)]+)[,)]")),
    ("services", re.compile(r"advertiseService\s*(?:<[^>]*>)?()\(\s*([^,;]+),\s*&?([\w:]+)")),
)
_PYTHON: Final = (
    ("publishes", re.compile(r"rospy\.Publisher\s*\(\s*([^,]+),\s*([\w.]+)")),
    ("subscribes", re.compile(r"rospy\.Subscriber\s*\(\s*([^,]+),\s*([\w.]+)")),
    ("clients", re.compile(r"rospy\.ServiceProxy\s*\(\s*([^,]+),\s*([\w.]+)")),
    ("services", re.compile(r"rospy\.Service\s*\(\s*([^,]+),\s*([\w.]+)")),
)
_SETTING: Final = re.compile(
    r"param\w*\s*(?:<[^>]*>)?\(\s*\"[^\"]+\"\s*,\s*(\w+)\s*,\s*(?:std::string\s*\(\s*)?\"([^\"]*)\""
)
_PYTHON_SETTING: Final = re.compile(
    r"([\w.]+)\s*=\s*rospy\.get_param\s*\(\s*['\"][^'\"]+['\"]\s*,\s*['\"]([^'\"]*)['\"]"
)
_IMPORT: Final = re.compile(r"from\s+(\w+)\.(?:msg|srv)\s+import\s+([^\n]+)")
_TEXT: Final = re.compile(r"[\"']([^\"']+)[\"']")


@dataclass(frozen=True, order=True)
class Fact:
    """A relation of a node: `name` as in the code, `type` as `package/Type`, `file` relative to the checkout."""

    repository: str
    package: str
    node: str
    relation: str
    name: str
    type: str
    file: str
    line: int


def facts(checkout: Path) -> list[Fact]:
    """Return what the strings of a checkout's C++ and Python files say."""
    found: list[Fact] = []
    for manifest in sorted(checkout.rglob("package.xml")):
        package = _PACKAGE.search(manifest.read_text(errors="replace"))
        inside = [one for one in manifest.parent.rglob("*") if _package_of(one, checkout) == manifest.parent]
        texts = {one: _code(one) for one in sorted(inside) if one.is_file() and _is_code(one)}
        inits = {one: [first or second for first, second in _INIT.findall(text)] for one, text in texts.items()}
        every = {name for names in inits.values() for name in names}
        for path, text in texts.items():
            nodes = inits[path] or (sorted(every) if len(every) == 1 else [])
            for relation, name, kind, line in _calls(path, text):
                for node in nodes:
                    place = str(path.relative_to(checkout))
                    found.append(
                        Fact(checkout.name, package[1] if package else "", node, relation, name, kind, place, line)
                    )
    return sorted(set(found))


def _package_of(path: Path, checkout: Path) -> Path | None:
    parents = [one for one in path.parents if one.is_relative_to(checkout)]
    return next((one for one in parents if (one / "package.xml").exists()), None)


def _is_code(path: Path) -> bool:
    return path.suffix in _ENDINGS or (
        not path.suffix and path.open("rb").readline(60).startswith(b"#!") and b"python" in path.open("rb").readline(60)
    )


def _code(path: Path) -> str:
    """Return the text of a file, with blanks in place of comments, so that lines keep their numbers."""
    text = path.read_text(errors="replace")
    if path.suffix in {".py", ""}:
        return re.sub(r"(?m)^[ \t]*#.*$", "", text)
    return _COMMENT.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)


def _calls(path: Path, text: str) -> Iterator[tuple[str, str, str, int]]:
    is_python = path.suffix in {".py", ""}
    settings = dict((_PYTHON_SETTING if is_python else _SETTING).findall(text))
    for relation, pattern in _PYTHON if is_python else _CALLS:
        for call in pattern.finditer(text):
            argument = call[1] if is_python else call[2]
            name = _TEXT.fullmatch(argument.strip())
            value = (name[1] if name else settings.get(argument.strip(), "")).replace("~/", "~")
            kind = _imported(text, call[2]) if is_python else _type(text, relation, call)
            if value and kind:
                yield relation, value, kind, text.count("\n", 0, call.start()) + 1


def _type(text: str, relation: str, call: re.Match[str]) -> str | None:
    """Return the type of a call of C++: its template argument, or what its callback takes."""
    if call[1]:
        return "/".join(call[1].split("::")[-2:]) if "::" in call[1] else None
    callback = call[3].rpartition("::")[2]
    ending = "::Request" if relation == "services" else ""
    found = re.search(
        rf"\b{re.escape(callback)}\s*\(\s*(?:const\s+)?([\w:]+?){ending}\s*(?:const\s*)?&?\s*\w*\s*[,)]", text
    )
    if not found or "::" not in found[1]:
        return None
    return "/".join(re.sub(r"(?:::ConstPtr|ConstPtr|::Ptr|Ptr)$", "", found[1]).split("::")[-2:])


def _imported(text: str, name: str) -> str | None:
    """Return the type that a name of Python stands for by the import of the file."""
    last = name.rpartition(".")[2]
    for package, names in _IMPORT.findall(text):
        if last in re.findall(r"\w+", names) or names.strip() == "*":
            return f"{package}/{last}"
    return None
