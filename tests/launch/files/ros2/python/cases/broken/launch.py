def generate_launch_description():
    return LaunchDescription([Node(
]
