"""Files that are written whole or not at all."""
import contextlib
import os
import tempfile


class OutputError(OSError):
    """What could not be written."""


@contextlib.contextmanager
def replacing(path):
    """The name to write to: it becomes `path` at the end, and is removed if that is not reached.

    Whatever of the file system fails until then is an OutputError that names `path`.
    """
    part = None
    try:
        # A name that nobody knows before, in a file that was not there before.
        descriptor, part = tempfile.mkstemp(".part", ".threelink_", os.path.dirname(path) or ".")
        os.fchmod(descriptor, 0o666 & ~umask())
        os.close(descriptor)
        yield part
        descriptor = os.open(part, os.O_RDONLY)
        os.fsync(descriptor)
        os.close(descriptor)
        os.replace(part, path)
    except OSError as error:
        raise OutputError(error.errno, error.strerror or str(error), path) from error
    finally:
        if part and os.path.exists(part):
            os.remove(part)


def umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask
