#!/usr/bin/env python
import rospy
from std_msgs.msg import String


def imported(name):
    package, _, member = name.rpartition(".")
    return getattr(__import__(package), member)


class Trees:
    def __init__(self):
        self.state = rospy.Publisher("~state", String, queue_size=1)
        self.tree = imported(rospy.get_param("~tree"))(self)


if __name__ == "__main__":
    rospy.init_node("trees")
    Trees()
    rospy.spin()
