#!/usr/bin/env python3
import rospy
from sensor_msgs.msg import Image

rospy.init_node("eye")
publisher = rospy.Publisher("image", Image, queue_size=1)
publisher.publish(Image())
rospy.spin()
