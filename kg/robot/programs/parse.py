"""Parser of the text form of programs: one statement per line, blocks until `end`; grammar in docs/programs.md."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeVar

import msgspec

from kg.robot.programs import tree
from kg.robot.programs.tokens import ENDINGS, FOREIGN, FUNCTIONS, RESERVED, Cursor
from kg.robot.programs.units import ALIASES, UNITS, convert
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.errors import RobotError

_Loop = TypeVar("_Loop", tree.While, tree.Forever, tree.Repeat, tree.For)

LEVELS: Final = (("or",), ("and",), ("not",), ("<", "<=", "=", "!=", ">=", ">", "contains"), ("+", "-"), ("*", "/"))
"""Operators from lowest to highest precedence; comparisons cannot be chained."""
_NOT: Final = 2
_COMPARISON: Final = 3


def expression(cursor: Cursor, path: str) -> tree.Expression:
    """Parse an expression; its parts get places below `path`."""
    places, cursor.places = cursor.places, {}  # apart from those before, since operators move the places of their parts
    try:
        return _level(cursor, path, 0, 0)
    finally:
        places.update(cursor.places)
        cursor.places = places


def _level(cursor: Cursor, path: str, depth: int, level: int) -> tree.Expression:
    if depth > tree.EXPRESSIONS_DEEP:
        raise _too_deep(cursor)
    if level == len(LEVELS):
        return _signed(cursor, path, depth)
    cursor.note(path)
    if level == _NOT:
        if not cursor.phrase("not"):
            return _level(cursor, path, depth, level + 1)
        return tree.Unary(operator="not", of=_level(cursor, f"{path}/of", depth + 1, level))
    return _binary(cursor, path, depth, level)


def _binary(cursor: Cursor, path: str, depth: int, level: int) -> tree.Expression:
    left = _level(cursor, path, depth, level + 1)
    begin = cursor.places[path]
    while cursor.sign(*LEVELS[level]) or cursor.word(*LEVELS[level]):
        # What was parsed so far becomes the left side, and so do the places of its parts.
        for old in [old for old in cursor.places if old == path or old.startswith(f"{path}/")]:
            cursor.places[f"{path}/left{old[len(path) :]}"] = cursor.places.pop(old)
        cursor.places[path] = begin
        operator: Any = cursor.take().value.lower()
        left = tree.Binary(operator=operator, left=left, right=_level(cursor, f"{path}/right", depth + 1, level + 1))
        if tree.height(left) > tree.EXPRESSIONS_DEEP:
            raise _too_deep(cursor)
        if level == _COMPARISON and (cursor.sign(*LEVELS[level]) or cursor.word("contains")):
            raise cursor.refused(cursor.token, "comparisons cannot be chained", "Write `a < b and b < c`.")
    return left


def _too_deep(cursor: Cursor) -> RobotError:
    message = f"expressions are nested more than {tree.EXPRESSIONS_DEEP} deep"
    return cursor.refused(cursor.token, message, "Use variables.")


def _signed(cursor: Cursor, path: str, depth: int) -> tree.Expression:
    cursor.note(path)
    if not cursor.sign("-"):
        return _atom(cursor, path, depth)
    cursor.take()
    if cursor.kind("number"):
        number = cursor.take()
        return tree.Written(value=-_number(cursor, number.value), unit=number.unit)
    return tree.Unary(operator="-", of=_level(cursor, f"{path}/of", depth + 1, len(LEVELS)))


def _atom(cursor: Cursor, path: str, depth: int) -> tree.Expression:
    if cursor.kind("number"):
        return _with_unit(cursor)
    if cursor.kind("text"):
        return tree.Written(value=cursor.take().value)
    if cursor.word("true", "false"):
        return tree.Written(value=cursor.take().value.lower() == "true")
    if cursor.sign("(") and cursor.ahead().kind == "word" and cursor.ahead(2).value == ":":
        return _place(cursor, path, depth)
    if cursor.sign("("):
        return _in_parentheses(cursor, path, depth)
    if cursor.word(*FUNCTIONS) and cursor.ahead().value == "(":
        operator: Any = cursor.take().value.lower()
        return tree.Unary(operator=operator, of=_in_parentheses(cursor, f"{path}/of", depth))
    name, words = _name(cursor)
    if cursor.phrase("of"):
        return tree.Read(parameter=name, capability=_capability_read(cursor))
    if words > 1:
        hint = "What the robot senses is written `nearest of laserScanning`; quote a variable of several words."
        raise cursor.refused(cursor.ahead(-1), f"`{name}` is not a value", hint)
    return tree.Variable(name=name)


def _in_parentheses(cursor: Cursor, path: str, depth: int) -> tree.Expression:
    cursor.take()
    inner = _level(cursor, path, depth + 1, 0)
    if not cursor.sign(")"):
        raise cursor.expected("`)`")
    cursor.take()
    return inner


def _place(cursor: Cursor, path: str, depth: int) -> tree.Position:
    begin = cursor.take()
    components: dict[str, tree.Expression] = {}
    while not components or cursor.sign(","):
        if components:
            cursor.take()
            cursor.skip()
        name = cursor.token
        part = name.value.lower()
        if part in components or not cursor.word(*tree.Position.__struct_fields__):
            raise cursor.refused(name, f"{name} is not allowed here", "A place has an x, a y, and maybe z and heading.")
        cursor.take()
        if not cursor.sign(":"):
            raise cursor.expected(f"`:` after `{part}`")
        cursor.take()
        components[part] = _level(cursor, f"{path}/{part}", depth + 1, 0)
    if not cursor.sign(")"):
        raise cursor.expected("`)`")
    cursor.take()
    if not {"x", "y"} <= components.keys():
        raise cursor.refused(begin, "a place needs its x and its y", "Write `(x: 2 m, y: 1.5 m, heading: 90 deg)`.")
    return tree.Position(x=components["x"], y=components["y"], z=components.get("z"), heading=components.get("heading"))


def _with_unit(cursor: Cursor) -> tree.Written:
    number = cursor.take()
    if number.unit is None and cursor.kind("word") and cursor.token.value.lower() not in RESERVED:
        unit = cursor.token
        raise cursor.refused(
            unit,
            f"`{unit.value}` is not a unit",
            did_you_mean(unit.value, [*UNITS, *ALIASES]) or "Units: " + ", ".join(UNITS),
        )
    return tree.Written(value=_number(cursor, number.value), unit=number.unit)


def _number(cursor: Cursor, digits: str) -> float:
    number = float(digits)
    if number == float("inf"):
        raise cursor.refused(cursor.ahead(-1), f"`{digits}` is too large")
    return number


def _name(cursor: Cursor) -> tuple[str, int]:
    """Return a quoted name, or the words before the next keyword, and their number."""
    if cursor.kind("name"):
        return cursor.take().value, 1
    words = _words(cursor)
    if not words:
        unequal = cursor.sign(">") and cursor.ahead(-1).value == "<"
        raise cursor.expected("a value", hint="Write `!=`." if unequal else None)
    return " ".join(words), len(words)


def _capability_read(cursor: Cursor) -> str:
    if cursor.kind("name", "text"):
        return cursor.take().value
    words = _words(cursor)
    if not words:
        raise cursor.expected("a capability of the robot", hint='Write it in quotes: `nearest of "scan with a laser"`.')
    return " ".join(words)


def _words(cursor: Cursor) -> list[str]:
    words = []
    while cursor.kind("word") and cursor.token.value.lower() not in RESERVED:
        words.append(cursor.take().value)
    return words


class Parsed(NamedTuple):
    """A program with the lines and columns of its parts, counted from one, by their paths."""

    program: tree.Program
    places: dict[str, tuple[int, int]]


def parse(text: str, path: str = "program") -> tree.Program:
    """Return the program in a text; RobotError KG830 at the line and column of a syntax error."""
    return parse_with_places(text, path).program


def parse_with_places(text: str, path: str = "program") -> Parsed:
    """Return the program in a text, with the places of its parts; RobotError KG830 as for `parse`."""
    cursor = Cursor(text, path)
    cursor.skip()
    program = tree.Program()
    if cursor.word("program"):
        program = _head(cursor)
    body, behind = _sequence(cursor, "/body", 0)
    if not cursor.kind("end of the program"):
        raise cursor.expected("a statement", hint=f"No open block for {cursor.token}.")
    comment = "\n".join(filter(None, (program.comment, behind)))
    return Parsed(msgspec.structs.replace(program, body=body, comment=comment), cursor.places)


def _head(cursor: Cursor) -> tree.Program:
    comment = cursor.take_comments()
    cursor.take()
    if not cursor.kind("text", "name"):
        raise cursor.expected("the name of the program in quotes")
    name = cursor.take().value
    seconds = None
    if cursor.phrase("within"):
        token = cursor.token
        match expression(cursor, "/seconds"):
            case tree.Written(value=float(value), unit=unit):
                with suppress(ValueError):
                    seconds = convert(value, unit or "s", "s")
        if seconds is None:
            message = "the time for a program is a number with a unit of time"
            raise cursor.refused(token, message, "Write `within 5 min`.")
    _line_end(cursor)
    return tree.Program(name=name, comment=comment, seconds=seconds)


def _sequence(cursor: Cursor, path: str, depth: int) -> tuple[tuple[tree.Statement, ...], str]:
    """Parse statements up to a keyword that ends them; comments after the last one belong to it, or are returned."""
    if depth > tree.BLOCKS_DEEP:
        raise cursor.refused(cursor.token, f"blocks are nested more than {tree.BLOCKS_DEEP} deep")
    body: list[tree.Statement] = []
    cursor.skip()
    while not cursor.kind("end of the program") and not cursor.word(*ENDINGS):
        body.append(_statement(cursor, f"{path}/{len(body)}", depth))
        cursor.skip()
    behind = cursor.take_comments()
    if body and behind:
        body[-1] = _commented(body[-1], behind)
        behind = ""
    return tuple(body), behind


def _commented(statement: tree.Statement, *comments: str) -> tree.Statement:
    comment = "\n".join(filter(None, (statement.comment, *comments)))
    return msgspec.structs.replace(statement, comment=comment) if comment != statement.comment else statement


def _statement(cursor: Cursor, path: str, depth: int) -> tree.Statement:
    comment = cursor.take_comments()
    cursor.note(path)
    cursor.begun.append(cursor.token.line)
    _own(cursor)
    read = _KEYWORDS.get(cursor.token.value.lower()) if cursor.kind("word") else None
    statement = (read and read(cursor, path, depth)) or _do(cursor, path)
    cursor.begun.pop()
    behind = cursor.take_comments()
    _line_end(cursor)
    return _commented(
        msgspec.structs.replace(statement, comment=comment), statement.comment, behind, cursor.take_comments()
    )


def _own(cursor: Cursor) -> None:
    """Raise RobotError KG830 for a statement of another language, with the syntax used here."""
    token, after = cursor.token, cursor.ahead()
    if token.kind != "word":
        return
    assigns = after.kind == "sign" and after.value == "="
    hint = f"Write `set {token.value} to {cursor.ahead(2).value}`." if assigns else FOREIGN.get(token.value.lower())
    if token.value.lower() in {"let", "var"} and after.kind == "word" and cursor.ahead(2).value == "=":
        hint = f"Write `set {after.value} to {cursor.ahead(3).value}`."
    if hint is not None:
        raise cursor.refused(token, f"{token} begins no statement", hint)


def _line_end(cursor: Cursor) -> None:
    if cursor.kind("comment"):
        cursor.comments.append(cursor.take().value)
    if not cursor.kind("line", "end of the program") and not cursor.word(*ENDINGS):
        hint = "A value has a name before it: `forward: 0.2 m/s`." if cursor.kind("number", "text") else None
        raise cursor.expected("the end of the statement", hint=hint)


def _id(cursor: Cursor) -> str | None:
    return cursor.take().value if cursor.kind("id") else None


def _end(cursor: Cursor, what: str) -> None:
    if not cursor.word("end"):
        hint = f"`{what}` of line {cursor.begun[-1]} has no `end`."
        raise cursor.expected(f"`end` of `{what}`", hint=hint)
    cursor.take()


def _block(cursor: Cursor, path: str, what: str, depth: int) -> tuple[tuple[tree.Statement, ...], str]:
    body, behind = _sequence(cursor, path, depth + 1)
    _end(cursor, what)
    return body, behind


def _if(cursor: Cursor, path: str, depth: int) -> tree.If:
    cursor.take()
    condition = expression(cursor, f"{path}/condition")
    cursor.phrase("then")
    identifier = _id(cursor)
    then, comment = _sequence(cursor, f"{path}/then", depth + 1)
    otherwise: tuple[tree.Statement, ...] = ()
    if cursor.phrase("otherwise"):
        if cursor.word("if"):
            cursor.note(f"{path}/otherwise/0")
            if depth > tree.BLOCKS_DEEP:
                raise cursor.refused(cursor.token, f"blocks are nested more than {tree.BLOCKS_DEEP} deep")
            otherwise = (_if(cursor, f"{path}/otherwise/0", depth + 1),)
            return tree.If(id=identifier, comment=comment, condition=condition, then=then, otherwise=otherwise)
        otherwise, behind = _sequence(cursor, f"{path}/otherwise", depth + 1)
        comment = "\n".join(filter(None, (comment, behind)))
    _end(cursor, "if")
    return tree.If(id=identifier, comment=comment, condition=condition, then=then, otherwise=otherwise)


def _loop(cursor: Cursor, path: str, depth: int, kind: type[_Loop], word: str, **given: Any) -> _Loop:
    cursor.phrase(word)
    identifier = _id(cursor)
    body, comment = _block(cursor, f"{path}/body", kind.__name__.lower(), depth)
    return kind(id=identifier, comment=comment, body=body, **given)


def _while(cursor: Cursor, path: str, depth: int) -> tree.While:
    cursor.take()
    return _loop(cursor, path, depth, tree.While, "do", condition=expression(cursor, f"{path}/condition"))


def _forever(cursor: Cursor, path: str, depth: int) -> tree.Forever:
    cursor.take()
    return _loop(cursor, path, depth, tree.Forever, "do")


def _repeat(cursor: Cursor, path: str, depth: int) -> tree.Repeat:
    cursor.take()
    return _loop(cursor, path, depth, tree.Repeat, "times", times=expression(cursor, f"{path}/times"))


def _variable(cursor: Cursor) -> str:
    if not cursor.kind("word", "name"):
        raise cursor.expected("the name of a variable")
    return cursor.take().value


def _for(cursor: Cursor, path: str, depth: int) -> tree.For:
    cursor.take()
    each = cursor.word("each") and cursor.ahead().kind in {"word", "name"} and cursor.ahead().value != "from"
    if each:
        cursor.take()
    variable = _variable(cursor)
    start = end = step = of = None
    if cursor.phrase("in"):
        of = expression(cursor, f"{path}/of")
    elif cursor.phrase("from"):
        start = expression(cursor, f"{path}/start")
        if not cursor.phrase("to"):
            raise cursor.expected("`to`")
        end = expression(cursor, f"{path}/end")
        step = expression(cursor, f"{path}/step") if cursor.phrase("step") else None
    else:
        raise cursor.expected(
            "`from` or `in`", hint="Write `for i from 1 to 5` or `for each tag in tags of recognizingTags`."
        )
    return _loop(cursor, path, depth, tree.For, "do", variable=variable, start=start, end=end, step=step, of=of)


def _break(cursor: Cursor, path: str, depth: int) -> tree.Break:
    del path, depth
    cursor.take()
    return tree.Break(id=_id(cursor))


def _set(cursor: Cursor, path: str, depth: int) -> tree.Set | None:
    del depth
    if cursor.ahead().kind in {"word", "name"} and cursor.ahead(2).kind in {"number", "text"}:
        cursor.take()
        variable = cursor.take().value
        raise cursor.expected("`to`", hint=f"Write `set {variable} to {cursor.token.value}`.")
    if cursor.ahead().kind not in {"word", "name"} or cursor.ahead(2).value.lower() not in {"to", "="}:
        return None
    cursor.take()
    variable = _variable(cursor)
    cursor.take()
    value = expression(cursor, f"{path}/value")
    return tree.Set(id=_id(cursor), variable=variable, value=value)


def _wait(cursor: Cursor, path: str, depth: int) -> tree.Wait | tree.WaitUntil:
    cursor.take()
    if not cursor.phrase("until"):
        cursor.phrase("for")
        seconds = expression(cursor, f"{path}/seconds")
        return tree.Wait(id=_id(cursor), seconds=seconds)
    condition = expression(cursor, f"{path}/condition")
    limit = expression(cursor, f"{path}/seconds") if cursor.phrase("within") else None
    if not cursor.phrase("otherwise"):
        return tree.WaitUntil(id=_id(cursor), condition=condition, seconds=limit)
    identifier = _id(cursor)
    body, comment = _block(cursor, f"{path}/otherwise", "wait until", depth)
    return tree.WaitUntil(id=identifier, comment=comment, condition=condition, seconds=limit, otherwise=body)


def _parallel(cursor: Cursor, path: str, depth: int) -> tree.Parallel | None:
    if not cursor.phrase("at the same time"):
        return None
    identifier = _id(cursor)
    branches: list[tuple[tree.Statement, ...]] = []
    comments: list[str] = []
    while not branches or cursor.phrase("also"):
        body, comment = _sequence(cursor, f"{path}/branches/{len(branches)}", depth + 1)
        branches.append(body)
        comments.append(comment)
    _end(cursor, "at the same time")
    nonempty = tuple(branches) if len(branches) > 1 or branches[0] else ()
    return tree.Parallel(id=identifier, comment="\n".join(filter(None, comments)), branches=nonempty)


def _on_event(cursor: Cursor, path: str, depth: int) -> tree.OnEvent | None:
    end = cursor.phrase("as soon as")
    if not end and not cursor.phrase("whenever"):
        return None
    condition = expression(cursor, f"{path}/condition")
    cursor.phrase("do")
    identifier = _id(cursor)
    then, comment = _sequence(cursor, f"{path}/then", depth + 1)
    if not cursor.phrase("during"):
        raise cursor.expected("`during`", hint="After `during`, write the statements to run.")
    body, behind = _block(cursor, f"{path}/body", "as soon as" if end else "whenever", depth)
    comment = "\n".join(filter(None, (comment, behind)))
    return tree.OnEvent(id=identifier, comment=comment, condition=condition, then=then, body=body, end=end)


def _log(cursor: Cursor, path: str, depth: int) -> tree.Log:
    del depth
    cursor.take()
    message = expression(cursor, f"{path}/message")
    return tree.Log(id=_id(cursor), message=message)


def _stop(cursor: Cursor, path: str, depth: int) -> tree.Stop | None:
    del path, depth
    if cursor.ahead().kind == "word" and cursor.ahead().value.lower() not in ENDINGS:
        return None
    cursor.take()
    return tree.Stop(id=_id(cursor))


def _do(cursor: Cursor, path: str) -> tree.Do:
    named = cursor.phrase("do")
    quoted = cursor.kind("text", "name")
    capability = cursor.take().value if quoted else _capability(cursor, named=named)
    arguments = _arguments(cursor, path)
    seconds = within = None
    if cursor.phrase("for"):
        seconds = expression(cursor, f"{path}/seconds")
    if cursor.phrase("within"):
        within = expression(cursor, f"{path}/within")
    return tree.Do(id=_id(cursor), capability=capability, arguments=arguments, seconds=seconds, within=within)


def _capability(cursor: Cursor, *, named: bool) -> str:
    """Parse the words of a capability, up to the name of the first argument or a duration."""
    words: list[str] = []
    while cursor.kind("word") and not cursor.word(*ENDINGS):
        after = cursor.ahead()
        if words and after.kind == "sign" and after.value in {":", "="}:
            break
        begins = after.kind == "number" or (after.kind, after.value) == ("sign", "(")
        if words and begins and cursor.word("for", "within"):
            break
        words.append(cursor.take().value)
    if not words:
        raise cursor.expected("a capability of the robot" if named else "a statement")
    return " ".join(words)


def _arguments(cursor: Cursor, path: str) -> dict[str, tree.Expression]:
    arguments: dict[str, tree.Expression] = {}
    while cursor.kind("word", "name") and not cursor.word("for", "within", *ENDINGS):
        first = cursor.token
        name = _argument_name(cursor)
        if name in arguments:
            raise cursor.refused(first, f"`{name}` is given twice")
        arguments[name] = expression(cursor, f"{path}/arguments/{name}")
        if not cursor.sign(","):
            break
        cursor.take()
        cursor.skip()
    return arguments


def _argument_name(cursor: Cursor) -> str:
    words = [cursor.take().value]
    while cursor.kind("word"):
        words.append(cursor.take().value)
    if not cursor.sign(":", "="):
        raise cursor.expected(f"`:` after the name `{' '.join(words)}`")
    cursor.take()
    return " ".join(words)


_KEYWORDS: Final[dict[str, Callable[[Cursor, str, int], tree.Statement | None]]] = {
    "if": _if,
    "while": _while,
    "forever": _forever,
    "repeat": _repeat,
    "for": _for,
    "break": _break,
    "set": _set,
    "wait": _wait,
    "at": _parallel,
    "as": _on_event,
    "whenever": _on_event,
    "log": _log,
    "stop": _stop,
}
