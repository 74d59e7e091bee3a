#!/usr/bin/env python
import rospy
from jsk_rviz_plugins.overlay_text_interface import OverlayTextInterface
from std_msgs.msg import Bool


def show(message):
    sign.publish("open" if message.data else "closed")


if __name__ == "__main__":
    rospy.init_node("door_sign")
    sign = OverlayTextInterface("~sign")
    rospy.Subscriber("door", Bool, show)
    rospy.spin()
