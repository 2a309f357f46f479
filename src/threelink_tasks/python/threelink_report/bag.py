"""Messages of a bag: the one way in which this package reads a bag file, of format 2.0.

As src/core/bag_reader.hpp does, it believes nothing that the file does not say twice: the messages in
its chunks are those of its index, and no byte is left over. Messages are read by the definitions that
are installed here, not by those that a file brings.
"""
import collections
import io
import logging
import os
import stat
import struct

import genpy

MAGIC = b"#ROSBAG V2.0\n"
MESSAGE, HEADER, INDEX, CHUNK, CHUNK_INFO, CONNECTION = 2, 3, 4, 5, 6, 7
MOST_FIELDS = 24  # of a header
MOST_BYTES = 2 ** 32 - 1
LENGTH = struct.Struct("<I")
LONG = struct.Struct("<Q")
TIME = struct.Struct("<II")
ENTRY = struct.Struct("<III")  # of an index: seconds, nanoseconds, offset
COUNT = struct.Struct("<II")  # of a chunk's summary: connection, number of messages


# What genpy finds wrong with a text, and replaces, is nothing for standard error.
logging.getLogger("rosout").addHandler(logging.NullHandler())


class BagError(ValueError):
    """What is no bag, or not as the format wants it; the text says why, for people."""


Message = collections.namedtuple("Message", "topic type md5sum time data")
Record = collections.namedtuple("Record", "at fields data")
Stored = collections.namedtuple("Stored", "time offset first_offset")


def read_messages(path):
    """Every Message of a bag, in the order of their times; raises BagError or OSError."""
    try:
        messages = Reader(read_file(path)).messages
    except BagError as error:
        raise BagError(f"{path}: {error}") from None
    return sorted(messages, key=lambda message: message.time)


def decode(message, kind):
    """A Message as the class `kind`; raises BagError if it is not of that type."""
    if (message.type, message.md5sum) != (kind._type, kind._md5sum):
        raise BagError(f"{message.topic} is of another type, {printable(message.type)} "
                       f"({printable(message.md5sum)}), than {kind._type} ({kind._md5sum})")
    decoded = kind()
    try:
        decoded.deserialize(message.data)
        again = io.BytesIO()
        decoded.serialize(again)
    except (genpy.MessageException, struct.error, ValueError, OverflowError) as error:
        raise BagError(f"{message.topic}: a damaged message: {error}") from None
    if len(again.getvalue()) != len(message.data):
        raise BagError(f"{message.topic}: a damaged message: bytes after its end")
    return decoded


def printable(text):
    """The text without what could do more to a terminal or picture than be seen."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


def read_file(path):
    # Opening a pipe must not wait for its writer.
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            raise BagError("it is not a file")
        if status.st_size > MOST_BYTES:
            raise BagError(f"it has {status.st_size} bytes, more than {MOST_BYTES}")
        with open(descriptor, "rb", closefd=False) as file:
            return file.read()
    finally:
        os.close(descriptor)


class Reader:
    """Reads and checks the bytes of a bag; `messages` are in the order of the file."""

    def __init__(self, data):
        self.data = memoryview(data)
        self.connections, self.chunks, self.messages = {}, [], []
        if not data:
            raise BagError("it is empty")
        if not data.startswith(MAGIC):
            raise BagError("it is no bag of format 2.0")
        header, at = self.next(len(MAGIC), len(data), HEADER, 4)
        index = number(header, "index_pos", LONG)
        count, chunks = number(header, "conn_count"), number(header, "chunk_count")
        if bytes(header.data).strip(b" "):
            raise damaged(header.at, "the padding of its header")
        if index == 0 or index > len(data):
            raise cut_off(len(data))
        while at < index:
            at = self.read_chunk(at)
        if at != index:
            raise damaged(at, "a record that reaches into the index")
        listed = set()
        for _ in range(count):
            record, at = self.next(at, len(data), CONNECTION, 3)
            listed.add(self.check_connection(record))
        if count != len(listed) or listed != set(self.connections) or chunks != len(self.chunks):
            raise damaged(header.at, "numbers of connections and chunks that are not those in the file")
        for chunk in self.chunks:
            record, at = self.next(at, len(data), CHUNK_INFO, 6)
            check_chunk_info(record, chunk)
        if at != len(data):
            raise damaged(at, "bytes after its end")

    def next(self, at, end, op, count):
        """The Record at a place, which has to be of that kind and have so many fields; its end."""
        parts, place = [], at
        for _ in range(2):
            size = LENGTH.unpack_from(self.data, place)[0] if place + 4 <= end else end
            place += 4 + size
            if place > end:
                if end == len(self.data):
                    raise cut_off(at)
                raise damaged(at, "a record that is longer than its chunk")
            parts.append(self.data[place - size:place])
        header = fields(parts[0])
        if header is None:
            raise damaged(at, "what should be the header of a record")
        if header.get("op") != bytes((op,)) or len(header) != count:
            raise damaged(at, "a record of another kind than belongs there")
        return Record(at, header, parts[1]), place

    def read_chunk(self, at):
        """Reads a chunk and the index of it that follows; returns where that ends."""
        chunk, after = self.next(at, len(self.data), CHUNK, 3)
        compression = chunk.fields.get("compression")
        if compression in (b"bz2", b"lz4"):
            raise BagError(f"it is compressed ({compression.decode()}): `rosbag decompress` first")
        if compression != b"none" or number(chunk, "size") != len(chunk.data):
            raise damaged(at, "the header of a chunk")
        contents = self.read_contents(after - len(chunk.data), after)
        times = [stored.time for messages in contents.values() for stored in messages]
        counts = {id: len(messages) for id, messages in contents.items()}
        self.chunks.append((at, min(times, default=(0, 0)), max(times, default=(0, 0)), counts))
        at = after
        for _ in range(len(contents)):
            record, at = self.next(at, len(self.data), INDEX, 4)
            check_index(record, contents)
        return at

    def read_contents(self, start, end):
        """{connection: [Stored]} of the records of a chunk."""
        contents = {}
        announced, at = None, start  # the first of connection records in a row
        while at < end:
            if self.is_connection(at, end):
                if announced is None:
                    announced = at - start
                record, at = self.next(at, end, CONNECTION, 3)
                self.announce(record)
                continue
            offset = at - start
            record, at = self.next(at, end, MESSAGE, 3)
            id = number(record, "conn")
            if id not in self.connections:
                raise damaged(record.at, "a message of a connection that was not announced")
            when = time(field(record, "time", 8), record.at)
            contents.setdefault(id, []).append(
                Stored(when, offset, offset if announced is None else announced))
            self.messages.append(Message(*self.connections[id][2], when, bytes(record.data)))
            announced = None
        return contents

    def is_connection(self, at, end):
        size = LENGTH.unpack_from(self.data, at)[0] if at + 4 <= end else end
        header = fields(self.data[at + 4:at + 4 + size]) if at + 4 + size <= end else None
        return bool(header) and header.get("op") == bytes((CONNECTION,))

    def announce(self, record):
        id, data = number(record, "conn"), fields(record.data)
        if data is None or "topic" not in record.fields:
            raise damaged(record.at, "the record of a connection")
        if id in self.connections:
            self.check_connection(record)
            return
        for name in ("type", "md5sum", "message_definition"):
            if name not in data:
                raise damaged(record.at, f"a connection without `{name}`")
        topic = record.fields["topic"]
        if data.get("topic", topic) != topic:
            raise damaged(record.at, "a connection of two topics")
        described = [value.decode(errors="replace") for value in (topic, data["type"], data["md5sum"])]
        self.connections[id] = (record.fields, data, described)

    def check_connection(self, record):
        """The number of a connection that was announced before."""
        id = number(record, "conn")
        known = self.connections.get(id)
        if known is None or known[:2] != (record.fields, fields(record.data)):
            raise damaged(record.at, "a connection that is not the one before its messages")
        return id


def check_index(record, contents):
    count = number(record, "count")
    messages = contents.pop(number(record, "conn"), None)
    if messages is None or number(record, "ver") != 1 or len(messages) != count or \
            len(record.data) != ENTRY.size * count:
        raise damaged(record.at, "an index that is not that of its chunk")
    for (seconds, nanoseconds, offset), message in zip(ENTRY.iter_unpack(record.data),
                                                       sorted(messages)):
        if (seconds, nanoseconds) != message.time:
            raise damaged(record.at, "the index gives a message another time than its record")
        if offset not in message[1:]:
            raise damaged(record.at, "the index gives a message another place than it has")


def check_chunk_info(record, chunk):
    start, end = (time(field(record, name, 8), record.at) for name in ("start_time", "end_time"))
    told = (number(record, "chunk_pos", LONG), start, end)
    if told != chunk[:3] or number(record, "ver") != 1 or number(record, "count") != len(chunk[3]) or \
            len(record.data) != COUNT.size * len(chunk[3]) or \
            dict(COUNT.iter_unpack(record.data)) != chunk[3]:
        raise damaged(record.at, "a summary that is not that of its chunk")


def fields(data):
    """{name: value} of a header; None if it is none, has too many fields or one of them twice."""
    found, at = {}, 0
    while at < len(data):
        if at + 4 > len(data):
            return None
        end = at + 4 + LENGTH.unpack_from(data, at)[0]
        name, equals, value = bytes(data[at + 4:end]).partition(b"=")
        name = name.decode("latin-1")
        if end > len(data) or not equals or name in found or len(found) == MOST_FIELDS:
            return None
        found[name] = value
        at = end
    return found


def field(record, name, size):
    value = record.fields.get(name, b"")
    if len(value) != size:
        raise damaged(record.at, f"a header without a proper `{name}`")
    return value


def number(record, name, form=LENGTH):
    return form.unpack(field(record, name, form.size))[0]


def time(data, at):
    seconds, nanoseconds = TIME.unpack(data)
    if nanoseconds >= 10 ** 9:
        raise damaged(at, "a time that is none")
    return seconds, nanoseconds


def damaged(at, what):
    return BagError(f"it is damaged at byte {at}: {what}")


def cut_off(at):
    return BagError(f"it is cut off, or was not closed (byte {at}): `rosbag reindex` may mend it")
