from launch import Action, Substitution
from launch.actions import OpaqueCoroutine
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from ament_index_python.packages import get_package_share_directory
from somewhere import Base


class LaunchFile(PathJoinSubstitution):
    def __init__(self, package, file):
        super().__init__([get_package_share_directory(package), "launch", file])


class Address(Substitution):
    def __init__(self, host):
        super().__init__()
        self.__host = host

    def perform(self, context):
        return resolve(self.__host)


class Driver(Node):
    def __init__(self, side, **kwargs):
        super().__init__(package="drivers", executable="driver", name=["driver_", side], **kwargs)


class Camera(Driver):
    pass


class Notify(OpaqueCoroutine):
    def __init__(self, url):
        super().__init__(coroutine=self.notify)
        self.__url = url

    async def notify(self, context):
        await send(self.__url)


class Both(Action):
    def __init__(self, names, **kwargs):
        super().__init__(**kwargs)
        self.names = names

    def execute(self, context):
        prefix = LaunchConfiguration("prefix").perform(context)
        return [Node(package="demo", executable="one", name=prefix + name) for name in self.names]


class Foreign(Base):
    pass
