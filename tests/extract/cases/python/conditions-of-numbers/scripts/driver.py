#!/usr/bin/env python
"""A rate that a parameter gives, or a search where it is zero: without any, the node ends."""

import ports
import rospy
from std_msgs.msg import String


def main():
    rospy.init_node("driver")
    rate = rospy.get_param("~rate", 0)
    if rospy.get_param("~device", "auto") == "auto":
        found = ports.search()
        if not found:
            return
        _, rate = found[0]
    if not rate:
        rate = ports.rate_of("/dev/ttyUSB0")
    if not rate:
        rospy.logerr("no rate")
        return
    rospy.Publisher("data", String, queue_size=1)
    rospy.spin()


if __name__ == "__main__":
    main()
