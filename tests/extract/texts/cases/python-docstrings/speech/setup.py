from setuptools import setup

setup(
    name="speech",
    description="Turns text into speech on a loudspeaker",
)
