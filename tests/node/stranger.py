#!/usr/bin/python3
"""A node that has no part in anything: publishes each line TOPIC MODULE TYPE HEX of its input once."""
import importlib
import sys

import rospy

from waiting import wait


def main():
    rospy.init_node("stranger", anonymous=True, disable_signals=True)
    publishers = {}
    for line in sys.stdin:
        topic, module, name, data = line.split()
        kind = getattr(importlib.import_module(module), name)
        if topic not in publishers:
            publishers[topic] = rospy.Publisher(topic, kind, queue_size=100)
        publisher = publishers[topic]
        connected = wait(publisher.get_num_connections)
        message = kind()
        message.deserialize(bytes.fromhex(data))
        publisher.publish(message)
        print("sent" if connected else "nobody listens", flush=True)


if __name__ == "__main__":
    main()
