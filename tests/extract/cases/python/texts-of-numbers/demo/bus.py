import rclpy
from demo.msg import Frame
from rclpy.node import Node


class Bus(Node):
    def __init__(self):
        super().__init__("bus")
        first = self.declare_parameter("first", 1).value
        self.create_subscription(Frame, f"frames/{hex(Frame.WHEELS)[1:]}", self.receive, 10)
        self.create_subscription(Frame, "frames/" + oct(8) + bin(Frame.DOORS), self.receive, 10)
        self.create_subscription(Frame, f"frames/{hex(first)}", self.receive, 10)

    def receive(self, frame):
        pass


def main():
    rclpy.init()
    rclpy.spin(Bus())
