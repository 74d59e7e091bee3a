"""What rules inferred of a node type: its functions and hardware, how sure each is, and by which evidence."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.graph import vocabulary as v
from kg.graph.reading.queries import texts

if TYPE_CHECKING:
    from kg.store.interface import Queryable

_QUERY: Final = """
SELECT DISTINCT ?property ?class (STR(?label) AS ?text) WHERE {{
  VALUES ?property {{ rnkg:hasFunction rnkg:usesHardware rnkg:usesDevice }}
  <{iri}> ?property ?class . ?class rdfs:label ?label .
}} ORDER BY ?text"""

_GRADES: Final = {"gradeCertain": "certain", "gradeStrong": "strong", "gradeWeak": "weak"}
_EVIDENCE: Final = {"byName": "name", "byText": "text", "byCode": "code"}
_GRADES_QUERY: Final = f"""
SELECT DISTINCT ?property ?class WHERE {{{{
  VALUES ?property {{{{ {" ".join(f"rnkg:{name}" for name in (*_GRADES, *_EVIDENCE))} }}}}
  <{{iri}}> ?property ?class .
}}}}"""


@dataclass(frozen=True, slots=True)
class Grade:
    """How sure a class of a node is (`certain`, `strong`, `weak`), and what shows it (`name`, `text`, `code`).

    Both are empty where the rules of the family `grade` did not run.
    """

    grade: str = ""
    evidence: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.grade}: {', '.join(self.evidence)}" if self.evidence else self.grade

    @property
    def rank(self) -> int:
        """The position of the grade: certain first, unknown last."""
        return [*_GRADES.values(), ""].index(self.grade)


@dataclass(frozen=True, slots=True)
class Class:
    """The label of a function, a kind of hardware or a device, with its grade."""

    label: str
    grade: Grade = Grade()

    def __str__(self) -> str:
        return f"{self.label} ({self.grade})" if self.grade.grade else self.label


@dataclass(frozen=True, slots=True)
class Classes:
    """Functions, kinds of hardware and devices, each sorted by grade and label."""

    functions: tuple[Class, ...] = ()
    hardware: tuple[Class, ...] = ()
    devices: tuple[Class, ...] = ()


def classes(graph: Queryable, iri: str) -> Classes:
    """Return what is inferred of the node type with this IRI; nothing where no rules ran."""
    by_relation = {name: list[Class]() for name in ("hasFunction", "usesHardware", "usesDevice")}
    graded = grades(graph, iri)
    for relation, kind, label in texts(graph, _QUERY.format(iri=iri)):
        by_relation[relation.removeprefix(v.RNKG)].append(Class(label, graded.get(kind, Grade())))
    return Classes(
        *(
            tuple(sorted(one, key=lambda one_class: (one_class.grade.rank, one_class.label)))
            for one in by_relation.values()
        )
    )


def grades(graph: Queryable, iri: str) -> dict[str, Grade]:
    """Return the grade of each class of the node type with this IRI, by the IRI of the class."""
    relations: defaultdict[str, set[str]] = defaultdict(set)
    for relation, kind in texts(graph, _GRADES_QUERY.format(iri=iri)):
        relations[kind].add(relation.removeprefix(v.RNKG))
    return {
        one: Grade(
            next((grade for name, grade in _GRADES.items() if name in names), ""),
            tuple(word for name, word in _EVIDENCE.items() if name in names),
        )
        for one, names in relations.items()
    }
