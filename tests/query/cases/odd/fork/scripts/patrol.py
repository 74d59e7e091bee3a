#!/usr/bin/env python
"""A patrol that publishes the filtered scan with another type than the rover's."""
import rospy
from std_msgs.msg import String


def main():
    rospy.init_node("patrol")
    publisher = rospy.Publisher("scan_filtered", String, queue_size=1)
    publisher.publish("nothing")


if __name__ == "__main__":
    main()
