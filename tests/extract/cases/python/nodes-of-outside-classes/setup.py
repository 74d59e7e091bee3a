from setuptools import setup

setup(
    name="demo",
    packages=["demo"],
    entry_points={
        "console_scripts": [
            "driver = demo.driver:main",
            "commander = demo.commander:main",
            "tree = demo.tree:main",
        ]
    },
)
