"""Devices, and events of their queues."""

from __future__ import annotations

import atexit
import operator
from typing import Any, Iterable, Union

from . import _native
from ._arrays import members, naming, pointer
from ._handle import Handle
from .errors import UsageError


def devices() -> list[dict[str, Any]]:
    """All OpenCL devices of this machine. Memory is in bytes. Raises DeviceError if there is no OpenCL platform."""
    return _native.list_devices()


class Device(Handle):
    """An OpenCL device with an in-order queue.

    selector: "cpu", "gpu", an index of devices(), or a part of the name. Empty: $CLARAY_DEVICE, else the first GPU, else
    the first device. Raises UsageError if no device or several match, DeviceError if there is no OpenCL platform.

    Several threads may use one device; their calls then run one after another.
    """

    __slots__ = ("_native",)
    _instead_of_pickling = "pass its index or name, and open it in each process"

    def __init__(self, selector: str | int = "") -> None:
        self._native = _native_device("selector", selector)

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
        info: dict[str, Any] = self._native.info()
        return info

    @property
    def name(self) -> str:
        return str(self.info["name"])

    @property
    def type(self) -> str:
        """"cpu", "gpu" or "other"."""
        return str(self.info["type"])

    @property
    def context_ptr(self) -> int:
        """The cl_context, for pyopencl.Context.from_int_ptr."""
        return int(self._native.context_ptr())

    @property
    def queue_ptr(self) -> int:
        """The cl_command_queue, for pyopencl.CommandQueue.from_int_ptr."""
        return int(self._native.queue_ptr())

    def finish(self) -> None:
        """Waits for all commands of the queue."""
        self._native.finish()

    def __repr__(self) -> str:
        return f"claray.Device({self.name!r}, {self.type!r})"


class Event(Handle):
    """The end of enqueued commands."""

    __slots__ = ("_native", "_alive")
    _instead_of_pickling = "wait for it in this process"

    def __init__(self, event: Any) -> None:
        """event: an event of pyopencl, or its int_ptr. It is retained."""
        self._native = _native.NativeEvent.adopt(pointer("event", event))
        self._alive = ()

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

    def __repr__(self) -> str:
        return f"<claray.Event: {'done' if self.done else 'pending'}>"


def native_events(events: Iterable[Any]) -> list[Any]:
    return [e._native if isinstance(e, Event) else _native.NativeEvent.adopt(pointer("wait_for", e))
            for e in members("wait_for", events, "events")]


AnyDevice = Union[Device, str, int, None]
"""Where a device is asked for: a Device; "cpu", "gpu", an index of devices() or a part of a name; None: default_device()."""

_opened: dict[str, Device] = {}


def _selector(name: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    try:
        if not isinstance(value, bool) and operator.index(value) >= 0:
            return str(operator.index(value))
    except TypeError:
        pass
    raise UsageError(f"{name}: is {value!r}; use a claray.Device, 'cpu', 'gpu', an index of claray.devices() or a part of a name")


def _native_device(name: str, selector: Any) -> Any:
    text = _selector(name, selector)
    with naming(name):
        return _native.NativeDevice.open(text)


def device_of(device: AnyDevice) -> Device:
    """The device. What is not a Device is opened once, so that structures share its memory."""
    if isinstance(device, Device):
        return device
    selector = "" if device is None else _selector("device", device)
    if selector not in _opened:
        made = Device._of(_native_device("device", selector))
        _opened[selector] = next((one for one in _opened.values() if one.info["index"] == made.info["index"]), made)
    return _opened[selector]


def default_device() -> Device:
    """The device that is used where none is given: Device(), opened at the first call."""
    return device_of(None)


@atexit.register
def _close() -> None:
    """Drivers must not be used while the process ends."""
    if not _native.is_forked():
        for device in set(_opened.values()):
            device.finish()
    _opened.clear()
