"""RoBIOS-7 for robot programs in Python: `from eye import *`.

`eyesim run` runs a program with this module, whatever `eye.py` lies beside it; a copy beside the program is for editors.
Functions, constants and units are those of C (millimetres, degrees, milliseconds). What C writes through pointers is
returned: `x, y, phi = VWGetPosition()`. Images are flat `bytearray`s, three bytes a pixel in colour; wherever an image
goes in, anything with a buffer does, such as an array of numpy, and `image.array()` is one with rows and columns.

Time is the robot's virtual time in `time.time`, `time.monotonic`, `time.perf_counter` and `time.sleep`; `random` and
`os.urandom` draw from the robot's own stream.
"""

import array as _array
import ctypes as _ctypes
import mmap as _mmap
import os as _os
import platform as _platform
import random as _random
import signal as _signal
import struct as _struct
import sys as _sys
import time as _time

# ---- constants ----

# @CONSTANTS@

PSD_FRONT2, PSD_LEFTDIAG, PSD_RIGHTDIAG = 5, 6, 7
CAM_SUCCESS, CAM_FAILURE = 0, 1

_SIZES = {QQVGA: (160, 120), QVGA: (320, 240), VGA: (640, 480), CAM1MP: (1296, 730), CAMHD: (1920, 1080), CAM5MP: (2592, 1944)}

CAMWIDTH, CAMHEIGHT, CAMPIXELS, CAMSIZE, CAMMODE = 320, 240, 320 * 240, 320 * 240 * 3, QVGA
IP_WIDTH, IP_HEIGHT, IP_PIXELS, IP_SIZE = 320, 240, 320 * 240, 320 * 240 * 3

# ---- the channel to the simulator: docs/protocol.md ----

_CHANNEL = 32 << 20
_BODY = 64
_READY, _REFUSED, _CALL, _RETURNED, _EXITED, _FAULT = 1, 2, 3, 4, 5, 6
_RUN, _OK, _STOP, _CALL_BACK = 16, 17, 18, 19
_SYS_FUTEX = {"x86_64": 202, "aarch64": 98, "riscv64": 98, "armv7l": 240, "i686": 240}
_NULL = 0xFFFFFFFF


class _Stop(BaseException):
    """The program must be left."""


class _Channel:
    def __init__(self):
        self.memory = _mmap.mmap(0, _CHANNEL, _mmap.MAP_SHARED)
        magic, version = _struct.unpack_from("<II", self.memory, 0)
        if magic != 0x53455945 or version != 1:
            raise RuntimeError("the simulator speaks another protocol: copy its eye.py anew")
        self.libc = _ctypes.CDLL(None, use_errno=True)
        self.futex = _SYS_FUTEX[_platform.machine()]
        self.turn = _ctypes.c_uint32.from_buffer(self.memory, 8)
        _struct.pack_into("<I", self.memory, 20, self.libc.syscall({202: 186, 98: 178, 240: 224}[self.futex]))

    def send(self, kind, body):
        if len(body) > _CHANNEL - _BODY:
            raise ValueError("more than 32 MB in one call")
        memory = self.memory
        memory[_BODY : _BODY + len(body)] = body
        _struct.pack_into("<II", memory, 12, kind, len(body))
        self.turn.value = 1
        self.libc.syscall(self.futex, _ctypes.byref(self.turn), 1, 1)

    def receive(self):
        while self.turn.value == 1:
            self.libc.syscall(self.futex, _ctypes.byref(self.turn), 0, 1, None)
        kind, length = _struct.unpack_from("<II", self.memory, 12)
        return kind, self.memory[_BODY : _BODY + length]


_channel = None  # while the program does not run
_is_stopped = False
_callbacks = {}


def _exchange(kind, body):
    """Sends a message and gives the body of the answer; functions that the simulator calls run in between."""
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
    """Runs a timer's function; what it raises is raised in the program, by the call in progress."""
    global _raised
    try:
        _callbacks[code]()
        return 0
    except _Stop:
        return 1
    except BaseException as error:  # noqa: B902
        _raised = error
        return 1


_raised = None


def _place():
    """File and line of the program that is in a call."""
    frame = _sys._getframe(1)
    while frame is not None and frame.f_globals is globals():
        frame = frame.f_back
    return ("", 0) if frame is None else (_os.path.basename(frame.f_code.co_filename), frame.f_lineno)


def _int(value, low, high, name):
    """A whole number within bounds; fractions are cut off, as in C."""
    try:
        number = int(value)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name}: expected a number, got {value!r}") from None
    if not low <= number <= high:
        raise OverflowError(f"{name}: {number} is not within {low} to {high}")
    return number


def _bytes(value):
    if value is None:
        return _struct.pack("<I", _NULL)
    if isinstance(value, str):
        value = value.encode("utf-8", "surrogateescape")
    elif isinstance(value, (list, tuple)):
        value = bytes(value)
    else:
        view = memoryview(value)
        value = view.cast("B") if view.c_contiguous else view.tobytes()
    return _struct.pack("<I", len(value)) + bytes(value)


def _call(row, *values):
    """Calls a function of a list: what it writes, in order, then its result."""
    name, function_list, number, kinds, result = row
    if _channel is None:
        raise RuntimeError(f"{name}: no simulator; run the program with `eyesim run`")
    if _is_stopped and function_list == 7:
        raise _Stop
    file, line = _place()
    file = file.encode("utf-8", "replace")
    body = [_struct.pack("<IIQII", function_list, number, 0, line, len(file)), file]
    for kind, value in zip(kinds, values):
        if kind == "i":
            body.append(_struct.pack("<i", _int(value, -(1 << 31), (1 << 31) - 1, name)))
        elif kind in "tb":
            body.append(_bytes(value))
        elif kind == "B":
            value = ord(value) if isinstance(value, str) and len(value) == 1 else value
            body.append(_struct.pack("<B", _int(value, 0, 255, name)))
        elif kind in "IrRF":
            body.append(_struct.pack("<I", value))
        elif kind in "qQ":
            body.append(_struct.pack("<" + kind, value))
        elif kind in "oOe":
            body.append(b"\1")
        elif kind == "k":
            code = 0 if value is None else len(_callbacks) + 1
            if value is not None and not callable(value):
                raise TypeError(f"{name}: expected a function, got {value!r}")
            _callbacks[code] = value
            body.append(_struct.pack("<QQ", code, 0))
    global _raised
    try:
        answer = _exchange(_CALL, b"".join(body))
    except _Stop:
        if _raised is not None:
            raised, _raised = _raised, None
            raise raised from None
        raise
    at, written = 0, []
    for kind in kinds:
        if kind in "oOe":
            (is_set,) = _struct.unpack_from("<B", answer, at)
            at += 1
            if is_set:
                form = {"o": "<i", "O": "<B", "e": "<f"}[kind]
                written.append(_struct.unpack_from(form, answer, at)[0])
                at += _struct.calcsize(form)
            else:
                written.append(0)
        elif kind == "r":
            (length,) = _struct.unpack_from("<I", answer, at)
            written.append(bytearray(answer[at + 4 : at + 4 + length]))
            at += 4 + length
        elif kind in "RF":
            (count,) = _struct.unpack_from("<I", answer, at)
            numbers = _struct.unpack_from(f"<{count}{'i' if kind == 'R' else 'f'}", answer, at + 4)
            written.append(list(numbers))
            at += 4 + 4 * count
    if result:
        written.append(_struct.unpack_from("<" + result, answer, at)[0])
    return written


# Name, number of the list, number in it, kinds of the parameters, kind of the result.
# @CALLS@

# ---- functions ----

# @FUNCTIONS@

# ---- functions whose form in Python is not that of the call ----


def LCDPrintf(text, *values):
    """Prints at the cursor; with further values as `text % values`. Returns 0."""
    return _call(_LCDPrintf, str(text) % values if values else str(text))[-1]


def LCDSetPrintf(row, column, text, *values):
    """Prints at a row and a column of characters, both from 0. Returns 0, 1 if there is no such place."""
    return _call(_LCDSetPrintf, row, column, str(text) % values if values else str(text))[-1]


def KEYReadXY():
    """The place of a touch of the display as (x, y), None if there was none. Does not wait."""
    x, y, is_missing = _call(_KEYReadXY, None, None)
    return None if is_missing else (x, y)


_shown_width, _shown_height = 320, 240


def LCDImageSize(t):
    """Size of the images that LCDImage and the like show, a resolution such as QVGA. Returns 0, 1 for another number."""
    global _shown_width, _shown_height
    result = _call(_LCDImageSize, t)[-1]
    if result == 0:
        _shown_width, _shown_height = _SIZES.get(t, (CAMWIDTH, CAMHEIGHT))
    return result


def LCDImageStart(x, y, xs, ys):
    """Place and size in pixels of the images that LCDImage and the like show. Returns 0, 1 for a size below 1."""
    global _shown_width, _shown_height
    result = _call(_LCDImageStart, x, y, xs, ys)[-1]
    if result == 0:
        _shown_width, _shown_height = int(xs), int(ys)
    return result


def LCDImage(img):
    """Shows a colour image, 3 bytes a pixel, of the size that LCDImageStart or LCDImageSize has set. Returns 0."""
    return _call(_LCDImage, _shown_width, _shown_height, img)[-1]


def LCDImageGray(g):
    """Shows a grey image, 1 byte a pixel. Returns 0."""
    return _call(_LCDImageGray, _shown_width, _shown_height, g)[-1]


def LCDImageBinary(b):
    """Shows a binary image, 1 byte a pixel: 0 is white, everything else black. Returns 0."""
    return _call(_LCDImageBinary, _shown_width, _shown_height, b)[-1]


class Image(bytearray):
    """A flat image: one byte a pixel, or three."""

    width = height = 0

    def array(self):
        """The image as an array of numpy with rows and columns, which shares its bytes."""
        import numpy

        shape = (self.height, self.width) if len(self) == self.width * self.height else (self.height, self.width, 3)
        return numpy.frombuffer(self, numpy.uint8).reshape(shape)


def _image(data, size, width, height):
    image = Image(bytes(data).ljust(size, b"\0"))
    image.width, image.height = width, height
    return image


def _grey(data):
    return _image(data, IP_PIXELS, IP_WIDTH, IP_HEIGHT)


def _colour(data):
    return _image(data, IP_SIZE, IP_WIDTH, IP_HEIGHT)


def _set_ip_size(width, height):
    global IP_WIDTH, IP_HEIGHT, IP_PIXELS, IP_SIZE
    IP_WIDTH, IP_HEIGHT, IP_PIXELS, IP_SIZE = width, height, width * height, 3 * width * height


def CAMInit(resolution, width=None, height=None):
    """Switches the camera on, with a resolution such as QVGA; CUSTOM with width and height. Returns 0, 1 if there is no
    camera."""
    global CAMWIDTH, CAMHEIGHT, CAMPIXELS, CAMSIZE, CAMMODE, _shown_width, _shown_height
    size = (int(width), int(height)) if resolution == CUSTOM and width and height else _SIZES.get(resolution)
    if size is not None:
        CAMWIDTH, CAMHEIGHT = size
        CAMPIXELS, CAMSIZE, CAMMODE = CAMWIDTH * CAMHEIGHT, 3 * CAMWIDTH * CAMHEIGHT, resolution
        _set_ip_size(CAMWIDTH, CAMHEIGHT)
        _shown_width, _shown_height = CAMWIDTH, CAMHEIGHT
    return _call(_CAMInit, resolution, CAMWIDTH, CAMHEIGHT)[-1]


def CAMGet():
    """A colour image of CAMSIZE bytes, row 0 on top; black if there is no camera."""
    return _image(_call(_CAMGet, CAMSIZE)[0], CAMSIZE, CAMWIDTH, CAMHEIGHT)


def CAMGetGray():
    """A grey image of CAMPIXELS bytes; black if there is no camera."""
    return _image(_call(_CAMGetGray, CAMPIXELS)[0], CAMPIXELS, CAMWIDTH, CAMHEIGHT)


class _Numbers(_array.array):
    """A flat image of numbers, one a pixel, row 0 on top."""

    width = height = 0

    def array(self):
        """The image as an array of numpy with rows and columns, which shares its numbers."""
        import numpy

        return numpy.frombuffer(self, self.typecode).reshape(self.height, self.width)


def _numbers(typecode, values):
    numbers = _Numbers(typecode, values)
    numbers.width, numbers.height = CAMWIDTH, CAMHEIGHT
    return numbers


def CAMGetDepth():
    """How far away what each pixel of the last image shows is: along the line of sight, in mm, infinite for the sky. An
    array of CAMPIXELS numbers, row 0 on top; None if no image has been taken."""
    values, result = _call(_CAMGetDepth, CAMPIXELS)
    return _numbers("f", values) if result == 0 else None


def CAMGetLabels():
    """What each pixel of the last image shows: CAM_SKY, CAM_FLOOR, CAM_WALL, or CAM_BODY + n for robot or object n. An array
    of CAMPIXELS numbers, row 0 on top; None if no image has been taken."""
    values, result = _call(_CAMGetLabels, CAMPIXELS)
    return _numbers("i", values) if result == 0 else None


def LEGGetJoint(leg, joint):
    """The angle of a joint, now, in degrees; both from 1. None if there is no such leg or joint."""
    degrees, result = _call(_LEGGetJoint, leg, joint, None)
    return degrees if result == 0 else None


def LEGGetLink(leg, link):
    """Where a link of a leg is, now, in the frame of the body: [x, y, z, roll, pitch, yaw] in mm and degrees; leg and link
    from 1. None if there is no such leg or link."""
    pose, result = _call(_LEGGetLink, leg, link, 6)
    return pose if result == 0 else None


def LEGGetHeight():
    """How high the body's frame is above the world's floor, now, in mm. None if there are no legs."""
    mm, result = _call(_LEGGetHeight, None)
    return mm if result == 0 else None


def IPSetSize(resolution, width=None, height=None):
    """Sets the size of the images of all IP functions; CUSTOM with width and height. Returns 0, 1 for another number."""
    size = (width, height) if resolution == CUSTOM and width and height else _SIZES.get(resolution)
    result = _call(_IPSetSize, resolution)[-1]
    if size is None:
        return 1
    _set_ip_size(*size)
    return result


def IPReadFile(filename):
    """Reads a PNM file: a grey or a colour image of the size that IPSetSize has set; None if it cannot be read."""
    data, result = _call(_IPReadFile, filename, IP_WIDTH, IP_HEIGHT, IP_SIZE)
    return None if result <= 0 else _grey(data) if len(data) == IP_PIXELS else _colour(data)


def IPWriteFile(filename, img):
    """Writes a colour image as PPM. Returns 0, 1 if it cannot be written."""
    return _call(_IPWriteFile, filename, IP_WIDTH, IP_HEIGHT, img)[-1]


def IPWriteFileGray(filename, gray):
    """Writes a grey image as PGM. Returns 0, 1 if it cannot be written."""
    return _call(_IPWriteFileGray, filename, IP_WIDTH, IP_HEIGHT, gray)[-1]


def IPLaplace(gray):
    """Laplace edges of a grey image."""
    return _grey(_call(_IPLaplace, IP_WIDTH, IP_HEIGHT, gray, IP_PIXELS)[0])


def IPSobel(gray):
    """Sobel edges of a grey image."""
    return _grey(_call(_IPSobel, IP_WIDTH, IP_HEIGHT, gray, IP_PIXELS)[0])


def IPCol2Gray(img):
    """Grey of a colour image."""
    return _grey(_call(_IPCol2Gray, img, IP_PIXELS)[0])


def IPGray2Col(gray):
    """A colour image that looks like a grey one."""
    return _colour(_call(_IPGray2Col, gray, IP_SIZE)[0])


def IPRGB2Col(r, g, b):
    """A colour image of its three channels."""
    return _colour(_call(_IPRGB2Col, r, g, b, IP_SIZE)[0])


def IPCol2HSI(img):
    """Hue, saturation and intensity of a colour image, a channel each."""
    return tuple(_grey(data) for data in _call(_IPCol2HSI, img, IP_PIXELS, IP_PIXELS, IP_PIXELS)[:3])


def IPOverlay(c1, c2):
    """The second colour image over the first, where it is not black."""
    return _colour(_call(_IPOverlay, c1, c2, IP_SIZE)[0])


def IPOverlayGray(g1, g2, col):
    """The second grey image over the first, in a colour, where it is not 0."""
    return _colour(_call(_IPOverlayGray, g1, g2, col, IP_SIZE)[0])


def _text(data):
    return bytes(data).split(b"\0")[0].decode("utf-8", "replace")


def OSExecute(command):
    """Runs a command of the machine that simulates, where that is allowed; its output."""
    return _text(_call(_OSExecute, command, 4096)[0])


def OSVersion():
    """Version of RoBIOS."""
    return _text(_call(_OSVersion, 32)[0])


def OSVersionIO():
    """Version of the input and output board."""
    return _text(_call(_OSVersionIO, 32)[0])


def OSMachineName():
    """Name of the robot."""
    return _text(_call(_OSMachineName, 32)[0])


def SERReceive(interface):
    """What has come in, as bytes, at most 255. Does not wait."""
    data, length = _call(_SERReceive, interface, 256)
    return bytes(data[:length])


def AURecord(time_ms, freq_hz):
    """Records the microphone: a value of 0 to 255 for each sample."""
    return _call(_AURecord, max(0, int(time_ms) * int(freq_hz) // 1000), freq_hz)[0]


def LIDARGet():
    """Distances in millimetres from left to right, the middle one (of n, that of index n/2) straight ahead; 9999 for
    nothing. A list, empty if there is no scanner."""
    return _call(_LIDARGet, 65536)[0]


def ANALOGTransfer():
    """The recording of ANALOGRecord; empty while it goes on."""
    data, length = _call(_ANALOGTransfer, 1 << 20)
    return data[:length]


def RADIOReceive(size=1024):
    """Waits for a message: address of its sender, and text; 0 and no text if the radio is off. Bytes that are no UTF-8, as damaged
    ones may be, show as the replacement character."""
    sender, data, _result = _call(_RADIOReceive, None, size)
    return sender, _text(data)


def RADIOStatus():
    """Addresses of the robots whose radios are on, the own one included; none if that is off."""
    return _call(_RADIOStatus, 256)[0]


def SIMGetPose():
    """True pose of this robot: mm, mm, degrees."""
    x, y, _z, phi = SIMGetRobot(0)
    return x, y, phi


def SIMSetPose(x, y, phi):
    """Puts this robot at a pose."""
    return SIMSetRobot(0, x, y, 0, phi)


SIMLaserScan = LIDARGet
MOTORPIDoff = MOTORPIDOff
VWDriveRemain, VWDriveDone, VWDriveWait = VWRemain, VWDone, VWWait

__all__ = [_name for _name in dir() if not _name.startswith("_") and _name != "annotations"]

# ---- the program's run ----

_STDOUT, _STDERR = 1, 2
_FAILED_WITH_ERROR = 5


class _Console:
    """A stream of the program: whole lines go to the simulator."""

    encoding, errors, closed, newlines = "utf-8", "replace", False, None

    def __init__(self, stream):
        self.stream, self.line = stream, ""

    def write(self, text):
        if not isinstance(text, str):
            raise TypeError(f"write() argument must be str, not {type(text).__name__}")
        self.line += text
        end = self.line.rfind("\n") + 1
        lines, self.line = self.line[:end], self.line[end:]
        if lines:
            self._send(lines)
        return len(text)

    def writelines(self, lines):
        for line in lines:
            self.write(line)

    def flush(self):
        line, self.line = self.line, ""
        if line:
            self._send(line)

    def _send(self, text):
        if _channel is None:
            return
        try:
            _call(_support_console, self.stream, text)
        except _Stop:
            pass  # the next call of RoBIOS leaves the program

    def isatty(self):
        return False

    def fileno(self):
        raise OSError("the robot's console is no file")

    def readable(self):
        return False

    def writable(self):
        return True

    def seekable(self):
        return False


def _now_us():
    return _call(_support_time_us)[0]


def _replace_surroundings():
    """Puts virtual time and the robot's random stream where Python has those of the machine."""

    def urandom(size):
        words = (_call(_support_random, 4)[0] for _ in range((size + 7) // 8))
        return b"".join(_struct.pack("<Q", word) for word in words)[:size]

    def sleep(seconds):
        if seconds < 0:
            raise ValueError("sleep length must be non-negative")
        _call(_support_sleep_us, min(int(seconds * 1e6), 1 << 62))

    _os.urandom = _random._urandom = urandom
    _random.seed(_call(_support_random, 1)[0])
    _time.sleep = sleep
    for name in ("time", "monotonic", "perf_counter", "process_time", "thread_time"):
        setattr(_time, name, lambda: _now_us() / 1e6)
        setattr(_time, name + "_ns", lambda: _now_us() * 1000)


def _tell_place(_signal_number, frame):
    """The program has used up its processor time: tells where it is."""
    if _channel is None or _channel.turn.value == 1:
        return
    while frame is not None and frame.f_globals is globals():
        frame = frame.f_back
    place = "" if frame is None else f"{_os.path.basename(frame.f_code.co_filename)}:{frame.f_lineno}"
    text = place.encode("utf-8", "replace")
    body = _struct.pack("<iIQQQQ", _signal.SIGURG, len(text), 0, 0, 0, 0) + text
    _channel.send(_FAULT, body)
    _os._exit(1)


def _die_with_host(channel):
    host = _struct.unpack_from("<I", channel.memory, 28)[0]
    channel.libc.prctl(1, _signal.SIGKILL)
    if _os.getppid() != host:
        _os._exit(1)


def _tell_error(path):
    """Prints the traceback of the program's own frames, and tells the simulator what the program failed with."""
    import traceback

    kind, error, trace = _sys.exc_info()
    while trace is not None and trace.tb_frame.f_globals is globals():
        trace = trace.tb_next
    text = "".join(traceback.format_exception(kind, error, trace))
    _sys.stderr.write(text if text.endswith("\n") else text + "\n")
    said = traceback.format_exception_only(kind, error)[-1].strip()
    frames = [frame for frame in traceback.extract_tb(trace) if frame.filename != __file__]
    own = [frame for frame in frames if _os.path.dirname(_os.path.abspath(frame.filename)) == _os.path.dirname(path)]
    if isinstance(error, SyntaxError) and error.filename:
        said += f" at {_os.path.basename(error.filename)}:{error.lineno}"
    elif own or frames:
        frame = (own or frames)[-1]
        said += f" at {_os.path.basename(frame.filename)}:{frame.lineno}"
    try:
        _call(_support_failed, _FAILED_WITH_ERROR, said)
    except _Stop:
        pass


def _run(path):
    """Runs the program as `__main__`; its exit code."""
    import atexit
    import types

    program = types.ModuleType("__main__")
    program.__file__ = path
    program.__builtins__ = __builtins__
    _sys.modules["__main__"] = program
    exit_code = 0
    try:
        with open(path, "rb") as file:
            code = compile(file.read(), path, "exec")
        exec(code, program.__dict__)
    except _Stop:
        pass
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            exit_code = (end.code or 0) & 0xFF
        else:
            print(end.code, file=_sys.stderr)
            exit_code = 1
    except BaseException:
        if not _is_stopped:
            _tell_error(path)
        exit_code = 1
    try:
        atexit._run_exitfuncs()
        _sys.stdout.flush()
        _sys.stderr.flush()
    except BaseException:
        pass  # nobody is left to tell
    return exit_code


def _main(path):
    global _channel
    _sys.modules["eye"] = _sys.modules["__main__"]
    channel = _Channel()
    null = _os.open("/dev/null", _os.O_RDWR)
    _os.dup2(null, 0)
    _os.close(null)
    _die_with_host(channel)
    _sys.stdin = open(_os.devnull)
    _sys.stdout, _sys.stderr = _Console(_STDOUT), _Console(_STDERR)
    _signal.signal(_signal.SIGURG, _tell_place)
    path = _os.path.abspath(path)
    _sys.path[0] = _os.path.dirname(path)
    channel.send(_READY, _struct.pack("<Q", 0))
    kind, body = channel.receive()
    if kind != _RUN:
        _os._exit(0)
    (count,) = _struct.unpack_from("<I", body, 0)
    at, arguments = 4, []
    for _ in range(count):
        (length,) = _struct.unpack_from("<I", body, at)
        arguments.append(body[at + 4 : at + 4 + length].decode("utf-8", "surrogateescape"))
        at += 4 + length
    _sys.argv = arguments
    _channel = channel
    exit_code = 0
    try:
        _replace_surroundings()
        exit_code = _run(path)
    except _Stop:
        pass
    channel.send(_EXITED, _struct.pack("<i", exit_code))
    _os._exit(0)


if __name__ == "__main__":
    _main(_sys.argv[1])
