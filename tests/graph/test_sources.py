from __future__ import annotations

from graph.samples import FACTS, IRIS, REPOSITORY, ROVER, loaded, rows, sample, source_triples, true

from kg.facts import Problem, Repository
from kg.graph.packages import package_triples, repository_triples


def test_a_repository_says_which_commit_was_read() -> None:
    """A repository has name, commit, branch, address and state, but not its folder on this machine."""
    store = sample()
    assert true(
        store,
        f"""<repository/{ROVER}> a rnkg:Repository ; rdfs:label "{ROVER}" ; rnkg:name "{ROVER}" ;
        rnkg:commit "0123456789abcdef" ; rnkg:branch "main" ;
          rnkg:remote "https://github.com/acme/rover" ; rnkg:dirty false .""",
    )
    assert not [quad for quad in store if REPOSITORY.root in str(quad)]


def test_a_folder_without_git_has_no_commit() -> None:
    """A plain folder has no commit and no branch."""
    store = loaded(repository_triples(Repository("local/ws", "/ws"), IRIS))
    assert not true(store, "?r rnkg:commit|rnkg:branch|rnkg:remote ?x")


def test_problems_outside_packages_belong_to_the_repository() -> None:
    """A problem outside packages belongs to the repository; two in one file are distinct."""
    problems = [Problem("KG110", "no right to read it", "secret"), Problem("KG110", "again", "secret")]
    store = loaded(repository_triples(REPOSITORY, IRIS, problems))
    query = "SELECT ?m { ?r a rnkg:Repository ; rnkg:hasProblem/rnkg:message ?m }"
    assert rows(store, query) == [("again",), ("no right to read it",)]


def test_the_graph_of_a_source_is_its_packages_and_itself() -> None:
    """Packages can be written separately, in any process, and combined."""
    parts = repository_triples(REPOSITORY, IRIS) + package_triples(FACTS, IRIS)
    assert source_triples(REPOSITORY, [FACTS], IRIS) == parts
