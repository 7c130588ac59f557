"""RoBIOS-7 for robot programs in Python: `from eye import *`.

`eyesim run` runs a program with this module, even if another `eye.py` is beside it; a copy beside the program is for editors.
Functions, constants and units are those of C (millimetres, degrees, milliseconds). Values that C writes through pointers
are returned: `x, y, phi = VWGetPosition()`. Images are flat `bytearray`s, with three bytes per pixel in colour. Functions
accept any buffer as an image, such as a numpy array; `image.array()` is a numpy array with rows and columns.

Time is the robot's virtual time in `time.time`, `time.monotonic`, `time.perf_counter` and `time.sleep`; `random` and
`os.urandom` draw from the robot's own stream.
"""

import array as _array
import collections as _collections
import ctypes as _ctypes
import io as _io
import mmap as _mmap
import opcode as _opcode
import os as _os
import platform as _platform
import random as _random
import signal as _signal
import struct as _struct
import sys as _sys
import time as _time
import _thread

# ---- constants ----

# @CONSTANTS@

# Functions that only RoBIOS 6 has.
_ROBIOS6_ONLY = frozenset("""
# @ROBIOS6@
""".split())

PSD_FRONT2, PSD_LEFTDIAG, PSD_RIGHTDIAG = 5, 6, 7
CAM_SUCCESS, CAM_FAILURE = 0, 1
MACHINE_SPEED, MACHINE_TYPE, MACHINE_NAME, MACHINE_ID, VERSION = 700000000, VEHICLE, "EyeBot", 1, "1.0"
LIDAR_RESOLUTION = 360

QQVGA_X, QVGA_X, VGA_X, CAM1MP_X, CAMHD_X, CAM5MP_X = 160, 320, 640, 1296, 1920, 2592
QQVGA_Y, QVGA_Y, VGA_Y, CAM1MP_Y, CAMHD_Y, CAM5MP_Y = 120, 240, 480, 730, 1080, 1944
_SIZES = {}
CAMWIDTHARR, CAMHEIGHTARR, CAMPIXELSARR, CAMSIZEARR = {}, {}, {}, {}
for _name in ("QQVGA", "QVGA", "VGA", "CAM1MP", "CAMHD", "CAM5MP", "CUSTOM"):
    _x, _y = globals().get(_name + "_X", 0), globals().get(_name + "_Y", 0)
    _mode = globals()[_name]
    CAMWIDTHARR[_mode], CAMHEIGHTARR[_mode], CAMPIXELSARR[_mode], CAMSIZEARR[_mode] = _x, _y, _x * _y, 3 * _x * _y
    if _x:
        _SIZES[_mode] = _x, _y
        globals().update({_name + "_PIXELS": _x * _y, _name + "_SIZE": 3 * _x * _y})
        globals().update({_name + "col": _ctypes.c_ubyte * (3 * _x * _y), _name + "gray": _ctypes.c_ubyte * (_x * _y)})
BYTE, COLOR, TIMER = _ctypes.c_ubyte, _ctypes.c_int, _ctypes.c_int

# ---- the channel to the simulator: docs/protocol.md ----

_CHANNEL = 32 << 20
_BODY = 64
_READY, _REFUSED, _CALL, _RETURNED, _EXITED, _FAULT = 1, 2, 3, 4, 5, 6
_RUN, _OK, _STOP, _CALL_BACK = 16, 17, 18, 19
_SYS_FUTEX = {"x86_64": 202, "aarch64": 98, "riscv64": 98, "armv7l": 240, "i686": 240}
_NULL = 0xFFFFFFFF


class _Stop(BaseException):
    """Raised to unwind the program when the host stops it."""


class _Channel:
    def __init__(self):
        self.memory = _mmap.mmap(0, _CHANNEL, _mmap.MAP_SHARED)
        magic, version = _struct.unpack_from("<II", self.memory, 0)
        if magic != 0x53455945 or version != 1:
            raise RuntimeError("the simulator speaks another protocol: copy its eye.py again")
        self.libc = _ctypes.CDLL(None, use_errno=True)
        self.futex = _SYS_FUTEX[_platform.machine()]
        self.is_ordered, self.has_woken = _platform.machine() == "x86_64", True
        self.turn = _ctypes.c_uint32.from_buffer(self.memory, 8)
        _struct.pack_into("<I", self.memory, 20, self.libc.syscall({202: 186, 98: 178, 240: 224}[self.futex]))

    def send(self, kind, body):
        if len(body) > _CHANNEL - _BODY:
            raise ValueError("more than 32 MB in one call")
        memory = self.memory
        memory[_BODY : _BODY + len(body)] = body
        _struct.pack_into("<II", memory, 12, kind, len(body))
        self.turn.value = 1
        self.has_woken = self.libc.syscall(self.futex, _ctypes.byref(self.turn), 1, 1) > 0

    def receive(self):
        # A simulator that is not asleep answers most calls soon. Only on this processor, a thread that sees the turn
        # without a call of the kernel also sees the message.
        if not self.has_woken and self.is_ordered:
            end = _real_time_ns() + 10_000
            while self.turn.value == 1 and _real_time_ns() < end:
                pass
        while self.turn.value == 1:
            self.libc.syscall(self.futex, _ctypes.byref(self.turn), 0, 1, None)
        kind, length = _struct.unpack_from("<II", self.memory, 12)
        return kind, self.memory[_BODY : _BODY + length]


_channel = None  # while the program does not run
_is_stopped = False
_callbacks = {}


# ---- results and arguments of calls ----


class _Number(int):
    """An integer; like a ctypes value it also has its number in `value`."""

    __slots__ = ()
    value = property(int)

    def __bytes__(self):
        """The bytes of a C `int` in memory."""
        return _struct.pack("<I", self & 0xFFFFFFFF)


# Python's messages contain the type's name, and students know the type by this name.
_Number.__name__ = "int"


class _Variable(int):
    """The value of a variable of this module: no other name has this object, see `_set_variables`."""

    __slots__ = ()


_Variable.__name__ = "int"


class _Values(tuple):
    """Output parameters of a C call: a tuple with item assignment, for programs written for EyeSim VR's lists."""

    def __setitem__(self, index, value):
        index = range(len(self))[index]
        value = _Number(value) if type(value) is int else value
        # The tuple was created for this caller, so no other code has a reference to it.
        address = id(self) + tuple.__basicsize__ + index * _ctypes.sizeof(_ctypes.c_void_p)
        _ctypes.pythonapi.Py_IncRef(_ctypes.py_object(value))
        old = tuple.__getitem__(self, index)
        _ctypes.c_void_p.from_address(address).value = id(value)
        _ctypes.pythonapi.Py_DecRef(_ctypes.py_object(old))

    def __eq__(self, other):
        return tuple(self) == tuple(other) if isinstance(other, (list, tuple)) else NotImplemented

    def __ne__(self, other):
        return not self == other

    def __hash__(self):
        return hash(tuple(self))

    def __add__(self, other):
        return list(self) + other if isinstance(other, list) else tuple(self) + other

    def copy(self):
        """The items as a list."""
        return list(self)


def _unpacked_into():
    """Number of targets if the caller of `__iter__` unpacks the object, read from its bytecode; otherwise None."""
    frame = _sys._getframe(2)
    code, offset = frame.f_code.co_code, frame.f_lasti
    return code[offset + 1] if 0 <= offset < len(code) and code[offset] == _opcode.opmap["UNPACK_SEQUENCE"] else None


class _Object(_Values):
    """A pose of `SIMGetObject`: x, y and phi, or x, y, z and phi if it is unpacked into four names."""

    def __getnewargs__(self):
        x, y, phi = tuple(self)
        return ((x, y, self.z, phi),)

    def __new__(cls, values):
        x, y, z, phi = values
        pose = super().__new__(cls, (x, y, phi))
        pose.z = z
        return pose

    def __iter__(self):
        x, y, phi = (tuple.__getitem__(self, index) for index in range(3))
        return iter((x, y, self.z, phi) if _unpacked_into() == 4 else (x, y, phi))

    def __getitem__(self, index):
        return tuple.__getitem__(self, 2 if index == 3 else index)


# Keeps recent temporary arrays alive: `ctypes.cast` does not hold a reference.
_recent_arrays = _collections.deque(maxlen=64)


class _Numbers(list):
    """A list of integers, which also serves as a ctypes array."""

    @property
    def _as_parameter_(self):
        array = (_ctypes.c_int * len(self))(*self)
        _recent_arrays.append(array)
        return array


class _Addresses(_Numbers):
    """The addresses of `RADIOStatus`. Unpacked into two names, it is their number and the list, as in EyeSim VR."""

    def __iter__(self):
        return iter((_Number(len(self)), _Numbers(self[:])) if _unpacked_into() == 2 else self[:])


class _Part(bytearray):
    """A slice of an image; it equals a list of the same numbers."""

    def __eq__(self, other):
        return list(self) == list(other) if isinstance(other, (list, tuple)) else bytearray.__eq__(self, other)

    __hash__ = None


class Image:
    """A flat image with one or three bytes per pixel: a ctypes array with a buffer, whose items are 0 to 255."""

    width = height = result = 0
    _types_by_size = {}

    @staticmethod
    def _of(data, size, width, height):
        image_type = Image._types_by_size.get(size)
        if image_type is None:
            image_type = Image._types_by_size[size] = type("Image", (Image, _ctypes.c_ubyte * size), {})
        image = image_type.from_buffer_copy(bytes(data[:size]).ljust(size, b"\0"))
        image.width, image.height = width, height
        return image

    def array(self):
        """The image as a numpy array with rows and columns, which shares the image's bytes."""
        import numpy

        shape = (self.height, self.width) if len(self) == self.width * self.height else (self.height, self.width, 3)
        return numpy.frombuffer(self, numpy.uint8).reshape(shape)

    def copy(self):
        """An independent copy."""
        return Image._of(bytes(self), len(self), self.width, self.height)

    def __reduce_ex__(self, _protocol):
        return _image, (bytes(self), len(self), self.width, self.height)

    def __getitem__(self, index):
        return _Part(memoryview(self).cast("B")[index]) if isinstance(index, slice) else super().__getitem__(index)

    def __eq__(self, other):
        if isinstance(other, (list, tuple)):
            return list(self) == list(other)
        try:
            return bytes(self) == bytes(memoryview(other))
        except TypeError:
            return NotImplemented

    __hash__ = None

    def __iter__(self):
        data = memoryview(self).cast("B")
        return iter((_Number(self.result), self) if self.result and _unpacked_into() == 2 else data)


def _image(data, size, width, height):
    return Image._of(data, size, width, height)


# Otherwise `pickle` and `copy` would search for them in `__main__`, which is the program.
for _name in (_Number, _Variable, _Values, _Object, _Numbers, _Addresses, _Part, _image):
    _name.__module__ = "eye"

_POINTER = _ctypes._Pointer
_REFERENCE = type(_ctypes.byref(_ctypes.c_int()))
_SIMPLE = _ctypes._SimpleCData


def _pointee(value):
    """Target of a ctypes reference or pointer, or of a numpy array's `ctypes`: an object or an address.
    None for a null pointer; any other value itself."""
    if isinstance(value, _REFERENCE):
        return value._obj
    if isinstance(value, _POINTER):
        if not value:
            return None
        return value.contents if isinstance(value.contents, _ctypes.Array) else _address(value)
    if isinstance(value, (_ctypes.c_void_p, _ctypes.c_char_p)):
        return None if value.value is None else _address(value)
    if isinstance(value, _ctypes._CFuncPtr) or not hasattr(value, "_as_parameter_"):
        return value
    if hasattr(value, "data_as"):
        return _ctypes.c_void_p(value.data)
    return value if isinstance(value, _Numbers) else _pointee(value._as_parameter_)


def _address(pointer):
    return _ctypes.c_void_p(_ctypes.cast(pointer, _ctypes.c_void_p).value)


def _is_whole(item):
    """True for an item that `int` converts, unlike a list, an infinite number or `nan`."""
    try:
        int(item)
    except (TypeError, ValueError, OverflowError):
        return False
    return True


def _memory(value, size, name):
    """The first `size` bytes of a program's image or buffer. Without a size: all bytes, or a text up to its terminating 0."""
    if isinstance(value, str):
        value = value.encode("utf-8", "surrogateescape")
    value = _pointee(value)
    if value is None:
        return None
    if isinstance(value, _ctypes.c_void_p):
        return _ctypes.string_at(value, -1 if size is None else size)
    if isinstance(value, (list, tuple)):
        try:
            data = bytes(int(item) & 0xFF for item in value)
        except (TypeError, ValueError, OverflowError):
            wrong = next(item for item in value if not _is_whole(item))
            text = ": write `[pixel for row in image for pixel in row]`" if isinstance(wrong, (list, tuple)) else ""
            raise TypeError(f"{name}: expected a list of numbers from 0 to 255, got one with {wrong!r:.50}{text}") from None
    else:
        try:
            view = memoryview(value)
        except TypeError:
            text = f", or a text: `str({value!r})`" if isinstance(value, (int, float)) else ""
            raise TypeError(f"{name}: expected an image or buffer{text}, got {value!r:.100}") from None
        code = view.format.lstrip("<>=@!")
        if view.itemsize == 1 or isinstance(value, _ctypes.Array) or size is None:
            data = view.tobytes()
        elif code in "hHiIlLqQ":
            data = bytes(item & 0xFF for item in memoryview(view.tobytes()).cast(code))
        else:
            raise TypeError(f"{name}: expected bytes, got numbers of kind `{view.format}`: convert them to uint8")
    if size is None:
        return data.split(b"\0")[0] if isinstance(value, _ctypes.Array) else data
    if len(data) < size:
        raise ValueError(f"{name}: the image or buffer has {len(data)} bytes, but {size} are needed")
    return data[:size]


def _is_output(target):
    """True for an output argument: an object to which a value can be written."""
    kinds = (_REFERENCE, _POINTER, _SIMPLE, _ctypes.Array, list, bytearray, memoryview, _array.array)
    return isinstance(target, kinds) or hasattr(target, "data_as") or hasattr(target, "__array_interface__")


def _fill(target, data, name):
    """Writes bytes to an output argument: a buffer or image."""
    target, data = _pointee(target), bytes(data)
    if target is None:
        return
    if isinstance(target, _ctypes.c_void_p):
        _ctypes.memmove(target, data, len(data))
        return
    if isinstance(target, list):
        capacity = len(target)
    else:
        try:
            view = memoryview(target)
        except TypeError:
            raise TypeError(f"{name}: expected a buffer, got {target!r:.100}") from None
        if view.readonly or not view.c_contiguous:
            raise TypeError(f"{name}: the buffer cannot be written to, or has gaps")
        capacity = view.nbytes
    if capacity < len(data):
        raise ValueError(f"{name}: the buffer has {capacity} bytes, but {len(data)} are needed")
    if isinstance(target, list):
        target[: len(data)] = data
    else:
        view.cast("B")[: len(data)] = data


def _store(target, values, name):
    """Writes numbers to an output argument: a ctypes value or pointer, an array or a list."""
    target = _pointee(target)
    if target is None:
        return
    if isinstance(target, _ctypes.c_void_p):
        kind = _ctypes.c_float if isinstance(values[0], float) else _ctypes.c_int
        target = _ctypes.cast(target, _ctypes.POINTER(kind))
    elif isinstance(target, _SIMPLE):
        target.value = bytes(values[:1]) if isinstance(target, _ctypes.c_char) else values[0]
        return
    elif len(target) < len(values):
        raise ValueError(f"{name}: there is room for {len(target)} numbers, but {len(values)} are needed")
    for index, value in enumerate(values):
        target[index] = value


def _result_is_dropped():
    """True if the program discards the return value of the module's function that called the caller; read from the bytecode."""
    frame = _sys._getframe()
    while frame.f_code.co_filename in _own_files:
        frame = frame.f_back
    code, offset = frame.f_code.co_code, frame.f_lasti + 2
    while offset < len(code) and code[offset] == _opcode.opmap.get("CACHE"):
        offset += 2
    return offset < len(code) and code[offset] == _opcode.opmap["POP_TOP"]


_shown_hints = set()


def _show_hint(text):
    """Prints a hint with the program's line, once per text."""
    frame = _sys._getframe(1)
    while frame is not None and frame.f_code.co_filename in _own_files:
        frame = frame.f_back
    if frame is not None and text not in _shown_hints:
        _shown_hints.add(text)
        _consoles[1].write(f"{_os.path.basename(frame.f_code.co_filename)}:{frame.f_lineno}: hint: {text}\n")


def _out(name, written, *targets):
    """The outputs of a call if the program passes no output argument; otherwise stores them there and returns the result."""
    count = len(targets)
    if not any(_is_output(target) for target in targets):
        if any(target is not None for target in targets) and _result_is_dropped():
            code = _sys._getframe(1).f_code
            names = code.co_varnames[: code.co_argcount]
            left, right = ", ".join(names[-count:]), ", ".join(names[:-count])
            _show_hint(f"`{name}` returns what it reads: write `{left} = {name}({right})`")
        values = _or_zero(written[:count])
        return values[0] if count == 1 else _Values(values)
    for target, value in zip(targets, written):
        if value is not None and _is_output(target):
            _store_one(target, value, name)
    return written[count] if len(written) > count else None


def _or_zero(written):
    """The outputs of a call, 0 for those that the call has not set."""
    return [_Number(0) if value is None else value for value in written]


def _store_one(target, value, name):
    if isinstance(target, _POINTER) and target and not isinstance(target.contents, _ctypes.Array):
        target = target.contents
    _store(target, [value], name)


def _out_image(name, data, size, width, height, target, result=0):
    """Returns an image, or stores it in the output argument."""
    if target is None or not _is_output(target):
        return _image(data, size, width, height)
    _fill(target, data[:size], name)
    return result


def _out_text(name, data, target, result):
    if target is None or not _is_output(target):
        return _text(data)
    if data:
        _fill(target, bytes(data).split(b"\0")[0] + b"\0", name)
    return result


def _out_numbers(name, values, target, result):
    if target is None or not _is_output(target):
        return values
    if values:
        _store(target, values, name)
    return result


def _always():
    return True


def _never():
    return False


_allocate_lock = _thread.allocate_lock


class _Turn:
    """A thread in the queue of the run token."""

    __slots__ = "thread", "is_ready", "until_us", "block", "may_look", "result"

    def __init__(self, thread, is_ready=_always, until_us=None, block=None):
        self.thread = thread  # identifier; None until the thread has begun
        self.is_ready = is_ready  # may take a lock for the thread; any thread calls it
        self.until_us = until_us
        self.block = block  # waits for what comes from outside of the program, while all threads wait
        self.may_look = _allocate_lock()
        self.result = None  # once the token has been passed to the thread: False if its time has come first

    def wake(self):
        if self.may_look.locked():
            self.may_look.release()


class _RunToken:
    """Lets one thread of the program run at a time, so that the order of their calls depends on the program only.

    The token passes on before calls, when a thread waits, and at its end, to the first thread of the queue that can
    continue. If all wait, the thread that passes it on sleeps in virtual time for them. A thread that computes for long, or
    waits outside of this module, loses the token to the queue, and joins the queue before its next call.
    """

    def __init__(self):
        # Lock of all fields. Signal handlers and destructors may enter it again.
        self.guard = _thread.RLock()
        self.main = _thread.get_ident()
        self.holder = _Turn(self.main)  # by which the running thread got the token; None if all threads wait
        self.caller = None  # identifier of the holder while it uses the channel or passes the token on
        self.queue = []
        self.uses = 0  # number of uses of the channel
        self.changes = 0  # number of changes by threads without the token
        self.started = set()  # identities of the threads that the program has started and that have not ended
        self.error = None  # exception of a timer's function, for the main thread
        self.has_hinted = False

    def is_calling(self):
        """Returns True in a function that the simulator has called during a call of this thread."""
        return self.caller == _thread.get_ident()

    def wait(self, is_ready, until_us=None, block=None):
        """Lets the other threads run, until `is_ready()` is true or a virtual time. Returns False at that time."""
        if self.is_calling():
            return self._wait_in_call(is_ready, until_us)
        result = self._queue_up(is_ready, until_us, block)
        if _is_stopped:
            raise _Stop
        return result

    def notify(self):
        """Lets the threads run that a change of this thread may have made ready."""
        with self.guard:
            self.changes += 1
            may_pass_on = self.caller is None and (self.holder is None or self._is_holder())
        if may_pass_on:
            self._queue_up()

    def enter_call(self):
        """Acquires the channel, after the calls of the other threads that can continue."""
        with self.guard:
            if not self.started and not self.queue and self._begin_to_pass_on():
                return
        self._queue_up()
        while not self._begin_to_pass_on():  # this thread has lost the token already
            self._queue_up()

    def leave_call(self):
        with self.guard:
            self.uses, self.caller = self.uses + 1, None

    def start(self, starter, function, *arguments, **options):
        """Starts a thread with `starter`; it begins when the token comes to it."""
        turn = _Turn(None)
        is_of_threading = getattr(function, "__name__", "") == "_bootstrap"
        identity = id(function.__self__ if is_of_threading else turn)
        is_in_call = self.is_calling()  # which waits until the thread has begun

        def run(*arguments, **options):
            turn.thread = _thread.get_ident()
            try:
                if not is_in_call:
                    self._await(turn)
                try:
                    return function(*arguments, **options)
                finally:
                    for console in _consoles:
                        console.flush()
            finally:
                with self.guard:
                    self.started.discard(identity)
                    self._remove(turn)
                if self._begin_to_pass_on():
                    self._pass_on()

        with self.guard:
            self.started.add(identity)
            self.queue += [] if is_in_call else [turn]
        try:
            result = starter(run, *arguments, **options)
        except BaseException:
            with self.guard:
                self.started.discard(identity)
                self._remove(turn)
            raise
        self.notify()
        return result

    def _is_holder(self):
        return self.holder is not None and self.holder.thread == _thread.get_ident()

    def _remove(self, turn):
        if turn in self.queue:
            self.queue.remove(turn)

    def _queue_up(self, is_ready=_always, until_us=None, block=None):
        """Passes the token on, if this thread has it, and waits for it. Returns False at the time `until_us`."""
        turn = _Turn(_thread.get_ident(), is_ready, until_us, block)
        with self.guard:
            self.queue.append(turn)
        try:
            if self._begin_to_pass_on():
                self._pass_on()
            self._await(turn)
        finally:
            with self.guard:
                self._remove(turn)
        if self.error is not None and turn.thread == self.main:
            error, self.error = self.error, None
            raise error
        return turn.result

    def _wait_in_call(self, is_ready, until_us):
        """Waits in a function that the simulator has called: only a thread that has no token can run meanwhile."""
        start_ns = _real_time_ns()
        while not is_ready():
            if until_us is not None and not _sleep_towards(until_us):
                return False
            if _real_time_ns() - start_ns > 5 * _PATIENCE_NS:
                raise RuntimeError("a timer's function waits for a thread that waits for the end of the function")
            _real_sleep(0.001)
        return True

    def _begin_to_pass_on(self):
        """Makes this thread the caller; returns False if another thread has the token."""
        with self.guard:
            if self.holder is None:
                self.holder = _Turn(_thread.get_ident())
                for turn in self.queue:
                    turn.wake()  # it waits no longer for ever, but for this thread
            elif not self._is_holder():
                self.changes += 1
                return False
            self.caller = _thread.get_ident()
            return True

    def _pass_on(self):
        """Gives the token of this thread, the caller, to a thread of the queue that can continue, or to none."""
        try:
            while not self._has_passed_on():
                pass
        except BaseException:  # of a signal handler
            self.leave_call()
            raise

    def _has_passed_on(self):
        changes, queue = self.changes, list(self.queue)
        times_us = [turn.until_us for turn in queue if turn.until_us is not None]
        try:
            now_us = _now_us() if times_us and not _is_stopped else 0
            turn, result = self._first_of(queue, now_us)
            if turn is None and times_us:
                _request(_support_sleep_us, (min(min(times_us) - now_us, _SLICE_US),))
                return False
        except _Stop:
            return False  # now all threads can continue
        except Exception as error:
            self.error = error
            return False
        with self.guard:
            if turn not in self.queue if turn else changes != self.changes:
                return False
            self.holder, self.caller, self.uses = turn, None, self.uses + 1
            if turn is not None:
                turn.result = result
                self.queue.remove(turn)
                turn.wake()
        return True

    def _first_of(self, queue, now_us):
        """The first thread of the queue that can continue, and what `wait` returns in it."""
        for turn in queue:
            if _is_stopped or self.error is not None and turn.thread == self.main or turn.is_ready():
                return turn, True
            if turn.until_us is not None and now_us >= turn.until_us:
                return turn, False
        return None, None

    def _await(self, turn):
        """Waits for the token, and takes it from a thread that keeps it for long without a call."""
        uses, cpu_ns, since_ns, looked_ns = None, 0, 0, 0
        while turn.result is None:
            # Without a holder, the next thread that does something passes the token on.
            is_idle = self.holder is None
            if is_idle and turn.block is not None:
                turn.block()
                if self._begin_to_pass_on():
                    self._pass_on()
                continue
            turn.may_look.acquire(True, -1 if is_idle else _PATIENCE_NS / 1e9)
            # A look that comes late shows only that the whole program did not run.
            is_late = _real_time_ns() - looked_ns > 2 * _PATIENCE_NS
            looked_ns = _real_time_ns()
            with self.guard:
                if turn.result is not None or self.holder is None:
                    continue
                if self.uses != uses or self.caller is not None:
                    uses, cpu_ns, since_ns = self.uses, _processor_time_ns(), _real_time_ns()
                    continue
                spent_ns, waited_ns = _processor_time_ns() - cpu_ns, _real_time_ns() - since_ns
                is_asleep = waited_ns >= _PATIENCE_NS and spent_ns <= waited_ns // 100 and not is_late
                if spent_ns < _PATIENCE_NS and not is_asleep:
                    continue
                busy, self.holder, self.caller = self.holder, turn, turn.thread
            if spent_ns >= _PATIENCE_NS and not _imports:
                self._hint_at(busy)
            self._pass_on()

    def _hint_at(self, busy):
        """Prints a hint, once in each program, about a thread that has lost the token because it has run for long without a call."""
        if self.has_hinted or _is_stopped:
            return
        self.has_hinted = True
        try:
            _request(_support_hint, (_BUSY_HINT,), _sys._current_frames().get(busy.thread))
        except _Stop:
            pass  # `_pass_on` lets all threads continue


_BUSY_HINT = b"this thread has run for 0.2 s of processor time without a call; now the other threads run beside it, and results may depend on the \
machine: a loop that waits for another thread (`get_nowait`, `empty`, `is_set`) needs a call that waits, such as `OSWait(10)`"

# Processor time, and real time without any, after which the other threads of the program do not wait for the running one.
_PATIENCE_NS = 200_000_000
_real_sleep, _real_time_ns, _processor_time_ns = _time.sleep, _time.perf_counter_ns, _time.process_time_ns
_token = _RunToken()


def _exchange(kind, body):
    """Sends a message and returns the body of the answer; functions that the simulator calls run in between."""
    global _is_stopped
    while True:
        _channel.send(kind, body)
        answer, body = _channel.receive()
        if answer == _OK:
            return body
        if answer == _STOP:
            _is_stopped = True
            raise _Stop
        code, _data = _struct.unpack("<QQ", body)
        kind, body = _RETURNED, _struct.pack("<i", _called_back(code))


def _called_back(code):
    """Runs a timer's function. The call in progress raises the function's exception in the program."""
    global _callback_error
    try:
        _callbacks[code]()
        return 0
    except _Stop:
        return 1
    except BaseException as error:  # noqa: B902
        _callback_error = error
        return 1


_callback_error = None


def _refuse():
    """Rejects calls after a stop."""
    raise _Stop


def _location(frame):
    """File and line in the program of a frame, or of its innermost caller there."""
    while frame is not None and frame.f_code.co_filename in _own_files:
        frame = frame.f_back
    return ("", 0) if frame is None else (_os.path.basename(frame.f_code.co_filename), frame.f_lineno)


def _int(value, low, high, name):
    """An integer within bounds; fractions are truncated, as in C."""
    try:
        if isinstance(value, (str, bytes)):
            raise TypeError
        number = int(_pointee(value).value if isinstance(value, (_SIMPLE, _REFERENCE)) else value)
    except (TypeError, ValueError, OverflowError):
        cause = ": check how it is calculated, in this line or above" if isinstance(value, float) else ""
        cause = f": `int({value!r})` is one" if isinstance(value, str) and value.isdigit() else cause
        raise TypeError(f"{name}: expected a number, got {value!r}{cause}") from None
    if not low <= number <= high:
        raise OverflowError(f"{name}: {number} is not within {low} to {high}")
    return number


def _bytes(value, name):
    data = _memory(value, None, name)
    return _struct.pack("<I", _NULL) if data is None else _struct.pack("<I", len(data)) + data


# Maximum time for which a waiting call may hold the channel while other threads of the program need it.
_SLICE_US = 10000


def _receive_if_any(row, values, check, *what):
    """Receives what `check` finds before another thread can take it; returns None if there is nothing."""
    _token.enter_call()
    try:
        return _request(row, values) if _request(check, what)[-1] else None
    finally:
        _token.leave_call()


_switched_on = set()  # the radio, and serial interfaces
_SWITCHES = {"RADIOInit", "RADIORelease", "SERInit", "SERClose"}


def _note_switch(name, values):
    """Notes that the radio or a serial interface has been switched on or off."""
    device = "RADIO" if name.startswith("RADIO") else _whole(values[0])
    (_switched_on.add if name.endswith("Init") else _switched_on.discard)(device)


def _is_refused(name, values):
    """Returns True if the simulator refuses a waiting call, or ends the program in it: then it does not wait."""
    return (
        name == "OSError"
        or name == "RADIOReceive" and ("RADIO" not in _switched_on or values[1] == 0)
        or name == "SERReceiveChar" and _whole(values[0]) not in _switched_on
        or name == "KEYWait" and not _whole(values[0]) & _KEYS
    )


def _polled_once(row, values):
    """Executes a waiting call if it need not wait; otherwise returns None."""
    name = row[0]
    if name == "RADIOReceive":
        return _receive_if_any(row, values, _RADIOCheck)
    if name == "SERReceiveChar":
        return _receive_if_any(row, values, _SERCheck, *values)
    if name == "KEYGetXY":
        answer = _request(_KEYReadXY, values)
        return answer if answer[-1] == 0 else None
    answer = _request({"VWWait": _VWDone, "IRTVGet": _IRTVRead}.get(name, _KEYRead), ())[-1]
    if name == "VWWait":
        return [_Number(0)] if answer else None
    return [answer] if answer and (name != "KEYWait" or answer & _whole(values[0])) else None


def _wait_by_polling(row, values):
    """Executes a waiting call by polling, so that other threads of the program can make calls in between. Returns None if the normal
    blocking call should be used."""
    name = row[0]
    if name == "OSWait" or name == "sleep_us":
        span = values[0] if name == "sleep_us" else 1000 * _int(values[0], -(1 << 31), (1 << 32) - 1, name)
        _token.wait(_never, _now_us() + span)
        return [_Number(0)]
    if name == "OSError" and not _whole(values[2]):
        _call(_LCDPrintf, (_memory(values[0], None, name) or b"") + b"\nError %d\n" % _whole(values[1]))
        _call(_KEYGet)
        return [_Number(0)]
    while _has_threads() and not _is_refused(name, values):
        outputs = _polled_once(row, values)
        if outputs is not None:
            return outputs
        _token.wait(_never, _now_us() + _SLICE_US)
    return None


# Functions with which a loop waits for something without letting time pass.
_POLLING = {"KEYRead", "IRTVRead", "RADIOCheck", "VWDone", "OSGetCount", "time_us"}
_poll_count = 0  # of calls of these functions in succession


def _call(row, *values):
    """Calls a table function; returns its outputs in order, then its result. A loop that only polls takes 0.1 ms a turn after
    100 turns, and 1 ms after 1000."""
    global _poll_count
    if row[0] in _POLLING and not _token.is_calling():
        count = _poll_count + 1
        if count > 100:
            _call(_support_sleep_us, 100 if count <= 1000 else 1000)
        _poll_count = count
    if row[0] in _WAITING and _has_threads() and not _token.is_calling():
        answer = _wait_by_polling(row, values)
        if answer is not None:
            return answer
    answer = _request(row, values)
    if row[0] in _SWITCHES and answer[-1] == 0:
        _note_switch(row[0], values)
    return answer


def _has_threads():
    """Returns True if the program has several threads, whose calls interleave."""
    return bool(_token.started) or _thread.get_ident() != _token.main


_WAITING = {"OSWait", "OSError", "sleep_us", "VWWait", "KEYGet", "KEYWait", "KEYGetXY", "IRTVGet", "RADIOReceive", "SERReceiveChar"}
_KEYS = ANYKEY | KEY_LIST1 | KEY_LIST2 | KEY_LIST3 | KEY_LIST4 | KEY_LIST5 | KEY_LIST6 | KEY_LIST7 | KEY_LIST8
_KEYS |= KEY_LISTDN | KEY_LISTUP | KEY_LISTTL


_has_hinted_at_truncation = False


def _hint_at_truncation(name, value):
    """Prints a hint, once in each program, that a fraction is truncated to 0."""
    global _has_hinted_at_truncation
    if not _has_hinted_at_truncation:
        _has_hinted_at_truncation = True
        _call(_support_hint, f"`{name}`: {value:g} becomes 0: RoBIOS-7 takes whole numbers, in mm, mm/s, degrees and ms: 0.3 m is `300`, half a second is `500`".encode())


def _is_in_radians(angle):
    """True for a fraction close to a multiple of pi / 12, up to a full turn: 1.57, but not 2.5."""
    twelfths = abs(angle) * 12 / 3.141592653589793
    is_close = abs(twelfths - round(twelfths)) < 0.001 * twelfths
    return is_close and abs(angle) < 6.4 and not (2 * angle).is_integer()


_has_hinted_at_radians = False


def _hint_at_radians(angle):
    """Prints a hint, once in each program, that an angle is in radians."""
    global _has_hinted_at_radians
    if not _has_hinted_at_radians:
        _has_hinted_at_radians = True
        degrees = round(angle * 12 / 3.141592653589793) * 15
        _call(_support_hint, f"`VWTurn`: {angle:g} becomes {int(angle)}: RoBIOS-7 takes degrees, not radians: write `{degrees}`".encode())


def _request(row, values, frame=None):
    """Executes a call, at the place in the program of `frame`, by default of the running thread."""
    global _callback_error, _is_stopped, _poll_count
    name, function_list, number, kinds, result = row
    if _channel is None:
        raise RuntimeError(f"{name}: no simulator; run the program with `eyesim run`")
    if _is_stopped and function_list == 7:
        _refuse()
    if name not in _POLLING:
        _poll_count = 0
    file, line = _location(frame or _sys._getframe())
    file = file.encode("utf-8", "replace")
    body = [_struct.pack("<IIQII", function_list, number, 0, line, len(file)), file]
    for kind, value in zip(kinds, values):
        if kind == "i":
            number = _int(value, -(1 << 31), (1 << 32) - 1, name)
            if number == 0 and isinstance(value, float) and value != 0:
                _hint_at_truncation(name, value)
            elif name == "VWTurn" and value is values[0] and isinstance(value, float) and _is_in_radians(value):
                _hint_at_radians(value)
            body.append(_struct.pack("<I", number & 0xFFFFFFFF))
        elif kind in "tb":
            body.append(_bytes(value, name))
        elif kind == "B":
            value = value.value if isinstance(value, _SIMPLE) else value
            value = ord(value) if isinstance(value, (str, bytes)) and len(value) == 1 else value
            body.append(_struct.pack("<B", _int(value, -128, 255, name) & 0xFF))
        elif kind in "IrRF":
            body.append(_struct.pack("<I", value))
        elif kind in "qQd":
            body.append(_struct.pack("<" + kind, value))
        elif kind in "oOe":
            body.append(b"\1")
        elif kind == "k":
            value = value if value else None  # a null pointer of ctypes
            code = 0 if value is None else len(_callbacks) + 1
            if value is not None and not callable(value):
                raise TypeError(f"{name}: expected a function, got {value!r}")
            _callbacks[code] = value
            body.append(_struct.pack("<QQ", code, 0))
    is_first = not _token.is_calling()
    if is_first:
        _token.enter_call()
    try:
        answer = _exchange(_CALL, b"".join(body))
    except _Stop:
        if _callback_error is not None:
            # The call was abandoned because a timer's function raised an exception, which is raised in the program now.
            error, _callback_error, _is_stopped = _callback_error, None, False
            raise error from None
        raise
    finally:
        if is_first:
            _token.leave_call()
    offset, written = 0, []
    for kind in kinds:
        if kind in "oOe":
            (is_set,) = _struct.unpack_from("<B", answer, offset)
            offset += 1
            if is_set:
                form = {"o": "<i", "O": "<B", "e": "<f"}[kind]
                value = _struct.unpack_from(form, answer, offset)[0]
                written.append(value if kind == "e" else _Number(value))
                offset += _struct.calcsize(form)
            else:
                written.append(None)
        elif kind == "r":
            (length,) = _struct.unpack_from("<I", answer, offset)
            written.append(bytearray(answer[offset + 4 : offset + 4 + length]))
            offset += 4 + length
        elif kind in "RF":
            (count,) = _struct.unpack_from("<I", answer, offset)
            numbers = _struct.unpack_from(f"<{count}{'i' if kind == 'R' else 'f'}", answer, offset + 4)
            written.append(_Numbers(numbers))
            offset += 4 + 4 * count
    if result:
        value = _struct.unpack_from("<" + result, answer, offset)[0]
        written.append(value if result == "f" else _Number(value))
    return written


# Name, number of the list, number in it, kinds of the parameters, kind of the result.
# @CALLS@

# ---- functions ----

# @FUNCTIONS@

# ---- functions whose signature in Python differs from that of the call ----


def _formatted(text, values):
    """`text % values` as in C: surplus values are ignored, and without values `%%` is printed as `%`."""
    text = text.decode("utf-8", "replace") if isinstance(text, bytes) else str(_plain(text))
    values = tuple(_plain(value) for value in values)
    for count in range(len(values), -1, -1):
        try:
            return text % values[:count]
        except (TypeError, ValueError) as error:
            if "not all arguments converted" not in str(error):
                if not values:
                    return text
                raise
    return text


def _plain(value):
    """The Python value of a ctypes value; text for bytes."""
    value = value.value if isinstance(value, _SIMPLE) or hasattr(type(value), "raw") else value
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


def LCDPrintf(text, *values):
    """Prints at the cursor; with further values as `text % values`. Returns 0."""
    return _call(_LCDPrintf, _formatted(text, values))[-1]


def LCDSetPrintf(row, column, text, *values):
    """Prints at a row and a column of characters, both from 0. Returns 0."""
    return _call(_LCDSetPrintf, row, column, _formatted(text, values))[-1]


def KEYReadXY(x=None, y=None):
    """The position of a touch of the display as (x, y), None if there was none. Does not wait."""
    written = _call(_KEYReadXY, None, None)
    if written[-1] and not (_is_output(x) or _is_output(y)):
        return None
    return written[-1] if written[-1] else _out("KEYReadXY", written, x, y)


def LCDInit():
    """Function of the library of 2016; the display always exists. Returns 0."""
    return _Number(0)


_shown_width, _shown_height = 320, 240


def LCDImageSize(t):
    """Sets the size of the images that LCDImage and similar functions show, a resolution such as QVGA. Returns 0, 1 for another number."""
    global _shown_width, _shown_height
    t = _whole(t)
    result = _call(_LCDImageSize, t)[-1]
    if result == 0:
        _shown_width, _shown_height = _SIZES.get(t, (CAMWIDTH, CAMHEIGHT))
    return result


def LCDImageStart(x, y, xs, ys):
    """Sets position and size in pixels of the images that LCDImage and similar functions show. Returns 0, 1 for a size below 1."""
    global _shown_width, _shown_height
    result = _call(_LCDImageStart, x, y, xs, ys)[-1]
    if result == 0:
        _shown_width, _shown_height = _whole(xs), _whole(ys)
    return result


def LCDImage(img):
    """Shows a colour image, 3 bytes per pixel, of the size that LCDImageStart or LCDImageSize has set. Returns 0."""
    data = _memory(img, 3 * _shown_width * _shown_height, "LCDImage")
    return _call(_LCDImage, _shown_width, _shown_height, data)[-1]


def LCDImageGray(g):
    """Shows a grey image, 1 byte per pixel. Returns 0."""
    data = _memory(g, _shown_width * _shown_height, "LCDImageGray")
    return _call(_LCDImageGray, _shown_width, _shown_height, data)[-1]


def LCDImageBinary(b):
    """Shows a binary image, 1 byte per pixel: 0 is white, everything else black. Returns 0."""
    data = _memory(b, _shown_width * _shown_height, "LCDImageBinary")
    return _call(_LCDImageBinary, _shown_width, _shown_height, data)[-1]


def _whole(value):
    return _int(value, -(1 << 31), (1 << 31) - 1, "size")


def _size_of(resolution, width, height):
    """Width and height of a resolution, as the program gives them for CUSTOM; None if it is unknown."""
    if resolution != CUSTOM or width is None or height is None:
        return _SIZES.get(resolution)
    return _whole(width), _whole(height)


def _is_size(size):
    return size is not None and min(size) > 0 and size[0] * size[1] <= CAM5MP_PIXELS


def _grey(data):
    return _image(data, IP_PIXELS, IP_WIDTH, IP_HEIGHT)


def _colour(data):
    return _image(data, IP_SIZE, IP_WIDTH, IP_HEIGHT)


def _set_variables(**values):
    """Sets variables of this module, also in the modules that have imported them: C programs share them with the library."""
    importers = [vars(module) for module in list(_sys.modules.values()) if type(module) is type(_sys)]
    for name, value in values.items():
        old = globals().get(name)
        globals()[name] = value = _Variable(value)
        for names in importers:
            # A variable of the same name that the program has defined itself is another object.
            if old is not None and names.get(name) is old:
                names[name] = value


def _set_ip_size(width, height):
    _set_variables(IP_WIDTH=width, IP_HEIGHT=height, IP_PIXELS=width * height, IP_SIZE=3 * width * height)


def _set_cam_size(width, height, resolution):
    _set_variables(
        CAMWIDTH=width, CAMHEIGHT=height, CAMPIXELS=width * height, CAMSIZE=3 * width * height, CAMMODE=resolution
    )


_set_cam_size(QVGA_X, QVGA_Y, QVGA)
_set_ip_size(QVGA_X, QVGA_Y)


def CAMInit(resolution, width=None, height=None):
    """Switches the camera on, with a resolution such as QVGA; CUSTOM with width and height. Returns 0, 1 if there is no
    camera."""
    global _shown_width, _shown_height
    resolution = _whole(resolution)
    size = _size_of(resolution, width, height)
    if _is_size(size):
        _set_cam_size(*size, resolution)
        _set_ip_size(*size)
        _shown_width, _shown_height = CAMWIDTH, CAMHEIGHT
    return _call(_CAMInit, resolution, *(size or (CAMWIDTH, CAMHEIGHT)))[-1]


def CAMGet(buf=None):
    """A colour image of CAMSIZE bytes, row 0 at the top; black if there is no camera."""
    data, result = _call(_CAMGet, CAMSIZE)
    return _out_image("CAMGet", data, CAMSIZE, CAMWIDTH, CAMHEIGHT, buf, result)


def CAMGetGray(buf=None):
    """A grey image of CAMPIXELS bytes; black if there is no camera."""
    data, result = _call(_CAMGetGray, CAMPIXELS)
    return _out_image("CAMGetGray", data, CAMPIXELS, CAMWIDTH, CAMHEIGHT, buf, result)


class _Plane(_array.array):
    """A flat image of numbers, one per pixel, row 0 at the top."""

    width = height = 0

    def array(self):
        """The image as a numpy array with rows and columns, which shares the image's numbers."""
        import numpy

        return numpy.frombuffer(self, self.typecode).reshape(self.height, self.width)


def _plane(typecode, values):
    numbers = _Plane(typecode, values)
    numbers.width, numbers.height = CAMWIDTH, CAMHEIGHT
    return numbers


def CAMGetDepth():
    """Depth image of the last image: the distance along each pixel's ray, in mm, infinite for the sky. An
    array of CAMPIXELS numbers, row 0 at the top; None if no image has been taken."""
    values, result = _call(_CAMGetDepth, CAMPIXELS)
    return _plane("f", values) if result == 0 else None


def CAMGetLabels():
    """Label of each pixel of the last image: CAM_SKY, CAM_FLOOR, CAM_WALL, or CAM_BODY + n for robot or object n. An array
    of CAMPIXELS numbers, row 0 at the top; None if no image has been taken."""
    values, result = _call(_CAMGetLabels, CAMPIXELS)
    return _plane("i", values) if result == 0 else None


def LEGGetJoint(leg, joint, degrees=None):
    """Current angle of a joint, in degrees; leg and joint numbers start at 1. None if there is no such leg or joint."""
    written = _call(_LEGGetJoint, leg, joint, None)
    return _out("LEGGetJoint", written, degrees) if written[-1] == 0 or _is_output(degrees) else None


def LEGGetLink(leg, link, pose=None):
    """Current pose of a link of a leg in the frame of the body: [x, y, z, roll, pitch, yaw] in mm and degrees; leg and link
    from 1. None if there is no such leg or link."""
    values, result = _call(_LEGGetLink, leg, link, 6)
    return _out_numbers("LEGGetLink", values, pose, result) if result == 0 or _is_output(pose) else None


def LEGGetHeight(mm=None):
    """Current height of the body's frame above the world's floor, in mm. None if there are no legs."""
    written = _call(_LEGGetHeight, None)
    return _out("LEGGetHeight", written, mm) if written[-1] == 0 or _is_output(mm) else None


def IPSetSize(resolution, width=None, height=None):
    """Sets the size of the images of all IP functions; CUSTOM with width and height. Returns 0, 1 for another number."""
    resolution = _whole(resolution)
    size = _size_of(resolution, width, height)
    result = _call(_IPSetSize, resolution)[-1]
    if not _is_size(size):
        return 1
    _set_ip_size(*size)
    return result


def IPReadFile(filename, img=None):
    """Reads a PNM file: a grey or a colour image of the size that IPSetSize has set; None if it cannot be read. Unpacked into
    two names it is the digit of P1 to P6 and the image."""
    data, result = _call(_IPReadFile, filename, IP_WIDTH, IP_HEIGHT, IP_SIZE)
    if img is not None:
        if result > 0:
            _fill(img, data, "IPReadFile")
        return result
    if result <= 0:
        return None
    image = _grey(data) if len(data) == IP_PIXELS else _colour(data)
    image.result = result
    return image


def IPWriteFile(filename, img):
    """Writes a colour image as PPM. Returns 0, 1 if it cannot be written."""
    return _call(_IPWriteFile, filename, IP_WIDTH, IP_HEIGHT, _memory(img, IP_SIZE, "IPWriteFile"))[-1]


def IPWriteFileGray(filename, gray):
    """Writes a grey image as PGM. Returns 0, 1 if it cannot be written."""
    return _call(_IPWriteFileGray, filename, IP_WIDTH, IP_HEIGHT, _memory(gray, IP_PIXELS, "IPWriteFileGray"))[-1]


def _grey_in(name, *images):
    return [_memory(image, IP_PIXELS, name) for image in images]


def _colour_in(name, *images):
    return [_memory(image, IP_SIZE, name) for image in images]


def _grey_out(name, data, target):
    return _out_image(name, data, IP_PIXELS, IP_WIDTH, IP_HEIGHT, target)


def _colour_out(name, data, target):
    return _out_image(name, data, IP_SIZE, IP_WIDTH, IP_HEIGHT, target)


def IPLaplace(gray, out=None):
    """Laplace edges of a grey image."""
    data = _call(_IPLaplace, IP_WIDTH, IP_HEIGHT, *_grey_in("IPLaplace", gray), IP_PIXELS)[0]
    return _grey_out("IPLaplace", data, out)


def IPSobel(gray, out=None):
    """Sobel edges of a grey image."""
    data = _call(_IPSobel, IP_WIDTH, IP_HEIGHT, *_grey_in("IPSobel", gray), IP_PIXELS)[0]
    return _grey_out("IPSobel", data, out)


def IPCol2Gray(img, out=None):
    """Converts a colour image to a grey image."""
    return _grey_out("IPCol2Gray", _call(_IPCol2Gray, *_colour_in("IPCol2Gray", img), IP_PIXELS)[0], out)


def IPGray2Col(gray, out=None):
    """Converts a grey image to a colour image."""
    return _colour_out("IPGray2Col", _call(_IPGray2Col, *_grey_in("IPGray2Col", gray), IP_SIZE)[0], out)


def IPRGB2Col(r, g, b, out=None):
    """Composes a colour image from its three channels."""
    return _colour_out("IPRGB2Col", _call(_IPRGB2Col, *_grey_in("IPRGB2Col", r, g, b), IP_SIZE)[0], out)


def IPCol2HSI(img, h=None, s=None, i=None):
    """Hue, saturation and intensity of a colour image, a channel each."""
    name = "IPCol2HSI"
    planes = _call(_IPCol2HSI, *_colour_in(name, img), IP_PIXELS, IP_PIXELS, IP_PIXELS)[:3]
    planes = [_grey_out(name, data, target) for data, target in zip(planes, (h, s, i))]
    return 0 if _is_output(h) or _is_output(s) or _is_output(i) else _Values(planes)


def IPOverlay(c1, c2, out=None):
    """Lays the second colour image over the first where the second is not black."""
    return _colour_out("IPOverlay", _call(_IPOverlay, *_colour_in("IPOverlay", c1, c2), IP_SIZE)[0], out)


def IPOverlayGray(g1, g2, col, out=None):
    """Lays the second grey image over the first, in a colour, where the second is not 0."""
    data = _call(_IPOverlayGray, *_grey_in("IPOverlayGray", g1, g2), col, IP_SIZE)[0]
    return _colour_out("IPOverlayGray", data, out)


def _text(data):
    return bytes(data).split(b"\0")[0].decode("utf-8", "replace")


def OSExecute(command, out=None):
    """Runs a command on the machine that runs the simulator, if allowed; returns its output."""
    return _out_text("OSExecute", *_outputs(_call(_OSExecute, command, 4096), out))


def _outputs(written, target):
    return written[0], target, written[-1]


def OSVersion(buf=None):
    """Version of RoBIOS."""
    return _out_text("OSVersion", *_outputs(_call(_OSVersion, 32), buf))


def OSVersionIO(buf=None):
    """Version of the input and output board."""
    return _out_text("OSVersionIO", *_outputs(_call(_OSVersionIO, 32), buf))


def OSMachineName(buf=None):
    """Name of the robot."""
    return _out_text("OSMachineName", *_outputs(_call(_OSMachineName, 32), buf))


def SERSend(interface, buf, size=None):
    """Sends a text, or `size` bytes. Returns 0, 1 if the interface is not open."""
    return _call(_SERSend, interface, _memory(buf, None if size is None else _whole(size), "SERSend"))[-1]


def SERReceive(interface, buf=None, size=256):
    """The received bytes, at most 255. Does not wait."""
    data, length = _call(_SERReceive, interface, min(256, max(1, _whole(size))))
    if buf is None or not _is_output(buf):
        return bytes(data[:length])
    if data:
        _fill(buf, bytes(data[:length]) + b"\0", "SERReceive")
    return length


def AURecord(*arguments):
    """AURecord(time, freq) records the microphone: a value of 0 to 255 for each sample; AURecord(buf, time, freq) into a
    buffer. Times in milliseconds, rates in Hz."""
    _expect("AURecord", len(arguments), (2, 3), "(time, freq) or (buf, time, freq)")
    *buf, time_ms, freq_hz = arguments
    freq_hz = _whole(freq_hz)
    size = max(0, _whole(time_ms) * freq_hz // 1000)
    data, result = _call(_AURecord, size, freq_hz)
    return _out_image("AURecord", data, size, size, 1, buf[0], result) if buf and _is_output(buf[0]) else data


def LIDARGet(distance=None):
    """Distances in millimetres from left to right, the middle one (of n, that of index n/2) straight ahead; 9999 if
    nothing is in range. A list, empty if there is no scanner."""
    return _out_numbers("LIDARGet", *_outputs(_call(_LIDARGet, 65536), distance))


def LIDARSet(range, tilt, points):
    """Sets angle in degrees, 1 to 360, the scanner's tilt in degrees, and the number of points."""
    _call(_LIDARSet, range, tilt, points)
    _set_lidar_resolution()


def _set_lidar_resolution():
    """Sets LIDAR_RESOLUTION to the number of points of the robot's scanner; without a scanner it stays as it is."""
    global LIDAR_RESOLUTION
    LIDAR_RESOLUTION = int(_call(_support_lidar_points)[-1]) or LIDAR_RESOLUTION


def ANALOGTransfer(buffer=None):
    """The recording of ANALOGRecord; empty while it continues."""
    data, length = _call(_ANALOGTransfer, 1 << 20)
    if buffer is None or not _is_output(buffer):
        return data[:length]
    _fill(buffer, data[:length], "ANALOGTransfer")
    return length


def RADIOSend(id, buf, size=None):
    """Sends a text of up to 1023 bytes to a robot, 0 for all robots; `size` limits the text. Returns 0, 1 on failure."""
    size = None if size is None else max(0, _whole(size))
    is_text = isinstance(buf, (str, bytes, bytearray))
    data = _memory(buf, None, "RADIOSend")[:size] if is_text else _memory(buf, size, "RADIOSend")
    return _call(_RADIOSend, id, data)[-1]


def RADIOReceive(*arguments):
    """RADIOReceive(size=1024) waits for a message: address of its sender, and text; 0 and no text if the radio is off. Bytes
    that are not UTF-8, for example after bit errors, become the replacement character. RADIOReceive(id, buf, size) is as in C."""
    _expect("RADIOReceive", len(arguments), (0, 1, 3), "(size) or (id, buf, size)")
    id, buf, size = (None, None) + (arguments or (1024,)) if len(arguments) < 2 else arguments
    sender, data, result = _call(_RADIOReceive, None, max(0, _whole(size)))
    if not (_is_output(id) or _is_output(buf)):
        return _Values((*_or_zero([sender]), _text(data)))
    _out("RADIOReceive", [sender], id)
    if result == 0:
        _fill(buf, bytes(data).split(b"\0")[0] + b"\0", "RADIOReceive")
    return result


def RADIOCheck(id=None):
    """Number of waiting messages; 0 if the radio is off."""
    return _call(_RADIOCheck)[0]


def RADIOStatus(IDlist=None):
    """Addresses of all robots whose radio is on, including this robot; none if its radio is off."""
    values, count = _call(_RADIOStatus, 256)
    return _out_numbers("RADIOStatus", _Addresses(values), IDlist, count)


def SIMGetRobot(id=0, x=None, y=None, z=None, phi=None):
    """Ground-truth pose of a robot (0 is the calling robot): mm, mm, mm, degrees."""
    return _out("SIMGetRobot", _call(_SIMGetRobot, id, None, None, None, None), x, y, z, phi)


def SIMSetRobot(*arguments):
    """SIMSetRobot(id, x, y, z, phi) places a robot (0 is the calling robot). Older programs leave out the id, if x is no number of a robot:
    (x, y, z, phi) and (x, y, phi) place the calling robot."""
    forms = {5: (0, 1, 2, 3, 4), 4: (None, 0, 1, 2, 3), 3: (None, 0, 1, None, 2)}
    if len(arguments) in (3, 4) and -_LEAST_X < _int(arguments[0], -(1 << 31), (1 << 32) - 1, "SIMSetRobot") < _LEAST_X:
        forms = {5: forms[5]}
    _call(_SIMSetRobot, *_pose("SIMSetRobot", arguments, forms))


# No robot has its centre closer to a wall at x = 0, in mm, and few scenes have so many robots.
_LEAST_X = 80


def SIMGetObject(id, *targets):
    """True pose of an object: x, y, phi, or x, y, z, phi for four names; the numbers of objects follow those of robots."""
    _expect("SIMGetObject", 1 + len(targets), (1, 4, 5), "(id), (id, x, y, phi) or (id, x, y, z, phi)")
    written = _call(_SIMGetObject, id, None, None, None, None)
    if not any(_is_output(target) for target in targets):
        return _Object(_or_zero(written))
    return _out("SIMGetObject", written if len(targets) == 4 else [*written[:2], written[3]], *targets)


def SIMSetObject(*arguments):
    """SIMSetObject(id, x, y, z, phi), or (id, x, y, phi), places an object."""
    _call(_SIMSetObject, *_pose("SIMSetObject", arguments, {5: (0, 1, 2, 3, 4), 4: (0, 1, 2, None, 3)}))


def _expect(name, count, counts, parameters):
    """Raises an exception with the names of the parameters unless the number of arguments is one of `counts`."""
    if count not in counts:
        raise TypeError(f"{name}: expected {parameters}, got {count} argument{'' if count == 1 else 's'}")


def _pose(name, arguments, forms):
    """Number and pose in the arguments, whose count must match one of the forms."""
    short = " or (id, x, y, phi)" if name == "SIMSetObject" else ""
    _expect(name, len(arguments), forms, "(id, x, y, z, phi)" + short)
    return [0 if index is None else arguments[index] for index in forms[len(arguments)]]


def SIMGetPose(x=None, y=None, phi=None):
    """Ground-truth pose of this robot: mm, mm, degrees."""
    own_x, own_y, _z, own_phi = _call(_SIMGetRobot, 0, None, None, None, None)
    return _out("SIMGetPose", [own_x, own_y, own_phi], x, y, phi)


def SIMSetPose(x, y, phi):
    """Places this robot."""
    return SIMSetRobot(0, x, y, 0, phi)


def SERVODone(servo):
    """Returns 1 if a servo has reached its position, which it does at once; 0 if there is no such servo."""
    return _Number(SERVOGet(servo) >= 0)


def SERVOWait(servo):
    """Waits until a servo has reached its position. Returns 0, 1 if there is no such servo."""
    return _Number(SERVOGet(servo) < 0)


SIMLaserScan = LIDARGet
MOTORPIDoff = MOTORPIDOff
LCDFontSize = LCDSetFontSize
VWDriveRemain, VWDriveDone, VWDriveWait, VWDriveReady = VWRemain, VWDone, VWWait, VWDone

# ---- EyeSim VR's library, for programs that call it with ctypes ----


class _Foreign:
    """A function with the interface of a ctypes function. Setting `argtypes` or `restype` has no effect."""

    argtypes = restype = errcheck = None

    def __init__(self, function):
        self._function, self.__name__ = function, function.__name__

    def __call__(self, *arguments):
        code = getattr(self._function, "__wrapped__", self._function).__code__
        if not code.co_flags & 4:  # without *arguments: surplus arguments are ignored, as in C
            arguments = arguments[: code.co_argcount]
        result = self._function(*arguments)
        return result.encode() if isinstance(result, str) else 0 if result is None else result


class _Library:
    """Replacement of `ctypes.CDLL` for EyeSim VR's library."""

    _name, _handle = "libeyesim.so", 0

    def __getattr__(self, name):
        function = _functions.get(name)
        if function is None:
            raise AttributeError(f"{self._name}: undefined symbol: {name}")
        setattr(self, name, _Foreign(function))
        return self.__dict__[name]

    __getitem__ = __getattr__


def _cdll(loader):
    """The class `CDLL`, which returns this library for the name of EyeSim VR's library; other libraries load normally."""

    class CDLL(loader):
        """Loads a library."""

        def __new__(cls, name=None, *arguments, **options):
            is_replaced = _os.path.basename(str(name)).split(".")[0] in ("libeyesim", "libeyebot", "cygeyesim")
            return lib if is_replaced else super().__new__(cls)

    return CDLL


# ---- layers of the window, as in C's eyesim.h ----

EYESIM_WORLD, EYESIM_ODOMETRY, EYESIM_OCCUPIED, EYESIM_UNKNOWN = 0, 1, 100, 255


def eyesim_show_grid(name, frame, x_m, y_m, cell_m, columns, rows, cells):
    """Shows a grid as the layer of this name in the window: one byte per cell, row by row from the smallest y, 0 (free) to 100
    (occupied) or EYESIM_UNKNOWN; or a list of rows. Its lower left corner is at x_m, y_m. Returns 0, 1 on failure."""
    if isinstance(cells, (list, tuple)) and cells and hasattr(cells[0], "__len__"):
        cells = [cell for row in cells for cell in row]
    corner = [_real(value, "eyesim_show_grid") for value in (x_m, y_m, cell_m)]
    data = _memory(cells, max(0, _whole(columns)) * max(0, _whole(rows)), "eyesim_show_grid")
    return _call(_support_show_grid, name, frame, *corner, columns, rows, data)[-1]


def eyesim_show_points(name, frame, points):
    """Shows points as the layer of this name in the window: a list of (x, y) or (x, y, z) in metres. Returns 0, 1 on failure."""
    return _call(_support_show_points, name, frame, *_coordinates(points, "eyesim_show_points"))[-1]


def eyesim_show_line(name, frame, points):
    """Like eyesim_show_points, for a line through the points."""
    return _call(_support_show_line, name, frame, *_coordinates(points, "eyesim_show_line"))[-1]


def _real(value, name):
    try:
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected a number, got {value!r}") from None


def _coordinates(points, name):
    """Number of dimensions, number of points, and their coordinates."""
    points = [tuple(point) for point in points]
    dimensions = len(points[0]) if points else 2
    if any(len(point) != dimensions for point in points):
        raise ValueError(f"{name}: expected points of {dimensions} coordinates like the first one")
    numbers = [_real(value, name) for point in points for value in point]
    return dimensions, len(points), _struct.pack(f"<{len(numbers)}d", *numbers)


# Names of parameters in EyeSim VR's `eye.py` that differ from those of the functions here, in their order.
_PARAMETERS = {
    "VWStraight": ("dist", "speed"),
    "VWTurn": ("ang", "speed"),
    "VWCurve": ("dist", "angle", "speed"),
    "VWDrive": ("dis", "vel", "spd"),
    "VWSetSpeed": ("speed", "angspeed"),
    "LCDPrintf": ("format",),
    "LCDSetPrintf": ("row", "column", "format"),
    "LCDImageGray": ("img_gray",),
    "LCDImageBinary": ("binary",),
    "IPLaplace": ("grayIn",),
    "IPSobel": ("grayIn",),
    "IPCol2Gray": ("imgIn",),
    "LIDARSet": ("angRange", "tilt", "numPoints"),
    "MOTORSpeed": ("motor", "speed"),
    "AUPlay": ("filename",),
    "RADIOSend": ("idnum", "mes"),
    "SIMSetRobot": ("id", "x", "y", "z", "phi"),
    "SIMSetObject": ("id", "x", "y", "z", "phi"),
}


def _accept_keywords(name, parameters):
    """Lets a function accept its arguments by the names of EyeSim VR, too."""
    import functools

    function = globals()[name]

    @functools.wraps(function)
    def accepting(*arguments, **keywords):
        for parameter in parameters[len(arguments) :]:
            if parameter not in keywords:
                break
            arguments += (keywords.pop(parameter),)
        return function(*arguments, **keywords)

    globals()[name] = accepting


for _name, _names in _PARAMETERS.items():
    _accept_keywords(_name, _names)

lib = _Library()
_functions = {name: value for name, value in globals().items() if name[:2].isupper() and hasattr(value, "__code__")}

# Further names of EyeSim VR's `eye.py`; a name that the program has already defined is kept.
_FURTHER_NAMES = {"ctypes": _ctypes, "sys": _sys, "os": _os}
_FURTHER_NAMES.update((_name, getattr(_ctypes, _name)) for _name in dir(_ctypes) if not _name.startswith("_"))
__all__ = [_name for _name in dir() if not _name.startswith("_") and _name != "annotations"] + [*_FURTHER_NAMES, "np"]


class _Numpy:
    """numpy, imported when it is first used."""

    def __getattr__(self, name):
        import numpy

        return getattr(numpy, name)


def __getattr__(name):
    if name != "np" and name not in _FURTHER_NAMES:
        raise AttributeError(f"module 'eye' has no attribute '{name}'")
    default = _Numpy() if name == "np" else _FURTHER_NAMES[name]
    return _sys._getframe(1).f_globals.get(name, default)


# ---- the program's run ----

_STDOUT, _STDERR = 1, 2
_FAILED_WITH_ERROR = 5


class _Console:
    """A stream of the program: whole lines go to the simulator."""

    encoding, errors, closed, newlines = "utf-8", "replace", False, None

    def __init__(self, stream):
        self.stream, self.lines = stream, {}  # incomplete line per thread

    def write(self, text):
        if not isinstance(text, str):
            raise TypeError(f"write() argument must be str, not {type(text).__name__}")
        thread = _thread.get_ident()
        line = self.lines.pop(thread, "") + text
        end = line.rfind("\n") + 1
        if line[end:]:
            self.lines[thread] = line[end:]
        if end:
            self._send(line[:end])
        return len(text)

    def writelines(self, lines):
        for line in lines:
            self.write(line)

    def flush(self):
        line = self.lines.pop(_thread.get_ident(), "")
        if line:
            self._send(line)

    def close(self):
        """Leaves the console open: it belongs to the robot."""
        self.flush()

    def finish(self):
        """Prints the incomplete lines of all threads."""
        for thread in list(self.lines):
            self._send(self.lines.pop(thread))

    def _send(self, text):
        if _channel is None:
            return
        try:
            _call(_support_console, self.stream, text)
        except _Stop:
            pass  # the next call of RoBIOS raises _Stop

    def isatty(self):
        return False

    def fileno(self):
        raise _io.UnsupportedOperation("the robot's console is not a file")  # an OSError; that name is a function of RoBIOS

    def readable(self):
        return False

    def writable(self):
        return True

    def seekable(self):
        return False


_consoles = _Console(_STDOUT), _Console(_STDERR)


class _Input(_io.RawIOBase):
    """Standard input of the robot: its lines come from the simulator."""

    def readable(self):
        return True

    def readinto(self, buffer):
        if _channel is None:
            return 0
        _sys.stdout.flush()  # a prompt
        data, length = _call(_support_input, len(buffer))
        buffer[:length] = data[:length]
        return length


def _now_us():
    return int(_request(_support_time_us, ())[0])


def _read_clock_us():
    """Virtual time for the program."""
    return int(_call(_support_time_us)[0])


def _sleep(seconds):
    if seconds < 0:
        raise ValueError("sleep length must be non-negative")
    _call(_support_sleep_us, min(int(seconds * 1e6), 1 << 62))


def _urandom(size):
    words = (_call(_support_random, 4)[0] for _ in range((size + 7) // 8))
    return b"".join(_struct.pack("<Q", word) for word in words)[:size]


def _sleep_towards(until_us):
    """Sleeps until a virtual time, but no longer than a slice; returns False if the time has passed already."""
    left_us = int(until_us - _now_us())
    if left_us > 0:
        _call(_support_sleep_us, min(left_us, _SLICE_US))
    return left_us > 0


def _replace_time_and_randomness():
    """Replaces the machine's time and randomness in Python's modules by virtual time and the robot's random stream."""
    import functools
    import select
    import threading

    class Lock:
        def __init__(self):
            self._lock, self._waiting = _allocate_lock(), 0
            self.locked, self._at_fork_reinit = self._lock.locked, getattr(self._lock, "_at_fork_reinit", None)

        def acquire(self, blocking=True, timeout=-1):
            if not blocking or timeout <= 0 and timeout != -1:
                return self._lock.acquire(blocking, timeout)
            is_mine = False

            def take():
                nonlocal is_mine
                is_mine = self._lock.acquire(False)
                return is_mine

            self._waiting += 1
            try:
                return wait_for(take, None if timeout == -1 else timeout)
            except BaseException:
                if is_mine:
                    self.release()
                raise
            finally:
                self._waiting -= 1

        def release(self):
            self._lock.release()
            if self._waiting:
                _token.notify()

        __enter__ = acquire

        def __exit__(self, *_):
            self.release()

    class RLock(threading._PyRLock):
        def acquire(self, blocking=True, timeout=-1):
            return bool(super().acquire(blocking, timeout))

        __enter__ = acquire

    def wait_for(is_ready, timeout, block=None):
        if is_ready():
            return True
        return _token.wait(is_ready, None if timeout is None else _now_us() + int(timeout * 1e6), block)

    def join(thread, timeout=None):
        original_join(thread, 0)  # raises an exception unless the thread may be joined
        if wait_for(lambda: id(thread) not in _token.started, timeout):
            original_join(thread)

    def is_alive(thread):
        foreign = isinstance(thread, (threading._MainThread, threading._DummyThread))
        return original_is_alive(thread) and (foreign or id(thread) in _token.started)

    class Select:  # a function would become a method of a class that has it as attribute
        def __call__(self, readers, writers, others, timeout=None):
            ready = []

            def is_ready():
                ready[:] = original_select(readers, writers, others, 0)
                return any(ready)

            wait_for(is_ready, timeout, lambda: original_select(readers, writers, others))
            return tuple(ready)

    def excepthook(arguments):
        if not issubclass(arguments.exc_type, _Stop):  # otherwise the program is stopped with all its threads
            original_excepthook(arguments)

    original_excepthook, threading.excepthook = threading.excepthook, excepthook
    original_join, threading.Thread.join = threading.Thread.join, join
    original_is_alive, threading.Thread.is_alive = threading.Thread.is_alive, is_alive
    threading.Lock = threading._allocate_lock = _thread.allocate_lock = Lock
    threading._CRLock, _sys.modules["_queue"] = RLock, None  # `queue` then uses its form in Python, and thus `Lock`
    for module, prefix in ((threading, "_"), (_thread, "")):
        for name in (prefix + "start_new_thread", prefix + "start_joinable_thread"):
            if hasattr(module, name):
                setattr(module, name, functools.partial(_token.start, getattr(module, name)))
    original_select, select.select = select.select, Select()
    # `selectors`, and thus asyncio, uses `select` if none of these exists. Some modules of Python 3.10 import it before.
    _sys.modules.pop("selectors", None)
    for name in ("epoll", "poll", "devpoll", "kqueue"):
        vars(select).pop(name, None)
    _os.urandom = _random._urandom = _urandom
    _random.seed(_call(_support_random, 1)[0])
    _time.sleep = _sleep
    for name in _CLOCKS:
        setattr(_time, name, lambda: _read_clock_us() / 1e6)
        setattr(_time, name + "_ns", lambda: _read_clock_us() * 1000)
    # Clock for the timeouts of semaphores, barriers and `wait_for`.
    threading._time = _time.monotonic


_CLOCKS = ("time", "monotonic", "perf_counter", "process_time", "thread_time")
_IMPORTING = 32
_imports = 0  # in progress


def _watch_imports(channel):
    """Reports imports to the simulator: a module that computes for a long time during its import is not an endless loop."""
    import importlib._bootstrap as bootstrap

    find_and_load = bootstrap._find_and_load
    spent_ns = 0

    def load(*arguments):
        global _imports
        nonlocal spent_ns
        start = _processor_time_ns() if _imports == 0 else 0
        _imports += 1
        _struct.pack_into("<I", channel.memory, _IMPORTING, 1)
        try:
            return find_and_load(*arguments)
        finally:
            _imports -= 1
            if _imports == 0:
                spent_ns += _processor_time_ns() - start
                _struct.pack_into("<II", channel.memory, _IMPORTING, 0, spent_ns // 1000000)

    bootstrap._find_and_load = load


# Files whose frames do not belong to the program.
_own_files = {__file__}


def _remove_runtime_frames(report):
    """Removes internal frames from a traceback."""
    while report is not None:
        report.stack[:] = [frame for frame in report.stack if frame.filename not in _own_files]
        _remove_runtime_frames(report.__cause__)
        report = report.__context__


# Offset and states of the request for the line at which the program computes, as in `channel.rs`.
_LOCATION, _LOCATION_READY, _LOCATION_REQUESTED, _LOCATION_WRITTEN = 40, 1, 2, 3


def _report_location(_signal_number, frame):
    """Answers the simulator's liveness check with the current line; ends the program if its processor time is used up."""
    if _channel is None or _channel.turn.value == 1:
        return
    while frame is not None and frame.f_code.co_filename in _own_files:
        frame = frame.f_back
    frame = _frame_beside_program(frame) or frame
    state = _struct.unpack_from("<I", _channel.memory, _LOCATION)[0]
    if state in (_LOCATION_READY, _LOCATION_WRITTEN):
        return  # the signal belongs to an earlier request, and came late
    if state == _LOCATION_REQUESTED:
        if frame is not None:
            name = _os.path.basename(frame.f_code.co_filename).encode("utf-8", "replace")
            _struct.pack_into("<I16s", _channel.memory, _LOCATION + 4, frame.f_lineno, name)
            _struct.pack_into("<I", _channel.memory, _LOCATION, _LOCATION_WRITTEN)
        return
    location = "" if frame is None else f"{_os.path.basename(frame.f_code.co_filename)}:{frame.f_lineno}"
    text = location.encode("utf-8", "replace")
    body = _struct.pack("<iIQQQQ", _signal.SIGURG, len(text), 0, 0, 0, 0) + text
    _channel.send(_FAULT, body)
    _os._exit(1)


def _frame_beside_program(frame):
    """The innermost of this frame and its callers whose file is in the folder of the program or below it; None if there is none."""
    folder = _os.path.dirname(_os.path.abspath(getattr(_sys.modules["__main__"], "__file__", None) or ""))
    while frame is not None and not _is_below(folder, frame.f_code.co_filename):
        frame = frame.f_back
    return frame


def _is_below(folder, name):
    """True for a file in the folder or below it, except this one, packages and the library of Python, which may be installed there."""
    if name in _own_files or name.startswith("<"):
        return False
    file, library = _os.path.abspath(name), _os.path.dirname(_os.__file__)
    installed = "site-packages" in file or file.startswith(library + _os.sep)
    return file.startswith(folder.rstrip(_os.sep) + _os.sep) and not installed


def _leave_fork():
    """Prepares a process that the program has forked: it has no robot, and ends at its first call."""
    def end(*_message):
        _os.write(2, b"error: a process that a robot program has forked cannot call RoBIOS or print with `print`: "
                      b"it is ended; a thread can: `threading.Thread` in place of `multiprocessing.Process`\n")
        _os._exit(1)

    _channel.send = end


def _die_with_host(channel):
    host = _struct.unpack_from("<I", channel.memory, 28)[0]
    channel.libc.prctl(1, _signal.SIGKILL)
    if _os.getppid() != host:
        _os._exit(1)


def _similar_name(error, trace):
    """Closest existing name for an undefined one, as newer Pythons suggest it; None if there is none."""
    import builtins
    import difflib

    name = getattr(error, "name", None)
    if isinstance(error, ModuleNotFoundError):
        alike = isinstance(name, str) and difflib.get_close_matches(name.lower(), ["eye", "eyebot", "eyesim"], 1, 0.75)
        return "eye" if alike else None
    if isinstance(error, NameError):
        while trace and trace.tb_next:
            trace = trace.tb_next
        frame = trace and trace.tb_frame
        known = {*frame.f_locals, *frame.f_globals, *vars(builtins)} if frame else ()
    elif isinstance(error, AttributeError):
        known = dir(getattr(error, "obj", None))
    else:
        return None
    if not isinstance(name, str):
        return None
    alike = {other.lower(): other for other in known if not other.startswith("_")}
    near = difflib.get_close_matches(name.lower(), alike, 1, 0.75)
    return alike[near[0]] if near else None


def _line_of(trace):
    """The line of source at which an exception was raised; empty if it is unknown."""
    import linecache

    while trace and trace.tb_next:
        trace = trace.tb_next
    return linecache.getline(trace.tb_frame.f_code.co_filename, trace.tb_lineno) if trace else ""


def _argument_indices(line):
    """The numbers of the arguments that a line of source uses: 1 for `sys.argv[1]`."""
    indices = (part.split("]")[0].strip() for part in line.split("argv[")[1:])
    return [int(index) for index in indices if index.isascii() and index.isdecimal()]


def _advice(error, trace):
    """Suggested replacement; None if there is none."""
    if isinstance(error, RecursionError):
        return "the function calls itself for ever: it needs an `if` with a `return` before the call"
    used = _argument_indices(_line_of(trace)) if isinstance(error, IndexError) else []
    if any(index >= len(_sys.argv) for index in used):
        count = len(_sys.argv) - 1
        arguments = "no arguments" if count == 0 else "only 1 argument" if count == 1 else f"only {count} arguments"
        return f"the program has {arguments}: `--args` gives it some, as in `--args VALUE`"
    if isinstance(error, IndexError) and "index out of range" in str(error):
        return "the last index is one less than the length, len(...) - 1"
    if isinstance(error, SyntaxError) and "unicodeescape" in str(error):
        return r"`\U`, `\x` and `\N` in a text begin a character's number: write `/` between folders"
    if isinstance(error, SyntaxError) and any(words in str(error) for words in ("codec can't decode", "Non-UTF-8")):
        return "the file is not saved as UTF-8: save it as UTF-8 in the editor"
    if isinstance(error, SyntaxError) and "invalid character" in str(error):
        letter = (str(error).split("'") + [None])[1]
        plain = _PLAIN_LETTERS.get(letter)
        return f"`{letter}` comes from a page or a word processor: write `{plain}`" if plain else None
    if isinstance(error, SyntaxError) and error.text and not isinstance(error, IndentationError):
        return _advice_on_syntax(error.text)
    if isinstance(error, UnboundLocalError):
        name = (str(error).split("'") + [None] * 2)[1]
        return f"a function that sets a variable of the program begins with `global {name}`"
    names = _PYTHON3_NAMES if isinstance(error, NameError) else _PYTHON3_METHODS if isinstance(error, AttributeError) else {}
    if getattr(error, "name", None) in names:
        return f"it belongs to Python 2: Python 3 writes `{names[error.name]}`"
    if isinstance(error, NameError) and getattr(error, "name", None) in getattr(_sys, "stdlib_module_names", ()):
        return f"write `import {error.name}` as the first line"
    if isinstance(error, FileNotFoundError) and isinstance(error.filename, str) and error.filename:
        return _advice_on_path(error.filename)
    if isinstance(error, TypeError) and _signature_in(error):
        return f"it is `{_signature_in(error)}`"
    if isinstance(error, TypeError) and "function' object is not subscriptable" in str(error):
        return "`[ ]` belongs to a list: a function is called with `( )`, as in `PSDGet(1)`"
    if isinstance(error, AttributeError) and str(error).startswith("'NoneType' object has no attribute '"):
        return f"what stands before `.{str(error).split(chr(39))[3]}` is None: test it with `if ... is not None:` first"
    if isinstance(error, TypeError) and "can only concatenate str" in str(error):
        return "`+` joins only texts: write `str(...)` around the number"
    module = (getattr(error, "name", None) or "").split(".")[0]
    if isinstance(error, ModuleNotFoundError) and module and "eye" not in module.lower() and _sys.executable:
        if module in ("msvcrt", "winreg", "winsound"):
            return f"`{module}` exists only on Windows"
        if module == "robios" or error.name.endswith(".eye"):
            return "the module of the robot is `eye`: write `from eye import *`"
        present = _PYTHON3_MODULES.get(module, module.lower())
        if module not in getattr(_sys, "stdlib_module_names", ()) and present.split(".")[0] in getattr(_sys, "stdlib_module_names", ()):
            return f"write `import {present}`"
        if module in getattr(_sys, "stdlib_module_names", ()):
            return f"this Python is installed without its module `{module}`"
        return f"install it for this Python: {_sys.executable} -m pip install {_PACKAGES.get(module, module)}"
    return _missing_import(error, trace)


# Characters to which Python converts a backslash and the letter after it.
_ESCAPES = {"\a": "/a", "\b": "/b", "\f": "/f", "\n": "/n", "\r": "/r", "\t": "/t", "\v": "/v", "\\": "/"}


def _advice_on_path(name):
    """Where a file was looked for that does not exist, and what to write instead of a path of Windows; None for other absolute paths."""
    path = "".join(_ESCAPES.get(letter, letter) for letter in name)
    has_drive = path[1:2] == ":" and path[:1].isalpha()
    place = f"relative paths begin in `{_os.getcwd()}`, the folder in which eyesim runs"
    beside = _file_beside(path)
    if path == name and _os.path.isabs(name):
        return None if beside is None else f"write `{beside}`, which is beside the program"
    if path == name and not has_drive:
        return place if beside is None else f"{place}; write `{beside}`, which is beside the program"
    cause = f"there is no drive `{path[:2]}` here" if has_drive else "`/` stands between folders, not a backslash"
    there = path[2:].lstrip("/") if has_drive else path
    for part in range(there.count("/") + 1 if has_drive else 1):
        rest = there.split("/", part)[-1]
        if _os.path.exists(rest):
            return f"{cause}: write `{rest}`"
    if beside is not None:
        return f"{cause}: write `{beside}`, which is beside the program"
    instead = "a path from" if has_drive else f"`{path}`; relative paths begin in"
    return f"{cause}: write {instead} `{_os.getcwd()}`, the folder in which eyesim runs"


def _file_beside(path):
    """Path, from the working folder if it is there, of a file of this name beside the program; None if there is none."""
    folder = _os.path.dirname(_os.path.abspath(getattr(_sys.modules["__main__"], "__file__", None) or ""))
    found = _os.path.join(folder, path.rsplit("/", 1)[-1])
    if not _os.path.isfile(found):
        return None
    relative = _os.path.relpath(found)
    return found if relative.startswith("..") else relative


def _signature_in(error):
    """The call of the function of this module to which a program has given a wrong number of arguments; None for other errors."""
    name, _, rest = str(error).partition("() ")
    function = _functions.get(name) if rest.startswith(("missing ", "takes ", "got ")) else None
    if function is None:
        return None
    function = getattr(function, "__wrapped__", function)
    names = function.__code__.co_varnames[: function.__code__.co_argcount]
    optional = len(function.__defaults__ or ())
    return f"{name}({', '.join(names[: len(names) - optional])})"


# Names of packages that differ from those of their modules.
_PACKAGES = {"cv2": "opencv-python-headless", "PIL": "Pillow", "sklearn": "scikit-learn", "skimage": "scikit-image", "yaml": "PyYAML"}

# Names and methods of Python 2 and what Python 3 writes.
_PYTHON3_NAMES = {
    "raw_input": "input", "xrange": "range", "unicode": "str", "unichr": "chr", "long": "int", "reduce": "functools.reduce",
}
_PYTHON3_METHODS = {"has_key": "key in dictionary", "iteritems": "items", "iterkeys": "keys", "itervalues": "values"}

# Modules of Python 2 that have another name in Python 3; those that differ in case only are not listed.
_PYTHON3_MODULES = {"StringIO": "io", "cPickle": "pickle", "thread": "threading", "urllib2": "urllib.request", "tkMessageBox": "tkinter.messagebox"}

# Typographic letters and those of programs.
_PLAIN_LETTERS = {"\u201c": '"', "\u201d": '"', "\u201e": '"', "\u2018": "'", "\u2019": "'", "\u2212": "-", "\u2013": "-", "\u2014": "-"}

# Words at the start of statements.
_STATEMENT_WORDS = ("while", "for", "if", "elif", "else", "def", "return", "import", "from", "class", "try", "except", "with", "break")


def _advice_on_syntax(line):
    """Suggested replacement for a syntax error; None if there is none."""
    import difflib
    import re

    if re.match(r"\s*else\s+if\b", line):
        return "write `elif`"
    handler = re.match(r"\s*except\s+([\w.]+)\s*,\s*(\w+)\s*:", line)
    if handler and handler.group(2)[0].isupper():
        return f"write `except ({handler.group(1)}, {handler.group(2)}):`"
    if handler:
        return f"Python 3 writes `except {handler.group(1)} as {handler.group(2)}:`"
    raised = re.match(r"\s*raise\s+([\w.]+)\s*,\s*(.+)", line)
    if raised:
        return f"Python 3 writes `raise {raised.group(1)}({raised.group(2).strip()})`"
    for words, instead in (("++", "+= 1"), ("--", "-= 1"), ("&&", "and"), ("||", "or")):
        if words in line:
            return f"Python has no `{words}`: write `{instead}`"
    # A name that is assigned, or whose attribute is used, is not a misspelt keyword.
    word = re.match(r"\s*(\w*)(?!\w|\s*[.=,])|", line).group(1) or ""
    near = difflib.get_close_matches(word, _STATEMENT_WORDS, 1, 0.75) if word not in _STATEMENT_WORDS else []
    return f"did you mean `{near[0]}`?" if near else None


def _missing_import(error, trace):
    """Suggestion for a name of this module that the program has not imported, or of RoBIOS 6; None for other errors."""
    name = getattr(error, "name", None) or (str(error).split("'") + [None] * 2)[1]
    if isinstance(error, (NameError, AttributeError)) and name in _ROBIOS6_ONLY:
        return "it belongs to RoBIOS 6, which C and C++ have; Python has RoBIOS-7, whose devices need no handle and no `...Init`"
    if not isinstance(error, NameError) or name not in __all__ or name in _FURTHER_NAMES:
        return None
    while trace.tb_next:
        trace = trace.tb_next
    if trace.tb_frame.f_globals.get("eye") is _sys.modules["eye"]:
        return f"write eye.{name}"
    return "it belongs to `eye`: write `from eye import *` as the first line"


def _report_error(path):
    """Prints the traceback of the program's own frames, and reports the exception to the simulator."""
    import traceback

    kind, error, trace = _sys.exc_info()
    _consoles[0].finish()  # what the program has printed comes before its error
    report = traceback.TracebackException(kind, error, trace)
    _remove_runtime_frames(report)
    text = "".join(report.format()).rstrip("\n")
    message = traceback.format_exception_only(kind, error)[-1].strip()
    advice = _advice(error, trace)
    near = None if advice else _similar_name(error, trace)
    if advice:
        message, text = message.split(". Did you mean")[0] + f": {advice}", text.split(". Did you mean")[0] + f": {advice}"
    elif near and "Did you mean" not in message:
        hint = f". Did you mean: '{near}'?"
        message, text = message + hint, text + ("" if "Did you mean" in text else hint)
    _sys.stderr.write(text + "\n")
    frames = [frame for frame in traceback.extract_tb(trace) if frame.filename not in _own_files]
    local_frames = [frame for frame in frames if _is_below(_os.path.dirname(path), frame.filename)]
    if isinstance(error, SyntaxError) and error.filename:
        message += f" at {_os.path.basename(error.filename)}:{error.lineno}"
    elif local_frames or frames:
        frame = (local_frames or frames)[-1]
        message += f" at {_os.path.basename(frame.filename)}:{frame.lineno}"
    try:
        _call(_support_failed, _FAILED_WITH_ERROR, message, b"")
    except _Stop:
        pass


def _exit_code_of(program, path):
    """Runs the program of the file `path`, reports a failure to the simulator and returns the exit code."""
    try:
        program()
    except _Stop:
        pass
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return (end.code or 0) & 0xFF
        print(end.code, file=_sys.stderr)
        return 1
    except BaseException:
        if not _is_stopped:
            _report_error(path)
        return 1
    return 0


_AST_ONLY = 0x400  # `ast.PyCF_ONLY_AST`, without the import


def _hint_at_missing_parentheses(tree, file):
    """Reports statements that only name a function of this module: `VWWait` instead of `VWWait()`."""
    for field in ("body", "orelse", "finalbody", "handlers"):
        statements = getattr(tree, field, ())
        for statement in statements if isinstance(statements, list) else ():
            value = getattr(statement, "value", None) if type(statement).__name__ == "Expr" else None
            name = getattr(value, "attr", None) or getattr(value, "id", None)
            if name in _functions:
                text = f"`{name}` without `()` does nothing: write `{name}()`"
                _consoles[1].write(f"{file}:{statement.lineno}: hint: {text}\n")
            _hint_at_missing_parentheses(statement, file)


def _hint_at_own_eye(text, path):
    """Reports a module `eye` beside a program that imports `eye`: the simulator's module is used instead."""
    folder = _os.path.dirname(path)
    found = [name for name in ("eye.py", "eye/__init__.py") if _os.path.isfile(_os.path.join(folder, name))]
    if not found:
        return
    import re

    if not re.search(rb"^[ \t]*(from|import)[ \t]+([\w.]+[ \t]*,[ \t]*)*eye\b", text, re.MULTILINE):
        return
    try:
        with open(_os.path.join(folder, found[0]), "rb") as file:
            is_copy = file.read(100).startswith(b'"""RoBIOS-7 for ')
    except EnvironmentError:  # OSError; that name is a function of RoBIOS
        return
    if not is_copy:
        own = "`eye.py`" if found[0] == "eye.py" else "the folder `eye`"
        text = f"`import eye` gives the simulator's module, not {own} beside the program: a module of your own needs another name"
        _consoles[1].write(f"{_os.path.basename(path)}: hint: {text}\n")


def _run(path):
    """Runs the program as `__main__` and returns its exit code."""
    import atexit
    import types

    module = types.ModuleType("__main__")
    module.__file__ = path
    module.__builtins__ = __builtins__
    _sys.modules["__main__"] = module

    def program():
        with open(path, "rb") as file:
            text = file.read()
        tree = compile(text, path, "exec", _AST_ONLY)
        _hint_at_missing_parentheses(tree, _os.path.basename(path))
        _hint_at_own_eye(text, path)
        exec(compile(text, path, "exec"), module.__dict__)

    exit_code = _exit_code_of(program, path)
    try:
        threading = _sys.modules.get("threading")
        if threading is not None:
            while getattr(threading, "_threading_atexits", None):
                threading._threading_atexits.pop()()
            _token.wait(lambda: all(thread.daemon or id(thread) not in _token.started for thread in threading.enumerate()))
            threading._shutdown()
        atexit._run_exitfuncs()
    except _Stop:
        pass
    except BaseException:
        if not _is_stopped:
            _report_error(path)
        exit_code = exit_code or 1
    try:
        _token.enter_call()  # from now on, daemon threads can make no calls
    except BaseException:
        pass  # the error of a timer's function came too late
    for stream in _consoles:
        stream.finish()
    return exit_code


def _main(path):
    global _channel
    _sys.modules["eye"] = _sys.modules["__main__"]
    channel = _Channel()
    null = _os.open("/dev/null", _os.O_RDWR)
    _os.dup2(null, 0)
    _os.close(null)
    _die_with_host(channel)
    _os.register_at_fork(after_in_child=_leave_fork)
    _sys.stdin = _io.TextIOWrapper(_io.BufferedReader(_Input()), encoding="utf-8", errors="replace")
    _sys.stdout, _sys.stderr = _consoles
    _ctypes.CDLL = _ctypes.cdll._dlltype = _FURTHER_NAMES["CDLL"] = _cdll(_ctypes.CDLL)
    _signal.signal(_signal.SIGURG, _report_location)
    path = _os.path.abspath(path)
    _sys.path[0] = _os.path.dirname(path)
    _struct.pack_into("<I", channel.memory, _LOCATION, _LOCATION_READY)
    channel.send(_READY, _struct.pack("<Q", 0))
    kind, body = channel.receive()
    if kind != _RUN:
        _os._exit(0)
    (count,) = _struct.unpack_from("<I", body, 0)
    offset, arguments = 4, []
    for _ in range(count):
        (length,) = _struct.unpack_from("<I", body, offset)
        arguments.append(body[offset + 4 : offset + 4 + length].decode("utf-8", "surrogateescape"))
        offset += 4 + length
    _sys.argv = arguments
    _channel = channel
    exit_code = 0
    try:
        _set_lidar_resolution()
        _replace_time_and_randomness()
        _watch_imports(channel)
        exit_code = _run(path)
    except _Stop:
        pass
    channel.send(_EXITED, _struct.pack("<i", exit_code))
    _os._exit(0)


if __name__ == "__main__":
    _main(_sys.argv[1])
