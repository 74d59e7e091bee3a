"""The node around the statements: its methods for time and for parts that run at the same time, and its file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.robot.programs.converting.fields import HELPERS
from kg.robot.programs.converting.members import indented
from kg.robot.programs.converting.names import camel, plain, snake

if TYPE_CHECKING:
    from kg.robot.programs.converting.members import Members
    from kg.robot.programs.tree import Program

__all__ = ["module"]

_COUNTED: Final = '''def counted(start: float, end: float, step: float = 1.0) -> Iterator[float]:
    """Yield the numbers from one to another, both included, upwards or downwards."""
    way = abs(step) if end >= start else -abs(step)
    for number in range(int(abs(end - start) / abs(step) + 1e-9) + 1):
        yield start + number * way
'''
_PLACE: Final = '''class Place(NamedTuple):
    """A place on the map, and where to look there, in m and rad."""

    x: float
    y: float
    z: float = 0.0
    heading: float = 0.0
'''
_ERRORS: Final = '''class StoppedError(Exception):
    """The program has to end."""
'''
_ENDED: Final = '''class EndedError(Exception):
    """A part of the program is ended by another."""
'''
_TIME: Final = '''def now(self) -> float:
    """Return the time in seconds."""
    return {clock}

def on_signal(self, number: int, _: object) -> None:
    """End the program when a signal asks for it; its parts see that in `check`."""
    self.over, self.status = True, 128 + number

def check(self) -> None:
    """Raise an error when the program has to end."""
    if self.over or {ended}:
        raise StoppedError("the program was ended from outside")
{more}
def sleep(self, seconds: float) -> None:
    """Wait so many seconds."""
    end = self.now() + seconds
    self.check()
    while self.now() < end:
        time.sleep(0.01)
        self.check()

def until(self, condition: Callable[[], bool], within: float = math.inf) -> None:
    """Wait until a condition holds; TimeoutError when it does not in time."""
    end = self.now() + within
    while not condition():
        if self.now() > end:
            raise TimeoutError("what was waited for did not happen in time")
        self.sleep(0.05)
'''
_WAIT: Final = '''def wait(self, call: Callable[[], Any]) -> Any:
    """Return what a call gives, made in another thread: it may block, and the program may have to end."""
    answer: Future[Any] = Future()

    def work() -> None:
        try:
            answer.set_result(call())
        except Exception as error:
            answer.set_exception(error)

    threading.Thread(target=work, daemon=True).start()
    self.until(answer.done)
    return answer.result()
'''
_ENDS: Final = '''def ends(self) -> tuple[threading.Event, ...]:
    """Return what ends the part of the program that runs in this thread."""
    return getattr(self.local, "ends", ())
'''
_METHODS: Final = {
    "together": '''def together(self, *parts: Callable[[], None]) -> None:
    """Do parts at the same time; when one fails the others are ended."""
    around, end = self.ends(), threading.Event()
    errors: list[Exception] = []

    def work(part: Callable[[], None]) -> None:
        self.local.ends = (*around, end)
        try:
            part()
        except Exception as error:
            errors.append(error)
            end.set()

    threads = [threading.Thread(target=work, args=(part,)) for part in parts]
    for thread in threads:
        thread.start()
    try:
        for thread in threads:
            thread.join()
    finally:
        end.set()
    if errors:
        raise errors[0]
''',
    "as_soon_as": '''def as_soon_as(
    self, condition: Callable[[], bool], then: Callable[[], None], work: Callable[[], None]
) -> None:
    """Do work until a condition holds, and then something else."""
    around, happened, over = self.ends(), threading.Event(), threading.Event()

    def watch() -> None:
        self.local.ends = (*around, over)
        try:
            self.until(condition)
            happened.set()
        except (EndedError, StoppedError):
            return

    watcher = threading.Thread(target=watch)
    watcher.start()
    self.local.ends = (*around, happened)
    try:
        work()
    except EndedError:
        if not happened.is_set():
            raise
    finally:
        self.local.ends = around
        over.set()
        watcher.join()
    if happened.is_set():
        then()
''',
    "whenever": '''def whenever(
    self, condition: Callable[[], bool], then: Callable[[], None], work: Callable[[], None]
) -> None:
    """Do work, and something else each time that a condition begins to hold."""
    around, failed, over = self.ends(), threading.Event(), threading.Event()
    errors: list[Exception] = []

    def watch() -> None:
        try:
            while True:
                self.local.ends = (*around, over)
                self.until(condition)
                self.local.ends = around
                then()
                self.local.ends = (*around, over)
                self.until(lambda: not condition())
        except EndedError:
            return
        except Exception as error:
            errors.append(error)
            failed.set()

    watcher = threading.Thread(target=watch)
    watcher.start()
    self.local.ends = (*around, failed)
    try:
        work()
    except EndedError:
        if not errors:
            raise
    finally:
        self.local.ends = around
        over.set()
        watcher.join()
    if errors:
        raise errors[0]
''',
}
_DEADLINE: Final = """if self.now() > self.deadline:
    raise RuntimeError("the program did not end within {seconds:g} s")
"""
_ANY_END: Final = """if any(end.is_set() for end in self.ends()):
    raise EndedError
"""
_STANDARD: Final = ("math", "signal", "sys", "threading", "time")


def module(program: Program, members: Members, used: set[str], run: list[str]) -> str:
    """Return the file: imports, helpers, the class, `main`."""
    parallel = bool(used & _METHODS.keys())
    name = program.name if program.name.strip() else "program"
    made = camel(name)
    own = _class(program, members, used, run, made)
    helpers = [HELPERS[one] for one in HELPERS if one in members.helpers]
    helpers += [_COUNTED] if "counted" in used else []
    helpers += [_PLACE] if any("Place(" in line for line in run) else []
    main = [
        "def main() -> None:",
        '    """Run the program, and stop the robot however it ends."""',
        *indented(members.dialect.main(snake(name), made)),
    ]
    parts = [*helpers, _ERRORS, *([_ENDED] if parallel else []), "\n".join(own).rstrip() + "\n", "\n".join(main) + "\n"]
    code = "\n\n".join(parts) + '\n\nif __name__ == "__main__":\n    main()\n'
    head = ["#!/usr/bin/env python3", f'"""{_sentence(program)}"""', "", *_imports(members, used, code)]
    return "\n".join(head) + "\n\n\n" + code


def _sentence(program: Program) -> str:
    first = plain(program.comment.partition("\n")[0]) or f"Does '{plain(program.name)}'"
    return f"{first[:1].upper()}{first[1:].rstrip('.')}."


def _imports(members: Members, used: set[str], code: str) -> list[str]:
    """Return the imports in the order that isort gives them."""
    standard = [f"import {one}" for one in _STANDARD if f"{one}." in code]
    abstract = ["Callable", *(["Iterator"] if "counted" in used else [])]
    standard.append(f"from collections.abc import {', '.join(abstract)}")
    standard += ["from concurrent.futures import Future"] if "Future" in code else []
    typing = [one for one in ("Any", "NamedTuple") if one in code]
    standard += [f"from typing import {', '.join(typing)}"] if typing else []
    lines = members.dialect.imports(goals=members.goals, topics=members.topics)
    plain_ones = sorted(one for one in lines if one.startswith("import "))
    classes: dict[str, set[str]] = {}
    for one in lines:
        if one.startswith("from "):
            _, module_name, _, *names = one.replace(",", "").split()
            classes.setdefault(module_name, set()).update(names)
    for module_name, class_name in members.classes:
        classes.setdefault(module_name, set()).add(class_name)
    others = [f"from {one} import {', '.join(sorted(classes[one]))}" for one in sorted(classes)]
    return ["from __future__ import annotations", "", *standard, "", *plain_ones, *others]


def _class(program: Program, members: Members, used: set[str], run: list[str], made: str) -> list[str]:
    dialect = members.dialect
    parallel = bool(used & _METHODS.keys())
    constructor = [*dialect.begin(snake(program.name)), "self.over, self.status = False, 0"]
    constructor += ["self.local = threading.local()"] if parallel else []
    constructor += ["self.deadline = math.inf"] if program.seconds is not None else []
    begin = [f"self.deadline = self.now() + {program.seconds!r}"] if program.seconds is not None else []
    more = (_DEADLINE.format(seconds=program.seconds) if program.seconds is not None else "") + (
        _ANY_END if parallel else ""
    )
    checks = "\n".join(indented(more.rstrip("\n").split("\n"))) + "\n" if more else ""
    times = _TIME.format(clock=dialect.clock, ended=dialect.ended, more=checks)
    waits = any("self.wait(" in line for line in (*members.connect, *members.methods))
    inner = [
        f'"""{_sentence(program)}"""',
        "",
        "def __init__(self) -> None:",
        '    """Offer and ask for topics, services and actions."""',
        *indented([*constructor, *members.made]),
        "",
        "def connect(self) -> None:",
        '    """Wait until the robot listens."""',
        *indented(members.connect),
        "",
        "def halt(self) -> None:",
        '    """End all parts of the program, and stop what moves."""',
        *indented(["self.over = True", *members.halt, "time.sleep(0.2)  # until it has been sent"]),
        "",
        *members.methods,
        *times.split("\n"),
        *(_WAIT.split("\n") if waits else []),
        *(_ENDS.split("\n") if parallel else []),
    ]
    for name, method in _METHODS.items():
        inner += method.split("\n") if name in used else []
    inner += ["def run(self) -> None:", '    """Do what the program says."""', *indented([*begin, *run])]
    return [f"class {made}{dialect.base}:", *indented(inner)]
