#!/usr/bin/python3
"""Damaged and forged bags against everything that reads bags: bag_mutations.py [--bags N] [--seed S]

Each bag is a mutation of one in tests/data/bags_1: flipped bits, cut ends, wrong lengths, swapped
records and chunks, other types, definitions and compressions, changed messages in a bag that is whole
again. verify_bag has to end with 0, 1 or 2 in time, and with 0 only if the bag still tells the very
same; the page and the pictures are made, or refused with a sentence. Prints counts; the exit status is
1 if one bag was worse than that.
"""
import argparse
import collections
import contextlib
import io
import os
import random
import struct
import subprocess
import sys
import tempfile
import time

import rosbag
import roslib.packages
from std_msgs.msg import String

from threelink_report import bag as reader
from threelink_report.episode import EpisodeError, read_episode
from threelink_report.episode_figure import draw_all, draw_path_alone
from threelink_report.player import page
from threelink_report.style import save, use_style

DATA = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "data", "bags_1")
LIMIT = 20  # [s] that anything may take with one bag


def originals():
    return sorted(os.path.join(DATA, name) for name in os.listdir(DATA) if name.endswith(".bag"))


# --- Mutations of the bytes -----------------------------------------------------------------------


def flip(data, chance, number=1):
    for _ in range(number):
        data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    return data


def flip_some(data, chance):
    return flip(data, chance, chance.randrange(2, 30))


def cut(data, chance):
    return data[:chance.randrange(len(data))]


def cut_in_the_index(data, chance):
    return data[:-chance.randrange(1, 5000)]


def leave_open(data, chance):
    """As a recorder leaves a bag that is killed: nothing of the index."""
    at = data.find(b"index_pos=") + len(b"index_pos=")
    index = struct.unpack_from("<Q", data, at)[0]
    data[at:at + 8] = bytes(8)
    return data[:index - chance.randrange(0, 2000)]


def remove(data, chance):
    at = chance.randrange(len(data))
    del data[at:at + chance.randrange(1, 300)]
    return data


def repeat(data, chance):
    at = chance.randrange(len(data))
    data[at:at] = data[at:at + chance.randrange(1, 300)]
    return data


def overwrite(data, chance):
    at = chance.randrange(len(data))
    for place in range(at, min(len(data), at + chance.randrange(1, 500))):
        data[place] = chance.randrange(256)
    return data


def zero_the_end(data, chance):
    at = chance.randrange(len(data))
    data[at:] = bytes(len(data) - at)
    return data


NAMES = (b"op=", b"conn=", b"time=", b"size=", b"count=", b"ver=", b"chunk_pos=", b"index_pos=",
         b"conn_count=", b"chunk_count=", b"start_time=", b"end_time=", b"topic=", b"md5sum=", b"type=",
         b"compression=", b"message_definition=")


def places(data, name):
    found, at = [], data.find(name)
    while at >= 0:
        found.append(at)
        at = data.find(name, at + 1)
    return found


def change_length(data, chance):
    """The length of a header's field, of its header or of the data after it."""
    at = chance.choice(places(data, chance.choice(NAMES)))
    at -= chance.choice((4, 8, 12))
    value = chance.choice((0, 1, 3, 5, 900000, 2 ** 31 - 1, 2 ** 31, 2 ** 32 - 1,
                           chance.randrange(2 ** 32)))
    data[at:at + 4] = struct.pack("<I", value)
    return data


def change_field(data, chance):
    """What a header's field holds, or what it is called."""
    name = chance.choice(NAMES)
    at = chance.choice(places(data, name))
    place = at + chance.randrange(len(name) + 8)
    data[place] = chance.randrange(256)
    return data


def records(data):
    """[(start, end)] of the messages in all chunks, and of the chunks with their indices."""
    messages, chunks, at = [], [], len(reader.MAGIC)
    while at + 8 <= len(data):
        start = at
        size = struct.unpack_from("<I", data, at)[0]
        header = reader.fields(memoryview(data)[at + 4:at + 4 + size]) or {}
        at += 4 + size
        length = struct.unpack_from("<I", data, at)[0]
        op = header.get("op")
        if op == bytes((reader.CHUNK,)):
            chunks.append([start, at + 4 + length])
            inner = at + 4
            while inner < at + 4 + length:
                first = inner
                for _ in range(2):
                    inner += 4 + struct.unpack_from("<I", data, inner)[0]
                messages.append((first, inner))
        elif op == bytes((reader.INDEX,)):
            chunks[-1][1] = at + 4 + length
        at += 4 + length
    return messages, [tuple(chunk) for chunk in chunks]


def swap(data, one, other):
    (a, b), (c, d) = sorted((one, other))
    return data[:a] + data[c:d] + data[b:c] + data[a:b] + data[d:]


def swap_messages(data, chance):
    """Two records of one size: all lengths still agree."""
    messages, _ = records(data)
    one = chance.choice(messages)
    same = [m for m in messages if m[1] - m[0] == one[1] - one[0] and m != one]
    return swap(data, one, chance.choice(same)) if same else flip(data, chance)


def swap_chunks(data, chance):
    _, chunks = records(data)
    return swap(data, *chance.sample(chunks, 2)) if len(chunks) > 1 else remove(data, chance)


def repeat_chunk(data, chance):
    start, end = chance.choice(records(data)[1])
    return data[:end] + data[start:end] + data[end:]


def lie_in_the_connections(data, chance):
    """The same change in every copy of a connection's record: nothing contradicts it."""
    old, new = chance.choice((
        (b"float64 power", b"float64 qower"), (b"float64[2] x_1 ", b"float64[2] x_7 "),
        (b"uint64 seed ", b"uint64 sead "), (b"/threelink/state", b"/threelink/stade"),
        (b"threelink_msgs/SwimmerState", b"threelink_msgs/SwimmerStane"), (b"md5sum=", b"md5sun="),
        (b"string reason", b"string raeson"), (b"/threelink/recording", b"/threelink/redording")))
    return bytearray(data.replace(old, new))


BYTES = (flip, flip, flip, flip_some, cut, cut_in_the_index, leave_open, remove, repeat, overwrite,
         zero_the_end, change_length, change_length, change_field, change_field, swap_messages,
         swap_messages, swap_chunks, repeat_chunk, lie_in_the_connections)


# --- Mutations of the messages, in a bag that is whole -------------------------------------------


def change_data(messages, chance):
    place = chance.randrange(len(messages))
    topic, (kind, data, *rest), stamp = messages[place]
    data = bytearray(data)
    for _ in range(chance.randrange(1, 4)):
        data[chance.randrange(len(data))] = chance.randrange(256)
    messages[place] = (topic, (kind, bytes(data), *rest), stamp)


def cut_data(messages, chance):
    place = chance.randrange(len(messages))
    topic, (kind, data, *rest), stamp = messages[place]
    data = data[:chance.randrange(len(data))] if chance.random() < 0.5 else data + b"more"
    messages[place] = (topic, (kind, data, *rest), stamp)


def change_length_in_data(messages, chance):
    """Lengths of strings and arrays, among other numbers."""
    place = chance.randrange(len(messages))
    topic, (kind, data, *rest), stamp = messages[place]
    data = bytearray(data)
    at = chance.randrange(len(data))
    data[at:at + 4] = struct.pack("<I", chance.choice((2 ** 32 - 1, 2 ** 31, 2 ** 24, 0)))
    messages[place] = (topic, (kind, bytes(data), *rest), stamp)


def leave_out(messages, chance):
    for _ in range(chance.randrange(1, 5)):
        del messages[chance.randrange(len(messages))]


def leave_out_topic(messages, chance):
    name = chance.choice(messages)[0]
    messages[:] = [message for message in messages if message[0] != name]


def double(messages, chance):
    messages.append(chance.choice(messages))


def change_time(messages, chance):
    place = chance.randrange(len(messages))
    topic, raw, _ = messages[place]
    stamp = messages[chance.randrange(len(messages))][2]
    messages[place] = (topic, raw, stamp)


def rename(messages, chance):
    old, new = (chance.choice(messages)[0] for _ in range(2))
    messages[:] = [(new if topic == old else topic, raw, stamp) for topic, raw, stamp in messages]


def change_config(messages, chance):
    lines = ((b"dt: 0.1", b"dt: .nan"), (b"dt: 0.1", b"dt: []\n"), (b"links: 3", b"links: 9"),
             (b"gamma: ", b"gamme: "), (b"simulator:", b"simulato_:"), (b"links: 3", b"links: &"),
             (b"length_scale: 1", b"length_scale: 0"), (b"joint_limit: 2", b"joint_limit: x"),
             (b"task:", b"tesk:"), (b"dt: 0.1", b"dt: {{{"))
    old, new = chance.choice(lines)
    messages[:] = [(topic, (raw[0], raw[1].replace(old, new), *raw[2:]), stamp)
                   if topic.endswith("/episode") and len(old) == len(new) else (topic, raw, stamp)
                   for topic, raw, stamp in messages]


def put_other_type(messages, chance):
    buffer = io.BytesIO()
    String("x").serialize(buffer)
    name = chance.choice(messages)[0]
    messages[:] = [message for message in messages if message[0] != name]
    messages.append((name, (String._type, buffer.getvalue(), String._md5sum, None, String),
                     messages[0][2] if messages else None))


MESSAGES = (change_data, change_data, cut_data, change_length_in_data, leave_out, leave_out_topic,
            double, change_time, rename, change_config, change_config, put_other_type)


def mutant(path, seed):
    """(name of the mutation, bytes) of the bag with that number."""
    chance = random.Random(seed)
    if chance.random() < 0.3:
        with tempfile.NamedTemporaryFile(suffix=".bag") as file:
            return write_mutant(path, file.name, chance)
    with open(path, "rb") as file:
        data = bytearray(file.read())
    change = chance.choice(BYTES)
    return change.__name__, bytes(change(data, chance))


def write_mutant(path, target, chance):
    with rosbag.Bag(path) as old:
        messages = list(old.read_messages(raw=True))
    change = chance.choice(MESSAGES)
    messages = [tuple(message) for message in messages]
    change(messages, chance)
    compression = "bz2" if chance.random() < 0.05 else "none"
    with rosbag.Bag(target, "w", compression, chance.choice((2048, 16384, 768 * 1024))) as new:
        for topic, raw, stamp in messages:
            new.write(topic, raw, stamp, raw=True)
    with open(target, "rb") as file:
        return change.__name__ + (" (bz2)" if compression == "bz2" else ""), file.read()


# --- Readers --------------------------------------------------------------------------------------


def verify(path):
    """(exit status, what it said); status None if it took too long."""
    program = roslib.packages.find_node("threelink_tasks", "verify_bag")[0]
    try:
        done = subprocess.run([program, path], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return None, ""
    return done.returncode, done.stdout.decode(errors="replace")


def told(path):
    """What a bag tells, for comparison; None if it cannot be read."""
    try:
        return sorted(tuple(message) for message in reader.read_messages(path))
    except reader.BagError:
        return None


def show(path):
    """"shown", or "refused"; raises what is neither."""
    try:
        episode = read_episode(path)
    except EpisodeError:
        return "refused"
    page(episode)
    with tempfile.TemporaryDirectory() as folder:
        save(draw_all(episode), os.path.join(folder, "all.png"))
        save(draw_path_alone(episode), os.path.join(folder, "path.png"))
    return "shown"


def judge(original, name, data, folder):
    """(verdict, None or what was wrong) of one mutant."""
    path = os.path.join(folder, "mutant.bag")
    with open(path, "wb") as file:
        file.write(data)
    start = time.monotonic()
    status, text = verify(path)
    if status not in (0, 1, 2):
        return "worse", f"{name}: verify_bag ended with {status}: {text[:500]}"
    if status == 0 and told(path) != told(original):
        return "worse", f"{name}: verify_bag says OK of a bag that tells something else"
    try:
        shown = show(path)
    except Exception as error:  # pylint: disable=broad-except
        return "worse", f"{name}: {type(error).__name__}: {error}"
    if time.monotonic() - start > LIMIT:
        return "worse", f"{name}: {time.monotonic() - start:.1f} s"
    return f"{('proven', 'not proven', 'unreadable')[status]}, {shown}", None


def survey(number, seed, report=lambda done: None):
    """({verdict: count}, [what was wrong]) of so many mutants."""
    use_style()
    counts, wrong = collections.Counter(), []
    paths = originals()
    with tempfile.TemporaryDirectory() as folder:
        for index in range(number):
            path = paths[index % len(paths)]
            name, data = mutant(path, f"{seed} {index}")
            with contextlib.redirect_stdout(io.StringIO()):
                verdict, trouble = judge(path, name, data, folder)
            counts[verdict] += 1
            if trouble:
                wrong.append(f"bag {index} (seed {seed}), {trouble}")
            report(index + 1)
    return counts, wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n\n")[2],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bags", type=int, default=1000, help="how many (1000)")
    parser.add_argument("--seed", type=int, default=1, help="keys all mutations (1)")
    options = parser.parse_args()
    start = time.monotonic()
    counts, wrong = survey(options.bags, options.seed)
    for verdict, count in sorted(counts.items()):
        print(f"{count:6} {verdict}")
    print(f"{options.bags} bags in {time.monotonic() - start:.0f} s, {len(wrong)} worse")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
