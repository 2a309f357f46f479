#!/usr/bin/python3
"""A node that nobody asked for: it says everything that the type of a topic lets it say.

  strangers.py [--count N] [--seed S] GROUP    N messages on each topic of a group; prints their number
"""
import argparse
import io
import random
import re
import struct
import time

import genpy
import rospy
from geometry_msgs.msg import PointStamped, PoseStamped
from sensor_msgs.msg import JointState
from threelink_msgs.msg import (Episode, EpisodeAbort, EpisodeBatch, HingeRates, Leases,
                                Observation, PolicyWeights, Recording, SwimmerState,
                                TrainingStatus, WorkerStatus)

NAMESPACE = "/threelink/"
GROUPS = {
    "training": {"workers": WorkerStatus, "episodes": EpisodeBatch, "leases": Leases,
                 "policy": PolicyWeights, "training_status": TrainingStatus},
    "loop": {"state": SwimmerState, "target": PointStamped, "observation": Observation,
             "hinge_rates": HingeRates, "episode": Episode, "abort": EpisodeAbort,
             "recording": Recording, "joint_states": JointState, "pose": PoseStamped,
             "policy": PolicyWeights},
}
TEXTS = ["", "/threelink/worker_1", "/threelink/learner", "world", "direction", "\x1b[2J\x07",
         "../../outside", "a,b\nc", "&a [*a]", "x" * 100000, "\x00" * 50, "\u202eabc", "%s%n"]
NUMBERS = [0.0, -0.0, 1.0, -1.0, 0.5, 1e308, -1e308, 5e-324, float("nan"), float("inf"),
           float("-inf")]
CLAIM = 400000000  # elements of an array that are not there


def raw(kind):
    """A class of messages of that type, whose bytes are what one likes."""
    return type("Raw" + kind.__name__, (genpy.Message,), {
        "_type": kind._type, "_md5sum": kind._md5sum, "_full_text": kind._full_text,
        "_has_header": False, "__slots__": ["data"], "_slot_types": ["uint8[]"],
        "serialize": lambda self, buff: buff.write(self.data)})


def bytes_of(message):
    buff = io.BytesIO()
    message.serialize(buff)
    return buff.getvalue()


def claims(kind):
    """A small message with one length, or number, replaced: a claim of gigabytes, at each place."""
    empty = bytes_of(kind())
    for offset in range(0, len(empty) - 3):
        yield empty[:offset] + struct.pack("<I", CLAIM) + empty[offset + 4:]


class Stranger:
    def __init__(self, group, seed=0):
        self.chance = random.Random(seed)
        self.kinds = {NAMESPACE + name: kind for name, kind in GROUPS[group].items()}
        self.raw = {topic: raw(kind) for topic, kind in self.kinds.items()}
        self.publishers = {topic: rospy.Publisher(topic, kind, queue_size=1000)
                           for topic, kind in self.raw.items()}
        self.heard = {topic: [] for topic in self.kinds}  # what others said, to be repeated
        self.subscribers = [rospy.Subscriber(topic, rospy.AnyMsg, self.listen, topic)
                            for topic in self.kinds]

    def end(self):
        for topic in list(self.publishers.values()) + self.subscribers:
            topic.unregister()

    def listen(self, message, topic):
        if message._connection_header["callerid"] == rospy.get_name():
            return
        heard = self.heard[topic]
        heard.append(message._buff)
        if len(heard) > 20:
            del heard[self.chance.randrange(20)]

    def number(self, kind):
        if kind in ("float32", "float64"):
            value = self.chance.choice(NUMBERS)
            return value if kind == "float64" else max(-3e38, min(3e38, value))
        if kind == "bool":
            return self.chance.random() < 0.5
        bits = int(kind.lstrip("uint"))
        low, high = (0, 2 ** bits - 1) if kind[0] == "u" else (-2 ** (bits - 1), 2 ** (bits - 1) - 1)
        return self.chance.choice([0, 1, 2, 3, high, high // 2 + 1, low, self.chance.randint(low, high)])

    def value(self, kind):
        if kind.endswith("]"):
            kind, _, size = kind[:-1].rpartition("[")
            size = int(size) if size else self.chance.choice([0, 1, 2, 3, 30])
            if kind in ("uint8", "char"):
                return bytes(self.chance.getrandbits(8) for _ in range(size))
            return [self.value(kind) for _ in range(size)]
        if kind == "string":
            return self.chance.choice(TEXTS)
        if kind in ("time", "duration"):
            return rospy.Time(self.chance.choice([0, 1, 2 ** 31, 2 ** 32 - 1]),
                              self.chance.randrange(10 ** 9))
        if "/" in kind or kind == "Header":
            kind = "std_msgs/Header" if kind == "Header" else kind
            return self.filled(genpy.message.get_message_class(kind)
                               if hasattr(genpy.message, "get_message_class")
                               else __import__("roslib.message").message.get_message_class(kind))
        return self.number(kind)

    def filled(self, kind):
        message = kind()
        for slot, slot_type in zip(kind.__slots__, kind._slot_types):
            setattr(message, slot, self.value(slot_type))
        return message

    def message(self, topic):
        kind, heard = self.kinds[topic], self.heard[topic]
        case = self.chance.randrange(5)
        if case == 0:
            return bytes(self.chance.getrandbits(8) for _ in range(self.chance.randrange(200)))
        if case == 1:
            return self.chance.choice(list(claims(kind)))
        if case >= 3 and heard:
            message = bytearray(self.chance.choice(heard))
            if case == 4 and message:  # as it was, or with a few other bytes
                for _ in range(self.chance.randint(1, 8)):
                    message[self.chance.randrange(len(message))] = self.chance.getrandbits(8)
            return bytes(message)
        return bytes_of(self.filled(kind))

    def connected(self):
        return all(publisher.get_num_connections() > 0 for publisher in self.publishers.values())

    def say_once(self):
        """A message on each topic."""
        for topic, publisher in self.publishers.items():
            message = self.raw[topic]()
            message.data = self.message(topic)
            publisher.publish(message)


def said(process):
    """How many messages a stranger of this program has said, by its output."""
    numbers = re.findall(r"^\d+$", process.text(), re.MULTILINE)
    return int(numbers[-1]) if numbers else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("group", choices=sorted(GROUPS))
    options = parser.parse_args()
    rospy.init_node("stranger", disable_rosout=True)
    stranger = Stranger(options.group, options.seed)
    time.sleep(1)  # connections come as the others do; who is not there is not disturbed
    said = 0
    while said < options.count and not rospy.is_shutdown():
        stranger.say_once()
        said += 1
        if said % 100 == 0:
            print(said * len(stranger.publishers), flush=True)


if __name__ == "__main__":
    main()
