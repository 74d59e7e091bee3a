from setuptools import setup

setup(
    name="demo",
    packages=["demo"],
    entry_points={"console_scripts": ["web = demo.web:main", "named = demo.named:main"]},
)
