import os

from launch import LaunchDescription
from launch_ros.actions import Node


def addresses():
    text = os.getenv('ROBOTS', '')
    return text.split(',') if text else []


def generate_launch_description():
    robots = addresses()
    if len(robots) == 1:
        nodes = [Node(package='driver', executable='driver', name='driver')]
    else:
        nodes = [Node(package='driver', executable='driver', name=f'driver{i}') for i in range(len(robots))]
    monitor = Node(package='monitor', executable='monitor', name=os.environ.get('MONITOR', 'monitor'))
    return LaunchDescription([*nodes, monitor])
