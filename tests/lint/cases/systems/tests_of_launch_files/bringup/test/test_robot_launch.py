import importlib.util


def robot_is_described():
    spec = importlib.util.spec_from_file_location("robot", "launch/robot.launch.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert not module.generate_launch_description().entities
