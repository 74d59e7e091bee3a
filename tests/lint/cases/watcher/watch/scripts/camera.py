#!/usr/bin/env python3
import rospy
from sensor_msgs.msg import Image

rospy.init_node("camera")
pictures = rospy.Publisher("image_raw", Image, queue_size=1)
pictures.publish(Image())
rospy.spin()
