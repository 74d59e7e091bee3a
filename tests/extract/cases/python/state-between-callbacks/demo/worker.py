import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, String


class Worker(Node):
    def __init__(self):
        super().__init__("worker")
        self.jobs = []
        self.kind = ""
        self.armed = False
        self.create_timer(1.0, self.tick)
        self.create_subscription(String, "jobs", self.receive, 10)
        self.create_subscription(Bool, "arm", self.arm, 10)

    def tick(self):
        if not len(self.jobs) or not self.armed:
            return
        if self.jobs[0] in ["photo", "map"]:
            self.kind = self.jobs[0]
            self.jobs.pop(0)
            return
        if self.kind == "":
            return
        if self.kind == "photo":
            self.send("camera/take")
        elif self.kind == "map":
            self.send(topic="map/update")

    def receive(self, message):
        self.jobs.extend(message.data.split("\n"))

    def arm(self, message):
        self.armed = True

    def send(self, topic):
        self.create_publisher(Bool, topic, 10)


def main():
    rclpy.init()
    rclpy.spin(Worker())
