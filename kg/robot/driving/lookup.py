"""Capabilities by the names that people use for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from kg.errors import RobotError
from kg.similar import did_you_mean, folded

if TYPE_CHECKING:
    from kg.robot.capability import Capabilities, Capability

__all__ = ["find"]


def find(capabilities: Capabilities, name: str, modality: Literal["read", "write"] | None = None) -> Capability:
    """Return the capability of a name, label or alternative label, whatever its case, that is read or done.

    Raises:
        RobotError: KG821 when there is none, with those that were probably meant; KG822 for one that is only there the
            other way, or that cannot be reached.
    """
    wanted = folded(name)
    named = [one for one in capabilities.capabilities if folded(one.name) == wanted or one.iri == name]
    found = named or [
        one for one in capabilities.capabilities if wanted in {folded(each) for each in (one.label, *one.alternatives)}
    ]
    if not found:
        raise _unknown(capabilities, name, modality)
    fitting = [one for one in found if modality in {None, one.modality}]
    if not fitting:
        can = "be done" if found[0].modality == "write" else "be read"
        raise RobotError("KG822", f"`{found[0].name}` can only {can}", hint=_other(found[0]))
    return min(fitting, key=lambda one: not one.ways)


def _other(capability: Capability) -> str:
    return f"Use `kg robot {'do' if capability.modality == 'write' else 'read'} {capability.name}`."


def _unknown(capabilities: Capabilities, name: str, modality: str | None) -> RobotError:
    known = [one for one in capabilities.capabilities if modality in {None, one.modality} and one.ways]
    words = {each: one.name for one in reversed(known) for each in (one.name, one.label, *one.alternatives)}
    hint = did_you_mean(name, words)
    if hint is None:
        listed = ", ".join(f"`{one.name}`" for one in known)
        hint = f"It can: {listed}." if listed else "No capabilities of it are known."
    return RobotError("KG821", f"{capabilities.of} has no capability `{name}`", hint=hint)
