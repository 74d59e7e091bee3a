"""From the text of a `.rq` to blocks.

Expressions of SPARQL as blocks; an expression without a block stays text, as a whole.

The grammar is that of SPARQL 1.1, productions from Expression on; the text was checked by the parser of rules before.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from textwrap import dedent
from typing import Final, get_args, get_type_hints

import msgspec
from pyoxigraph import Literal, NamedNode

from kg.errors import RuleError
from kg.rules.blocks import tree as blocks
from kg.rules.blocks.write import SECTIONS, inferred, namespace
from kg.rules.files import parse_header
from kg.rules.form import Variable
from kg.syntax import tree
from kg.syntax.lexer import END, Kind, Token, as_operator, bare, normalise, quoted, token_at, tokens_of, unescape
from kg.syntax.names import PREFIXES, RDF_TYPE, shorten
from kg.syntax.parser import parse_rq
from kg.syntax.printer import path_text, renamed

_XSD: Final = PREFIXES["xsd"]
_NUMBERS: Final = {
    _XSD + "integer": r"[+-]?[0-9]+",
    _XSD + "decimal": r"[+-]?[0-9]*\.[0-9]+",
    _XSD + "double": r"[+-]?([0-9]+|[0-9]*\.[0-9]+)[eE][+-]?[0-9]+",
}
"""How SPARQL writes numbers of a datatype (SPARQL 1.1 Query Language, section 4.1.2)."""

_LEVELS: Final = (("||",), ("&&",), ("=", "!=", "<", "<=", ">", ">="), ("+", "-"), ("*", "/"))
"""Operators, from those that bind least."""
_WORDS: Final = {"||": "or", "&&": "and"}
_TESTS: Final = (blocks.Compare, blocks.Match, blocks.Bound, blocks.Logic, blocks.Not, blocks.RawTest)
_MATCHES: Final = frozenset(get_args(get_type_hints(blocks.Match)["how"]))
_FUNCTIONS: Final = frozenset(get_args(get_type_hints(blocks.Of)["function"]))


class _NoBlock(Exception):  # noqa: N818 - no error: there is only no block for it
    """No block exists for an expression."""


def test_of(text: str) -> blocks.Test | None:
    """Return the test of an expression; None if a part of it has no block."""
    parsed = _parsed(text)
    return parsed if isinstance(parsed, _TESTS) else None


def value_of(text: str) -> blocks.Value:
    """Return the value of an expression, as SPARQL if a part of it has no block."""
    parsed = _parsed(text)
    return blocks.Formula(text=formula(text)) if parsed is None or isinstance(parsed, _TESTS) else parsed


def formula(text: str) -> str:
    """Return an expression without the brackets around all of it, and without comments; lines are joined."""
    pieces = tokens_of(bare(text))
    spaced = zip([None, *pieces], pieces, strict=False)
    return "".join((" " if one and one.end < other.start else "") + other.text for one, other in spaced)


def _parsed(text: str) -> blocks.Test | blocks.Value | None:
    parser = _Parser(text)
    try:
        result = parser.level(0)
    except _NoBlock:
        return None
    return result if parser.token.text == END else None


class _Parser:
    def __init__(self, text: str) -> None:
        self.text = text
        self.token = token_at(text, 0)

    def level(self, level: int) -> blocks.Test | blocks.Value:
        """Read operands and the operators between them that bind at least as much as those of a level."""
        if level == len(_LEVELS):
            return self._operand()
        result = self.level(level + 1)
        while as_operator(self.token).text in _LEVELS[level]:
            self.token = as_operator(self.token)
            operator = self._advance().text
            result = _joined(operator, result, self.level(level + 1))
        return result

    def _advance(self) -> Token:
        token = self.token
        self.token = token_at(self.text, token.end)
        return token

    def _accept(self, sign: str) -> bool:
        matches = self.token.text == sign
        if matches:
            self._advance()
        return matches

    def _expect(self, sign: str) -> None:
        if not self._accept(sign):
            raise _NoBlock

    def _operand(self) -> blocks.Test | blocks.Value:
        if self._accept("!"):
            return blocks.Not(of=_test(self._operand()))
        if self.token.text in {"-", "+"}:
            sign = self._advance().text
            if self.token.kind is not Kind.NUMBER:
                raise _NoBlock
            return self._number(sign)
        if self._accept("("):
            result = self.level(0)
            self._expect(")")
            return result
        return self._primary()

    def _primary(self) -> blocks.Test | blocks.Value:
        token = self.token
        if token.kind is Kind.NUMBER:
            return self._number("")
        if token.kind is Kind.WORD:
            return self._called(self._advance().text.upper())
        self._advance()
        if token.kind is Kind.VARIABLE:
            return blocks.Thing(name=token.text[1:])
        if token.kind is Kind.STRING:
            return self._string(token)
        if token.kind in {Kind.IRI, Kind.NAME} and self.token.text != "(":
            return blocks.Name(name=token.text)
        raise _NoBlock

    def _number(self, sign: str) -> blocks.Number:
        digits = self._advance().text
        if digits.endswith("."):
            raise _NoBlock
        return blocks.Number(value=sign + digits)

    def _string(self, token: Token) -> blocks.Text:
        content = unescape(quoted(token)[1])
        if self.token.kind is Kind.TAG:
            return blocks.Text(value=content, language=self._advance().text[1:])
        if self._accept("^^"):
            return blocks.Text(value=content, datatype=self._advance().text)
        return blocks.Text(value=content)

    def _called(self, word: str) -> blocks.Test | blocks.Value:
        if word in {"TRUE", "FALSE"}:
            return blocks.Truth(value=word == "TRUE")
        arguments = self._arguments()
        if word == "CONCAT" and arguments:
            return blocks.Join(parts=tuple(map(_value, arguments)))
        if word in _FUNCTIONS and len(arguments) == 1:
            return blocks.Of(function=word, of=_value(arguments[0]))  # type: ignore[arg-type]  # one of them, as was just seen
        if word in _MATCHES and len(arguments) == 2:  # noqa: PLR2004 - the value and the text
            value, text = map(_value, arguments)
            return blocks.Match(how=word, value=value, text=text)  # type: ignore[arg-type]  # as above
        if word == "BOUND" and len(arguments) == 1 and isinstance(arguments[0], blocks.Thing):
            return blocks.Bound(name=arguments[0].name)
        raise _NoBlock

    def _arguments(self) -> list[blocks.Test | blocks.Value]:
        self._expect("(")
        result: list[blocks.Test | blocks.Value] = []
        while not self._accept(")"):
            if result:
                self._expect(",")
            result.append(self.level(0))
        return result


def _test(part: blocks.Test | blocks.Value) -> blocks.Test:
    if not isinstance(part, _TESTS):
        raise _NoBlock
    return part


def _value(part: blocks.Test | blocks.Value) -> blocks.Value:
    if isinstance(part, _TESTS):
        raise _NoBlock
    return part


def _joined(
    operator: str, left: blocks.Test | blocks.Value, right: blocks.Test | blocks.Value
) -> blocks.Test | blocks.Value:
    if operator in _WORDS:
        return blocks.Logic(operator=_WORDS[operator], left=_test(left), right=_test(right))  # type: ignore[arg-type]  # a word
    if operator in _LEVELS[2]:
        return blocks.Compare(operator=operator, left=_value(left), right=_value(right))  # type: ignore[arg-type]  # one of them
    return blocks.Reckon(operator=operator, left=_value(left), right=_value(right))  # type: ignore[arg-type]  # one of them


def read(text: str, name: str, path: str = "") -> blocks.Rule:
    """Return the blocks of a rule's text; `name` is `family/name`, `path` the path in errors.

    Parts without a block stay SPARQL inside one; comments inside the rule are dropped. RuleError: KG201 and KG209
    as `parse_rq`, KG206 for the header, and KG209 for what blocks have not: blank nodes and triple terms in the head,
    and names beyond letters, digits and `_`.
    """
    text = normalise(text)
    header = parse_header(text, path)
    parse_rq(text, path)  # errors then have their place in the original text
    text = _unmarked(text)
    unit = parse_rq(text, path)
    (rule,) = unit.rules
    blank = blocks.Rule(name=name)
    own = {"my": namespace(blank), **PREFIXES}
    prefixes = {prefix: iri for prefix, iri in unit.prefixes.items() if own.get(prefix) != iri}
    reader = _Reader(text, path, {**own, **prefixes})
    sections = header.sections
    texts = {member: sections.get(heading, "") for member, heading in SECTIONS.items()}
    parsed = blocks.Rule(
        name=name,
        title=header.title,
        since=header.since or "0.1",
        severity=header.severity,
        prefixes=prefixes,
        when=reader.conditions(rule.group.nodes),
        then=tuple(reader.conclusion(one) for one in rule.template),
    )
    if texts["infers"] == inferred(parsed):
        texts["infers"] = ""  # the default texts of the writer
    try:
        return msgspec.convert(msgspec.to_builtins(msgspec.structs.replace(parsed, **texts)), blocks.Rule)
    except msgspec.ValidationError as error:
        message = f"blocks cannot show this rule: {error}"
        raise RuleError("KG209", message, hint="It can be changed as text.") from error


def _unmarked(text: str) -> str:
    """Return a text without the `_` that `write` puts before names that occur once."""
    names = Counter(token.text[1:] for token in tokens_of(text) if token.kind is Kind.VARIABLE)
    marked = (name for name, uses in names.items() if uses == 1 and re.match(r"_[^\W\d]", name))
    return renamed(text, {name: name[1:] for name in marked if name[1:] not in names})


def _is_plain(pattern: tree.TriplePattern) -> bool:
    return all(isinstance(one, Variable | NamedNode | Literal) for one in (pattern.subject, pattern.object))


class _Reader:
    """Reads a text with its prefixes."""

    def __init__(self, text: str, path: str, prefixes: Mapping[str, str]) -> None:
        self._text = text
        self._path = path
        self._prefixes = prefixes
        self._named: dict[str, str] = {}

    def conditions(self, nodes: Iterable[tree.Node]) -> tuple[blocks.Condition, ...]:
        """Return the blocks of the parts of a group."""
        return tuple(self._condition(node) for node in nodes)

    def conclusion(self, pattern: tree.TriplePattern) -> blocks.Conclusion:
        """Return the block of a triple of a head."""
        if not _is_plain(pattern):
            hint = "It can be changed as text; its file is not touched."
            raise RuleError("KG209", "blocks cannot make new things without a name", hint=hint)
        return self._fact(pattern)

    def _condition(self, node: tree.Node) -> blocks.Condition:
        if isinstance(node, tree.TriplePattern) and _is_plain(node):
            return self._fact(node)
        if isinstance(node, tree.Filter):
            text = self._source(node.expression.span)
            return blocks.Only(test=test_of(text) or blocks.RawTest(text=formula(text)))
        if isinstance(node, tree.Bind):
            return blocks.Let(name=self._name(node.variable), value=value_of(self._source(node.expression.span)))
        if isinstance(node, tree.Exists):
            return (blocks.Absent if node.negated else blocks.Present)(when=self.conditions(node.group.nodes))
        if isinstance(node, tree.Optional):
            return blocks.Perhaps(when=self.conditions(node.group.nodes))
        if isinstance(node, tree.Union) and len(node.groups) > 1:
            return blocks.Either(branches=tuple(self.conditions(group.nodes) for group in node.groups))
        text = self._source(node.span)
        return blocks.Other(text=f"{{ {text} }}" if isinstance(node, tree.SubSelect) and text[0] != "{" else text)

    def _source(self, span: tree.Span) -> str:
        """Return a part of the text without the indentation of its place."""
        line = self._text.rfind("\n", 0, span.start) + 1
        return dedent(" " * (span.start - line) + self._text[span.start : span.end]).strip()

    def _fact(self, node: tree.TriplePattern) -> blocks.Fact | blocks.Is:
        subject = self._term(node.subject)
        if node.predicate == RDF_TYPE and isinstance(node.object, NamedNode):
            return blocks.Is(subject=subject, kind=shorten(node.object.value, self._prefixes))
        return blocks.Fact(
            subject=subject, property=path_text(node.predicate, self._predicate), object=self._term(node.object)
        )

    def _predicate(self, one: NamedNode | Variable) -> str:
        return f"?{self._name(one)}" if isinstance(one, Variable) else shorten(one.value, self._prefixes)

    def _term(self, term: object) -> blocks.Term:
        if isinstance(term, Variable):
            return blocks.Thing(name=self._name(term))
        if isinstance(term, NamedNode):
            return blocks.Name(name=shorten(term.value, self._prefixes))
        assert isinstance(term, Literal)  # noqa: S101 - callers let nothing else through
        return self._literal(term)

    def _literal(self, literal: Literal) -> blocks.Term:
        kind = literal.datatype.value
        if literal.language:
            return blocks.Text(value=literal.value, language=literal.language)
        if kind == _XSD + "string":
            return blocks.Text(value=literal.value)
        if kind == _XSD + "boolean" and literal.value in {"true", "false"}:
            return blocks.Truth(value=literal.value == "true")
        if kind in _NUMBERS and re.fullmatch(_NUMBERS[kind], literal.value):
            return blocks.Number(value=literal.value)
        return blocks.Text(value=literal.value, datatype=shorten(kind, self._prefixes))

    def _name(self, variable: Variable) -> str:
        """Return the name of a variable; `[ ]` gets one that the text does not have."""
        if not variable.name.startswith("."):
            return variable.name
        if variable.name not in self._named:
            number = len(self._named) + 1
            while re.search(rf"[?$]_{number}\b", self._text):
                number += len(self._named) + 1
            self._named[variable.name] = f"_{number}"
        return self._named[variable.name]
