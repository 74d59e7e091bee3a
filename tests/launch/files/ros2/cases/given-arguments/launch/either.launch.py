import os

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    names = [os.environ.get('ROBOTS') or 'driver', os.environ.get('MONITOR') or 'monitor']
    return LaunchDescription([Node(package='driver', executable='driver', name=name) for name in names])
