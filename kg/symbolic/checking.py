"""Checks of descriptions of framework calls: each error with its place and what to do."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from kg.errors import Place, SourceError
from kg.facts import Role
from kg.resources import table_of
from kg.settings import toml_place
from kg.similar import did_you_mean
from kg.symbolic.columns import (
    ACCESSES,
    CALL,
    CLASS,
    FILE,
    GIVES,
    INDEX,
    INTERFACE,
    KINDS,
    LANGUAGES,
    MOST_ARGUMENTS,
    PARAMETER,
    PORT,
    RESULTS,
    SECONDS,
    SLOT,
    TYPES,
    Form,
)
from kg.symbolic.descriptions import agree, shipped

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable, Iterator, Mapping


_WRONG: Final = "KG123"
_UNREACHABLE: Final = "KG124"
_TABLES: Final = {"call": CALL, "class": CLASS}
_HEADER: Final = re.compile(r"^[ \t]*\[\[\s*(call|class)\s*\]\]", re.MULTILINE)
_ROLES: Final = tuple(role.value for role in Role)


class _Row(NamedTuple):
    """A row of a file, with the part of the text that has it."""

    file: _File
    kind: str
    content: dict[str, Any]
    start: int
    end: int

    @property
    def names(self) -> list[str]:
        name = self.content["name"]
        return name if isinstance(name, list) else [name]

    @property
    def counts(self) -> tuple[int, int]:
        least, most = self.content.get("arguments", (0, MOST_ARGUMENTS))
        return least, most

    def place(self, *keys: str, text: str | None = None) -> Place:
        """Return where a key below others is, or a text in its value; what is not found is where the key before is."""
        patterns = [rf"(?<![\w-])[\"']?{re.escape(key)}[\"']?\s*[=.\]]" for key in keys]
        at = self.start
        for pattern in (*patterns, *(() if text is None else (f"[\"']{re.escape(text)}[\"']",))):
            match = re.compile(pattern).search(self.file.text, at, self.end)
            at = match.start() if match else at
        return self.file.place(at)


class _File(NamedTuple):
    path: str
    text: str
    language: str = "cpp"

    def place(self, offset: int) -> Place:
        line = self.text.count("\n", 0, offset) + 1
        return Place(self.path, line, offset - self.text.rfind("\n", 0, offset))


def check(files: Mapping[str, str]) -> list[SourceError]:
    """Return the errors in files of descriptions, given as text by path, in the order in which they are read.

    KG123 is an error in a row, KG124 a row that never matches. Only files without errors are checked for KG124.
    """
    errors: list[SourceError] = []
    rows: list[_Row] = []
    for path, text in files.items():
        rows += _read(_File(path, text), errors)
    classes = _classes(rows)
    for row in rows:
        errors += _row_errors(row, classes)
    order = {path: index for index, path in enumerate(files)}
    if not errors:
        for language in LANGUAGES:
            errors += _unreachable([row for row in rows if row.file.language == language])
    return sorted(errors, key=lambda error: _position(error, order))


def _position(error: SourceError, order: Mapping[str, int]) -> tuple[int, int, int]:
    place = error.place
    return (order[place.path], place.line or 0, place.column or 0) if place is not None else (0, 0, 0)


def _read(file: _File, errors: list[SourceError]) -> list[_Row]:
    """Return the rows of a file, and add what is wrong outside of them to `errors`."""
    try:
        content = tomllib.loads(file.text)
    except tomllib.TOMLDecodeError as problem:
        message, line, column = toml_place(str(problem))
        errors.append(_error(Place(file.path, line, column), f"this is not TOML: {message}", "Correct the syntax."))
        return []
    file = file._replace(language=str(content.get("language", file.language)))
    rows = []
    headers = list(_HEADER.finditer(file.text))
    for key, value in content.items():
        whole = _Row(file, key, content, 0, len(file.text))
        if key in _TABLES and isinstance(value, list) and all(isinstance(one, dict) for one in value):
            ends = [*(one.start() for one in headers), len(file.text)]
            spans = [(one.start(), end) for one, end in zip(headers, ends[1:], strict=True) if one[1] == key]
            spans = spans if len(spans) == len(value) else [(0, len(file.text))] * len(value)
            rows += [_Row(file, key, one, *span) for one, span in zip(value, spans, strict=True)]
        elif key in _TABLES:
            errors.append(_error(whole.place(key), f"`{key}` is not a list of tables", f"Write [[{key}]]."))
        elif key not in FILE:
            errors.append(_unknown(whole.place(key), f"`{key}` is not a key of a file", key, (*FILE, *_TABLES)))
        else:
            errors += _form_errors(whole, {key: value}, FILE)
    return rows


def _error(place: Place, message: str, hint: str, code: str = _WRONG) -> SourceError:
    return SourceError(code, message, place=place, hint=hint)


def _unknown(place: Place, message: str, name: str, allowed: Iterable[str]) -> SourceError:
    listed = list(allowed)
    return _error(place, message, did_you_mean(name, listed) or f"Use one of {', '.join(listed)}.")


def _classes(rows: Iterable[_Row]) -> dict[str, str | None]:
    """Return the names of all described classes, each with the class that it is like."""
    described = [listed for language in LANGUAGES for listed in shipped(language).classes.values()]
    likes = {one.name: one.like for listed in described for one in listed}
    own = [row for row in rows if row.kind == "class" and CALL["name"].fits(row.content.get("name"))]
    return {name: row.content.get("like") for row in own for name in row.names} | likes


def _row_errors(row: _Row, classes: Mapping[str, str | None]) -> list[SourceError]:
    columns = _TABLES[row.kind]
    errors = list(_form_errors(row, row.content, columns))
    if "name" not in row.content:
        errors.append(_error(row.place(), f"the row has no `name`: [[{row.kind}]]", 'Add `name = "..."`.'))
    for key in (*_ROLES, *ACCESSES):
        if key in row.content and columns[key].fits(row.content[key]):
            value = row.content[key]
            for effect in value if isinstance(value, list) else [value]:
                errors += _effect_errors(row, key, effect)
    if errors:
        return errors
    return [*(_call_errors if row.kind == "call" else _class_errors)(row, classes), *_common_errors(row)]


def _form_errors(
    row: _Row, content: Mapping[str, Any], forms: Mapping[str, Form], *inside: str
) -> Generator[SourceError, None, bool]:
    """Yield unknown keys and values of the wrong type; return whether there are any."""
    wrong = False
    for key, value in content.items():
        place = row.place(*inside, key)
        if key not in forms:
            wrong = True
            where = f"`{inside[0]}`" if inside else f"[[{row.kind}]]"
            yield _unknown(place, f"`{key}` is not a {'key' if inside else 'column'} of {where}", key, forms)
        elif not forms[key].fits(value):
            wrong = True
            yield _error(place, f"`{key}` is {value!r}", f"It must be {forms[key].wanted}.")
    return wrong


def _effect_errors(row: _Row, column: str, effect: Mapping[str, Any]) -> Iterator[SourceError]:
    forms = INTERFACE if column in _ROLES else PARAMETER
    if (yield from _form_errors(row, effect, forms, column)):
        return
    if not {"name", "fixed", "specification"} & set(effect) and not effect.get("listed"):
        hint = "Add `name`, the number of the argument with the name, or `fixed`, the name itself."
        yield _error(row.place(column), f"`{column}` has no name", hint)
    for key, value in effect.items():
        if forms[key] is forms["name"] or (key == "specification" and isinstance(value, int)):
            yield from _number_errors(row, value, row.place(column, key))
    for word in effect.get("type", ()) if column in _ROLES else ():
        if "/" not in word:
            yield from _word_errors(row, word, TYPES, "a source of types", column, "type")


def _number_errors(row: _Row, value: int, place: Place, *, least: bool = False) -> Iterator[SourceError]:
    """Yield the error of an argument number that the call does not have; `least`: that each of its calls has."""
    if not CALL["arguments"].fits(row.content.get("arguments", [0, MOST_ARGUMENTS])):
        return
    fewest, most = row.counts
    if value >= (fewest if least else most):
        limit = f"can have only {fewest}" if least else f"has at most {most}"
        hint = "Arguments count from 0. Correct the number or `arguments`."
        message = f"no argument {value}: the call {limit} {'argument' if limit[-1] == '1' else 'arguments'}"
        yield _error(place, message, hint)


def _word_errors(row: _Row, text: str, words: Mapping[str, str], what: str, *keys: str) -> Iterator[SourceError]:
    """Yield the error of a word, and of the number after its colon."""
    word, colon, detail = text.partition(":")
    place = row.place(*keys, text=text)
    listed = [f"{one}:{after}" if after else one for one, after in words.items()]
    if word not in words or bool(colon) != bool(words[word]):
        yield _unknown(place, f'"{text}" is not {what}', text, listed)
    elif words[word] == INDEX:
        if not detail.isdecimal():
            yield _error(place, f'"{text}" has no argument number', f"Write {word}:0 for the first argument.")
        else:
            yield from _number_errors(row, int(detail), place, least=what == "a result")
    elif words[word] == SECONDS and not re.fullmatch(r"\d+(\.\d+)?(e-?\d+)?", detail):
        yield _error(place, f'"{text}" has no number of seconds', f"Write {word}:0.001 for milliseconds.")


def _slot_errors(row: _Row) -> Iterator[SourceError]:
    slot = row.content.get("slot", {})
    if (yield from _form_errors(row, slot, SLOT, "slot")):
        return
    if not {"base", "class", "module", "parameter"} & set(slot) and "slot" in row.content:
        hint = "Add `class`, the number of the argument with the class, `parameter`, `base` or `module`."
        yield _error(row.place("slot"), "`slot` names no plugins", hint)
    for key in ("class", "name"):
        if key in slot:
            yield from _number_errors(row, slot[key], row.place("slot", key))
    for key in ("base", "parameter", "names"):
        for number in re.findall(r"\{(\d+)\}", slot.get(key, "")):
            yield from _number_errors(row, int(number), row.place("slot", key))


def _common_errors(row: _Row) -> Iterator[SourceError]:
    yield from _slot_errors(row)
    for key in ("node", "node_name", "unless", "namespace", "detail", "under"):
        value = row.content.get(key)
        if isinstance(value, int):
            yield from _number_errors(row, value, row.place(key))
    mark = row.content.get("mark")
    if mark is not None and mark not in _marks():
        yield _unknown(row.place("mark"), f'"{mark}" is not a mark of ontology/implicit.toml', mark, _marks())


@cache
def _marks() -> tuple[str, ...]:
    return tuple(dict.fromkeys(use["mark"] for use in table_of("ontology", "implicit.toml")["use"]))


def _port_errors(row: _Row) -> Iterator[SourceError]:
    port = row.content.get("port", {})
    if (yield from _form_errors(row, port, PORT, "port")):
        return
    if "port" in row.content and "name" not in port:
        yield _error(row.place("port"), "`port` has no name", "Add `name`, the number of the argument with the name.")
    for key, value in port.items():
        yield from _number_errors(row, value, row.place("port", key))


def _call_errors(row: _Row, classes: Mapping[str, str | None]) -> Iterator[SourceError]:
    yield from _port_errors(row)
    if isinstance(row.content.get("registers"), int):
        yield from _number_errors(row, row.content["registers"], row.place("registers"), least=True)
    if "on" not in row.content and "in" not in row.content:
        hint = 'Add `on = ["acme::Class"]` for methods, or `in = ["acme"]` for functions of a namespace.'
        yield _error(row.place(), "the row matches no call: it has neither `on` nor `in`", hint)
    for name in row.content.get("on", ()):
        if name not in classes:
            hint = f'{did_you_mean(name, classes) or ""} Otherwise add a row: [[class]] name = "{name}".'.lstrip()
            yield _error(row.place("on", text=name), f"`on` names {name}, but no [[class]] describes it", hint)
    returns = row.content.get("returns", "")
    if returns == "path":
        yield from _number_errors(row, 1, row.place("returns"), least=True)
    if returns and "::" not in returns:
        yield from _word_errors(row, returns, RESULTS, "a result", "returns")
    for number in row.content.get("copies", ()):
        yield from _number_errors(row, number, row.place("copies"), least=True)
    if row.content.get("options") and not any(role in row.content for role in _ROLES):
        hint = "Add the interface that a later call creates: `subscribes = { name = 0 }`."
        yield _error(row.place("options"), "the row has `options` but no interface", hint)


def _class_errors(row: _Row, classes: Mapping[str, str | None]) -> Iterator[SourceError]:
    kind, like = row.content.get("is"), row.content.get("like")
    if kind is not None:
        yield from _word_errors(row, kind, KINDS, "a kind of object", "is")
    if like is not None and like not in classes:
        yield _unknown(row.place("like"), f"`like` names {like}, but no [[class]] describes it", like, classes)
    given = row.content.get("gives", [])
    for one in given if isinstance(given, list) else [given]:
        if (yield from _form_errors(row, one, GIVES, "gives")):
            continue
        for key in [key for key in GIVES if key not in one]:
            yield _error(row.place("gives"), f"`gives` has no `{key}`", f"Add `{key}`, {GIVES[key].wanted}.")


# Rows that never match


def _unreachable(rows: Iterable[_Row]) -> Iterator[SourceError]:
    """Yield the rows of one language of which an earlier one matches all calls, or all classes."""
    listed = list(rows)
    likes = _classes(listed)
    calls: dict[tuple[str, str, str], dict[int, _Row]] = {}
    classes: list[tuple[tuple[str, ...], _Row]] = []
    for row in listed:
        if row.kind == "class":
            for name in row.names:
                parts = tuple(name.split("::"))
                shorter = ((known, one) for known, one in classes if len(known) <= len(parts))
                earlier = next((one for known, one in shorter if agree(known, parts)), None)
                if earlier is not None:
                    yield _hidden(row, name, earlier)
                classes.append((parts, row))
            continue
        targets = [(how, one) for how in ("on", "in") for one in row.content.get(how, ())]
        counts = range(row.counts[0], row.counts[1] + 1)
        for name in row.names:
            taken = [_taken(calls, name, target, count, likes) for target in targets for count in counts]
            if taken and (first := taken[0]) is not None and all(taken):
                yield _hidden(row, name, first)
            for how, what in targets:
                known = calls.setdefault((name, how, what), {})
                for count in counts:
                    known.setdefault(count, row)


def _taken(
    calls: Mapping[tuple[str, str, str], Mapping[int, _Row]],
    name: str,
    target: tuple[str, str],
    count: int,
    likes: Mapping[str, str | None],
) -> _Row | None:
    """Return the earlier row that matches calls of a function or method with a number of arguments."""
    how, what = target
    places: list[str | None] = [what, "*"] if how == "in" else [what]
    while how == "on" and (like := likes.get(places[-1] or "")) is not None and like not in places:
        places.append(like)
    taken = (calls.get((name, how, place or ""), {}).get(count) for place in places)
    return next((one for one in taken if one is not None), None)


def _hidden(row: _Row, name: str, earlier: _Row) -> SourceError:
    message = f"the row never matches {name}: the row at {earlier.place()} matches it first"
    return _error(
        row.place("name", text=name), message, "Remove one of them, or write the narrower one first.", _UNREACHABLE
    )
