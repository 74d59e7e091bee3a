#!/usr/bin/env python3
import rospy
from company.ros import CompanyNode
from sensor_msgs.msg import Image


class Detector(CompanyNode):
    def __init__(self, node_name):
        super(Detector, self).__init__(node_name=node_name)
        self.size = rospy.get_param("~size", 3)
        self.image = rospy.Subscriber("~image", Image, self.detect, queue_size=1)

    def detect(self, image):
        pass


if __name__ == "__main__":
    Detector("detector")
    rospy.spin()
