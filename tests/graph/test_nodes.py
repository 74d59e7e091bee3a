from __future__ import annotations

from graph.samples import IRIS, MAIN, REPOSITORY, ROVER, loaded, rows, sample, source_triples, true

from kg.facts import Import, Location, NodeKind, NodeType, Package, PackageFacts


def test_a_node_says_what_it_is_and_where() -> None:
    """A node has kind, language, version of ROS, own name, executable, sources and evidence."""
    node = f"<node/{ROVER}/rover_base/driver>"
    assert true(
        sample(),
        f"""<package/{ROVER}/rover_base> rnkg:contains {node} .
        {node} a ros:Node, rnkg:NodeType ; rdfs:label "driver" ; rnkg:name "driver" ; rnkg:kind rnkg:executable ;
          rnkg:language "cpp" ; rnkg:rosVersion 1 ; rnkg:nodeName "rover_driver" ;
          rnkg:hasExecutable <executable/{ROVER}/rover_base/driver> ;
          rnkg:path "rover_base/src/main.cpp" ; rnkg:line {MAIN.line} ;
          rnkg:declaredIn <file/{ROVER}/-/rover_base/src/main.cpp> .
        <executable/{ROVER}/rover_base/driver> a rnkg:Executable ; rnkg:name "driver" .""",
    )


def test_sources_of_a_node_have_paths() -> None:
    """Each source file of a node has its path, listed by the package or not."""
    expected = [("rover_base/src/main.cpp",), ("rover_base/src/wheel.cpp",)]
    assert rows(sample(), "SELECT ?p { ?n rnkg:hasSource/rnkg:path ?p }") == expected


def test_a_parameter_keeps_what_is_known_of_it() -> None:
    """A parameter has name, type, default, access, purpose and place."""
    assert true(
        sample(),
        f"""<node/{ROVER}/rover_base/driver> rnkg:hasParameter <node/{ROVER}/rover_base/driver#parameter/~/port> .
        <node/{ROVER}/rover_base/driver#parameter/~/port> a rnkg:Parameter ; rnkg:name "~/port" ;
          rnkg:parameterType "string" ; rnkg:defaultValue "/dev/ttyUSB0" ; rnkg:access rnkg:read ; rnkg:line 10 ;
          rnkg:resolution rnkg:literal ; rnkg:implicit false ; dcterms:description "The serial port." .""",
    )


def test_two_nodes_of_one_name_stay_two() -> None:
    """An executable and a class of the same name in one package are not merged."""
    nodes = tuple(NodeType("n", kind, "cpp", 1, Location("a.cpp", 1)) for kind in (NodeKind.EXECUTABLE, NodeKind.CLASS))
    facts = PackageFacts(ROVER, Package("p", "p", 1, Location("p/package.xml", 1)), nodes)
    store = loaded(source_triples(REPOSITORY, [facts], IRIS))
    query = 'SELECT ?n (COUNT(?k) AS ?kinds) { ?n a rnkg:NodeType ; rnkg:name "n" ; rnkg:kind ?k } GROUP BY ?n'
    assert [row[1] for row in rows(store, query)] == ["1", "1"]


def test_an_import_is_there_with_what_holds_it() -> None:
    """A rule can match a library as a whole, and one of its modules; each name has its place."""
    imported = (Import("RPi.GPIO", Location("a.py", 2)), Import("pcl/io/pcd.h", MAIN), Import("termios.h", MAIN))
    node = NodeType("n", NodeKind.SCRIPT, "python", 1, Location("a.py", 1), imports=imported)
    facts = PackageFacts(ROVER, Package("p", "p", 1, Location("p/package.xml", 1)), (node,))
    store = loaded(source_triples(REPOSITORY, [facts], IRIS))
    names = [row[0] for row in rows(store, "SELECT ?i { ?n rnkg:imports ?i } ORDER BY ?i")]
    assert names == ["RPi", "RPi.GPIO", "pcl", "pcl/io", "pcl/io/pcd.h", "termios.h"]
    assert true(store, '?n rnkg:importedAt "RPi.GPIO a.py:2"')
