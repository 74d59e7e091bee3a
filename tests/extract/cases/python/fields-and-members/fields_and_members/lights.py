from dataclasses import dataclass, field
from enum import Enum

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.node import Node
from std_msgs.msg import String


class Color(Enum):
    RED = "red"
    GREEN = "green"


@dataclass
class Settings:
    topic: str = "mode"
    others: list = field(default_factory=lambda: ["first", "second"])


class Lights(Node):
    def __init__(self, settings=Settings()):
        super().__init__("lights")
        self.create_publisher(String, settings.topic, 1)
        for other in settings.others:
            self.create_publisher(String, other, 1)
        for color in Color:
            self.create_publisher(String, f"light/{color.value}", 1)
        self.server = ActionServer(self, Fibonacci, "blink", execute_callback=self.blink)

    def blink(self, goal):
        self.create_publisher(String, "while_blinking", 1)


def main():
    rclpy.init()
    rclpy.spin(Lights())
