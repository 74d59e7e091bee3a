"""The enabled rules, and the parts of a graph, for rules and for explanations."""

from __future__ import annotations

from contextlib import suppress
from functools import lru_cache, partial
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import pyoxigraph
from pyoxigraph import NamedNode, RdfFormat, Triple, parse

from kg import resources
from kg.errors import RuleError
from kg.graph.iris import Iris
from kg.graph.ontology_files import ontologies_in_force, ontology_triples
from kg.graph.shared import SHARED
from kg.graph.vocabulary import RNKG
from kg.lazily import lazily
from kg.pipeline.filecache import State, cached_text, installations, states, unless_changed
from kg.rules import compiled
from kg.rules.files import RuleSet
from kg.rules.reading import Pack, discover, families_in_force, packs, rule_files, user_folders
from kg.rules.recording import Names
from kg.rules.specialise import schema_pattern, schema_query, specialised
from kg.store.failure import translated
from kg.store.layout import user_cache
from kg.store.terms import cells
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from kg.rules.columns import Tables
    from kg.rules.documents import Statement
    from kg.rules.partitions import Parts
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    from kg.query.stored import discover as discover_queries
    from kg.query.terms import iris_of
    from kg.rules.checks.finding import Context
    from kg.rules.checks.firing import StoreOf, nothing
    from kg.rules.documents import place_of, statements
    from kg.rules.explain.proof import Evidence
    from kg.rules.explain.view import View, Vocabulary
    from kg.rules.partitions import parts_of

_USES: Final = """
SELECT ?term (COUNT(*) AS ?uses) WHERE { { ?s ?term ?o } UNION { ?s a ?term FILTER(ISIRI(?term)) } } GROUP BY ?term"""

_VOCABULARY: Final = """
SELECT DISTINCT ?term WHERE {
  { SELECT DISTINCT ?term WHERE { ?s ?term ?o } }
  UNION { SELECT DISTINCT ?term WHERE { ?s a ?term } }
  UNION { VALUES ?kind { owl:Class owl:ObjectProperty owl:DatatypeProperty owl:AnnotationProperty rdf:Property }
          ?term a ?kind }
  FILTER(ISIRI(?term))
}"""


_DIGEST: Final = "rules-digest"
"""Cache file with the digest of the rules; below: whether packs are installed, digest of ontologies."""
_PACKS: Final = "packs"
_ONTOLOGY_DIGEST: Final = "ontologies-digest"
_RULES: Final = "rules"
"""Folder of the user's cache with the rules that `kg` brings along, for the next new store."""

_Found = tuple[RuleSet, tuple[RuleError, ...]]
"""Rules, and the errors of unusable files."""


class _Selection(NamedTuple):
    """What rules are read from; `mark` is a digest of them, so that equal selections have equal rules."""

    folders: tuple[Path, ...]
    installed: tuple[Pack, ...]
    families: tuple[str, ...]
    mark: str

    def key(self) -> str:
        """Return a text that also differs if the code that reads rules does."""
        return f"{_code()} {self.folders} {self.installed} {self.families} {self.mark}"


def digest(settings: Settings, cache: Path | None = None) -> str:
    """Return a digest of all files of enabled rules and ontologies.

    It is cached in the folder `cache`, if given.

    Raises:
        RuleError: KG208 for a pack that cannot be loaded, KG231 for an unreadable folder of rules.
        UsageError: KG002 for a folder or a family of the settings that does not exist.
    """
    folders = (resources.folder("rules"), *(pack.folder for pack in installed_packs(cache)), *user_folders(settings))
    seen, families = tuple(state for folder in folders for state in states(folder)), families_in_force(settings)
    rules = cached_text(
        cache and cache / _DIGEST,
        seen,
        (families, folders),
        lambda: unless_changed(_digest, families, folders, seen=seen),
    )
    return f"{rules} {ontology_digest(settings, cache)}"


def ontology_digest(settings: Settings, cache: Path | None) -> str:
    """Return a digest of the ontologies in the settings; raises as `ontologies_in_force`."""
    files = ontologies_in_force(settings)
    seen = tuple(state for file in files for state in states(file))
    place = cache and cache / _ONTOLOGY_DIGEST
    return cached_text(place, seen, files, lambda: unless_changed(_digest_of, files, seen=seen))


@lru_cache(maxsize=4)
def _digest_of(files: tuple[Path, ...], _seen: tuple[State, ...]) -> str:
    digest_of_files = blake2b(digest_size=16)
    for file in files:
        digest_of_files.update(f"{file.name}\0".encode())
        digest_of_files.update(_content(file))
    return digest_of_files.hexdigest()


def installed_packs(cache: Path | None = None) -> tuple[Pack, ...]:
    """Return the installed rule packs; with a folder `cache`, without a search if the last one found none.

    Raises RuleError KG208 for a pack that cannot be loaded.
    """
    if cache is None:
        return packs()
    has_packs = cached_text(cache / _PACKS, tuple(installations()), "", lambda: str(bool(packs())))
    return packs() if has_packs == str(True) else ()


@lru_cache(maxsize=4)
def _digest(families: tuple[str, ...], folders: tuple[Path, ...], _seen: tuple[State, ...]) -> str:
    """Return the digest of the rules, computed again only if the state of a file changes."""
    digest_of_rules = blake2b(repr(families).encode(), digest_size=16)
    for folder in folders:
        for path, name in rule_files(folder, families):
            digest_of_rules.update(f"{name}{path.suffix}\0".encode())
            digest_of_rules.update(_content(path))
    return digest_of_rules.hexdigest()


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:  # reported when the file is read
        return str(error).encode()


def rules_in_force(settings: Settings, broken: list[RuleError] | None = None, *, cache: Path | None = None) -> RuleSet:
    """Return the rules of `kg`, of installed packs and of the user's folders.

    Unusable files are left out and their errors added to `broken`, if given. With a folder `cache`, rules come without
    texts and documentation, and are cached there if it is writable.

    Raises:
        RuleError: KG201 and others of KG2xx for an unusable file, without `broken`.
        UsageError: KG002 for a folder or a family of the settings that does not exist.
    """
    selection = _Selection(rule_folders(settings), installed_packs(), families_in_force(settings), digest(settings))
    return _sound(_read(selection) if cache is None else _read_before(cache, selection), broken)


@lru_cache(maxsize=2)
def _read_before(cache: Path, selection: _Selection) -> _Found:
    """Return rules as `_read`, from the folder `cache` if they are there."""
    before = compiled.load(cache, selection.key(), cut=False)
    if before is not None:
        return before, ()
    rules, broken = _read(selection)
    if not broken:
        with suppress(OSError):  # a read-only store
            rules = compiled.save(cache, selection.key(), rules, cut=False)
    return rules, broken


def _sound(read: _Found, broken: list[RuleError] | None) -> RuleSet:
    rules, errors = read
    if broken is None:
        for error in errors:
            raise error
    else:
        broken += errors
    return rules


@lru_cache(maxsize=2)
def _read(selection: _Selection) -> _Found:
    """Return rules, cached in this process until a file changes."""
    broken: list[RuleError] = []
    rules = discover(selection.folders, selection.installed, selection.families, broken)
    return rules, tuple(broken)


def rule_folders(settings: Settings) -> tuple[Path, ...]:
    """Return the folder of the rules of `kg` and those of the user."""
    return (resources.folder("rules"), *user_folders(settings))


def check_context(settings: Settings, snapshot: EmbeddedSnapshot | None) -> Context:
    """Return the context of checks: the ontologies, the stored queries, and a store if there is one."""
    vocabulary = explained_vocabulary(settings)
    ontologies = _ontologies(settings)
    terms = _terms(ontologies.query(_VOCABULARY, prefixes=dict(PREFIXES)))
    if snapshot:
        terms |= _terms(snapshot.query(_VOCABULARY, prefixes=PREFIXES))
    queries = discover_queries(settings.queries)
    read = frozenset(iri for query in queries.values() for iri in iris_of(query.text))
    store = StoreOf(View(snapshot, vocabulary)) if snapshot else None
    return Context(RuleSet(()), terms, read, store, nothing(vocabulary), schema=schema_of(snapshot or ontologies))


def ontology_schema(settings: Settings) -> tuple[Triple, ...]:
    """Return the axioms of the ontologies in the settings, for rules without a store."""
    return schema_of(_ontologies(settings))


def _ontologies(settings: Settings) -> pyoxigraph.Store:
    store = pyoxigraph.Store()
    store.bulk_load(ontology_triples(ontologies_in_force(settings)), RdfFormat.N_TRIPLES)
    return store


def schema_of(graph: Any) -> tuple[Triple, ...]:
    """Return the axioms of a store or a snapshot, for which rules about any schema are specialized before they run."""
    return tuple(graph.query(schema_query()))


def rules_over(  # noqa: PLR0913 - selects rules and their cache
    settings: Settings,
    source: Tables,
    broken: list[RuleError] | None = None,
    *,
    own: bool = True,
    cache: Path | None = None,
    families: tuple[str, ...] | None = None,
    mark: str | None = None,
) -> RuleSet:
    """Return the enabled rules, specialized for the axioms of a snapshot or a transaction.

    `broken` is as in `rules_in_force`. Without `own` the rules are those of `kg` and installed packs; with `families`
    those of these families, enabled or not. With a folder `cache` they contain only what evaluation needs, and are
    cached there. `mark` is the digest of the rules, if already computed. Raises as `rules_in_force`.
    """
    names = Names.of(settings.base, RNKG)
    named = f"GRAPH ?graph {schema_pattern()} FILTER(?graph NOT IN ({names.inferred}, {names.builds}))"
    query = f"SELECT ?s ?p ?o WHERE {{ {schema_pattern()} UNION {{ {named} }} }}"
    axiom_cells = cells(source.table(query, None), 3)
    lines = {b"%s %s %s .\n" % row for row in zip(axiom_cells[::3], axiom_cells[1::3], axiom_cells[2::3], strict=True)}
    folders = rule_folders(settings) if own else rule_folders(settings)[:1]
    axioms = b"".join(sorted(lines))
    chosen = families_in_force(settings) if families is None else families
    selection = _Selection(folders, installed_packs(cache), chosen, mark or digest(settings, cache))
    return _sound(_cut(selection, axioms) if cache is None else _cached_rules(cache, selection, axioms), broken)


@lru_cache(maxsize=2)
def _cached_rules(cache: Path, selection: _Selection, axioms: bytes) -> _Found:
    """Return the rules of `_cut`, reduced to what evaluation needs, from the folder `cache` if they are there."""
    whole = _whole(selection, axioms)
    before = compiled.load(cache, whole)
    if before is not None:
        return before, ()
    packed = _packed(selection, axioms)
    if packed is None:
        return _cut(selection, axioms)
    with translated(str(cache)):
        return compiled.write(cache, whole, packed), ()


def _whole(selection: _Selection, axioms: bytes) -> str:
    return f"{selection.key()} {axioms!r}"


@lru_cache(maxsize=1)
def _packed(selection: _Selection, axioms: bytes) -> compiled.Packed | None:
    """Return compiled rules, None if a file is unusable.

    They are cached in this process for other stores, and for other processes in the user's cache unless the user has
    rules.
    """
    whole, shared = _whole(selection, axioms), selection.folders == (resources.folder("rules"),)
    with suppress(OSError, RuntimeError):  # the home folder may be unknown
        if shared and (before := compiled.packed(user_cache() / _RULES, whole)):
            return before
    rules, broken = _cut(selection, axioms)
    if broken:
        return None
    packed = compiled.pack(rules)
    if shared:
        with suppress(OSError, RuntimeError):
            compiled.write(user_cache() / _RULES, whole, packed)
    return packed


@lru_cache(maxsize=1)
def _code() -> str:
    """Return a digest of the code that reads and orders rules."""
    own = Path(__file__).resolve().parent.parent / "rules"
    files = ("compiled.py", "dependencies.py", "form.py", "reading.py", "specialise.py", "stratify.py")
    parts = (*files, "decompose", "notations", "syntax")
    return f"{resources.digest(own / name for name in parts)} {pyoxigraph.__version__}"


@lru_cache(maxsize=2)
def _cut(selection: _Selection, axioms: bytes) -> _Found:
    """Return specialized rules, cached in this process until a file or an axiom changes."""
    rules, broken = _read(selection)
    return specialised(rules, [quad.triple for quad in parse(axioms, RdfFormat.N_TRIPLES)]), broken


def division(settings: Settings, snapshot: EmbeddedSnapshot) -> tuple[Parts, Parts]:
    """Return the division of a store's graph into sources, each with the systems of its launch files.

    The first counts all facts, the second only asserted ones.
    """
    start = f"{settings.base}graph/"

    def part(graph: str, subject: str) -> str | None:
        kind, _, path = graph.removeprefix(start).partition("/")
        if kind == "starts":  # shared by all sources, in one graph
            kind, path = "launch", subject.removeprefix(f"{settings.base}start/")
        if not graph.startswith(start) or kind not in {"launch", "source", "robot"}:
            return None
        return path.partition("/-/")[0] if kind == "launch" else path

    iris = Iris(settings.base)
    copied = frozenset(iris.graph(name) for name in ("builds", "ontology", SHARED))
    inferred = NamedNode(iris.graph("inferred"))
    asserted = parts_of(lambda: (quad for quad in snapshot.quads() if quad.graph_name != inferred), part, copied)
    return parts_of(snapshot.quads, part, copied), asserted


def term_uses(snapshot: EmbeddedSnapshot) -> dict[str, int]:
    """Return the number of triples of each property, and the number of instances of each class."""
    rows: Any = snapshot.query(_USES)
    return {row[0].value: int(row[1].value) for row in rows}


def _terms(rows: Any) -> frozenset[str]:
    return frozenset(row[0].value for row in rows)


def explained_vocabulary(settings: Settings) -> Vocabulary:
    """Return the vocabulary of explanations for these settings."""
    iris, ontologies = Iris(settings.base), ontologies_in_force(settings)
    path, line, repository, declared_by, seen_at, seen_since = (
        NamedNode(RNKG + name) for name in ("path", "line", "repository", "declaredBy", "seenAt", "seenSince")
    )
    inferred, builds = NamedNode(iris.graph("inferred")), NamedNode(iris.graph("builds"))
    line_of = partial(_ontology_line, ontologies)
    return Vocabulary(inferred, (builds,), path, line, repository, line_of, declared_by, seen_at, seen_since)


def _ontology_line(ontologies: tuple[Path, ...], fact: Triple) -> Evidence | None:
    """Return the line of an ontology that states a fact."""
    place = place_of(fact, _ontology_statements(ontologies))
    return Evidence(*place) if place else None


@lru_cache(maxsize=1)
def _ontology_statements(ontologies: tuple[Path, ...]) -> dict[str, Statement]:
    return statements(ontologies)
