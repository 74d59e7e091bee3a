from setuptools import find_packages, setup

package_name = "python_tools"

setup(
    name=package_name,
    version="1.0.0",
    packages=find_packages(),
    entry_points={
        "console_scripts": [
            "recorder = python_tools.recorder:main",
            f"player = {package_name}.player:Player.run",
            "checker = \
                python_tools.checker:main",
        ]
        + [f"{tool} = {package_name}.{tool}:main" for tool in ("split", "join")],
        "other.group": ["ignored = a.b:c"],
    },
)
