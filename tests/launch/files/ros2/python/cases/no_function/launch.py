import launch


def main():
    return launch.LaunchDescription()
