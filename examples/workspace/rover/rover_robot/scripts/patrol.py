#!/usr/bin/env python3
"""Drives from waypoint to waypoint, and stops where somebody stands in the way."""

import actionlib
import message_filters
import rospy
import tf
from geometry_msgs.msg import PointStamped, PoseStamped
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.srv import GetMap
from rover_core.msg import WheelSpeeds as Speeds
from rover_robot.gripper import Gripper
from sensor_msgs.msg import Image, LaserScan, Range
from std_msgs.msg import Bool
from std_srvs.srv import SetBool, SetBoolResponse

STOP_TOPIC = "/emergency_stop"

# Side of the rover -> type of the sensor mounted there.
SENSORS = {"left": Range, "right": Range, "front": LaserScan}


class Patrol:
    def __init__(self):
        self.paused = False
        self.frame = rospy.get_param("~map_frame", "map")
        goal_topic = rospy.get_param("~goal_topic", "patrol/goal")

        self.stop_pub = rospy.Publisher(STOP_TOPIC, Bool, queue_size=1, latch=True)
        self.goal_pub = rospy.Publisher(goal_topic, PoseStamped, queue_size=1)
        self.person_pub = rospy.Publisher("~person", PointStamped, queue_size=10)

        rospy.Subscriber("wheel_speeds", Speeds, self.on_speeds)
        for side, kind in SENSORS.items():
            rospy.Subscriber("sensors/{}".format(side), kind, self.on_distance, callback_args=side)

        picture = message_filters.Subscriber("camera/annotated", Image)
        scan = message_filters.Subscriber("scan_filtered", LaserScan)
        self.both = message_filters.ApproximateTimeSynchronizer([picture, scan], 10, 0.1)
        self.both.registerCallback(self.on_both)

        self.transforms = tf.TransformListener()
        self.gripper = Gripper()
        self.get_map = rospy.ServiceProxy("static_map", GetMap)
        rospy.Service("~pause", SetBool, self.on_pause)

        self.move_base = actionlib.SimpleActionClient("move_base", MoveBaseAction)
        self.move_base.wait_for_server()

    def on_speeds(self, msg):
        self.turning = msg.left != 0 or msg.right != 0

    def on_distance(self, msg, side):
        self.stop_pub.publish(Bool(data=getattr(msg, "range", 1.0) < 0.3))

    def on_both(self, picture, scan):
        if self.transforms.canTransform(self.frame, scan.header.frame_id, scan.header.stamp):
            self.person_pub.publish(PointStamped(header=scan.header))

    def on_pause(self, request):
        self.paused = request.data
        return SetBoolResponse(success=True)

    def go(self, waypoint):
        pose = PoseStamped()
        pose.header.frame_id = self.frame
        pose.pose.position.x, pose.pose.position.y = waypoint
        self.goal_pub.publish(pose)
        self.move_base.send_goal_and_wait(MoveBaseGoal(target_pose=pose))


def main():
    rospy.init_node("patrol")
    patrol = Patrol()
    for waypoint in rospy.get_param("~waypoints"):
        patrol.go(waypoint)


if __name__ == "__main__":
    main()
