import rclpy
from rcl_interfaces.msg import ParameterDescriptor, ParameterType
from rclpy.node import Node


class Sensor(Node):
    def __init__(self):
        super().__init__("sensor")
        names = ParameterDescriptor(type=ParameterType.PARAMETER_STRING_ARRAY)
        self.declare_parameter("names", descriptor=names)
        self.declare_parameters(
            "",
            [
                ("device", None, ParameterDescriptor(type=ParameterType.PARAMETER_STRING)),
                ("rate", 15, ParameterDescriptor(type=ParameterType.PARAMETER_DOUBLE)),
                ("any", None, ParameterDescriptor(dynamic_typing=True)),
            ],
        )
        self.declare_parameter("delay", 100, ParameterDescriptor(description="a model or a time", dynamic_typing=True))
        delay = self.get_parameter("delay").get_parameter_value()
        self.delay = 5 if delay.string_value == "slow" else int(delay.integer_value)


def main():
    rclpy.init()
    rclpy.spin(Sensor())
