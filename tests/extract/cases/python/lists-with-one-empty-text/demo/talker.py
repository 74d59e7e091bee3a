import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Range


class Layer(Node):
    def __init__(self):
        super().__init__("layer")
        self.declare_parameters(namespace="", parameters=[("topics", [""]), ("prefix", "")])
        topics = self.get_parameter("topics").get_parameter_value().string_array_value
        self.ranges = [
            self.create_subscription(Range, "/" + topics[index], self.on_range, 10) for index in range(len(topics))
        ]
        self.kept = [self.create_publisher(Range, "kept/" + topic, 10) for topic in topics]
        self.all = self.create_publisher(Range, self.get_parameter("prefix").value + "all", 10)

    def on_range(self, message):
        pass


def main():
    rclpy.init()
    rclpy.spin(Layer())
