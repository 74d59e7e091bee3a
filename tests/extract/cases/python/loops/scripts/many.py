#!/usr/bin/env python3

import rospy
from geometry_msgs.msg import Pose, Twist
from sensor_msgs.msg import CameraInfo, Image

TOPICS = {"pose": Pose, "twist": Twist}
SIDES = ["left", "right"]


def ignore(message):
    del message


if __name__ == "__main__":
    rospy.init_node("many")
    for name, kind in TOPICS.items():
        rospy.Publisher(name, kind, queue_size=1)
    for side in SIDES:
        for part, kind in (("image", Image), ("info", CameraInfo)):
            rospy.Subscriber("%s/%s" % (side, part), kind, ignore)
    for index in range(2):
        rospy.Publisher(f"wheel_{index}", Twist, queue_size=1)
    spare = [rospy.Publisher("spare_{}".format(index), Pose, queue_size=1) for index in range(rospy.get_param("~spares", 0))]
    for index, name in enumerate(SIDES, 1):
        rospy.Publisher("{}{}".format(name, index), Pose, queue_size=1)
    for name, kind in zip(["a", "b"], [Pose, Twist]):
        rospy.Publisher("zip/" + name, kind, queue_size=1)
    pubs = [rospy.Publisher(n + "_cmd", Twist, queue_size=1) for n in sorted(SIDES)]
