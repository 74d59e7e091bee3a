from __future__ import annotations

from graph.samples import FACTS, IRIS, ROVER, loaded, rows, sample, true
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pyoxigraph import BlankNode, RdfFormat, parse

from kg.facts import PackageFacts
from kg.graph.packages import package_triples

PACKAGE = f"<package/{ROVER}/rover_base>"


def test_a_package_says_what_its_manifest_says() -> None:
    """A package has name, folder, version, description, licences and addresses."""
    assert true(
        sample(),
        f"""<repository/{ROVER}> rnkg:contains {PACKAGE} .
        {PACKAGE} a ros:Package, rnkg:Package, schema:SoftwareSourceCode ; rdfs:label "rover_base" ;
          rnkg:name "rover_base" ; rnkg:folder "rover_base" ; rnkg:rosVersion 1 ; rnkg:version "1.2.0" ;
          dcterms:description '''Drives the "rover".\\nSlowly.''' ; rnkg:manifestFormat 2 ;
          rnkg:licenseName "BSD", "Apache 2.0" ; dcterms:license <https://spdx.org/licenses/Apache-2.0> ;
          rnkg:website "http://example.org/rover base" ;
          rnkg:path "rover_base/package.xml" ; rnkg:hasPackageName <package-name/rover_base> .""",
    )


def test_people_are_maintainers_or_authors() -> None:
    """A person is identified by address and name; without an address only within the source."""
    query = """SELECT ?role ?who ?name ?mail {
      ?package ?role ?who . ?who a rnkg:Person ; rnkg:name ?name OPTIONAL { ?who rnkg:email ?mail } }"""
    assert rows(sample(), query) == [
        ("ns#author", f"person/{ROVER}/Bo", "Bo", None),
        ("ns#maintainer", "person/ada%40example.org/Ada", "Ada", "ada@example.org"),
    ]


def test_dependencies_are_on_names_and_keep_kind_and_line() -> None:
    """A package depends once on a name, and each entry of the manifest gives a purpose."""
    store = sample()
    assert rows(store, "SELECT ?n { ?p rnkg:dependsOn ?n }") == [("package-name/roscpp",)]
    query = """SELECT ?kind ?line { ?package rnkg:hasDependency ?entry .
      ?entry rnkg:onPackage/rdfs:label "roscpp" ; rnkg:dependencyKind ?kind ; rnkg:line ?line }"""
    assert rows(store, query) == [("depend", "12"), ("test_depend", "13")]


def test_files_and_problems_belong_to_the_package() -> None:
    """Files have kind, size and digest; problems have code, message and place."""
    assert true(
        sample(),
        f"""{PACKAGE} rnkg:contains ?file ; rnkg:hasProblem ?problem .
        ?file a rnkg:SourceFile ; rnkg:path "rover_base/src/main.cpp" ; rnkg:fileKind "cpp" ;
          rnkg:bytes 1204 ; rnkg:digest "ab12" .
        ?problem a rnkg:Problem ; rnkg:code "KG115" ; rnkg:message "a bracket is missing" ;
          rnkg:path "rover_base/src/wheel.cpp" ; rnkg:line 3 .""",
    )


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.builds(PackageFacts, launches=st.just(())))
def test_any_facts_make_valid_triples_without_blank_nodes(facts: PackageFacts) -> None:
    """For any facts, a strict parser reads the triples, and the same facts give the same bytes."""
    written = package_triples(facts, IRIS)
    terms = [term for quad in parse(written, format=RdfFormat.N_TRIPLES) for term in (quad.subject, quad.object)]
    assert not any(isinstance(term, BlankNode) for term in terms)
    assert package_triples(facts, IRIS) == written


def test_no_triple_is_written_twice() -> None:
    """Entities shared inside a package are described once."""
    lines = package_triples(FACTS, IRIS).splitlines()
    assert len(lines) == len(set(lines)) == len(loaded(*[package_triples(FACTS, IRIS)]))
