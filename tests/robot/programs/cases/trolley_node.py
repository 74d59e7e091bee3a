"""A trolley as a node of ROS 1, in Debian's rospy: it rolls, publishes its position and the wall's distance, takes
goals.

It imports no test module, because the system's Python runs it.
"""

import threading

import actionlib
import rospy
from geometry_msgs.msg import Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseResult
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String
from std_srvs.srv import Trigger, TriggerResponse

STEP = 0.02
WALL = 3.0


class Trolley:
    """Position and speed of the trolley."""

    def __init__(self) -> None:
        """Advertise and subscribe to topics."""
        self.place = 0.0
        self.lock = threading.Lock()  # goals arrive in another thread than the rolling one
        self.speed = 0.0
        self.since = rospy.get_time()
        self.odometry = rospy.Publisher("/odom", Odometry, queue_size=1)
        self.scan = rospy.Publisher("/scan", LaserScan, queue_size=1)
        rospy.Subscriber("/cmd_vel", Twist, self.on_velocity)
        rospy.Subscriber("/say", String, lambda message: print(f"said {message.data}", flush=True))
        self.server = actionlib.SimpleActionServer("/move_base", MoveBaseAction, self.go, auto_start=False)
        self.server.start()
        rospy.Service("/wait", Trigger, self.wait)

    def wait(self, _: object) -> TriggerResponse:
        """Answer too late."""
        print("called", flush=True)
        rospy.sleep(1000)
        return TriggerResponse()

    def on_velocity(self, message: Twist) -> None:
        """Roll at the commanded velocity."""
        self.speed = message.linear.x
        print(f"speed {self.speed:g}", flush=True)

    def go(self, goal: MoveBaseAction) -> None:
        """Go to a place, at once; one behind the wall is never reached."""
        if goal.target_pose.pose.position.x > WALL:
            print("going", flush=True)
            while not self.server.is_preempt_requested():
                rospy.sleep(STEP)
            print("cancelled", flush=True)
            self.server.set_preempted()
            return
        with self.lock:
            self.place = goal.target_pose.pose.position.x
        self.tell()  # before the result: the robot is at its goal when it reports success
        self.server.set_succeeded(MoveBaseResult())

    def step(self) -> None:
        """Roll for the elapsed time, which may exceed a step, and publish the position."""
        since, self.since = self.since, rospy.get_time()
        with self.lock:
            self.place += self.speed * (self.since - since)
        self.tell()

    def tell(self) -> None:
        """Publish the position and the distance of the wall."""
        odometry = Odometry()
        odometry.pose.pose.position.x = self.place
        odometry.pose.pose.orientation.w = 1.0
        self.odometry.publish(odometry)
        self.scan.publish(
            LaserScan(angle_min=-0.5, angle_increment=0.5, range_max=10.0, ranges=[5.0, WALL - self.place, 5.0])
        )


if __name__ == "__main__":
    rospy.init_node("trolley")
    trolley = Trolley()
    print("ready", flush=True)
    while not rospy.is_shutdown():
        trolley.step()
        rospy.sleep(STEP)
