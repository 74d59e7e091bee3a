#!/usr/bin/env python
import sys

import rospy
from std_msgs.msg import Int32


class Reader:
    def __init__(self):
        self.camera = rospy.get_param("~camera", "")
        if self.camera:
            rospy.Publisher("/" + self.camera + "/state", Int32)
        else:
            rospy.Publisher("/state" + self.camera, Int32)


if __name__ == "__main__":
    rospy.init_node("demo")
    robot = rospy.get_param("~robot", "")
    if not robot or len(robot) <= 0:
        rospy.logerr("no robot")
        sys.exit(1)
    rospy.Publisher("/" + robot + "/mode", Int32)
    arm = rospy.get_param("~arm", "")
    if arm == "":
        raise ValueError("no arm")
    rospy.Publisher("/" + arm + "/mode", Int32)
    Reader()
    rospy.spin()
    sys.exit(0)
    rospy.Publisher("never", Int32)
