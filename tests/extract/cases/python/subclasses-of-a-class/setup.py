from setuptools import setup

setup(
    name="demo",
    packages=["demo", "demo.models"],
    entry_points={"console_scripts": ["plain = demo.plain:main"]},
)
