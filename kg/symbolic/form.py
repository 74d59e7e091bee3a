"""The intermediate form: front ends lower files into it, and the interpreter runs it.

It contains only what the interpreter needs: names with their scopes and template arguments, calls, constructions,
assignments, branches, loops, functions and classes. Every element has the line where it begins. Code that a front end
does not understand becomes `Opaque`.

Elements are not frozen, because frozen dataclasses take three times as long to create. Nothing changes them after
lowering.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from kg.corpus.files import FilePath


@dataclass(slots=True, frozen=True)
class Type:
    """A type as written: `std::vector<A>` has the names (`std`, `vector`) and one argument.

    `arguments` are the template arguments of the last name; `outer` those of a name before it (`A<T>::B`).
    """

    names: tuple[str, ...]
    arguments: tuple[Type | Expression, ...] = ()
    outer: tuple[Type | Expression, ...] = ()
    reference: bool = False
    pointer: bool = False
    constant: bool = False

    @property
    def name(self) -> str:
        """The last name."""
        return self.names[-1] if self.names else ""

    def __str__(self) -> str:
        return "::".join(self.names)


@dataclass(slots=True, eq=False)
class Literal:
    """A string, number, truth value or null; `written` is the number as the source has it."""

    line: int
    value: str | float | bool | None
    written: str = ""


@dataclass(slots=True, eq=False)
class Name:
    """A variable, function or class by its name, with its scopes from the outside in.

    `template` are the last template arguments in it, `outer` those of a name before the last.
    """

    line: int
    names: tuple[str, ...]
    template: tuple[Type | Expression, ...] = ()
    outer: tuple[Type | Expression, ...] = ()


@dataclass(slots=True, eq=False)
class Member:
    """A member of an object: `of.name` or `of->name`."""

    line: int
    of: Expression
    name: str
    template: tuple[Type | Expression, ...] = ()


@dataclass(slots=True, eq=False)
class Call:
    """A call of a function with arguments."""

    line: int
    function: Expression
    arguments: tuple[Expression, ...]
    keywords: tuple[tuple[str, Expression], ...] = ()
    """Arguments by name; a name of `**` spreads a dictionary."""


@dataclass(slots=True, eq=False)
class Construct:
    """The creation of an object of a type; `heap` where `new` makes it, `listed` where braces hold the arguments."""

    line: int
    type: Type
    arguments: tuple[Expression, ...]
    heap: bool = False
    listed: bool = False


@dataclass(slots=True, eq=False)
class Unary:
    """An operator before (or after) one operand: `!`, `-`, `*`, `&`, `++`."""

    line: int
    sign: str
    operand: Expression


@dataclass(slots=True, eq=False)
class Binary:
    """An operator between operands; chains of one left-associative operator have all of theirs."""

    line: int
    sign: str
    operands: tuple[Expression, ...]


@dataclass(slots=True, eq=False)
class Choice:
    """`condition ? then : otherwise`."""

    line: int
    condition: Expression
    then: Expression
    otherwise: Expression


@dataclass(slots=True, eq=False)
class Index:
    """An element of a container."""

    line: int
    of: Expression
    key: Expression


@dataclass(slots=True, eq=False)
class Display:
    """A list, tuple, set or initialiser list; `kind` is the one of Python that it is."""

    line: int
    items: tuple[Expression, ...]
    kind: str = "list"


@dataclass(slots=True, eq=False)
class Pairs:
    """A dictionary of pairs of key and value."""

    line: int
    items: tuple[tuple[Expression, Expression], ...]


@dataclass(slots=True, eq=False)
class Lambda:
    """A function without a name, with the variables around it. `captures` are those that it copies, or makes itself."""

    line: int
    function: Function
    captures: tuple[tuple[str, Expression], ...] = ()
    shared: frozenset[str] | None = None
    """The variables that it shares with the code around it while it copies all others; None if it copies no others."""


@dataclass(slots=True, eq=False)
class Assign:
    """`target = value`, or with an operator in front of the `=`."""

    line: int
    target: Expression
    value: Expression
    sign: str = ""


@dataclass(slots=True, eq=False)
class Opaque:
    """Code that was not understood; `text` is the source, shortened. `parts` run for their effects."""

    line: int
    text: str
    parts: tuple[Expression, ...] = ()


@dataclass(slots=True, eq=False)
class Spread:
    """The elements of a collection as arguments or items: `*values`."""

    line: int
    of: Expression


@dataclass(slots=True, eq=False)
class Import:
    """The import of a module, of one of its names, or of all of them (`*`), under the name `alias`."""

    line: int
    module: str
    name: str | None
    alias: str


@dataclass(slots=True, eq=False)
class Define:
    """The definition of a class by a statement that runs."""

    line: int
    cls: Class


Operation: TypeAlias = Call | Construct | Unary | Binary | Choice | Index | Assign | Spread | Import | Define
Expression: TypeAlias = Literal | Name | Member | Operation | Display | Pairs | Lambda | Opaque | Type


@dataclass(slots=True, eq=False)
class Declare:
    """A variable with its type and its first value; None if it is constructed without arguments."""

    line: int
    name: str
    type: Type | None
    value: Expression | None


@dataclass(slots=True, eq=False)
class Static(Declare):
    """A variable of a function that is initialised at the first call, and keeps its value for the next.

    `switched` means that the function assigns a truth value to it, so that its value depends on the call.
    """

    switched: bool = False


@dataclass(slots=True, eq=False)
class Step:
    """An expression that runs for its effect."""

    line: int
    value: Expression


@dataclass(slots=True, eq=False)
class Block:
    """Statements in a row, with a scope of their own unless `open`."""

    line: int
    body: tuple[Statement, ...]
    open: bool = False


@dataclass(slots=True, eq=False)
class Case(Block):
    """Statements of a `switch`, which a `break` in them ends."""


@dataclass(slots=True, eq=False)
class Branch:
    """Alternatives of which one runs: the first whose condition holds. A condition of None always holds."""

    line: int
    arms: tuple[tuple[Expression | None, Statement], ...]


@dataclass(slots=True, eq=False)
class Loop:
    """A loop over the elements of `over`, or while `condition` holds; `first` runs before, `step` after each turn."""

    line: int
    body: Statement
    targets: tuple[str, ...] = ()
    over: Expression | None = None
    first: Statement | None = None
    condition: Expression | None = None
    step: Expression | None = None
    declared: Type | None = None
    """The type of the targets, which are variables of the loop then; None if they are variables around it."""
    test_last: bool = False

    @property
    def runs_at_least_once(self) -> bool:
        """Whether the body always runs: the condition is tested last, or is a constant."""
        constant = isinstance(self.condition, Literal) and bool(self.condition.value)
        return self.test_last or self.condition is None or constant


@dataclass(slots=True, eq=False)
class Try:
    """A block with the handlers of its exceptions; `otherwise` runs if there was none, `last` in any case."""

    line: int
    body: Block
    handlers: tuple[Block, ...]
    otherwise: Block | None = None
    last: Block | None = None


@dataclass(slots=True, eq=False)
class Return:
    """The end of a function with its value."""

    line: int
    value: Expression | None


@dataclass(slots=True, eq=False)
class Jump:
    """`break`, `continue`, `raise`, or `exit` for the end of the program."""

    line: int
    kind: str


Statement: TypeAlias = Declare | Step | Block | Branch | Loop | Try | Return | Jump


@dataclass(slots=True, eq=False)
class Parameter:
    """A parameter of a function."""

    name: str
    type: Type | None
    default: Expression | None = None
    variadic: bool = False
    named: bool = False
    """Whether it is given by its name only; with `variadic`, it takes all arguments by name that are left."""


@dataclass(frozen=True, slots=True)
class Initialiser:
    """What a constructor initialises, a member or a base; `listed` if braces hold the arguments."""

    name: str
    arguments: tuple[Expression, ...] = ()
    line: int = 0
    listed: bool = False


@dataclass(slots=True, eq=False)
class Function:
    """A function with its body. `scope` holds the namespaces and classes around its name, from the outside in.

    `unit` is its file, `owner` its class. The front end lowers `body` at its first use.
    """

    unit: Unit
    name: str
    scope: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    line: int
    template: tuple[str, ...] = ()
    outer: tuple[str, ...] = ()
    """What its definition outside of a class template calls the parameters of the class."""
    pattern: tuple[Type | Expression, ...] = ()
    """The template arguments that a specialisation is for."""
    within: tuple[Type | Expression, ...] = ()
    """The template arguments of its class that a method is for, if it is not for all."""
    defaults: dict[str, Type | Expression] = field(default_factory=dict)
    """Defaults of its template parameters."""
    returns: Type | None = None
    owner: Class | None = None
    virtual: bool = False
    static: bool = False
    marks: frozenset[str] = frozenset()
    """What decorators make of a method: `property`, `classmethod`."""
    source: object = None
    lowered_body: Block | None = None
    initialisers: tuple[Initialiser, ...] = ()

    @property
    def body(self) -> Block:
        """The statements of the function."""
        if self.lowered_body is None:
            self.lowered_body = self.unit.lower_body(self)
        return self.lowered_body


@dataclass(slots=True, eq=False)
class Field:
    """A member variable of a class."""

    name: str
    type: Type | None
    value: Expression | None
    line: int
    static: bool = False
    inline: bool = False
    """Whether the class itself defines a static member, which need not have a value there."""


@dataclass(slots=True, eq=False)
class Class:
    """A class with its members; `scope` as in `Function`."""

    unit: Unit
    name: str
    scope: tuple[str, ...]
    line: int
    bases: tuple[Type, ...] = ()
    template: tuple[str, ...] = ()
    fields: dict[str, Field] = field(default_factory=dict)
    methods: dict[str, list[Function]] = field(default_factory=dict)
    declared: dict[str, list[Function]] = field(default_factory=dict)
    """Methods declared without a body, with their parameters."""
    defaults: dict[str, Type | Expression] = field(default_factory=dict)
    """The defaults of template parameters."""
    derived: tuple[Expression, ...] = ()
    """The bases as expressions, where a statement defines the class."""
    body: Block | None = None
    """What runs when a statement defines the class, except its methods."""
    pattern: tuple[Type | Expression, ...] = ()
    """The template arguments that a specialisation is for."""

    @property
    def inside(self) -> tuple[str, ...]:
        """The scope of its members."""
        return (*self.scope, self.name)


class Unit:
    """A lowered file."""

    key: FilePath
    """Identifies the file in the build."""
    uses: tuple[tuple[str, ...], ...] = ()
    """Namespaces whose names are visible without their scope."""

    @property
    def path(self) -> str:
        """The path of the file within its source."""
        return self.key.path

    def lower_body(self, function: Function) -> Block:
        """Return the statements of a function of this file."""
        raise NotImplementedError
