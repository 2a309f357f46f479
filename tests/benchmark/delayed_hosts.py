"""Two hosts whose packets take their time: a forwarder between two tun devices."""
import collections
import ctypes
import fcntl
import multiprocessing
import os
import select
import struct
import subprocess
import time

from hosts import Hosts

TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 1, 0x1000


class DelayedHosts(Hosts):
    """delay: [s] from one host to the other."""

    def __init__(self, delay):
        super().__init__()
        self.delay = delay

    def lay_cable(self):
        ends = []
        for device, name in zip(self.devices, self.names):
            end = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
            fcntl.ioctl(end, TUNSETIFF, struct.pack("16sH", device.encode(), IFF_TUN | IFF_NO_PI))
            subprocess.run(["ip", "link", "set", device, "netns", name], check=True)
            ends.append(end)
        self.forwarder = multiprocessing.Process(target=forward, args=(ends, self.delay))
        self.forwarder.daemon = True
        self.forwarder.start()
        for end in ends:
            os.close(end)

    def __exit__(self, *_):
        self.forwarder.terminate()
        self.forwarder.join()
        super().__exit__()


def forward(ends, delay):
    """What comes out of one end goes into the other `delay` later."""
    ctypes.CDLL(None).prctl(1, 15)  # ends with its parent
    other = dict(zip(ends, reversed(ends)))
    waiting = collections.deque()  # (when, where, packet): in the order of time, the delay being one
    while True:
        patience = max(0, waiting[0][0] - time.monotonic()) if waiting else None
        for end in select.select(ends, [], [], patience)[0]:
            for _ in range(64):
                try:
                    packet = os.read(end, 65536)
                except BlockingIOError:
                    break
                waiting.append((time.monotonic() + delay, other[end], packet))
        while waiting and waiting[0][0] <= time.monotonic():
            _, end, packet = waiting.popleft()
            try:
                os.write(end, packet)
            except OSError:
                pass  # the device is down, or full
