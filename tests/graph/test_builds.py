from __future__ import annotations

from graph.samples import BUILD, FACTS, IRIS, ROVER, loaded, true

from kg.facts import Problem
from kg.graph.builds import build_triples, count


def test_a_build_tells_what_was_read_when_and_by_what() -> None:
    """A build is an activity of PROV-O that used the repository and generated its graph."""
    assert true(
        loaded(build_triples(BUILD, IRIS)),
        f"""?b a prov:Activity, rnkg:Build ; prov:used <repository/{ROVER}> ; prov:generated <graph/source/{ROVER}> ;
        prov:startedAtTime "2026-01-02T03:04:05+00:00"^^xsd:dateTime ;
        prov:endedAtTime "2026-01-02T03:04:09.5+00:00"^^xsd:dateTime ;
        prov:wasAssociatedWith [ a prov:SoftwareAgent ; rnkg:version "0.1.0" ] ;
        rnkg:commit "0123456789abcdef" ; rnkg:kgVersion "0.1.0" ; rnkg:root "/home/someone/rover" ; rnkg:dirty false ;
        rnkg:packageCount 1 ; rnkg:nodeCount 1 ; rnkg:interfaceCount 9 ; rnkg:parameterCount 1 ;
        rnkg:definitionCount 1 ; rnkg:fileCount 1 ; rnkg:problemCount 1 ;
        rnkg:unresolvedCount 2 ; rnkg:tripleCount 321 .""",
    )


def test_problems_outside_packages_count() -> None:
    """The number of problems includes those outside packages."""
    assert count([FACTS], [Problem("KG110", "no right to read it", "secret")]).problems == 2
    assert count([]).packages == 0
