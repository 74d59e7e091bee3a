"""Functions of other packages that make actions, known by what they start: `controller_manager.launch_utils`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.texts import reason_of, to_text, unknown_text
from kg.extract.launch.expressions.values import Guarded, Items, Substitution, Table
from kg.extract.launch.ros2.actions import DeclareArgument, NodeAction
from kg.extract.launch.ros2.python.values import Description

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.values import Text, Value
    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.python.call import Call

__all__ = ["CONTROL"]

_MANAGER: Final = "controller_manager_name"


def _spawners(call: Call) -> Value:
    """Return the description of a node that loads the named controllers."""
    return _spawner(call, call.value("controller_names", 0), ())


def _spawners_of_files(call: Call) -> Value:
    """Return the description of a node that loads controllers with files of parameters."""
    table = call.value("controller_info_dict", 0)
    if not isinstance(table, Table):
        return _spawner(call, table, ())
    files: list[Text] = []
    for value in table.values():
        for file in value if isinstance(value, Items | tuple) else [value]:
            files += [("--param-file",), to_text(file)] if file else []
    return _spawner(call, call.machine.items(table), tuple(files))


def _spawner(call: Call, names: Value, files: tuple[Text, ...]) -> Value:
    found = call.machine.iterate(names)
    controllers = tuple(to_text(name) for name in found) if found is not None else (unknown_text(reason_of(names)),)
    extra = call.machine.iterate(call.value("extra_spawner_args", 1) or ()) or []
    manager: Text = (Substitution("var", ((_MANAGER,),)),)
    node = NodeAction(
        location=call.location,
        package=("controller_manager",),
        executable=("spawner",),
        arguments=(
            *controllers,
            ("--controller-manager",),
            manager,
            *files,
            *(to_text(value) for value in extra if not isinstance(value, Guarded)),
        ),
    )
    declared: list[Action] = [DeclareArgument(location=call.location, name=_MANAGER, default=("controller_manager",))]
    return Description(call.machine.items([*declared, node]))


CONTROL: Final[dict[str, Callable[[Call], Value]]] = {
    "generate_controllers_spawner_launch_description": _spawners,
    "generate_controllers_spawner_launch_description_from_dict": _spawners_of_files,
}
