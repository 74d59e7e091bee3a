"""The overview: sources of the store and their states, counts by kind, first questions.

The view `prepare` does slow computations ahead.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.errors import KgError
from kg.graph.source_states import SourceState, sources
from kg.query.core import run
from kg.query.result import Solutions
from kg.query.stored import find
from kg.views.complete import cache_of
from kg.views.find import search_over
from kg.views.listing import totals
from kg.views.remembered import once
from kg.views.stored import query_object
from kg.views.systems import configuration_names

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

QUESTIONS: Final = {
    "explore/who-publishes": "Who publishes this topic?",
    "explore/who-subscribes": "Who subscribes to this topic?",
    "explore/interface-of-node": "What goes in and out of this node?",
    "explore/nodes-by-type": "Which nodes use this message type?",
    "explore/feeds": "Which nodes get what this node publishes?",
    "explore/parameters-of-node": "Which parameters does this node have?",
    "explore/hardware": "Which hardware does this node work with?",
    "explore/unconnected": "Which topics have one end only?",
}
"""Stored queries that people who work with ROS ask first, and how they would say them."""
_SOON: Final = 5_000
"""The lists of a store with so many interfaces are made while somebody waits; those of a larger one beforehand."""
_WHOLE: Final = {"explore/unconnected"}  # questions about the whole store, though the query takes a parameter
_STARTED: Final = """SELECT ?node { ?instance rnkg:instanceOf ?node
    FILTER EXISTS { ?node rnkg:usesHardware ?hardware } FILTER EXISTS { ?node rnkg:feeds ?other } }
    GROUP BY ?node ORDER BY DESC(COUNT(?instance)) ?node LIMIT 1"""
"""The node that launch files start most often, of those about which every question has an answer."""
_BUSIEST: Final = """SELECT ?node { ?node a rnkg:NodeType ; ros:hasComponent ?end }
    GROUP BY ?node ORDER BY DESC(COUNT(?end)) ?node LIMIT 1"""
"""Counted with the parts that frameworks create, since excluding these takes seconds in a large store."""
_TOPICS: Final = '"/scan" "/cmd_vel" "/odom" "/image_raw" "/joint_states"'
_TYPES: Final = '"sensor_msgs/LaserScan" "geometry_msgs/Twist" "sensor_msgs/Image"'  # well-known types
_KNOWN: Final = """SELECT ?label {{ VALUES ?label {{ {names} }}
    FILTER EXISTS {{ ?known rdfs:label ?label . ?node {property} ?known }} }} LIMIT 1"""
_OF_NODE: Final = """SELECT ?label {{ {node} {property} ?known . ?known rdfs:label ?label
    FILTER(?label NOT IN ("/rosout", "/parameter_events")) }} ORDER BY ?label LIMIT 1"""
_EXAMPLES: Final = {
    "explore/who-publishes": (_TOPICS, "rnkg:publishes"),
    "explore/who-subscribes": (_TOPICS, "rnkg:subscribes"),
    "explore/nodes-by-type": (_TYPES, "ros:hasMessage"),
}
"""For questions about a topic or a type: names that are tried, and the property that leads to one in use."""


def overview(snapshot: EmbeddedSnapshot, settings: Settings) -> dict[str, Any]:
    """Return the content of the start page.

    `snapshot` is the identity of the snapshot. `sources` has for each source `name`, `remote`, `branch`, `commit`,
    `dirty`, `read` (ISO 8601), `version` (of `kg`), `root` (its folder, None if it was not on this machine), and the
    counts `packages`, `nodes`, `interfaces`, `unresolved`, `files`, `problems`. `counts` maps lists (see
    `kg.views.listing.totals`) to how many rows they have; it is empty while those of a large store have not been made.
    `systems` is how many launch configurations. `unresolved` and `interfaces` are sums over the sources. `questions`
    are objects of `stored` without their text, with `question` (as people say it), and in `parameters` an `example`
    that this store has.
    """
    states = sources(snapshot, counted=True)
    return {
        "snapshot": snapshot.identity,
        "sources": [_source(one) for one in states],
        "counts": totals(snapshot, settings, wait=sum(one.counts.interfaces for one in states) <= _SOON),
        "systems": len(configuration_names(snapshot)),
        "interfaces": sum(one.counts.interfaces for one in states),
        "unresolved": sum(one.counts.unresolved for one in states),
        "questions": _questions(snapshot, settings),
    }


def _source(state: SourceState) -> dict[str, Any]:
    counts = state.counts
    return {
        "name": state.name,
        "remote": state.remote,
        "branch": state.branch,
        "commit": state.commit,
        "dirty": state.dirty,
        "read": state.read,
        "version": state.version,
        "root": state.root,
        "packages": counts.packages,
        "nodes": counts.nodes,
        "interfaces": counts.interfaces,
        "unresolved": counts.unresolved,
        "files": counts.files,
        "problems": counts.problems,
    }


def _questions(snapshot: EmbeddedSnapshot, settings: Settings) -> list[dict[str, Any]]:
    """Return the questions; one without its query is left out."""
    questions = []
    for name, question in QUESTIONS.items():
        try:
            query = query_object(find(name, settings.queries))
        except KgError:
            continue
        parameters = [] if name in _WHOLE else query["parameters"]
        for parameter in parameters:
            parameter["example"] = _example(snapshot, name, parameter["name"]) or parameter["example"]
        del query["text"]
        questions.append({**query, "question": question, "parameters": parameters})
    return questions


@once
def _example(snapshot: EmbeddedSnapshot, query: str, parameter: str) -> str | None:
    """Return an example from the store for the first parameter of a question; None if there is none."""
    names, leads = _EXAMPLES.get(query, ("", ""))
    example = _first(snapshot, _KNOWN.format(names=names, property=leads)) if names else None
    busiest = None if example else _first(snapshot, _STARTED) or _first(snapshot, _BUSIEST)
    if busiest and parameter in {"node", "from"}:
        example = _first(snapshot, f"SELECT ?name {{ {busiest} rnkg:name ?name }} LIMIT 1")
    elif busiest and names:
        path = f"ros:hasComponent/{leads}" if names == _TYPES else leads
        example = _first(snapshot, _OF_NODE.format(node=busiest, property=path))
    return None if example is None else str(getattr(example, "value", example))


def _first(snapshot: EmbeddedSnapshot, query: str) -> Any:
    """Return the first term of a result; None if it is empty."""
    result = run(snapshot, query)
    return result.rows[0][0] if isinstance(result, Solutions) and result.rows else None


def prepare(snapshot: EmbeddedSnapshot, settings: Settings) -> dict[str, int]:
    """Build the index of the search, the statistics of completion and all lists, which the store then keeps.

    Returns how many nodes (`nodes`) the index has.
    """
    search = search_over(snapshot, settings)
    cache_of(snapshot, settings).statistics(fresh=True)
    totals(snapshot, settings)
    return {"nodes": search.index.size}
