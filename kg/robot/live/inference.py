"""Inference of a system's capabilities from its computation graph, in memory, without a store.

    capabilities = infer(await connection.graph(), settings, address=connection.address)

Rules, ontologies and definitions of capabilities are read once per process. Results are cached between commands: rules
run again only if the graph, the rules or an ontology changed. A file in the user's cache has the capabilities of one
graph; its name is a digest of all inputs.
"""

from __future__ import annotations

import hashlib
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

import msgspec
from pyoxigraph import DefaultGraph, NamedNode, RdfFormat, Store, parse

from kg.graph import vocabulary as v
from kg.graph.iris import Iris
from kg.graph.ontology_files import ontologies_in_force, ontology_triples
from kg.graph.systems import system_triples
from kg.pipeline.filecache import installations, states
from kg.pipeline.reasoning import digest, rule_folders, schema_of
from kg.robot.capabilities import Definition, definitions, read
from kg.robot.capability import Capabilities
from kg.robot.lifecycle import available
from kg.robot.live.systems import Seen, name_of, system_of
from kg.rules.columns import lines, read_columns, stated, stored, union_of, wanted
from kg.rules.engine.evaluate import Program, evaluate
from kg.rules.engine.terms import Dictionary
from kg.rules.reading import discover, families_in_force, packs
from kg.rules.specialise import specialised
from kg.store import bulk
from kg.store.layout import user_cache, write_atomically
from kg.store.snapshot import MemorySnapshot

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.facts import System
    from kg.robot.connection import ComputationGraph
    from kg.rules.engine.facts import Facts
    from kg.rules.files import RuleSet
    from kg.settings import Settings

MOST: Final = 64
"""Maximum number of cache files; the least recently used are removed."""
_MOST_BYTES: Final = 1 << 20
_CODE: Final = Path(__file__).resolve().parent.parent.parent


def cache_folder() -> Path:
    """Return the folder of the cache."""
    return user_cache() / "capabilities"


def cache_key(graph: ComputationGraph, settings: Settings, names: tuple[str, ...]) -> str:
    """Return a digest of the inputs of inference: graph, names, rules, ontologies, and the code of kg.

    Addresses of nodes are excluded, since they change at each start. Raises as `kg.pipeline.reasoning.digest`.
    """
    nodes = [(node.name, node.problem) for node in graph.nodes]
    seen = [graph.ros, nodes, graph.ends, graph.problems, graph.complete, names]
    rules = [settings.base, [str(one) for one in rule_folders(settings)], digest(settings)]
    code = [tuple(state) for state in (*states(_CODE), *installations())]
    return hashlib.blake2b(msgspec.json.encode([seen, rules, code]), digest_size=16).hexdigest()


def remembered(name: str, make: Callable[[], Capabilities]) -> Capabilities:
    """Return the capabilities of a key, inferred now if no file has them.

    Two processes may write the same file at once: each replaces it atomically with the same content. Without a writable
    folder, nothing is cached.
    """
    place = cache_folder() / f"{name}.json"
    with suppress(OSError, msgspec.MsgspecError):
        capabilities = msgspec.json.decode(place.read_bytes(), type=Capabilities)
        place.touch()
        return capabilities
    content = msgspec.json.encode(make())
    if len(content) <= _MOST_BYTES:
        with suppress(OSError):
            place.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            write_atomically(place, content, durable=False)
            # The least recently used files are removed, and so are leftovers of killed writers.
            files = sorted((path.stat().st_mtime_ns, path) for path in place.parent.iterdir())
            for _, path in files[:-MOST]:
                path.unlink(missing_ok=True)
    return msgspec.json.decode(content, type=Capabilities)  # omitted defaults are always the same


FAMILIES: Final = ("capability", "communication")
"""The families of rules for capabilities, together with users' rules of these families."""
_LEFT_OUT: Final = ("function.ttl", "hardware.ttl", "hardware-products.ttl", "architecture.ttl")
"""Ontologies that these rules do not read."""

_MODALITY: Final = v.ros("hasModality").encode()
_LABEL: Final = v.LABEL.encode()


@dataclass(frozen=True, slots=True)
class Knowledge:
    """Knowledge independent of any robot: rules, and the ontologies as triples and as columns.

    `full` has the triples of the ontologies as N-Triples, `short` only the modalities and labels of capabilities.
    """

    program: Program
    dictionary: Dictionary
    ontology: Facts
    full: bytes
    short: bytes
    definitions: Mapping[str, Definition]
    rules: RuleSet
    inferred: NamedNode
    """The graph for inferred triples, as in a store."""

    def world(self, content: bytes, *, whole: bool = False) -> MemorySnapshot:
        """Return a snapshot of some triples (N-Triples) with their inferences in a separate graph.

        With `whole` it includes the ontologies, else only what reading capabilities needs. Raises what
        `kg.rules.engine.evaluate` raises.
        """
        store = Store()
        bulk.load(lambda: store, DefaultGraph(), [content])
        own = read_columns(MemorySnapshot(store), wanted(self.program.rules), [None], self.dictionary)
        conclusions = evaluate(self.program, self.dictionary, union_of([self.ontology, own])).inferred
        shown = stored(conclusions, self.dictionary)
        bulk.load(lambda: store, self.inferred, lines(shown, self.dictionary))
        bulk.load(lambda: store, DefaultGraph(), [self.full if whole else self.short])
        return MemorySnapshot(store)


def knowledge(settings: Settings) -> Knowledge:
    """Return the knowledge, read once for the same settings and rules.

    Unusable rule files are left out. Raises as `kg.pipeline.reasoning.digest`.
    """
    return _cached_knowledge(_Same(f"{settings.base} {rule_folders(settings)} {digest(settings)}", settings))


@dataclass(frozen=True, slots=True)
class _Same:
    """Settings that compare equal if their `mark` is equal."""

    mark: str
    settings: Settings = field(compare=False)


@lru_cache(maxsize=2)
def _cached_knowledge(same: _Same) -> Knowledge:
    content = ontology_triples([path for path in ontologies_in_force(same.settings) if path.name not in _LEFT_OUT])
    store = Store()
    bulk.load(lambda: store, DefaultGraph(), [content])
    named = [one for one in families_in_force(same.settings) if not one.startswith("+")]
    families = tuple(one for one in FAMILIES if not named or one in named)
    rules = specialised(discover(rule_folders(same.settings), packs(), families, []), schema_of(store))
    dictionary = Dictionary()
    triples = [quad.triple for quad in parse(content, RdfFormat.N_TRIPLES)]
    ontology = stated([*triples, *rules.data], dictionary)
    short = [line for line in content.splitlines(keepends=True) if _MODALITY in line]
    subjects = {line.partition(b" ")[0] for line in short}
    short += [
        line for line in content.splitlines(keepends=True) if _LABEL in line and line.split(b" ", 1)[0] in subjects
    ]
    program = Program(rules.rules)
    inferred = NamedNode(Iris(same.settings.base).graph("inferred"))
    return Knowledge(
        program,
        dictionary,
        ontology,
        content,
        b"".join(short),
        definitions(MemorySnapshot(store)),
        rules,
        inferred,
    )


def now() -> str:
    """Return the current time in the format of facts (ISO 8601, UTC)."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def infer(graph: ComputationGraph, settings: Settings, *, address: str) -> Capabilities:
    """Return the capabilities of the system at an address by its graph; cached between processes.

    Capabilities that are unavailable because nodes are not active are marked. Raises as `knowledge`.
    """
    name = name_of(address) or "robot"
    capabilities = remembered(
        cache_key(graph, settings, (name, address)),
        lambda: infer_system(system_of(graph, Seen(address, name, now())), settings, of=address),
    )
    return available(capabilities, graph)


def infer_system(system: System, settings: Settings, *, of: str) -> Capabilities:
    """Return the capabilities of a system by its facts, whether it runs or would be started by a launch file.

    Raises as `knowledge`.
    """
    own = system.configuration
    iri = Iris(settings.base).configuration(own.repository, own.path)
    shared = knowledge(settings)
    world = shared.world(system_triples(system, {}, Iris(settings.base), whole=True))
    return read(world, iri, of, shared.definitions)


_OF: Final = "the ontology"


def general(settings: Settings) -> Capabilities:
    """Return every capability of the ontologies, without interfaces; raises as `knowledge`."""
    capabilities = [one.anywhere() for one in knowledge(settings).definitions.values()]
    return Capabilities(of=_OF, capabilities=tuple(sorted(capabilities, key=lambda each: (each.kinds, each.label))))
