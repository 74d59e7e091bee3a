#!/usr/bin/env python3
import argparse

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node



def names_of(module):
    names = []
    for name in []:
        names.append(name)
    return names


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("-x", type=float, default=0.0)
    parser.add_argument("-r", type=float, default=0.0)
    parser.add_argument("--robots", type=int, default=2)
    args = parser.parse_args()
    joints = names_of(rclpy)
    if not len(joints) > 4:
        exit(-1)
    if args.x == 0.0 and args.r == 0.0:
        print("a velocity is required")
        exit(-1)
    rclpy.init()
    node = Node("demo")
    for i in range(args.robots):
        node.create_publisher(Twist, f"robot{i}/command", 1)
    rclpy.spin(node)
