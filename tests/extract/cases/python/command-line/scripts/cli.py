#!/usr/bin/env python3

import argparse
import sys

import rospy
from std_msgs.msg import String


def parse():
    parser = argparse.ArgumentParser()
    parser.add_argument("--out-topic", "-o", default="chosen", help="x")
    parser.add_argument("--namespace", "-n", metavar="ns")
    parser.add_argument("--quiet", action="store_true")
    parser.add_argument("robot")
    return parser.parse_args(rospy.myargv()[1:])


if __name__ == "__main__":
    rospy.init_node("cli")
    args = parse()
    rospy.Publisher(args.out_topic, String, queue_size=1)
    rospy.Publisher(args.robot + "/state", String, queue_size=1)
    rospy.Subscriber(sys.argv[1], String, print)
    namespace = args.namespace or ""
    if namespace and namespace[-1] != "/":
        namespace = namespace + "/"
    rospy.Subscriber(namespace + "load", String, print)
