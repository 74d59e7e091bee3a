"""Texts with their substitutions performed, as far as that is possible without running anything.

Source: `launch.substitutions` and `launch_ros.substitutions`. What depends on an unknown text is unknown itself and
makes no problem of its own: the unknown text has its problem already.
"""

from __future__ import annotations

import math
import shlex
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import yaml

from kg.extract.python.evaluation import Dialect, ExpressionError, UnsupportedError, evaluate_text, failure
from kg.facts import LaunchParameter, LaunchPlugin, LaunchProblemKind, StartedNode
from kg.holes import ANONYMOUS
from kg.launch.files.access import SCHEME
from kg.launch.files.ros2.actions import Condition, ParameterFile, Substitution, Text
from kg.launch.files.ros2.context import HOLE, Context, Results, find, read
from kg.launch.files.ros2.parameters import Entry, Rewriting, read_parameters
from kg.launch.files.ros2.values import truth
from kg.launch.files.xacro.plugins import Descriptions, named_description, started
from kg.names import normalise
from kg.yamltext import compose_yaml

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from kg.corpus.files import FilePath


def describe(context: Context, words: Sequence[str]) -> None:
    """Keep the plugins of the description that a command line prints, for the parameter that is given it."""
    named = named_description(started(words))
    file = find(context, named[0]) if named is not None else None
    if named is None or file is None:
        return
    descriptions = Descriptions(context.files, context.stack[0], context.initial)
    description = descriptions.read(file, named[1], (*context.chain, context.location))
    context.results.problems.update(dict.fromkeys(description.problems))
    context.results.files.update(dict.fromkeys(description.files))
    context.results.printed = description.plugins


def described(results: Results, nodes: Iterable[StartedNode]) -> Iterator[LaunchPlugin]:
    """Yield the plugins in the parameters of nodes, each with the absolute name of its parameter."""
    names = {name for name, _, _ in results.described}
    for node in nodes:
        for given in node.parameters:
            if given.name in names:
                name = node.name or (node.executable or ANONYMOUS).removesuffix(".py")
                absolute = normalise(f"{node.namespace}/{name}/{given.name}")
                plugins = results.described.get((given.name, given.location, given.chain), ())
                yield from (replace(plugin, parameter=absolute) for plugin in plugins)


_MOST_CHARACTERS: Final = 5_000_000


@dataclass(frozen=True, slots=True)
class Generated:
    """The result of changing `file`: its text, or the parameters of a file of parameters; `recipe` is how."""

    file: FilePath
    content: bytes
    entries: tuple[Entry, ...] | None
    recipe: tuple[object, ...]


def replaced_file(context: Context, source: Text, condition: Text, *pairs: Text) -> str:
    """Return the name of a file in which texts are replaced where a condition holds; `pairs` are old and new in turn.

    Each line is taken through all replacements in their order.
    """
    path, applies = context.perform(source), truth(context.perform(condition))
    if applies is False or HOLE in path:
        return path
    if applies is None:
        return context.unresolved(f"whether texts of `{path}` are replaced is known only when it runs", path)
    source_file = read(context, path)
    if source_file is None:
        return HOLE
    texts = [context.perform(text) for text in pairs]
    existing = _generated_before(context, (path, *texts))
    if existing is not None:
        return existing
    replacements = list(zip(texts[::2], texts[1::2], strict=False))
    before = context.results.generated.get(path)
    entries = before.entries if before is not None else None
    content = _replaced(source_file[1].decode(), replacements)
    if content is None:
        context.problem(LaunchProblemKind.LIMIT, f"texts grow over {_MOST_CHARACTERS} characters", path)
        return HOLE
    changed = tuple(_replaced_in(entry, replacements) for entry in entries) if entries is not None else None
    return _named(context, path, Generated(source_file[0], content.encode("utf-8", "replace"), changed, (path, *texts)))


def _replaced(text: str, replacements: Sequence[tuple[str, str]]) -> str | None:
    for old, new in replacements:
        if not old:
            continue
        if len(text) + text.count(old) * len(new) > _MOST_CHARACTERS:
            return None
        text = text.replace(old, new)
    return text


def _replaced_in(entry: Entry, replacements: Sequence[tuple[str, str]]) -> Entry:
    node, value, names = entry.node, entry.value, entry.names
    for old, new in replacements:
        if old:
            node, value = node and node.replace(old, new), value.replace(old, new)
            names = tuple(name.replace(old, new) for name in names)
    return replace(entry, node=node, value=value[:_MOST_CHARACTERS], names=names)


def rewritten_file(context: Context, source: ParameterFile) -> str:
    """Return the name of a rewritten file of parameters."""
    path = context.perform(source.path)
    file = read(context, path)
    if file is None:
        return HOLE
    rewriting = Rewriting(
        {context.perform(old): context.perform(new) for old, new in source.keys},
        {context.perform(name): context.perform(value) for name, value in source.rewrites},
        {context.perform(old): context.perform(new) for old, new in source.values},
        context.perform(source.root) if source.root is not None else "",
        source.location,
    )
    existing = _generated_before(context, (path, rewriting))
    if existing is not None:
        return existing
    listed = read_parameters(context, path)
    if listed is None:
        return HOLE
    return _named(context, path, Generated(*file, rewriting.applied(listed[1]), (path, rewriting)))


def _generated_before(context: Context, recipe: tuple[object, ...]) -> str | None:
    """Return the name of the file made in the same way before."""
    return next((name for name, other in context.results.generated.items() if other.recipe == recipe), None)


def _named(context: Context, path: str, file: Generated) -> str:
    """Store the generated file, and return its name."""
    generated = context.results.generated
    if not context.allows("generated files"):
        return HOLE
    name = f"{path.partition('#')[0]}#{len(generated) + 1}"
    generated[name] = file
    return name


_MOST_TEXT: Final = 200_000
_TRUE: Final = {"true", "1"}
_FALSE: Final = {"false", "0"}
_PYTHON: Final = Dialect()


def perform(context: Context, text: Text) -> str:
    """Return a text with its substitutions performed in the current context; unknown parts are `{}`."""
    parts = [part if isinstance(part, str) else _perform(context, part) for part in text]
    if sum(map(len, parts)) > _MOST_TEXT:
        context.limit(f"a text grows over {_MOST_TEXT} characters")
        return HOLE
    return "".join(parts)


def holds(context: Context, condition: Condition) -> bool | None:
    """Return whether a condition is met; None where that cannot be known (`launch.conditions`)."""
    if condition.value is None:
        return None
    text = perform(context, condition.value).strip().lower()
    if text in _TRUE or text in _FALSE:
        return (text in _TRUE) is not condition.negated
    if HOLE not in text:
        context.problem(LaunchProblemKind.MALFORMED, f"a condition is `{text}`, neither true nor false")
    return None


def _perform(context: Context, part: Substitution) -> str:
    if isinstance(part.file, ParameterFile):
        return rewritten_file(context, part.file)
    if not context.allows("substitutions"):  # Python can put the same one into many others, and those into many
        return HOLE
    kind = _KINDS.get(part.kind)
    if kind is None:
        return context.unresolved(part.reason or f"`$({part.kind})` is known only when it runs", part.kind)
    performer, least, most = kind
    if not least <= len(part.arguments) <= most:
        context.problem(LaunchProblemKind.MALFORMED, f"`$({part.kind})` has too few or too many operands", part.kind)
        return HOLE
    return performer(context, *part.arguments)


def _var(context: Context, name: Text, default: Text | None = None) -> str:
    wanted = perform(context, name)
    if HOLE in wanted:
        return HOLE
    value = context.configuration(wanted)
    if value is not None:
        return value
    if default is not None:
        return perform(context, default)
    if context.scope.unread:
        return context.unresolved(f"`{wanted}` may be set by an included file that is not in the build", wanted)
    if context.results.reads_first(wanted, context.location.path, context.chain):
        message = f"the argument `{wanted}` is read, but nothing declares or sets it before"
        context.problem(LaunchProblemKind.UNDECLARED_ARGUMENT, message, wanted)
    return HOLE


def _env(context: Context, name: Text, default: Text | None = None) -> str:
    wanted = perform(context, name)
    value = context.environment(wanted)
    if value is not None:
        return value
    if default is not None:
        text = perform(context, default)
        context.results.defaults.setdefault(wanted, {}).setdefault(text, context.location)
        return text
    return context.unresolved(f"the variable `{wanted}` of the environment is known only when it runs", wanted)


def _share(context: Context, name: Text) -> str:
    package = perform(context, name)
    if HOLE in package:
        return HOLE
    if context.files.share(package) is None:
        message = f"the package `{package}` is neither in the build nor installed"
        context.problem(LaunchProblemKind.UNKNOWN_PACKAGE, message, package)
    return f"{SCHEME}{package}"


def _prefix(context: Context, name: Text) -> str:
    package = perform(context, name)
    return context.unresolved(f"where `{package}` is installed is known only when it runs", package)


def _eval(context: Context, expression: Text, _modules: Text = ()) -> str:
    text = perform(context, expression)
    if HOLE in text:
        return HOLE
    try:
        return str(evaluate_text(text, _PYTHON))
    except (ExpressionError, UnsupportedError) as error:
        return context.unresolved(failure(text, error), "eval")


def _command(context: Context, command: Text, _on_error: Text = ()) -> str:
    text = perform(context, command)
    try:
        words = shlex.split(text)
    except ValueError:
        words = []
    describe(context, words)
    if len(words) == 2 and words[0] == "cat":  # noqa: PLR2004  (the program and the file)
        return _content(context, (words[1],))
    shown = " ".join(words[:2]) or text
    return context.unresolved(f"what `{shown}` puts out is known only when it runs", words[0] if words else None)


def _content(context: Context, path: Text) -> str:
    file = read(context, perform(context, path))
    return HOLE if file is None else file[1].decode()


def _anon(context: Context, name: Text) -> str:
    text = perform(context, name)
    context.unresolved("an anonymous name is made when it runs", text)
    return f"{text}_{HOLE}"


def _path(context: Context, *parts: Text) -> str:
    joined = ""
    for part in parts:
        text = perform(context, part)
        if text.startswith("/") or SCHEME in text or not joined:
            joined = text
        else:
            joined = joined + text if joined.endswith("/") else f"{joined}/{text}"
    return joined


def _not(context: Context, value: Text) -> str:
    operand = _truth(context, value)
    return HOLE if operand is None else str(not operand).lower()


def _all(context: Context, *values: Text) -> str:
    truths = [_truth(context, value) for value in values]
    if False in truths:
        return "false"
    return HOLE if None in truths else "true"


def _any(context: Context, *values: Text) -> str:
    truths = [_truth(context, value) for value in values]
    if True in truths:
        return "true"
    return HOLE if None in truths else "false"


def _truth(context: Context, value: Text) -> bool | None:
    text = perform(context, value)
    result = truth(text)
    if result is None and HOLE not in text:
        context.problem(LaunchProblemKind.MALFORMED, f"`{text}` is neither true nor false")
    return result


def _equals(context: Context, left: Text, right: Text) -> str:
    one, other = perform(context, left), perform(context, right)
    if HOLE in one or HOLE in other:
        return HOLE
    if one.lower() in _TRUE | _FALSE and other.lower() in _TRUE | _FALSE:
        return str((one.lower() in _TRUE) == (other.lower() in _TRUE)).lower()
    try:
        return str(math.isclose(float(one), float(other))).lower()
    except ValueError:
        return str(one == other).lower()


def _differs(context: Context, left: Text, right: Text) -> str:
    same = _equals(context, left, right)
    return same if same == HOLE else str(same == "false").lower()


def _if(context: Context, condition: Text, then: Text, otherwise: Text = ()) -> str:
    test = _truth(context, condition)
    if test is None:
        one, other = perform(context, then), perform(context, otherwise)
        return one if one == other else HOLE
    return perform(context, then if test else otherwise)


def _parameter(context: Context, name: Text) -> str:
    wanted = perform(context, name)
    for given in reversed(context.scope.parameters):
        if isinstance(given, LaunchParameter) and given.name == wanted:
            return HOLE if given.value is None else given.value
    return context.unresolved(f"the parameter `{wanted}` is not among those set for all nodes", wanted)


def _has_section(context: Context, path: Text, node: Text) -> str:
    """Return whether a parameter file has a section for a node at its top (`nav2_common.launch.HasNodeParams`)."""
    file, name = read(context, perform(context, path)), perform(context, node)
    if file is None or HOLE in name:
        return HOLE
    try:
        document = compose_yaml(file[1].decode("utf-8", "replace"))
    except (yaml.YAMLError, ValueError, RecursionError):
        return HOLE
    keys = document.value if isinstance(document, yaml.MappingNode) else []
    return str(any(key.value == name for key, _ in keys))


def _dirname(context: Context) -> str:
    return context.files.folder(context.file)


def _filename(context: Context) -> str:
    return context.files.text(context.file)


_MANY: Final = 1000

_KINDS: Final[Mapping[str, tuple[Callable[..., str], int, int]]] = {
    "var": (_var, 1, 2),
    "env": (_env, 1, 2),
    "find-pkg-share": (_share, 1, 1),
    "find-pkg-prefix": (_prefix, 1, 1),
    "find-exec": (perform, 1, 1),
    "dirname": (_dirname, 0, 0),
    "filename": (_filename, 0, 0),
    "eval": (_eval, 1, 2),
    "command": (_command, 1, 2),
    "file-content": (_content, 1, 1),
    "anon": (_anon, 1, 1),
    "path-join": (_path, 1, _MANY),
    "not": (_not, 1, 1),
    "and": (_all, 2, 2),
    "all": (_all, 0, _MANY),
    "or": (_any, 2, 2),
    "any": (_any, 0, _MANY),
    "equals": (_equals, 2, 2),
    "not-equals": (_differs, 2, 2),
    "if": (_if, 2, 3),
    "param": (_parameter, 1, 1),
    "has-node-params": (_has_section, 2, 2),
    "replaced-file": (replaced_file, 2, _MANY),
}
"""Substitutions by name, with the least and the most operands that they take."""
