#!/usr/bin/env python
# -*- coding: utf-8 -*-
# Copyright 2020 Somebody
# Licensed under the Apache License, Version 2.0

# Says aloud what it receives.

"""Speaks sentences with a synthetic voice.

Author: Somebody
"""
import rospy
from std_msgs.msg import String


class SpeechError(Exception):
    """Raised when the loudspeaker is missing."""


class Speaker:
    """
    Receives sentences and plays them one after another.

    Args:
        voice: name of the voice
    """

    def __init__(self):
        self.sub = rospy.Subscriber("say", String, self.say)

    def say(self, message):
        """Plays one message on the loudspeaker."""


def main():
    """Starts the speaker and waits for sentences."""
    rospy.init_node("say")
    Speaker()
    rospy.spin()


if __name__ == "__main__":
    main()
