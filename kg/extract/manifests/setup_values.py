"""Values of expressions in a setup.py, as far as literals, names and simple text operations tell them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.holes import ANONYMOUS

if TYPE_CHECKING:
    from tree_sitter import Node

__all__ = ["Piece", "Values", "text_of"]

_DEEPEST: Final = 60


@dataclass(frozen=True, slots=True)
class Piece:
    """A string with the line it stands on."""

    text: str
    line: int


Value = "Piece | list[Value] | dict[str, Value] | None"


class Values:
    """Evaluates expressions against the names that a module assigns at its top level."""

    def __init__(self) -> None:
        self.names: dict[str, object] = {}
        self._depth = 0

    def of(self, node: Node | None) -> object:
        """Return a `Piece`, a list, a dict of strings, or None for what is not known."""
        if node is None or self._depth > _DEEPEST:
            return None
        self._depth += 1
        try:
            return self._evaluate(node)
        finally:
            self._depth -= 1

    def _evaluate(self, node: Node) -> object:
        match node.type:
            case "string":
                return self._string(node)
            case "concatenated_string":
                return self._join([self.of(child) for child in node.named_children], node)
            case "identifier":
                return self.names.get(text_of(node))
            case "list" | "tuple" | "set":
                return [item for child in node.named_children for item in self._items(child)]
            case "dictionary":
                return self._dictionary(node)
            case "parenthesized_expression" | "list_splat":
                return self.of(node.named_children[0]) if node.named_children else None
            case "binary_operator":
                return self._binary(node)
            case "call":
                return self._call(node)
            case "list_comprehension":
                return self._comprehension(node)
        return None

    def _items(self, node: Node) -> list[object]:
        value = self.of(node)
        if node.type == "list_splat":
            return value if isinstance(value, list) else []
        return [value]

    def _string(self, node: Node) -> Piece:
        parts: list[str] = []
        for child in node.named_children:
            if child.type == "string_content":
                parts.append(_unescaped(text_of(child)))
            elif child.type == "interpolation" and child.named_children:
                value = self.of(child.named_children[0])
                parts.append(value.text if isinstance(value, Piece) else ANONYMOUS)
        return Piece("".join(parts), node.start_point[0] + 1)

    def _join(self, values: list[object], node: Node) -> Piece | None:
        pieces = [value.text for value in values if isinstance(value, Piece)]
        return Piece("".join(pieces), node.start_point[0] + 1) if len(pieces) == len(values) else None

    def _dictionary(self, node: Node) -> dict[str, object]:
        found: dict[str, object] = {}
        for pair in node.named_children:
            if pair.type == "pair":
                key = self.of(pair.child_by_field_name("key"))
                if isinstance(key, Piece):
                    found[key.text] = self.of(pair.child_by_field_name("value"))
        return found

    def _binary(self, node: Node) -> object:
        left, right = self.of(node.child_by_field_name("left")), self.of(node.child_by_field_name("right"))
        operator = node.child_by_field_name("operator")
        sign = text_of(operator) if operator else ""
        if sign == "+":
            if isinstance(left, list) or isinstance(right, list):
                return [*(left if isinstance(left, list) else []), *(right if isinstance(right, list) else [])]
            return self._join([left, right], node)
        if sign == "%" and isinstance(left, Piece):
            values = right if isinstance(right, list) else [right]
            return _fill(left, "%s", values)
        return None

    def _call(self, node: Node) -> object:
        function = node.child_by_field_name("function")
        arguments = node.child_by_field_name("arguments")
        values = [self.of(child) for child in arguments.named_children] if arguments else []
        if function is None or function.type != "attribute":
            return values[0] if function is not None and text_of(function) in {"list", "str"} and values else None
        owner = self.of(function.child_by_field_name("object"))
        name = function.child_by_field_name("attribute")
        if isinstance(owner, Piece) and name is not None and text_of(name) == "format":
            return _fill(owner, "{}", values)
        return None

    def _comprehension(self, node: Node) -> list[object]:
        """Evaluate `[f"{x} = ..." for x in [...]]` for one loop over a known list."""
        loops = [child for child in node.named_children if child.type == "for_in_clause"]
        body = node.child_by_field_name("body")
        if len(loops) != 1 or body is None:
            return []
        left, right = loops[0].child_by_field_name("left"), self.of(loops[0].child_by_field_name("right"))
        if left is None or left.type != "identifier" or not isinstance(right, list):
            return []
        name, before = text_of(left), dict(self.names)
        found = []
        for item in right:
            self.names[name] = item
            found.append(self.of(body))
        self.names = before
        return found


def text_of(node: Node) -> str:
    """Return the text of a node."""
    return (node.text or b"").decode("utf-8", "replace")


def _unescaped(content: str) -> str:
    """Return the content of a string literal with its escapes undone; only those that entry points can have."""
    for written, meant in (("\\\n", ""), ("\\n", "\n"), ("\\t", "\t"), ("\\'", "'"), ('\\"', '"')):
        content = content.replace(written, meant)
    return content


def _fill(template: Piece, mark: str, values: list[object]) -> Piece | None:
    text = template.text
    for value in values:
        if not isinstance(value, Piece):
            return None
        text = text.replace(mark, value.text, 1)
    return Piece(text, template.line)
