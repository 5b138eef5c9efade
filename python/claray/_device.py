"""Devices, and events of their queues."""

from __future__ import annotations

import atexit
from typing import Any, Iterable

from . import _native
from ._arrays import pointer


def devices() -> list[dict[str, Any]]:
    """All OpenCL devices of this machine. Memory is in bytes. Raises DeviceError if there is no OpenCL platform."""
    return _native.list_devices()


class Device:
    """An OpenCL device with an in-order queue.

    selector: "cpu", "gpu", an index of devices(), or a part of the name. Empty: $CLARAY_DEVICE, else the first GPU, else
    the first device. Raises UsageError if no device or several match, DeviceError if there is no OpenCL platform.

    Several threads may use one device; their calls then run one after another.
    """

    def __init__(self, selector: str | int = "") -> None:
        self._native = _native.NativeDevice.open(str(selector))

    @classmethod
    def adopt(cls, context: Any, queue: Any) -> Device:
        """Uses a context and an in-order queue of pyopencl (or their int_ptr). Both are retained."""
        return cls._of(_native.NativeDevice.adopt(pointer("context", context), pointer("queue", queue)))

    @classmethod
    def _of(cls, native: Any) -> Device:
        device = cls.__new__(cls)
        device._native = native
        return device

    def with_new_queue(self) -> Device:
        """The same device and context with another queue, for queries that run at the same time."""
        return Device._of(self._native.with_new_queue())

    @property
    def info(self) -> dict[str, Any]:
        """Properties of the device, as devices() lists them."""
        return self._native.info()

    @property
    def name(self) -> str:
        return self.info["name"]

    @property
    def type(self) -> str:
        """"cpu", "gpu" or "other"."""
        return self.info["type"]

    @property
    def context_ptr(self) -> int:
        """The cl_context, for pyopencl.Context.from_int_ptr."""
        return self._native.context_ptr()

    @property
    def queue_ptr(self) -> int:
        """The cl_command_queue, for pyopencl.CommandQueue.from_int_ptr."""
        return self._native.queue_ptr()

    def finish(self) -> None:
        """Waits for all commands of the queue."""
        self._native.finish()

    def __repr__(self) -> str:
        return f"claray.Device({self.name!r}, {self.type!r})"


class Event:
    """The end of enqueued commands."""

    def __init__(self, event: Any) -> None:
        """event: an event of pyopencl, or its int_ptr. It is retained."""
        self._native = _native.NativeEvent.adopt(pointer("event", event))
        self._alive: tuple[Any, ...] = ()

    @classmethod
    def _of(cls, native: Any, alive: tuple[Any, ...] = ()) -> Event:
        event = cls.__new__(cls)
        event._native, event._alive = native, alive
        return event

    @property
    def done(self) -> bool:
        return self._native.done()

    @property
    def int_ptr(self) -> int:
        """The cl_event, for pyopencl.Event.from_int_ptr."""
        return self._native.ptr()

    def wait(self) -> None:
        """Waits for the commands. Raises DeviceError if they failed."""
        self._native.wait()
        self._alive = ()


def native_events(events: Iterable[Any]) -> list[Any]:
    return [e._native if isinstance(e, Event) else _native.NativeEvent.adopt(pointer("wait_for", e)) for e in events]


_default: Device | None = None


def default_device() -> Device:
    """The device that is used where none is given: Device(), opened at the first call."""
    global _default
    if _default is None:
        _default = Device()
    return _default


@atexit.register
def _close() -> None:
    global _default  # drivers must not be used while the process ends
    if _default is not None:
        _default.finish()
    _default = None
