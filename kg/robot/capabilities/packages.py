"""Packages of a store by name, and what one would add."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgspec
from pyoxigraph import Literal, Variable

from kg.errors import UnknownNameError, UsageError
from kg.graph import vocabulary as v
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from kg.robot.capability import Capabilities
    from kg.store.snapshot import EmbeddedSnapshot

__all__ = ["added", "package_iri"]

_PACKAGES = """SELECT ?iri ?name ?repository WHERE {
  ?owner <%(rnkg)scontains> ?iri ; <%(rnkg)sname> ?repository .
  ?iri a <%(rnkg)sPackage> ; <%(rnkg)sname> ?name .
} ORDER BY ?repository""" % {"rnkg": v.RNKG}  # noqa: UP031 - braces are those of SPARQL


def added(subject: Capabilities, base: Capabilities) -> Capabilities:
    """Return those capabilities that something has and something else does not."""
    known = {one.iri for one in base.capabilities}
    return msgspec.structs.replace(
        subject, capabilities=tuple(one for one in subject.capabilities if one.iri not in known)
    )


def package_iri(snapshot: EmbeddedSnapshot, name: str) -> str:
    """Return the IRI of a package, `name` or `repository:name`.

    Raises:
        UnknownNameError: KG001 when there is none of that name.
        UsageError: KG003 when there are several.
    """
    repository, _, plain = name.rpartition(":")
    rows: Any = snapshot.query(_PACKAGES, substitutions={Variable("name"): Literal(plain)})
    found = [(row["iri"].value, row["repository"].value) for row in rows]
    found = [one for one in found if repository in {"", one[1]}]
    if not found:
        every: Any = snapshot.query(_PACKAGES)
        hint = did_you_mean(plain, {row["name"].value for row in every}) or "`kg packages` lists those of the store."
        raise UnknownNameError("KG001", f"the store has no package `{name}`", hint=hint)
    if len(found) > 1:
        ways = "\n".join(f"`{source}:{plain}`" for _, source in found)
        raise UsageError("KG003", f"{len(found)} packages are called `{plain}`; say which", hint=ways)
    return str(found[0][0])
