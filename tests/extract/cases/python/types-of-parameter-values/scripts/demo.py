import rclpy
from rclpy.node import Node
from std_msgs.msg import String

_BOOL = 1
_STRING = 4


def scalar(node, name):
    value = node.get_parameter(name).get_parameter_value()
    kind = int(getattr(value, "type", 0) or 0)
    if kind == _BOOL:
        return bool(value.bool_value)
    if kind == _STRING:
        return value.string_value
    return None


def text(node, name, *, default=""):
    value = scalar(node, name)
    return default if value is None else str(value)


class Demo(Node):
    def __init__(self):
        super().__init__("demo")
        self.declare_parameter("topic", "words")
        self.declare_parameter("enabled", True)
        self.create_publisher(String, text(self, "topic"), 1)
        if scalar(self, "enabled"):
            self.create_subscription(String, "enabled", lambda message: None, 1)


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Demo())
