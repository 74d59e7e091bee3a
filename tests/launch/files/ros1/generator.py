"""Generator of random launch trees, with many constructs that roslaunch rejects, for comparisons with it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import quoteattr

if TYPE_CHECKING:
    from random import Random

__all__ = ["launch_tree"]

_ARGUMENTS: Final = ("a", "b", "c")
_NAMESPACES: Final = ("left", "left/inner", "/top", "right/", "a//b")
_NAMES: Final = ("scan", "/scan", "image", "cloud/raw", "~in", "image/", "tf")
_PARAMETERS: Final = ("rate", "~rate", "/global", "sub/deep", "~sub/deep", "x/", "~/y")
_VALUES: Final = (
    "1",
    "2.5",
    "true",
    "False",
    "text",
    " padded ",
    "1e5",
    "1_0",
    "-3",
    "",
    "[1, 2]",
    "{k: {l: 2}}",
    "0x10",
    "~",
)
_TYPES: Final = ("auto", "str", "string", "yaml", "STR")
_HARD_TYPES: Final = ("int", "double", "bool", "Int", "none")
_CONDITIONS: Final = ("1", "0", "true", "False", "$(eval arg('a') == 1)", "$(eval a and not b)")
_HARD_CONDITIONS: Final = ("$(arg a)", "maybe", "")
_ENTRIES: Final = (
    "on: 1",
    "a: 1",
    "b: {c: [1, 2.0], d: text}",
    "e/f: deg(90)",
    "/g: rad(pi/2)",
    "h: ~",
    "i: [x, {y: 1}]",
    "j: 1e3",
    "k: on",
)
_HARD_EXPRESSIONS: Final = ("a + b", "1 / 0", "nothing", "'x' + 1")
_PLAIN_TAGS: Final = ("arg", "param", "rosparam", "remap", "node", "node", "group", "include", "env", "test", "machine")


class _Writer:
    """Generator of one tree; files include only later ones, which avoids cycles."""

    def __init__(self, random: Random, files: int) -> None:
        self._random = random
        self._wild = random.choice((0.0, 0.0, 0.2))
        self._files = files
        self._here = 0
        self._known: list[str] = []

    def file(self, number: int) -> str:
        """Return the text of a file, which includes later ones only."""
        self._here, self._known = number, []
        declared = "".join(self._declare(name) for name in _ARGUMENTS if not self._is_wild())
        self._known.extend(_ARGUMENTS)
        body = "".join(self._element(2) for _ in range(self._random.randint(1, 6)))
        return f"<launch>{declared}{body}</launch>\n"

    def _declare(self, name: str) -> str:
        kind = self._random.random()
        text = self._text(("1", "0", "text", "true"))
        self._known.append(name)
        if kind < 0.85:
            return self._tag("arg", name=name, default=text)
        if not self._is_wild():
            return self._tag("arg", name=name, default="1")
        return self._tag("arg", name=name, value=self._text()) if kind < 0.95 else self._tag("arg", name=name)

    def _is_wild(self) -> bool:
        """Whether to write a construct that roslaunch may reject."""
        return self._random.random() < self._wild

    def _tag(self, tag: str, body: str = "", **attributes: str | None) -> str:
        if self._random.random() < 0.08 and (len(self._known) >= len(_ARGUMENTS) or self._is_wild()):
            attributes[self._random.choice(("if", "unless"))] = self._random.choice(
                _HARD_CONDITIONS if self._is_wild() else _CONDITIONS
            )
        text = "".join(
            f" {name.replace('_', '-')}={quoteattr(value)}" for name, value in attributes.items() if value is not None
        )
        text = text.replace("pass-all-args", "pass_all_args").replace("clear-params", "clear_params")
        return f"<{tag}{text}>{body}</{tag}>\n"

    def _maybe(self, chance: float, *texts: str) -> str | None:
        return self._random.choice(texts) if self._random.random() < chance else None

    def _text(self, texts: tuple[str, ...] = _VALUES) -> str:
        kind = self._random.random()
        if not self._known and not self._is_wild():
            return self._random.choice(texts)
        name = self._random.choice(self._known or _ARGUMENTS)
        if kind < 0.2:
            return f"$(arg {name})"
        if kind < 0.3:
            return self._random.choice(
                (f"x$(arg {name})y", "$(find demo)/p q", "$(optenv NONE d e)", "$(env HOME_OF)", "$(dirname)/z")
            )
        if kind < 0.36:
            easy = ("1 + 2", "7 / 2", f"'{name}' * 2", f"arg('{name}')", f"str({name}) + str(1)")
            return f"$(eval {self._random.choice(_HARD_EXPRESSIONS if self._is_wild() else easy)})"
        return self._random.choice(texts)

    def _element(self, depth: int) -> str:
        tag = self._random.choice(_PLAIN_TAGS)
        writer = getattr(self, f"_{tag}")
        text: str = writer(depth) if tag in {"group", "node", "test"} else writer()
        return text

    def _arg(self) -> str:
        name = self._random.choice(_ARGUMENTS) if self._is_wild() else f"d{self._random.randint(0, 999)}"
        return self._tag("arg", name=name, default=self._text())

    def _param(self) -> str:
        source = self._maybe(0.06, "textfile", "command") or "value"
        value = (
            self._text()
            if source == "value"
            else {"textfile": "$(find demo)/text.txt", "command": "cat $(find demo)/text.txt"}[source]
        )
        return self._tag(
            "param",
            name=self._random.choice(_PARAMETERS),
            type=self._maybe(0.4, *(_HARD_TYPES if self._is_wild() else _TYPES)),
            **{source: value},
        )

    def _rosparam(self) -> str:
        entries = "\n".join(
            self._random.sample(_ENTRIES[0 if self._is_wild() and self._is_wild() else 1 :], self._random.randint(0, 3))
        )
        file = self._maybe(
            0.3, "$(find demo)/some.yaml", "$(find demo)/list.yaml" if self._is_wild() else "$(find demo)/some.yaml"
        )
        command = self._maybe(0.2, "load", "delete" if self._is_wild() or not file else "load")
        where = {"ns": self._maybe(0.3, "deep", "/abs", "x/y/"), "param": self._maybe(0.3, "p", "/q", "r/s")}
        return self._tag("rosparam", f"\n{entries}\n", command=command, file=file, **where)

    def _remap(self) -> str:
        return self._tag("remap", **{"from": self._random.choice(_NAMES), "to": self._random.choice(_NAMES)})

    def _env(self) -> str:
        return self._tag("env", name=self._random.choice(("A", "B")), value=self._text())

    def _machine(self) -> str:
        return self._tag(
            "machine",
            name=self._random.choice(("m", "n")),
            address="here",
            default="never" if self._is_wild() else "true",
        )

    def _node(self, _: int, tag: str = "node") -> str:
        inner = "".join(
            getattr(self, f"_{self._random.choice(('remap', 'param', 'param', 'rosparam', 'env'))}")()
            for _ in range(self._random.randint(0, 3))
        )
        args = self._maybe(0.3, "-v a:=b", "_p:=5 _q:=text", "$(arg b) image:=/left", "'a b' c")
        names = {"name": f"n{self._random.randint(0, 10**6)}"}
        if tag == "test":
            names = {"test_name": names["name"], "time_limit": "x" if self._is_wild() else "7"}
        machine, required = self._maybe(0.1, "m"), self._maybe(0.1, "true", "x" if self._is_wild() else "false")
        attributes = {
            "pkg": "demo",
            "type": "t",
            "ns": self._maybe(0.3, *_NAMESPACES),
            "args": args,
            "machine": machine,
        }
        return self._tag(tag, inner, **names, **attributes, required=required, clear_params=self._maybe(0.1, "true"))

    def _test(self, depth: int) -> str:
        return self._node(depth, "test")

    def _group(self, depth: int) -> str:
        if not depth:
            return ""
        body = "".join(self._element(depth - 1) for _ in range(self._random.randint(1, 4)))
        return self._tag(
            "group", body, ns=self._maybe(0.6, *_NAMESPACES), clear_params="true" if self._is_wild() else None
        )

    def _include(self) -> str:
        if self._here + 1 >= self._files:
            return ""
        file = f"$(find demo)/f{self._random.randint(self._here + 1, self._files - 1)}.launch"
        passed = self._random.sample(_ARGUMENTS, self._random.randint(0, 3))
        body = "".join(self._tag("arg", name=name, value=self._text()) for name in passed)
        everything = self._maybe(0.3, "true", "True" if self._is_wild() else "false")
        return self._tag("include", body, file=file, ns=self._maybe(0.4, *_NAMESPACES), pass_all_args=everything)


def launch_tree(random: Random) -> dict[str, str]:
    """Return the files of a package `demo`; the first is `f0.launch`."""
    files = random.randint(1, 4)
    writer = _Writer(random, files)
    tree = {f"f{number}.launch": writer.file(number) for number in range(files)}
    tree["text.txt"] = random.choice(("12", "1.5", "some text\nmore\n", "true"))
    tree["some.yaml"] = "one: 1\ntwo:\n  three: [1, 2]\n  four: deg(180)\n"
    tree["list.yaml"] = "[1, 2, 3]\n"
    return tree
