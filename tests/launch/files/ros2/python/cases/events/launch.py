from launch import LaunchDescription
from launch.actions import EmitEvent, ExecuteProcess, LogInfo, RegisterEventHandler, Shutdown, TimerAction
from launch.event_handlers import OnProcessExit, OnProcessStart, OnShutdown
from launch.events import Shutdown as ShutdownEvent
from launch_ros.actions import LifecycleNode, Node
from launch_ros.event_handlers import OnStateTransition


def generate_launch_description():
    first = LifecycleNode(package="p", executable="first", name="first", namespace="")
    second = Node(package="p", executable="second")
    third = Node(package="p", executable="third")
    return LaunchDescription(
        [
            LogInfo(msg="begin"),
            first,
            RegisterEventHandler(OnProcessStart(target_action=first, on_start=[second])),
            RegisterEventHandler(OnProcessExit(target_action=second, on_exit=third)),
            RegisterEventHandler(OnProcessExit(target_action=third, on_exit=EmitEvent(event=ShutdownEvent()))),
            RegisterEventHandler(OnStateTransition(target_lifecycle_node=first, goal_state="active", entities=[third])),
            RegisterEventHandler(OnProcessExit(target_action=third, on_exit=lambda event, context: [second])),
            RegisterEventHandler(OnShutdown(on_shutdown=[Node(package="p", executable="late")])),
            TimerAction(period=5.0, actions=[third]),
            ExecuteProcess(cmd=["ros2", "run", "p", "tool", "--ros-args"]),
            Shutdown(),
        ]
    )
