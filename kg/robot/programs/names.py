"""Names of capabilities and parameters in programs: those of the ontology, or labels."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, Literal

from kg.errors import RobotError
from kg.robot.driving.ways import find
from kg.robot.programs.tree import Program, rewritten
from kg.similar import did_you_mean, folded

if TYPE_CHECKING:
    from kg.robot.capability import Capabilities, Capability, Parameter

AT: Final = "at"
"""The argument for a place, which sets x, y and the capability's other position parameters."""


class CapabilityIndex:
    """The capabilities that a program may use, found by name or label."""

    def __init__(self, capabilities: Capabilities) -> None:
        self._capabilities = capabilities
        self._cache: dict[tuple[str, str], Capability] = {}

    def read(self, name: str) -> Capability:
        """Return a readable capability; RobotError KG832 if it is missing, KG834 if it can only be executed."""
        return self._one(name, "read")

    def write(self, name: str) -> Capability:
        """Return an executable capability; RobotError KG832 if it is missing, KG834 if it can only be read."""
        return self._one(name, "write")

    def _one(self, name: str, modality: Literal["read", "write"]) -> Capability:
        if (name, modality) not in self._cache:
            try:
                self._cache[name, modality] = find(self._capabilities, name, modality)
            except RobotError as error:
                if error.code != "KG821":
                    raise _other_way(find(self._capabilities, name)) from error
                fitting = [one for one in self._capabilities.capabilities if one.modality == modality]
                reached = [one for one in fitting if one.ways] or fitting
                words = [word for one in reached for word in (one.name, one.label, *one.alternatives)]
                raise RobotError("KG832", error.message, hint=did_you_mean(name, words)) from error
        return self._cache[name, modality]

    def argument(self, capability: Capability, name: str) -> str:
        """Return the name of an argument's parameter, or that of the place; RobotError KG832 if it is missing."""
        return name if takes_place(capability, name) else self.parameter(capability, name).name

    @staticmethod
    def parameter(capability: Capability, name: str) -> Parameter:
        """Return a parameter by its name or label; RobotError KG832 if it is missing."""
        wanted = folded(name)
        for parameter in capability.parameters:
            if wanted in {folded(parameter.name), folded(parameter.label)}:
                return parameter
        names = [parameter.name for parameter in capability.parameters]
        hint = did_you_mean(name, names) or f"`{capability.label}` has: {', '.join(names) or 'no parameters'}."
        raise RobotError("KG832", f"`{capability.label}` has no `{name}`", hint=hint)


def takes_place(capability: Capability, name: str) -> bool:
    """Return whether a name is that of the place argument, for a capability that has one."""
    names = {one.name for one in capability.parameters}
    return name == AT and AT not in names and {"x", "y"} <= names


def _other_way(capability: Capability) -> RobotError:
    """Return the error for a capability that can only be read, or only be executed, and is used the other way."""
    if capability.modality == "read":
        hint = f"Use its reading in a condition or a value: `... of {capability.name}`."
        return RobotError("KG834", f"`{capability.label}` is something to sense, not to do", hint=hint)
    hint = f"Write `{capability.label}` as a statement of its own."
    return RobotError("KG834", f"`{capability.label}` is an action, not a reading", hint=hint)


def named(program: Program, capabilities: Capabilities) -> Program:
    """Return a program with names instead of labels; unknown ones are unchanged."""
    index = CapabilityIndex(capabilities)

    def change(part: dict[str, Any]) -> dict[str, Any]:
        if "capability" not in part:
            return part
        with suppress(RobotError):
            if part.get("expression") == "read":
                capability = index.read(part["capability"])
                part["parameter"] = index.parameter(capability, part["parameter"]).name
            else:
                capability = index.write(part["capability"])
                arguments = part.get("arguments", {})
                part["arguments"] = {index.argument(capability, name): value for name, value in arguments.items()}
            part["capability"] = capability.name
        return part

    return rewritten(program, change)
