#!/usr/bin/env python3
import rospy
from sensor_msgs.msg import Image

rospy.init_node("viewer")
rospy.Subscriber("image", Image, print)
rospy.spin()
