"""Which node type a started node is of: by package and executable, or by the class of a plugin."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from typing import Final, TypeAlias

from kg.facts import TREE_NODE, DataFile, MissingType, NodeKind, NodeName, NodeReference, NodeType, StartedNode
from kg.holes import is_partial
from kg.launch.wiring.similar_names import Alike
from kg.names import normalise

Typed: TypeAlias = "tuple[NodeReference, NodeType]"

_SCRIPT_ENDS: Final = (".py", ".sh", ".pl", ".rb")
_LOADED: Final = (NodeKind.NODELET, NodeKind.COMPONENT, NodeKind.PLUGIN)
_STARTED: Final = (NodeKind.EXECUTABLE, NodeKind.SCRIPT)
_SHOWN: Final = 12
_SCHEME: Final = "package://"


class NodeTypes:
    """The node types of a build, found by what launch files say, and the files that nodes read when they run.

    `pairs` are all node types with their references. `packages` names further packages of the build, which have no node
    types; `programs` what else packages install to be started, in which no node was found; `data` are the files.

    Whatever wiring learns of other packages it asks by one of `has`, `installed`, `executables`, `started`, `loaded`,
    `data` and `like`, so a build can record the answers that a system depends on.
    """

    def __init__(
        self,
        pairs: Iterable[Typed],
        *,
        packages: Iterable[str] = (),
        programs: Mapping[str, Iterable[str]] | None = None,
        data: Iterable[DataFile] = (),
    ) -> None:
        self._pairs = list(pairs)
        self._index((reference.package, node) for reference, node in self._pairs)
        self._packages.update(packages, programs or ())
        self._programs.update((package, set(names)) for package, names in (programs or {}).items())
        self._add_data(data)

    def _add_data(self, files: Iterable[DataFile]) -> None:
        self._data: defaultdict[str, list[DataFile]] = defaultdict(list)
        for file in files:
            self._data[file.package].append(file)

    def _index(self, nodes: Iterable[tuple[str, NodeType | NodeName]]) -> None:
        """Index the node types, given with their packages, by their names."""
        self._packages: set[str] = set()
        self._programs: dict[str, set[str]] = {}
        self._started: defaultdict[tuple[str, str], list[int]] = defaultdict(list)
        self._loaded: defaultdict[str, list[int]] = defaultdict(list)
        self._names: defaultdict[str, set[str]] = defaultdict(set)
        self._alike: Alike | None = None
        for at, (package, node) in enumerate(nodes):
            self._packages.add(package)
            if node.plugin or node.kind in _LOADED:
                for name in {class_name(node.plugin or node.name), class_name(node.name)}:
                    self._loaded[name].append(at)
            if node.executable or node.kind in _STARTED:
                names = [node.executable or "", node.name, *node.aliases]
                self._names[package].add(node.executable or node.name)
                for name in dict.fromkeys(part for full in names if full for part in (full, _without_end(full))):
                    self._started[package, name].append(at)

    def has(self, package: str) -> bool:
        """Return whether the build has a package."""
        return package in self._packages

    def installed(self, package: str) -> list[str]:
        """Return the other programs that a package installs, sorted."""
        return sorted(self._programs.get(package, ()))

    def executables(self, package: str) -> list[str]:
        """Return the programs of a package that are nodes, sorted."""
        return sorted(self._names.get(package, ()))

    def started(self, package: str, name: str) -> list[Typed]:
        """Return the node types started by the name of a program of a package."""
        return [self.typed(at) for at in self._started.get((package, name), ())]

    def loaded(self, name: str) -> list[Typed]:
        """Return the node types loaded by the name of a class, as `class_name` has it."""
        return [self.typed(at) for at in self._loaded.get(name, ())]

    def like(self, package: str) -> tuple[str, ...]:
        """Return suggestions from the build for the name of an unknown package."""
        if package in self._packages:
            return ()
        if self._alike is None:
            self._alike = Alike(self._packages)
        return tuple(self._alike.find(package))

    def typed(self, at: int) -> Typed:
        """Return one of the node types by its place among them."""
        return self._pairs[at]

    def of(self, started: StartedNode, repository: str) -> tuple[Typed | None, MissingType | None, str | None]:
        """Return the node type of a node of a configuration in `repository`.

        Of several sources that have it, the configuration's own counts before the first. Without any, what is missing
        and the reason in words come in its place.
        """
        if started.plugin is not None:
            return self._class(started, repository)
        package, executable = started.package, started.executable
        if not package or not executable or is_partial(package) or is_partial(executable):
            return None, MissingType.NOT_SAID, "which program is started is not known before run time"
        if not self.has(package):
            return None, MissingType.UNKNOWN_PACKAGE, f"package {package} is not in the build"
        program = executable.rpartition("/")[2]
        for name in dict.fromkeys((program, _without_end(program))):
            nearest = _nearest(self.started(package, name), repository)
            if nearest is not None:
                return nearest, None, None
        if not {program, _without_end(program)}.isdisjoint(self.installed(package)):
            return None, MissingType.NO_NODE, f"no node was found in {program} of package {package}"
        names = self.executables(package)
        shown = ", ".join(names[:_SHOWN]) + (", ..." if len(names) > _SHOWN else "")
        reason = f"package {package} has no executable {executable}; it has: {shown or 'none'}"
        return None, MissingType.UNKNOWN_NODE, reason

    def _class(self, started: StartedNode, repository: str) -> tuple[Typed | None, MissingType | None, str | None]:
        plugin = started.plugin or ""
        if not plugin or is_partial(plugin):
            return None, MissingType.NOT_SAID, "which class is loaded is not known before run time"
        nearest = self.plugin(plugin, repository, started.package)
        if nearest is not None:
            return nearest, None, None
        at_front = plugin.replace("::", "/").partition("/")[0] if "/" in plugin or "::" in plugin else None
        package = next((name for name in (at_front, started.package) if name and self.has(name)), None)
        if package is None:
            package = started.package or at_front or plugin
            return None, MissingType.UNKNOWN_PACKAGE, f"package {package} is not in the build"
        if plugin in self._programs.get(package, set()):
            return None, MissingType.NO_NODE, f"no node was found in {plugin} of package {package}"
        return None, MissingType.UNKNOWN_NODE, f"package {package} has no class {plugin} to load"

    def plugin(self, name: str, repository: str, package: str | None = None) -> Typed | None:
        """Return the node type loaded by the class (`pkg/Class`, `ns::Class`); if several, that of `package`."""
        loaded = [pair for pair in self.loaded(class_name(name)) if pair[1].base_class != TREE_NODE]
        exact = [pair for pair in loaded if name in (pair[1].plugin, pair[1].name)] or loaded
        own = [pair for pair in exact if pair[0].package == package] or exact
        return _nearest(own, repository)

    def tree_node(self, name: str, repository: str) -> Typed | None:
        """Return the node of behavior trees that is registered under a name."""
        loaded = [pair for pair in self.loaded(class_name(name)) if pair[1].base_class == TREE_NODE]
        return _nearest(loaded, repository)

    def data(self, package: str) -> list[DataFile]:
        """Return the files of a package that nodes read when they run."""
        return self._data.get(package, [])

    def data_file(self, path: str) -> DataFile | None:
        """Return the file that a path `package://NAME/...` names where the package is installed."""
        if not path.startswith(_SCHEME):
            return None
        package, _, inner = path.removeprefix(_SCHEME).partition("/")
        files = self.data(package)
        whole = [one for one in files if f"/{one.path}".endswith(f"/{inner}")]
        named = [one for one in files if one.path.rpartition("/")[2] == inner.rpartition("/")[2]]
        matches = whole or (named if len(named) == 1 else [])
        return min(matches, key=lambda one: len(one.path), default=None)


def class_name(name: str) -> str:
    """Return the name of a class to load in one form for `pkg/Class` and `pkg::Class`."""
    return name.strip().strip(":/").replace("::", "/")


def own_name(node: NodeType) -> str:
    """Return the name that a node has without a given one: its own, else that of its type."""
    if node.node_name:
        return normalise(node.node_name).rpartition("/")[2]
    return node.name.rpartition("::")[2].rpartition("/")[2].removesuffix(".py")


def _nearest(listed: Sequence[Typed], repository: str) -> Typed | None:
    return next((pair for pair in listed if pair[0].repository == repository), listed[0] if listed else None)


def _without_end(name: str) -> str:
    return next((name.removesuffix(end) for end in _SCRIPT_ENDS if name.endswith(end)), name)
