"""Files that are written whole or not at all."""
import contextlib
import os


@contextlib.contextmanager
def replacing(path):
    """The name to write to: it becomes `path` at the end, and is removed if that is not reached."""
    part = f"{path}.part"
    try:
        yield part
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)
