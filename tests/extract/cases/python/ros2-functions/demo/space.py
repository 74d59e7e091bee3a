import rclpy
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String


class Managed(LifecycleNode):
    def __init__(self, name, **kwargs):
        super().__init__(name, **kwargs)

    def on_configure(self, state):
        self.pub = self.create_lifecycle_publisher(String, "managed", 10)


class Nobody(rclpy.node.Node):
    def __init__(self, topic="given"):
        rclpy.node.Node.__init__(self, "nobody")
        self.create_subscription(String, topic, self.heard, 10)

    def heard(self, message):
        pass


def run():
    rclpy.init()
    rclpy.spin(Managed("managed"))
