"""A managed node of Jazzy independent of `kg`: plain Cyclone DDS, with handwritten classes of ROS 2.

    python managed.py DOMAIN

The node `/base` is inactive. It subscribes to `/cmd_vel`, publishes `/reading`, whose type only it can describe, and
`/riddle`, which it does not describe, and has parameters. It prints "ready" and runs until its standard input is
closed, each line of which is the number of another state.
Like rclcpp, it returns no values at all if a requested one is not set, and describes a type by its hash.
"""

from __future__ import annotations

import select
import sys
from typing import Any

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import types as idl
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from robot.dds.peer import HEADER, TOLD, Gid, Info, NodeInfo, Twist, _made

# the type checker cannot see the library's generics
array: Any = idl.array
sequence: Any = idl.sequence
float64, int64, uint8, uint64 = idl.float64, idl.int64, idl.uint8, idl.uint64

HASH = "RIHS01_" + 8 * "01234567"
RELIABLE = (Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))


def _message(package: str, called: str, /, **fields: Any) -> Any:
    return _made(f"{package}.msg.dds_.{called}_", fields)


def _service(package: str, name: str, request: dict[str, Any], response: dict[str, Any]) -> tuple[Any, Any]:
    whole = f"{package}.srv.dds_.{name}"
    return _made(f"{whole}_Request_", {**HEADER, **request}), _made(f"{whole}_Response_", {**HEADER, **response})


ParameterValue = _message(
    "rcl_interfaces",
    "ParameterValue",
    type=uint8,
    bool_value=bool,
    integer_value=int64,
    double_value=float64,
    string_value=str,
    byte_array_value=sequence[uint8],
    bool_array_value=sequence[bool],
    integer_array_value=sequence[int64],
    double_array_value=sequence[float64],
    string_array_value=sequence[str],
)
Parameter = _message("rcl_interfaces", "Parameter", name=str, value=ParameterValue)
DoubleRange = _message("rcl_interfaces", "FloatingPointRange", from_value=float64, to_value=float64, step=float64)
IntegerRange = _message("rcl_interfaces", "IntegerRange", from_value=int64, to_value=int64, step=uint64)
Descriptor = _message(
    "rcl_interfaces",
    "ParameterDescriptor",
    name=str,
    type=uint8,
    description=str,
    additional_constraints=str,
    read_only=bool,
    dynamic_typing=bool,
    floating_point_range=sequence[DoubleRange],
    integer_range=sequence[IntegerRange],
)
Names = _message("rcl_interfaces", "ListParametersResult", names=sequence[str], prefixes=sequence[str])
Result = _message("rcl_interfaces", "SetParametersResult", successful=bool, reason=str)
State = _message("lifecycle_msgs", "State", id=uint8, label=str)
Transition = _message("lifecycle_msgs", "Transition", id=uint8, label=str)
Event = _message(
    "lifecycle_msgs", "TransitionEvent", timestamp=uint64, transition=Transition, start_state=State, goal_state=State
)
FieldType = _message(
    "type_description_interfaces",
    "FieldType",
    type_id=uint8,
    capacity=uint64,
    string_capacity=uint64,
    nested_type_name=str,
)
Field = _message("type_description_interfaces", "Field", name=str, type=FieldType, default_value=str)
Individual = _message("type_description_interfaces", "IndividualTypeDescription", type_name=str, fields=sequence[Field])
Description = _message(
    "type_description_interfaces",
    "TypeDescription",
    type_description=Individual,
    referenced_type_descriptions=sequence[Individual],
)
Source = _message("type_description_interfaces", "TypeSource", type_name=str, encoding=str, raw_file_contents=str)
KeyValue = _message("type_description_interfaces", "KeyValue", key=str, value=str)
Spot = _message("newer_msgs", "Spot", x=float64, label=str)
Reading = _message("newer_msgs", "Reading", spots=sequence[Spot], three=array[idl.int16, 3], fine=bool)
Riddle = _message("newer_msgs", "Riddle", x=float64)

_RCL = "rcl_interfaces"
SERVICES: dict[str, tuple[Any, Any]] = {
    "list_parameters": _service(
        _RCL, "ListParameters", {"prefixes": sequence[str], "depth": uint64}, {"result": Names}
    ),
    "describe_parameters": _service(
        _RCL, "DescribeParameters", {"names": sequence[str]}, {"descriptors": sequence[Descriptor]}
    ),
    "get_parameters": _service(_RCL, "GetParameters", {"names": sequence[str]}, {"values": sequence[ParameterValue]}),
    "set_parameters": _service(
        _RCL, "SetParameters", {"parameters": sequence[Parameter]}, {"results": sequence[Result]}
    ),
    "get_state": _service(
        "lifecycle_msgs", "GetState", {"structure_needs_at_least_one_member": uint8}, {"current_state": State}
    ),
    "get_type_description": _service(
        "type_description_interfaces",
        "GetTypeDescription",
        {"type_name": str, "type_hash": str, "include_type_sources": bool},
        {
            "successful": bool,
            "failure_reason": str,
            "type_description": Description,
            "type_sources": sequence[Source],
            "extra_information": sequence[KeyValue],
        },
    ),
}
LABELS = {1: "unconfigured", 2: "inactive", 3: "active", 4: "finalized", 13: "activating"}


def value(kind: int, **told: Any) -> Any:
    """Return a ParameterValue."""
    empty: dict[str, Any] = {"bool_value": False, "integer_value": 0, "double_value": 0.0, "string_value": ""}
    empty |= {key: [] for key in (f"{one}_array_value" for one in ("byte", "bool", "integer", "double", "string"))}
    return ParameterValue(type=kind, **{**empty, **told})


def described(name: str, kind: int, words: str = "", **more: Any) -> Any:
    """Return a ParameterDescriptor."""
    rest = {"read_only": False, "floating_point_range": [], "integer_range": [], **more}
    return Descriptor(name=name, type=kind, description=words, additional_constraints="", dynamic_typing=False, **rest)


def individual(name: str, /, **fields: tuple[int, int, str]) -> Any:
    """Return the description of a message: its fields with type number, length, and message name."""
    every = [Field(field, FieldType(kind, many, 0, nested), "") for field, (kind, many, nested) in fields.items()]
    return Individual(name, every)


class Managed:
    """The node, written by hand."""

    def __init__(self, domain: int) -> None:
        self.participant = DomainParticipant(domain)
        self.readers: list[bytes] = []
        self.writers: list[bytes] = []
        self.state = 2
        self.values = {
            "speed": value(3, double_value=0.5),
            "mode": value(4, string_value="slow"),
            "serial": value(4, string_value="A1"),
            "gains": value(8, double_array_value=[1.0, 0.5]),
            "unset": value(0),
        }
        self.descriptors = {
            "speed": described("speed", 3, "how fast, in m/s", floating_point_range=[DoubleRange(0.0, 2.0, 0.0)]),
            "mode": described("mode", 4),
            "serial": described("serial", 4, read_only=True),
            "gains": described("gains", 8),
            "unset": described("unset", 2),
        }
        self.cmd_vel = self._reader("rt/cmd_vel", Twist)
        self.reading = self._writer("rt/reading", Reading, HASH)
        self.riddle = self._writer("rt/riddle", Riddle, HASH.swapcase())
        self.event = self._writer("rt/base/transition_event", Event)
        self.served = {
            name: (
                self._reader(f"rq/base/{name}Request", request),
                self._writer(f"rr/base/{name}Reply", response),
                response,
            )
            for name, (request, response) in SERVICES.items()
        }
        self.info = DataWriter(self.participant, Topic(self.participant, "ros_discovery_info", Info), qos=TOLD)
        node = NodeInfo("/", "base", *([Gid(list(one)) for one in side] for side in (self.readers, self.writers)))
        self.info.write(Info(Gid(list(self.participant.guid.bytes)), [node]))

    def _writer(self, topic: str, kind: type, digest: str = "") -> Any:
        data = [Policy.Userdata(f"typehash={digest};".encode())] if digest else []
        made: Any = DataWriter(self.participant, Topic(self.participant, topic, kind), qos=Qos(*RELIABLE, *data))
        self.writers.append(made.guid.bytes)
        return made

    def _reader(self, topic: str, kind: type) -> Any:
        made: Any = DataReader(self.participant, Topic(self.participant, topic, kind), qos=Qos(*RELIABLE))
        self.readers.append(made.guid.bytes)
        return made

    def step(self) -> None:
        """Publish, and answer pending requests."""
        self.reading.write(Reading([Spot(0.5, "here")], [1, 2, 3], True))
        for name, (requests, responses, response) in self.served.items():
            for request in requests.take(10):
                if not request.sample_info.valid_data:
                    continue  # a client has gone
                responses.write(response(request.guid, request.seq, *getattr(self, f"_{name}")(request)))

    def become(self, state: int) -> None:
        """Enter another state, and publish it."""
        before, self.state = self.state, state
        self.event.write(Event(0, Transition(0, ""), State(before, LABELS[before]), State(state, LABELS[state])))

    def _get_state(self, _: Any) -> tuple[Any, ...]:
        return (State(self.state, LABELS[self.state]),)

    def _list_parameters(self, _: Any) -> tuple[Any, ...]:
        return (Names([*self.values], []),)

    def _describe_parameters(self, request: Any) -> tuple[Any, ...]:
        return ([self.descriptors[name] for name in request.names],)

    def _get_parameters(self, request: Any) -> tuple[Any, ...]:
        found = [self.values[name] for name in request.names]
        return ([] if any(one.type == 0 for one in found) else found,)

    def _set_parameters(self, request: Any) -> tuple[Any, ...]:
        return ([self._set(one) for one in request.parameters],)

    def _set(self, one: Any) -> Any:
        if one.value.type != self.descriptors[one.name].type:
            return Result(False, "Wrong parameter type")
        if one.name == "mode" and one.value.string_value not in {"slow", "fast"}:
            return Result(False, "only slow and fast")
        self.values[one.name] = one.value
        return Result(True, "")

    def _get_type_description(self, request: Any) -> tuple[Any, ...]:
        if (request.type_name, request.type_hash) != ("newer_msgs/msg/Reading", HASH):
            return False, "Type not currently in use by this node", Description(individual(""), []), [], []
        whole = individual(
            "newer_msgs/msg/Reading", spots=(145, 0, "newer_msgs/msg/Spot"), three=(52, 3, ""), fine=(15, 0, "")
        )
        spot = individual("newer_msgs/msg/Spot", x=(11, 0, ""), label=(17, 0, ""))
        return True, "", Description(whole, [spot]), [], []


def main() -> None:
    """Run until the standard input is closed; a line is the number of the next state."""
    node = Managed(int(sys.argv[1]))
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    while True:
        node.step()
        if select.select([sys.stdin], [], [], 0.02)[0]:
            line = sys.stdin.readline()
            if not line:
                return
            node.become(int(line))


if __name__ == "__main__":
    main()
