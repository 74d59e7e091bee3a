"""A peer independent of `kg`: plain Cyclone DDS, with handwritten classes and names of ROS 2.

    python peer.py DOMAIN

It has the nodes `/robot/base` and `/tester`. `/robot/base` publishes `/chatter` (reliable) and `/scan` (best effort, to
which `/tester` subscribes reliably), repeats messages of `/cmd_vel` on `/echo`, serves `/add_two_ints` and executes
`/count`; `/tester` calls any server of `/double` and publishes the sum on `/told`. It prints "ready", runs until its
standard input is closed, and needs ROS 2's names only: `rt/`, `rq/`, `rr/`, `dds_`.
"""

from __future__ import annotations

import select
import sys
from typing import Any

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import make_idl_struct
from cyclonedds.idl import types as idl
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

# the type checker cannot see the library's generics
array: Any = idl.array
sequence: Any = idl.sequence
float64, int8, int32, int64 = idl.float64, idl.int8, idl.int32, idl.int64
uint8, uint32, uint64 = idl.uint8, idl.uint32, idl.uint64


def _made(name: str, fields: dict[str, Any]) -> Any:
    return make_idl_struct(name.rpartition(".")[2], name, fields)


HEADER = {"guid": uint64, "seq": int64}

Gid = _made("rmw_dds_common.msg.dds_.Gid_", {"data": array[uint8, 16]})
NodeInfo = _made(
    "rmw_dds_common.msg.dds_.NodeEntitiesInfo_",
    {"node_namespace": str, "node_name": str, "reader_gid_seq": sequence[Gid], "writer_gid_seq": sequence[Gid]},
)
Info = _made(
    "rmw_dds_common.msg.dds_.ParticipantEntitiesInfo_", {"gid": Gid, "node_entities_info_seq": sequence[NodeInfo]}
)
String = _made("std_msgs.msg.dds_.String_", {"data": str})
Vector3 = _made("geometry_msgs.msg.dds_.Vector3_", {"x": float64, "y": float64, "z": float64})
Twist = _made("geometry_msgs.msg.dds_.Twist_", {"linear": Vector3, "angular": Vector3})
SumRequest = _made("example_interfaces.srv.dds_.AddTwoInts_Request_", {**HEADER, "a": int64, "b": int64})
SumResponse = _made("example_interfaces.srv.dds_.AddTwoInts_Response_", {**HEADER, "sum": int64})
DoubleRequest = _made("kg_test.srv.dds_.Double_Request_", {**HEADER, "value": float64})
DoubleResponse = _made("kg_test.srv.dds_.Double_Response_", {**HEADER, "value": float64, "remark": str})
Uuid = _made("unique_identifier_msgs.msg.dds_.UUID_", {"uuid": array[uint8, 16]})
Time = _made("builtin_interfaces.msg.dds_.Time_", {"sec": int32, "nanosec": uint32})
Goal = _made("kg_test.action.dds_.Count_Goal_", {"until": int32})
Result = _made("kg_test.action.dds_.Count_Result_", {"reached": int32})
Feedback = _made("kg_test.action.dds_.Count_Feedback_", {"now": int32})
FeedbackMessage = _made("kg_test.action.dds_.Count_FeedbackMessage_", {"goal_id": Uuid, "feedback": Feedback})
SendGoalRequest = _made("kg_test.action.dds_.Count_SendGoal_Request_", {**HEADER, "goal_id": Uuid, "goal": Goal})
SendGoalResponse = _made("kg_test.action.dds_.Count_SendGoal_Response_", {**HEADER, "accepted": bool, "stamp": Time})
GetResultRequest = _made("kg_test.action.dds_.Count_GetResult_Request_", {**HEADER, "goal_id": Uuid})
GetResultResponse = _made("kg_test.action.dds_.Count_GetResult_Response_", {**HEADER, "status": int8, "result": Result})
Unheard = _made("unheard_msgs.msg.dds_.Part_", {"x": float64, "name": str})
UnheardWhole = _made(
    "unheard_msgs.msg.dds_.Whole_", {"parts": sequence[Unheard], "three": array[int32, 3], "fine": bool}
)


RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
BEST_EFFORT = Qos(Policy.Reliability.BestEffort)
TOLD = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.TransientLocal, Policy.History.KeepAll)


class Peer:
    """Two nodes, written by hand."""

    def __init__(self, domain: int) -> None:
        self.participant = DomainParticipant(domain)
        self.base: tuple[list[bytes], list[bytes]] = ([], [])
        self.tester: tuple[list[bytes], list[bytes]] = ([], [])
        self.chatter = self._writer("rt/chatter", String, self.base)
        self.scan = self._writer("rt/scan", Vector3, self.base, BEST_EFFORT)
        self.unheard = self._writer("rt/unheard", UnheardWhole, self.base)
        self.cmd_vel = self._reader("rt/cmd_vel", Twist, self.base)
        self.echo = self._writer("rt/echo", Twist, self.base)
        self.sums = self._reader("rq/add_two_intsRequest", SumRequest, self.base)
        self.sum = self._writer("rr/add_two_intsReply", SumResponse, self.base)
        self.goals = self._reader("rq/count/_action/send_goalRequest", SendGoalRequest, self.base)
        self.accepted = self._writer("rr/count/_action/send_goalReply", SendGoalResponse, self.base)
        self.results = self._reader("rq/count/_action/get_resultRequest", GetResultRequest, self.base)
        self.result = self._writer("rr/count/_action/get_resultReply", GetResultResponse, self.base)
        self.feedback = self._writer("rt/count/_action/feedback", FeedbackMessage, self.base)
        self.listening = self._reader("rt/scan", Vector3, self.tester)
        self.asking = self._writer("rq/doubleRequest", DoubleRequest, self.tester)
        self.asked = self._reader("rr/doubleReply", DoubleResponse, self.tester)
        self.told = self._writer("rt/told", String, self.tester)
        self.info = DataWriter(self.participant, Topic(self.participant, "ros_discovery_info", Info), qos=TOLD)
        self.until = 0
        self.tell("/robot", "base")

    def _writer(self, topic: str, kind: type, node: tuple[list[bytes], list[bytes]], qos: Qos = RELIABLE) -> Any:
        made: Any = DataWriter(self.participant, Topic(self.participant, topic, kind), qos=qos)
        node[1].append(made.guid.bytes)
        return made

    def _reader(self, topic: str, kind: type, node: tuple[list[bytes], list[bytes]]) -> Any:
        made: Any = DataReader(self.participant, Topic(self.participant, topic, kind), qos=RELIABLE)
        node[0].append(made.guid.bytes)
        return made

    def tell(self, namespace: str, name: str) -> None:
        """Announce the two nodes, the first by this name."""
        nodes = [
            NodeInfo(where, called, *([Gid(list(one)) for one in side] for side in ends))
            for where, called, ends in ((namespace, name, self.base), ("/", "tester", self.tester))
        ]
        self.info.write(Info(Gid(list(self.participant.guid.bytes)), nodes))

    def step(self) -> None:
        """Publish, and answer pending requests."""
        self.chatter.write(String("hello"))
        self.scan.write(Vector3(1.0, 2.0, 3.0))
        self.unheard.write(UnheardWhole([Unheard(0.5, "half")], [1, 2, 3], True))
        for twist in self.cmd_vel.take(10):
            self.echo.write(Twist(twist.linear, twist.angular))
        for request in self.sums.take(10):
            self.sum.write(SumResponse(request.guid, request.seq, request.a + request.b))
        for goal in self.goals.take(10):
            self.until = goal.goal.until
            self.accepted.write(SendGoalResponse(goal.guid, goal.seq, goal.goal.until >= 0, Time(7, 8)))
            for now in range(self.until):
                self.feedback.write(FeedbackMessage(goal.goal_id, Feedback(now + 1)))
        for request in self.results.take(10):
            self.result.write(GetResultResponse(request.guid, request.seq, 4, Result(self.until)))
        if self.asking.get_matched_subscriptions():
            self.asking.write(DoubleRequest(77, 5, 21.0))
        for response in self.asked.take(10):
            self.told.write(String(f"{response.guid} {response.seq} {response.value} {response.remark}"))


def main() -> None:
    """Run until the standard input is closed; a line `NAMESPACE NAME` renames the first node."""
    peer = Peer(int(sys.argv[1]))
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    while True:
        peer.step()
        if select.select([sys.stdin], [], [], 0.05)[0]:
            line = sys.stdin.readline()
            if not line:
                return
            peer.tell(*line.split())


if __name__ == "__main__":
    main()
