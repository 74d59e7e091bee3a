#!/usr/bin/env python3

import rosbag
import rospy
from std_msgs.msg import String


def main():
    with rosbag.Bag("out.bag", "w") as bag:
        bag.write("chatter", String(data="x"), rospy.Time(1))


if __name__ == "__main__":
    main()
