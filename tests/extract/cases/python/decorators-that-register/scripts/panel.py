#!/usr/bin/env python3
import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Empty, String
from std_srvs.srv import Trigger


class Remote:
    prepared = []
    methods = {}

    @classmethod
    def on_node(cls, function):
        """Register a function that runs with the node."""
        if function.__name__.startswith("prepare"):
            cls.prepared.append(function)
        else:
            cls.methods[function.__name__] = function
        return lambda self, *args: None

    def start(self):
        node = Node("panel")
        for prepare in self.prepared:
            prepare(node)
        for name, function in self.methods.items():
            setattr(node, name, lambda: function(node))
        return node


def listener(topic):
    def register(function):
        LISTENERS.append((topic, function))
        return function

    return register


LISTENERS = []


class Panel(Remote):
    @Remote.on_node
    def prepare(self):
        self.state = self.create_publisher(Bool, "state", 1)
        self.stop = self.create_client(Trigger, "stop")

    @Remote.on_node
    def show(self):
        self.state.publish(Bool())

    @listener("words")
    def hear(self, message):
        pass

    @property
    def title(self):
        return "title"


def main():
    rclpy.init()
    panel = Panel()
    node = panel.start()
    node.create_subscription(Empty, panel.title, panel.show, 1)
    for topic, function in LISTENERS:
        node.create_subscription(String, topic, function, 1)
    rclpy.spin(node)


main()
