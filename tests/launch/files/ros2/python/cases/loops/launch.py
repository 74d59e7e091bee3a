from itertools import product

from launch import LaunchDescription
from launch_ros.actions import Node

ROBOTS = {"red": (0, 1.5), "blue": (1, -2)}


def generate_launch_description():
    found = []
    for number, (name, (x, y)) in enumerate(ROBOTS.items(), start=1):
        if name == "blue":
            continue
        found.append(Node(package="p", executable="e", name=f"{name}_{number:02d}", arguments=[str(x), "%.2f" % y]))
    for name, port in zip(sorted(ROBOTS), range(5000, 5010, 2)):
        found.append(Node(package="p", executable="e", name="{}-{port}".format(name.upper(), port=port)))
    count = 3
    while count:
        count -= 1
        if count == 1:
            break
        found.append(Node(package="p", executable="e", name="n" + str(count)))
    for a, b in product("ab", "cd"):
        found.append(Node(package="p", executable="e", name=a + b))
    return LaunchDescription(found)
