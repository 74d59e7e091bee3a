from launch import LaunchDescription
from launch.actions import SetEnvironmentVariable, SetLaunchConfiguration
from launch.conditions import IfCondition, LaunchConfigurationEquals, LaunchConfigurationNotEquals
from launch.substitutions import (
    AndSubstitution,
    AnySubstitution,
    Command,
    EnvironmentVariable,
    EqualsSubstitution,
    FindExecutable,
    IfElseSubstitution,
    LaunchConfiguration,
    NotSubstitution,
    PathJoinSubstitution,
    PythonExpression,
    TextSubstitution,
)
from launch_ros.actions import Node

A, B = LaunchConfiguration("a"), LaunchConfiguration("b", default="1")


def let(name, value):
    return SetLaunchConfiguration(name, value)


def generate_launch_description():
    return LaunchDescription(
        [
            let("env", EnvironmentVariable("HOME", default_value="/root")),
            let("command", Command([FindExecutable(name="xacro"), " ", PathJoinSubstitution(["x", [A, ".urdf"]])])),
            let("expression", PythonExpression(["'", A, "' == 'x' and ", B])),
            let("logic", AndSubstitution(NotSubstitution(A), AnySubstitution(A, B))),
            let("choice", IfElseSubstitution(EqualsSubstitution(A, "x"), if_value="y", else_value=TextSubstitution(text="n"))),
            SetEnvironmentVariable("NAME", [A, "-x"]),
            Node(package="p", executable="a", condition=LaunchConfigurationEquals("a", "x")),
            Node(package="p", executable="b", condition=LaunchConfigurationNotEquals("a", "x")),
            Node(package="p", executable="c", condition=IfCondition(PythonExpression([A, " > 1"]))),
            Node(package="p", executable="never", name="compared") if A == "x" else let("compared", "never"),
        ]
    )
