"""Exceptions of claray. Each message is one line: what failed, where, and what to do."""


class Error(RuntimeError):
    """Base class of all errors that claray raises itself."""


class InputError(Error):
    """A file, mesh or scene that cannot be used, or a full disk."""


class UsageError(Error, ValueError):
    """An argument with an invalid value. The message begins with the argument's name."""

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.split()))  # what NumPy writes of an array has several lines


class DeviceError(Error):
    """OpenCL: no platform, a failed kernel build, or too little device memory."""
