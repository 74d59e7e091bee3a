"""Flies from waypoint to waypoint and returns home when the battery runs low."""

import rclpy
from drone_interfaces.action import FlyTo
from drone_interfaces.msg import FlightState
from drone_interfaces.srv import SetHome
from geometry_msgs.msg import PoseStamped
from rclpy.action import ActionClient
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_srvs.srv import Trigger
from tf2_ros import Buffer, TransformListener

from drone_mission.ground_link import GroundLink

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, reliability=ReliabilityPolicy.RELIABLE)


class Mission(GroundLink):
    def __init__(self):
        super().__init__("mission", "mission")
        self.declare_parameters("", [("battery_reserve", 0.2), ("home_service", "set_home")])
        self.declare_parameter("route", "/fleet/route")

        self.create_subscription(FlightState, "state", self.on_state, LATCHED)
        self.waypoint_pub = self.create_publisher(PoseStamped, "~/waypoint", 10)

        # Both names are values of parameters.
        self.create_subscription(PoseStamped, self.get_parameter("route").value, self.fly_to, 10)
        self.set_home = self.create_client(SetHome, self.get_parameter("home_service").value)

        self.create_service(Trigger, "/fleet/return_home", self.on_return_home)
        self.client = ActionClient(self, FlyTo, "fly_to")
        self.transforms = Buffer()
        self.listener = TransformListener(self.transforms, self)

    def on_state(self, state):
        if state.battery < self.get_parameter("battery_reserve").value:
            self.report("battery is low")

    def on_return_home(self, request, response):
        response.success = self.client.server_is_ready()
        return response

    def fly_to(self, pose):
        self.waypoint_pub.publish(pose)
        return self.client.send_goal_async(FlyTo.Goal(target=pose, speed=2.0))


def main():
    rclpy.init()
    rclpy.spin(Mission())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
