#!/usr/bin/python3
"""Runs a command in a network of its own, the loopback: isolate.py COMMAND [ARGUMENT ...]

No port of the command, or of what it starts, can be reached from outside, whatever address it is
bound to; nor can it reach anything there. The command takes this process's place, so that terminal,
signals and exit status are its own, and it keeps user and group. Status 2: the kernel does not allow
it; 126 and 127: the command cannot be run, or there is none of that name.
"""
import ctypes
import errno
import fcntl
import os
import signal
import socket
import struct
import sys

CLONE_NEWUSER, CLONE_NEWNET = 0x10000000, 0x40000000
SIOCGIFFLAGS, SIOCSIFFLAGS, IFF_UP = 0x8913, 0x8914, 1


def unshare(flags):
    """What os.unshare() is from Python 3.12 on."""
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(flags) != 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def leave_network():
    """Into a new network namespace; who may not make one makes it in a new user namespace, in which
    user and group stay what they are."""
    user, group = os.geteuid(), os.getegid()
    try:
        unshare(CLONE_NEWNET)
    except PermissionError:
        unshare(CLONE_NEWUSER | CLONE_NEWNET)
        write("/proc/self/setgroups", "deny")
        write("/proc/self/uid_map", "%d %d 1" % (user, user))
        write("/proc/self/gid_map", "%d %d 1" % (group, group))


def raise_loopback():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        request = struct.pack("16sH14x", b"lo", 0)
        _, flags = struct.unpack("16sH14x", fcntl.ioctl(any_socket, SIOCGIFFLAGS, request))
        fcntl.ioctl(any_socket, SIOCSIFFLAGS, struct.pack("16sH14x", b"lo", flags | IFF_UP))


def main(command):
    if not command:
        print("isolate: no command is given", file=sys.stderr)
        return 2
    try:
        leave_network()
        raise_loopback()
    except OSError as error:
        cause = "no more namespaces" if error.errno == errno.ENOSPC else error.strerror
        print("isolate: no network of its own can be made: %s. Root may, and where the kernel lets "
              "them, ordinary users (user namespaces; not in a chroot and in many containers)"
              % cause, file=sys.stderr)
        return 2
    for number in (signal.SIGPIPE, signal.SIGXFSZ):  # Python ignores them, and the command would
        signal.signal(number, signal.SIG_DFL)
    try:
        os.execvp(command[0], command)
    except OSError as error:
        print("isolate: %s: %s" % (command[0], error.strerror), file=sys.stderr)
        return 127 if error.errno == errno.ENOENT else 126


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
