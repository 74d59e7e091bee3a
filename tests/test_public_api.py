"""The names and signatures that `import kg` offers; a change here affects users and belongs in the changelog."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Final

import pytest
from repository import ROOT

import kg
from kg.query.result import Boolean

if TYPE_CHECKING:
    from pathlib import Path

SIGNATURES: Final = {
    "build": "(sources: 'Sequence[str | Path]' = (), *, store: 'str | Path | None' = None, jobs: 'int | None' = None, "
    "report: 'Report | None' = None) -> 'BuildReport'",
    "compose": "(sources: 'Sequence[str]', targets: 'Sequence[str]', *, using: 'Sequence[str]' = (), "
    "ros: 'int | None' = None, length: 'int | None' = None, limit: 'int' = 5, store: 'str | Path | None' = None) "
    "-> 'list[dict[str, Any]]'",
    "find": "(text: 'str' = '', *, filters: 'Mapping[str, Sequence[str]] | None' = None, limit: 'int' = 10, "
    "store: 'str | Path | None' = None) -> 'list[dict[str, Any]]'",
    "findings": "(sources: 'Sequence[str | Path]' = (), *, launch: 'str | None' = None, package: 'str | None' = None, "
    "level: 'str' = 'note', store: 'str | Path | None' = None) -> 'list[dict[str, Any]]'",
    "infer": "(*, rules: 'Sequence[str | Path] | None' = None, full: 'bool' = False, dry_run: 'bool' = False, "
    "timeout: 'float | None' = None, store: 'str | Path | None' = None) -> 'RunReport'",
    "instances": "(launch: 'str | Path | None' = None, *, arguments: 'Mapping[str, str] | None' = None, "
    "environment: 'Mapping[str, str] | None' = None, store: 'str | Path | None' = None) -> 'list[dict[str, Any]]'",
    "nodes": "(*, package: 'str | None' = None, store: 'str | Path | None' = None) -> 'list[dict[str, Any]]'",
    "open_store": "(store: 'str | Path | None' = None) -> 'EmbeddedStore'",
    "rdflib_dataset": "(store: 'str | Path | None' = None) -> 'SnapshotDataset'",
    "sparql": "(text: 'str', *, parameters: 'Mapping[str, NamedNode | Literal] | None' = None, "
    "timeout: 'float | None' = None, limit: 'int | None' = None, store: 'str | Path | None' = None) -> 'Result'",
}
ERRORS: Final = {"GraphError", "KgError", "QueryError", "RuleError", "SourceError", "StoreError", "UsageError"}


def test_the_public_names_are_these() -> None:
    """`kg.__all__` and `dir(kg)` list the functions, the errors and the types carried by errors."""
    assert set(kg.__all__) == {*SIGNATURES, *ERRORS, "Exit", "Place", "__version__"}
    assert dir(kg) == sorted(kg.__all__)


@pytest.mark.parametrize("name", SIGNATURES)
def test_signatures_do_not_change_by_accident(name: str) -> None:
    """Each public function has the expected arguments and a docstring."""
    function = getattr(kg, name)
    assert str(inspect.signature(function)) == SIGNATURES[name]
    assert inspect.getdoc(function)


@pytest.mark.parametrize("name", sorted(ERRORS))
def test_errors_have_one_base(name: str) -> None:
    """`except kg.KgError` catches every error."""
    assert issubclass(getattr(kg, name), kg.KgError)


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    """An unknown name raises AttributeError, as in any module."""
    with pytest.raises(AttributeError, match="bild"):
        _ = kg.bild


def test_the_version_is_that_of_the_installation() -> None:
    """`kg.__version__` is the version of pyproject.toml."""
    assert f'version = "{kg.__version__}"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")


def test_a_program_builds_and_asks(tmp_path: Path) -> None:
    """Build, list and query work from Python, on a store in a folder of the user."""
    store = tmp_path / "store"
    report = kg.build([ROOT / "examples" / "workspace" / "rover"], store=store, jobs=1)
    assert report.read == 2
    assert {node["package"] for node in kg.nodes(store=store)} == {"rover_robot"}
    answer = kg.sparql('ASK { ?node rnkg:name "base_controller" }', store=store)
    assert isinstance(answer, Boolean)
    assert answer
    assert kg.build(store=store).read == 0
    rules = tmp_path / "rules" / "mine"
    rules.mkdir(parents=True)
    (rules / "copy.rq").write_text(
        "CONSTRUCT { ?node <urn:called> ?name } WHERE { ?node a rnkg:NodeType ; rnkg:name ?name }"
    )
    assert kg.infer(rules=[rules.parent], store=store).added == len(kg.nodes(store=store))
    assert kg.infer(rules=[rules.parent], store=store).mode == "incremental"


def test_without_a_store_the_error_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A query without a store raises KG301, with the exit code for stores."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(kg.StoreError) as caught:
        kg.nodes()
    assert (caught.value.code, caught.value.exit_code) == ("KG301", kg.Exit.STORE)
