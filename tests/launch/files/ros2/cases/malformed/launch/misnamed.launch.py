from launch import LaunchDescription


def describe():
    return LaunchDescription([])
