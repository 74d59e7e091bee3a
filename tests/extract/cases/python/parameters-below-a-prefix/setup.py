from setuptools import setup

setup(name="gains", packages=["gains"], entry_points={"console_scripts": ["gains = gains.gains:main"]})
