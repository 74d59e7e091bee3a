"""Capabilities of a system or a package of the store: the view `capabilities`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgspec

from kg.errors import UsageError
from kg.graph.iris import Iris
from kg.robot.capabilities import added, capabilities_of, package_iri
from kg.views.systems import system_named

if TYPE_CHECKING:
    from kg.robot.capability import Capabilities
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def capabilities(
    snapshot: EmbeddedSnapshot, settings: Settings, *, system: str = "", package: str = "", every: str = ""
) -> dict[str, Any]:
    """Return the capabilities of a launch configuration, a running system, or a package.

    `system` is named as in the view `system`, `package` is `name` or `repository:name`. With both, only what the
    package would add is there. Without `every` (any text) general capabilities, which others imply, are left out.
    The answer is `{"of", "general", "capabilities"}`: `general` is how many were left out, the objects are those of
    `kg robot capabilities --json` without the keys that are empty.

    Raises:
        UnknownNameError: KG422 for a system and KG001 for a package that the store does not have.
        UsageError: KG003 when neither is named, or when several are called so.
    """
    if not system and not package:
        raise UsageError("KG003", "name a system or a package", hint="Give `system` or `package`.")
    if not package:
        selected = _of_system(snapshot, settings, system)
    else:
        selected = capabilities_of(snapshot, package_iri(snapshot, package), package)
        selected = added(selected, _of_system(snapshot, settings, system)) if system else selected
    chosen = [one for one in selected.capabilities if every or one.ways]
    return {
        "of": selected.of,
        "general": len(selected.capabilities) - len(chosen),
        "capabilities": msgspec.to_builtins(chosen),
    }


def _of_system(snapshot: EmbeddedSnapshot, settings: Settings, name: str) -> Capabilities:
    configuration = system_named(snapshot, name, base=settings.base)
    iri = Iris(settings.base).configuration(configuration.repository, configuration.path)
    return capabilities_of(snapshot, iri, configuration.name)
