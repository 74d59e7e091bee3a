from setuptools import setup

setup(
    name="demo",
    packages=["demo"],
    entry_points={"console_scripts": ["plain = demo.plain:main", "space = demo.space:run"]},
)
