#!/usr/bin/env python3
import rospy


def looked_up(name, default):
    full_name = rospy.search_param(name)
    return default if full_name is None else rospy.get_param(full_name, default)


rospy.init_node("node")
host = looked_up("host", "localhost")
rospy.spin()
