import rclpy
from company.kitchen import Worker
from company.threads import Task
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Empty


class Clock(Task):
    def __init__(self):
        super().__init__("clock")
        self.zone = self.get_parameter("zone")


class Ledger(Task):
    def create_publisher(self, kind, name):
        return self.get_parameter("owner"), kind, name

    def open(self):
        return self.create_publisher("first", "second")


class Cook(Worker):
    def __init__(self, place):
        super().__init__(place)
        self.dish = self.get_parameter("dish").value
        self.declare_parameter("speed", 1.0)
        self.loud = self.get_parameter_or("loud", Parameter("unset", Parameter.Type.BOOL, True)).value
        self.ready = self.create_publisher(Empty, "ready", 1)


def main():
    rclpy.init()
    settings = Node("cook_settings")
    settings.get_parameter("size")
    Clock()
    Ledger().open()
    rclpy.spin(Cook("stove"))
