#!/usr/bin/env python3
import rospy
from sensor_msgs.msg import Image

rospy.init_node("eye")
device = open(rospy.get_param("~device", "/dev/video0"), "rb")
publisher = rospy.Publisher("image", Image, queue_size=1)
publisher.publish(Image(data=device.read()))
rospy.spin()
