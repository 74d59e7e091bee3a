import functools

import rclpy
from fastapi import FastAPI
from rclpy.node import Node
from server import Server
from std_msgs.msg import Bool, String
from std_srvs.srv import Trigger

server = Server("demo")
bridge = None


class Bridge:
    def __init__(self):
        self.node = Node("bridge")
        self.stop = self.node.create_client(Trigger, "stop")


def started():
    global bridge
    if bridge is None:
        bridge = Bridge()
    return bridge


@server.tool(name="stop", structured=True)
def stop():
    return started().stop.call_async(Trigger.Request())


@functools.lru_cache(maxsize=None)
def never():
    Node("never").create_publisher(Bool, "never", 1)


def application(node):
    app = FastAPI()

    @app.get("/say")
    def say():
        node.create_publisher(String, "words", 1)

    return app


def main():
    rclpy.init()
    application(Node("bridge"))
    server.run()


if __name__ == "__main__":
    main()
