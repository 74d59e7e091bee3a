"""What differs between a node in rospy and one in rclpy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Protocol

if TYPE_CHECKING:
    from kg.robot.capability import Way

__all__ = ["Dialect", "Rclpy", "Rospy"]

_HANDLING: Final = (
    "for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):",
    "    if signal.getsignal(number) != signal.SIG_IGN:  # as under nohup",
    "        signal.signal(number, node.on_signal)",
)
"""How both dialects let signals end a program: a handler sets a flag, and every part of the program looks at it."""


class Dialect(Protocol):
    """Writes the parts of a node that depend on the library; lines are not indented."""

    ros: int
    base: str
    clock: str
    ended: str

    def imports(self, *, goals: bool, topics: bool) -> list[str]:
        """Return the imports that every node needs, those of action clients and of subscriptions."""

    def types(self, way: Way, *, read: bool) -> list[tuple[str, str]]:
        """Return the module and name of each class that a way needs."""

    def begin(self, name: str) -> list[str]:
        """Return what stands first in the constructor of a node."""

    def publisher(self, attribute: str, way: Way) -> list[str]:
        """Return the statement that makes a publisher."""

    def subscriber(self, callback: str, way: Way) -> list[str]:
        """Return the statement that makes a subscriber."""

    def client(self, attribute: str, way: Way) -> list[str]:
        """Return the statement that makes a client of a service or action."""

    def connect(self, attribute: str, way: Way) -> list[str]:
        """Return the statements that wait until there is someone to talk to."""

    def stamp(self, target: str) -> str:
        """Return the statement that puts the time into a header."""

    def real(self, value: str) -> str:
        """Return the expression that gives a field of real numbers a value."""

    def request(self, way: Way) -> str:
        """Return the expression for an empty request or goal."""

    def call(self, attribute: str) -> list[str]:
        """Return the statements that call a service with `request` and give `response`."""

    def reach(self, attribute: str, label: str) -> list[str]:
        """Return the statements that carry out `goal` within `within` seconds."""

    def log(self, text: str) -> str:
        """Return the statement that logs a text."""

    def main(self, name: str, made: str) -> list[str]:
        """Return the function `main` of a program and class."""


def _class(way: Way) -> str:
    return way.type.rpartition("/")[2]


def _package(way: Way) -> str:
    return way.type.partition("/")[0]


class Rospy:
    """ROS 1."""

    ros = 1
    base = ""
    clock = "rospy.get_time()"
    ended = "rospy.is_shutdown()"

    def imports(self, *, goals: bool, topics: bool) -> list[str]:
        """Return the imports that every node needs."""
        del topics
        status = ["from actionlib_msgs.msg import GoalStatus"] if goals else []
        return ["import rospy", *(["import actionlib"] if goals else []), *status]

    def types(self, way: Way, *, read: bool) -> list[tuple[str, str]]:
        """Return the module and name of each class that a way needs."""
        name = _class(way)
        if way.kind == "topic":
            return [(f"{_package(way)}.msg", name)]
        if way.kind == "service":
            return [(f"{_package(way)}.srv", one) for one in (name, f"{name}Request")]
        del read
        return [(f"{_package(way)}.msg", one) for one in (f"{name}Action", f"{name}Goal")]

    def begin(self, name: str) -> list[str]:
        """Return nothing: `main` names the node."""
        del name
        return []

    def publisher(self, attribute: str, way: Way) -> list[str]:
        """Return the statement that makes a publisher."""
        return [f'self.{attribute} = rospy.Publisher("{way.name}", {_class(way)}, queue_size=1)']

    def subscriber(self, callback: str, way: Way) -> list[str]:
        """Return the statement that makes a subscriber."""
        return [f'rospy.Subscriber("{way.name}", {_class(way)}, self.{callback}, queue_size=1)']

    def client(self, attribute: str, way: Way) -> list[str]:
        """Return the statement that makes a client of a service or action."""
        if way.kind == "service":
            return [f'self.{attribute} = rospy.ServiceProxy("{way.name}", {_class(way)})']
        return [f'self.{attribute} = actionlib.SimpleActionClient("{way.name}", {_class(way)}Action)']

    def connect(self, attribute: str, way: Way) -> list[str]:
        """Return the statements that wait until there is someone to talk to."""
        if way.kind == "topic":
            return [f"self.until(lambda: self.{attribute}.get_num_connections() > 0, 10.0)"]
        if way.kind == "service":
            return [f"self.wait(lambda: self.{attribute}.wait_for_service(10.0))"]
        return [f"self.until(lambda: self.{attribute}.wait_for_server(rospy.Duration(0.1)), 10.0)"]

    def stamp(self, target: str) -> str:
        """Return the statement that puts the time into a header."""
        return f"{target} = rospy.Time.now()"

    def real(self, value: str) -> str:
        """Return the value: rospy packs whole numbers as real ones."""
        return value

    def request(self, way: Way) -> str:
        """Return the expression for an empty request or goal."""
        return f"{_class(way)}{'Request' if way.kind == 'service' else 'Goal'}()"

    def call(self, attribute: str) -> list[str]:
        """Return the statement that calls a service with `request` and gives `response`."""
        return [f"response = self.wait(lambda: self.{attribute}(request))"]

    def reach(self, attribute: str, label: str) -> list[str]:
        """Return the statements that carry out `goal` within `within` seconds."""
        # Not wait_for_result: it never ends if the server answers before send_goal returns (a race in actionlib).
        state = f"self.{attribute}.get_state()"
        return [
            f"self.{attribute}.send_goal(goal)",
            "try:",
            f"    self.until(lambda: {state} not in (GoalStatus.PENDING, GoalStatus.ACTIVE), within)",
            "except BaseException:",
            f"    self.{attribute}.cancel_goal()",
            "    raise",
            f"if {state} != GoalStatus.SUCCEEDED:",
            f'    raise RuntimeError("could not {label}: " + self.{attribute}.get_goal_status_text())',
        ]

    def log(self, text: str) -> str:
        """Return the statement that logs a text."""
        return f'rospy.loginfo("%s", {text})'

    def main(self, name: str, made: str) -> list[str]:
        """Return the function `main` of a program and class."""
        return [
            f'rospy.init_node("{name}", disable_signals=True)',
            f"node = {made}()",
            "rospy.on_shutdown(node.halt)",
            *_HANDLING,
            "try:",
            "    node.connect()",
            "    node.run()",
            "except StoppedError as error:",
            '    rospy.loginfo("%s", error)',
            "finally:",
            "    node.halt()",
            '    rospy.signal_shutdown("the program has ended")',
            "sys.exit(node.status)",
        ]


class Rclpy:
    """ROS 2."""

    ros = 2
    base = "(Node)"
    clock = "self.get_clock().now().nanoseconds / 1e9"
    ended = "not rclpy.ok()"

    def imports(self, *, goals: bool, topics: bool) -> list[str]:
        """Return the imports that every node needs."""
        made = [
            "import rclpy",
            "from rclpy.executors import MultiThreadedExecutor",
            "from rclpy.node import Node",
            "from rclpy.signals import SignalHandlerOptions",
        ]
        if goals:
            made += ["from action_msgs.msg import GoalStatus", "from rclpy.action import ActionClient"]
        return [*made, "from rclpy.qos import qos_profile_sensor_data"] if topics else made

    def types(self, way: Way, *, read: bool) -> list[tuple[str, str]]:
        """Return the module and name of the class that a way needs."""
        del read
        part = {"topic": "msg", "service": "srv", "action": "action"}[way.kind]
        return [(f"{_package(way)}.{part}", _class(way))]

    def begin(self, name: str) -> list[str]:
        """Return what names the node."""
        return [f'super().__init__("{name}")']

    def publisher(self, attribute: str, way: Way) -> list[str]:
        """Return the statement that makes a publisher."""
        return [f'self.{attribute} = self.create_publisher({_class(way)}, "{way.name}", 1)']

    def subscriber(self, callback: str, way: Way) -> list[str]:
        """Return the statement that makes a subscriber."""
        made = f'{_class(way)}, "{way.name}", self.{callback}, qos_profile_sensor_data'
        return [f"self.create_subscription({made})"]

    def client(self, attribute: str, way: Way) -> list[str]:
        """Return the statement that makes a client of a service or action."""
        if way.kind == "service":
            return [f'self.{attribute} = self.create_client({_class(way)}, "{way.name}")']
        return [f'self.{attribute} = ActionClient(self, {_class(way)}, "{way.name}")']

    def connect(self, attribute: str, way: Way) -> list[str]:
        """Return the statements that wait until there is someone to talk to."""
        if way.kind == "topic":
            return [f"self.until(lambda: self.{attribute}.get_subscription_count() > 0, 10.0)"]
        waiting = "wait_for_service" if way.kind == "service" else "wait_for_server"
        return [f"self.until(lambda: self.{attribute}.{waiting}(0.1), 10.0)"]

    def stamp(self, target: str) -> str:
        """Return the statement that puts the time into a header."""
        return f"{target} = self.get_clock().now().to_msg()"

    def real(self, value: str) -> str:
        """Return the value as a float: the setters of ROS 2's messages refuse an int (rosidl_generator_py)."""
        return f"float({value})"

    def request(self, way: Way) -> str:
        """Return the expression for an empty request or goal."""
        return f"{_class(way)}.{'Request' if way.kind == 'service' else 'Goal'}()"

    def call(self, attribute: str) -> list[str]:
        """Return the statements that call a service with `request` and give `response`."""
        return [
            f"answer = self.{attribute}.call_async(request)",
            "self.until(answer.done, 10.0)",
            "response = answer.result()",
        ]

    def reach(self, attribute: str, label: str) -> list[str]:
        """Return the statements that carry out `goal` within `within` seconds."""
        return [
            f"sent = self.{attribute}.send_goal_async(goal)",
            "try:",
            "    self.until(sent.done, within)",
            "    handle = sent.result()",
            "    if not handle.accepted:",
            f'        raise RuntimeError("the goal to {label} was rejected")',
            "    result = handle.get_result_async()",
            "    self.until(result.done, within)",
            "except BaseException:",
            "    sent.add_done_callback(lambda _: sent.result().cancel_goal_async())",
            "    raise",
            "if result.result().status != GoalStatus.STATUS_SUCCEEDED:",
            f'    raise RuntimeError("could not {label}")',
        ]

    def log(self, text: str) -> str:
        """Return the statement that logs a text."""
        return f"self.get_logger().info({text})"

    def main(self, name: str, made: str) -> list[str]:
        """Return the function `main` of a program and class."""
        del name
        return [
            "rclpy.init(signal_handler_options=SignalHandlerOptions.NO)",
            f"node = {made}()",
            "executor = MultiThreadedExecutor()",
            "executor.add_node(node)",
            "spinning = threading.Thread(target=executor.spin, daemon=True)",
            "spinning.start()",
            *_HANDLING,
            "try:",
            "    node.connect()",
            "    node.run()",
            "except StoppedError as error:",
            "    node.get_logger().info(str(error))",
            "finally:",
            "    node.halt()",
            "    executor.shutdown()",
            "    rclpy.shutdown()",
            "    spinning.join()",
            "sys.exit(node.status)",
        ]
