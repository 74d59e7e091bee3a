"""Conversion of programs to Python code without kg: a file with a node for ROS 1 (rospy) or ROS 2 (rclpy)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal

from kg.robot.programs.check import kinds_of, refuse_errors
from kg.robot.programs.converting.code import COMMON, Dialect, Names, camel, indented, plain, snake
from kg.robot.programs.converting.members import Members
from kg.robot.programs.converting.statements import Code
from kg.robot.programs.names import CapabilityIndex

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.errors import Place
    from kg.robot.capability import Capabilities
    from kg.robot.programs.tree import Program

__all__ = ["convert"]

_METHODS = ("now", "check", "sleep", "until", "ends", "together", "as_soon_as", "whenever", "run", "connect", "halt")
_OF_SIGNALS = ("on_signal", "over", "status", "wait")
_OF_A_NODE = (
    "local",
    "deadline",
    "handle",
    "context",
    "executor",
    "clients",
    "publishers",
    "services",
    "subscriptions",
)
_IN_METHODS = ("seconds", "within", "end", "request", "response", "sent", "result", "answer", "handle", "error", "math")


def convert(
    program: Program,
    capabilities: Capabilities,
    *,
    to: Literal["rospy", "rclpy"] = "rospy",
    place: Callable[[str], Place] | None = None,
) -> str:
    """Return a Python file that does the same as a program, through the interfaces of a robot's capabilities.

    `place` returns the place of a part of the program in its file.

    Raises:
        RobotError: the first error of an invalid program; KG839 for parts without generated code.
    """
    refuse_errors(program, capabilities, place)
    names = Names(*_METHODS, *_OF_SIGNALS, *_OF_A_NODE, *_IN_METHODS)
    members = Members(Dialect(to), names)
    code = Code(members, CapabilityIndex(capabilities), kinds_of(program, capabilities), program, place)
    run = code.sequence(program.body, "/body")
    return module(program, members, code.used, run)


_PARALLEL: Final = ("together", "as_soon_as", "whenever")  # templates for parts of a program that run in parallel
_STANDARD: Final = ("math", "signal", "sys", "threading", "time")


def module(program: Program, members: Members, used: set[str], run: list[str]) -> str:
    """Return the file: imports, helpers, the class, `main`."""
    name = program.name if program.name.strip() else "program"
    wanted = {*members.helpers, *used & {"counted"}, "stopped"}
    wanted |= {"place"} if any("Place(" in line for line in run) else set()
    wanted |= {"ended"} if used & {*_PARALLEL} else set()
    parts = [COMMON.text(one) for one in COMMON.names() if one in wanted]
    parts.append(_class(program, members, used, run, camel(name)))
    main = members.dialect.lines("main", name=snake(name), made=camel(name))
    parts.append(COMMON.text("main", main="\n".join(indented(main))))
    code = "\n\n\n".join(parts)
    return COMMON.text("file", sentence=_sentence(program), imports=_imports(members, used, code), code=code) + "\n"


def _sentence(program: Program) -> str:
    first = plain(program.comment.partition("\n")[0]) or f"Does '{plain(program.name)}'"
    return f"{first[:1].upper()}{first[1:].rstrip('.')}."


def _imports(members: Members, used: set[str], code: str) -> str:
    standard = [f"import {one}" for one in _STANDARD if f"{one}." in code]
    abstract = ["Callable", *(["Iterator"] if "counted" in used else [])]
    standard.append(f"from collections.abc import {', '.join(abstract)}")
    standard += ["from concurrent.futures import Future"] if "Future" in code else []
    typing = [one for one in ("Any", "NamedTuple") if one in code]
    standard += [f"from typing import {', '.join(typing)}"] if typing else []
    lines = members.dialect.lines("imports")
    lines += members.dialect.lines("imports of goals") if members.goals else []
    lines += members.dialect.lines("imports of topics") if members.topics else []
    plain_ones = sorted(one for one in lines if one.startswith("import "))
    classes: dict[str, set[str]] = {}
    for one in (*lines, *members.classes):
        if one.startswith("from "):
            _, module_name, _, *names = one.replace(",", "").split()
            classes.setdefault(module_name, set()).update(names)
    others = [f"from {one} import {', '.join(sorted(classes[one]))}" for one in sorted(classes)]
    return "\n".join(["from __future__ import annotations", "", *standard, "", *plain_ones, *others])


def _class(program: Program, members: Members, used: set[str], run: list[str], name_of_class: str) -> str:
    dialect = members.dialect
    parallel = bool(used & {*_PARALLEL})
    limited = program.seconds is not None
    constructor = [*dialect.lines("begin", name=snake(program.name)), "self.over, self.status = False, 0"]
    constructor += ["self.local = threading.local()"] if parallel else []
    constructor += ["self.deadline = math.inf"] if limited else []
    checks = COMMON.lines("deadline", seconds=f"{program.seconds:g}") if limited else []
    checks += COMMON.lines("ends of parts") if parallel else []
    more = "\n".join(["", *indented(checks)])
    methods = [
        *members.methods,
        *COMMON.lines("time", clock=dialect.text("clock"), ended=dialect.text("ended"), more=more),
    ]
    waits = any("self.wait(" in line for line in (*members.connect, *members.methods))
    for piece in (
        *(["wait"] if waits else []),
        *(["ends"] if parallel else []),
        *(one for one in _PARALLEL if one in used),
    ):
        methods += ["", *COMMON.lines(piece)]
    begin = [f"self.deadline = self.now() + {program.seconds!r}"] if limited else []
    halt = ["self.over = True", *members.halt, "time.sleep(0.2)  # until it has been sent"]
    bodies = {"made": constructor + members.create, "connect": members.connect, "halt": halt, "run": begin + run}
    inner = {name: "\n".join(["", *indented(lines, 2)]) for name, lines in bodies.items()}
    return COMMON.text(
        "class",
        name=name_of_class,
        base=dialect.text("base"),
        sentence=_sentence(program),
        methods="\n".join(indented(methods)),
        **inner,
    )
