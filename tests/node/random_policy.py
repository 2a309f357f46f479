"""A policy file with random weights, for any swimmer, for tests."""
import hashlib
import json
import random
import struct


def write_policy(path, links=3, dt=0.1, gamma=0.5, observation="direction", seed=0, **metadata):
    """Returns the file's sha256 field. Further metadata, such as joint_limit, are text."""
    hinges = links - 1
    inputs = 2 + hinges + (3 if observation == "target" else 0)
    shapes = {"actor.0.weight": [8, inputs], "actor.0.bias": [8],
              "actor.2.weight": [hinges, 8], "actor.2.bias": [hinges], "log_std": [hinges]}
    numbers = random.Random(seed)
    header, data = {}, b""
    for name, shape in shapes.items():
        count = shape[0] * (shape[1] if len(shape) > 1 else 1)
        values = struct.pack("<%df" % count, *(numbers.uniform(-1, 1) for _ in range(count)))
        header[name] = {"dtype": "F32", "shape": shape,
                        "data_offsets": [len(data), len(data) + len(values)]}
        data += values
    sha256 = hashlib.sha256(data).hexdigest()
    header["__metadata__"] = dict(
        metadata, format="threelink-policy-1", observation=observation, action="hinge_rates",
        links=str(links), dt=repr(dt), gamma=repr(gamma), config="", sha256=sha256,
        header_sha256="0" * 64)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    text = text.replace(b'"header_sha256": "' + b"0" * 64,
                        b'"header_sha256": "' + hashlib.sha256(text).hexdigest().encode())
    with open(path, "wb") as file:
        file.write(struct.pack("<Q", len(text)) + text + data)
    return sha256
