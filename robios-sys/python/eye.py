"""RoBIOS-7 for robot programs in Python: `from eye import *`.

`eyesim run` runs a program with this module, whatever `eye.py` lies beside it; a copy beside the program is for editors.
Functions, constants and units are those of C (millimetres, degrees, milliseconds). What C writes through pointers is
returned: `x, y, phi = VWGetPosition()`. Images are flat `bytearray`s, three bytes a pixel in colour; wherever an image
goes in, anything with a buffer does, such as an array of numpy, and `numpy.asarray(image)` has rows and columns.

Time is the robot's virtual time in `time.time`, `time.monotonic`, `time.perf_counter` and `time.sleep`; `random` and
`os.urandom` draw from the robot's own stream. Generated: cargo run -p robios-sys --bin generate
"""

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

QQVGA = 0
QVGA = 1
VGA = 2
CAM1MP = 3
CAMHD = 4
CAM5MP = 5
CUSTOM = 10
RED = 0xFF0000
GREEN = 65280
BLUE = 255
WHITE = 0xFFFFFF
GRAY = 0x808080
BLACK = 0
SILVER = 0xC0C0C0
LIGHTGRAY = 0xD3D3D3
DARKGRAY = 0xA9A9A9
NAVY = 128
CYAN = 61166
TEAL = 32896
MAGENTA = 0xFF00FF
PURPLE = 0x800080
MAROON = 0x800000
YELLOW = 0xFFFF00
OLIVE = 0x9ACD32
ORANGE = 0xFFA500
NOKEY = 0
KEY1 = 1
KEY2 = 2
KEY3 = 4
KEY4 = 8
ANYKEY = -1
KEY_INVALID = -1
KEY_LIST1 = 16
KEY_LIST2 = 32
KEY_LIST3 = 64
KEY_LIST4 = 128
KEY_LIST5 = 256
KEY_LIST6 = 512
KEY_LIST7 = 1024
KEY_LIST8 = 2048
KEY_LISTDN = 0x10000000
KEY_LISTUP = 0x20000000
KEY_LISTTL = 0x40000000
KEY_ESCAPE = -2147483648
KEYTM_UNKNOWN = 0
KEYTM_CLASSIC = 1
KEYTM_STANDARD = 2
KEYTM_REGIONS = 3
KEYTM_LISTMENU = 4
HELVETICA = 0
TIMES = 1
COURIER = 2
NORMAL = 0
BOLD = 1
ITALICS = 2
LCD_BGCOL_TRANSPARENT = 1
LCD_BGCOL_NOTRANSPARENT = 4096
LCD_BGCOL_INVERSE = 2
LCD_BGCOL_NOINVERSE = 8192
LCD_FGCOL_INVERSE = 4
LCD_FGCOL_NOINVERSE = 16384
LCD_AUTOREFRESH = 8
LCD_NOAUTOREFRESH = 32768
LCD_SCROLLING = 16
LCD_NOSCROLLING = 0x010000
LCD_LINEFEED = 32
LCD_NOLINEFEED = 0x020000
LCD_SHOWMENU = 64
LCD_HIDEMENU = 0x040000
LCD_LISTMENU = 128
LCD_CLASSICMENU = 0x080000
LCD_FB_ROTATE = 256
LCD_FB_NOROTATION = 0x100000
VEHICLE = 1
PLATFORM = 2
WALKER = 3
PSD_FRONT = 1
PSD_LEFT = 2
PSD_RIGHT = 3
PSD_BACK = 4
IRTV_0 = 48
IRTV_1 = 49
IRTV_2 = 50
IRTV_3 = 51
IRTV_4 = 52
IRTV_5 = 53
IRTV_6 = 54
IRTV_7 = 55
IRTV_8 = 56
IRTV_9 = 57
IRTV_RED = 82
IRTV_GREEN = 71
IRTV_YELLOW = 89
IRTV_BLUE = 66
IRTV_LEFT = 76
IRTV_RIGHT = 62
IRTV_UP = 85
IRTV_DOWN = 68
IRTV_OK = 79
IRTV_POWER = 80

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
        elif kind in "IrR":
            body.append(_struct.pack("<I", value))
        elif kind in "qQ":
            body.append(_struct.pack("<" + kind, value))
        elif kind in "oO":
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
        if kind in "oO":
            (is_set,) = _struct.unpack_from("<B", answer, at)
            at += 1
            if is_set:
                written.append(_struct.unpack_from("<i" if kind == "o" else "<B", answer, at)[0])
                at += 4 if kind == "o" else 1
            else:
                written.append(0)
        elif kind == "r":
            (length,) = _struct.unpack_from("<I", answer, at)
            written.append(bytearray(answer[at + 4 : at + 4 + length]))
            at += 4 + length
        elif kind == "R":
            (count,) = _struct.unpack_from("<I", answer, at)
            written.append(list(_struct.unpack_from(f"<{count}i", answer, at + 4)))
            at += 4 + 4 * count
    if result:
        written.append(_struct.unpack_from("<" + result, answer, at)[0])
    return written


# Name, number of the list, number in it, kinds of the parameters, kind of the result.
_support_console = ("console", 0, 0, "ib", "i")
_support_random = ("random", 0, 1, "I", "Q")
_support_seed = ("seed", 0, 2, "IQ", "i")
_support_time_us = ("time_us", 0, 3, "", "q")
_support_sleep_us = ("sleep_us", 0, 4, "q", "i")
_support_failed = ("failed", 0, 5, "it", "i")
_support_program_name = ("program_name", 0, 6, "r", "i")
_support_task_self = ("task_self", 0, 7, "", "i")
_support_task_spawn = ("task_spawn", 0, 8, "k", "i")
_support_task_wait = ("task_wait", 0, 9, "Qiiq", "i")
_support_task_wake = ("task_wake", 0, 10, "Q", "i")
_support_task_wake_all = ("task_wake_all", 0, 11, "Q", "i")
_support_task_interrupt = ("task_interrupt", 0, 12, "i", "i")
_support_task_yield = ("task_yield", 0, 13, "", "i")
_support_task_turn = ("task_turn", 0, 14, "", "i")
_LCDPrintf = ("LCDPrintf", 7, 0, "t", "i")
_LCDSetPrintf = ("LCDSetPrintf", 7, 1, "iit", "i")
_LCDClear = ("LCDClear", 7, 2, "", "i")
_LCDSetPos = ("LCDSetPos", 7, 3, "ii", "i")
_LCDGetPos = ("LCDGetPos", 7, 4, "oo", "i")
_LCDSetColor = ("LCDSetColor", 7, 5, "ii", "i")
_LCDSetFont = ("LCDSetFont", 7, 6, "ii", "i")
_LCDSetFontSize = ("LCDSetFontSize", 7, 7, "i", "i")
_LCDSetMode = ("LCDSetMode", 7, 8, "i", "i")
_LCDMenu = ("LCDMenu", 7, 9, "tttt", "i")
_LCDMenuI = ("LCDMenuI", 7, 10, "itii", "i")
_LCDListLine = ("LCDListLine", 7, 11, "iitii", "i")
_LCDGetSize = ("LCDGetSize", 7, 12, "oo", "i")
_LCDPixel = ("LCDPixel", 7, 13, "iii", "i")
_LCDGetPixel = ("LCDGetPixel", 7, 14, "ii", "i")
_LCDLine = ("LCDLine", 7, 15, "iiiii", "i")
_LCDArea = ("LCDArea", 7, 16, "iiiiii", "i")
_LCDCircle = ("LCDCircle", 7, 17, "iiiii", "i")
_LCDPixelInvert = ("LCDPixelInvert", 7, 18, "ii", "i")
_LCDLineInvert = ("LCDLineInvert", 7, 19, "iiii", "i")
_LCDAreaInvert = ("LCDAreaInvert", 7, 20, "iiii", "i")
_LCDCircleInvert = ("LCDCircleInvert", 7, 21, "iii", "i")
_LCDImageSize = ("LCDImageSize", 7, 22, "i", "i")
_LCDImageStart = ("LCDImageStart", 7, 23, "iiii", "i")
_LCDImage = ("LCDImage", 7, 24, "iib", "i")
_LCDImageGray = ("LCDImageGray", 7, 25, "iib", "i")
_LCDImageBinary = ("LCDImageBinary", 7, 26, "iib", "i")
_LCDRefresh = ("LCDRefresh", 7, 27, "", "i")
_KEYGet = ("KEYGet", 7, 28, "", "i")
_KEYRead = ("KEYRead", 7, 29, "", "i")
_KEYWait = ("KEYWait", 7, 30, "i", "i")
_KEYGetXY = ("KEYGetXY", 7, 31, "oo", "i")
_KEYReadXY = ("KEYReadXY", 7, 32, "oo", "i")
_CAMInit = ("CAMInit", 7, 33, "iii", "i")
_CAMRelease = ("CAMRelease", 7, 34, "", "i")
_CAMGet = ("CAMGet", 7, 35, "r", "i")
_CAMGetGray = ("CAMGetGray", 7, 36, "r", "i")
_IPSetSize = ("IPSetSize", 7, 37, "i", "i")
_IPReadFile = ("IPReadFile", 7, 38, "tiir", "i")
_IPWriteFile = ("IPWriteFile", 7, 39, "tiib", "i")
_IPWriteFileGray = ("IPWriteFileGray", 7, 40, "tiib", "i")
_IPLaplace = ("IPLaplace", 7, 41, "iibr", "")
_IPSobel = ("IPSobel", 7, 42, "iibr", "")
_IPCol2Gray = ("IPCol2Gray", 7, 43, "br", "")
_IPGray2Col = ("IPGray2Col", 7, 44, "br", "")
_IPRGB2Col = ("IPRGB2Col", 7, 45, "bbbr", "")
_IPCol2HSI = ("IPCol2HSI", 7, 46, "brrr", "")
_IPOverlay = ("IPOverlay", 7, 47, "bbr", "")
_IPOverlayGray = ("IPOverlayGray", 7, 48, "bbir", "")
_IPPRGB2Col = ("IPPRGB2Col", 7, 49, "BBB", "i")
_IPPCol2RGB = ("IPPCol2RGB", 7, 50, "iOOO", "")
_IPPCol2HSI = ("IPPCol2HSI", 7, 51, "iOOO", "")
_IPPRGB2Hue = ("IPPRGB2Hue", 7, 52, "BBB", "B")
_IPPRGB2HSI = ("IPPRGB2HSI", 7, 53, "BBBOOO", "")
_OSExecute = ("OSExecute", 7, 54, "tr", "i")
_OSVersion = ("OSVersion", 7, 55, "r", "i")
_OSVersionIO = ("OSVersionIO", 7, 56, "r", "i")
_OSMachineSpeed = ("OSMachineSpeed", 7, 57, "", "i")
_OSMachineType = ("OSMachineType", 7, 58, "", "i")
_OSMachineName = ("OSMachineName", 7, 59, "r", "i")
_OSMachineID = ("OSMachineID", 7, 60, "", "i")
_OSError = ("OSError", 7, 61, "tii", "i")
_OSWait = ("OSWait", 7, 62, "i", "i")
_OSAttachTimer = ("OSAttachTimer", 7, 63, "ik", "i")
_OSDetachTimer = ("OSDetachTimer", 7, 64, "i", "i")
_OSSetTime = ("OSSetTime", 7, 65, "iii", "i")
_OSGetTime = ("OSGetTime", 7, 66, "oooo", "i")
_OSShowTime = ("OSShowTime", 7, 67, "", "i")
_OSGetCount = ("OSGetCount", 7, 68, "", "i")
_SERInit = ("SERInit", 7, 69, "iii", "i")
_SERSendChar = ("SERSendChar", 7, 70, "iB", "i")
_SERSend = ("SERSend", 7, 71, "ib", "i")
_SERReceiveChar = ("SERReceiveChar", 7, 72, "i", "B")
_SERReceive = ("SERReceive", 7, 73, "ir", "i")
_SERCheck = ("SERCheck", 7, 74, "i", "B")
_SERFlush = ("SERFlush", 7, 75, "i", "i")
_SERClose = ("SERClose", 7, 76, "i", "i")
_AUBeep = ("AUBeep", 7, 77, "", "i")
_AUPlay = ("AUPlay", 7, 78, "b", "i")
_AUDone = ("AUDone", 7, 79, "", "i")
_AUMicrophone = ("AUMicrophone", 7, 80, "", "i")
_AUTone = ("AUTone", 7, 81, "ii", "i")
_AUCheckTone = ("AUCheckTone", 7, 82, "", "i")
_AUCheckPlay = ("AUCheckPlay", 7, 83, "", "i")
_AURecord = ("AURecord", 7, 84, "rq", "i")
_AUCheckRecord = ("AUCheckRecord", 7, 85, "", "i")
_PSDGet = ("PSDGet", 7, 86, "i", "i")
_PSDGetRaw = ("PSDGetRaw", 7, 87, "i", "i")
_LIDARGet = ("LIDARGet", 7, 88, "R", "i")
_LIDARSet = ("LIDARSet", 7, 89, "iii", "")
_SERVOSet = ("SERVOSet", 7, 90, "ii", "i")
_SERVOSetRaw = ("SERVOSetRaw", 7, 91, "ii", "i")
_SERVORange = ("SERVORange", 7, 92, "iii", "i")
_MOTORDrive = ("MOTORDrive", 7, 93, "ii", "i")
_MOTORDriveRaw = ("MOTORDriveRaw", 7, 94, "ii", "i")
_MOTORPID = ("MOTORPID", 7, 95, "iiii", "i")
_MOTORPIDOff = ("MOTORPIDOff", 7, 96, "i", "i")
_MOTORSpeed = ("MOTORSpeed", 7, 97, "ii", "i")
_ENCODERRead = ("ENCODERRead", 7, 98, "i", "i")
_ENCODERReset = ("ENCODERReset", 7, 99, "i", "i")
_VWSetSpeed = ("VWSetSpeed", 7, 100, "ii", "i")
_VWGetSpeed = ("VWGetSpeed", 7, 101, "oo", "i")
_VWSetPosition = ("VWSetPosition", 7, 102, "iii", "i")
_VWGetPosition = ("VWGetPosition", 7, 103, "ooo", "i")
_VWStraight = ("VWStraight", 7, 104, "ii", "i")
_VWTurn = ("VWTurn", 7, 105, "ii", "i")
_VWCurve = ("VWCurve", 7, 106, "iii", "i")
_VWDrive = ("VWDrive", 7, 107, "iii", "i")
_VWRemain = ("VWRemain", 7, 108, "", "i")
_VWDone = ("VWDone", 7, 109, "", "i")
_VWWait = ("VWWait", 7, 110, "", "i")
_VWStalled = ("VWStalled", 7, 111, "", "i")
_VWControl = ("VWControl", 7, 112, "iiii", "i")
_VWControlOff = ("VWControlOff", 7, 113, "", "i")
_DIGITALSetup = ("DIGITALSetup", 7, 114, "iB", "i")
_DIGITALRead = ("DIGITALRead", 7, 115, "i", "i")
_DIGITALReadAll = ("DIGITALReadAll", 7, 116, "", "i")
_DIGITALWrite = ("DIGITALWrite", 7, 117, "ii", "i")
_ANALOGRead = ("ANALOGRead", 7, 118, "i", "i")
_ANALOGVoltage = ("ANALOGVoltage", 7, 119, "", "i")
_ANALOGRecord = ("ANALOGRecord", 7, 120, "ii", "i")
_ANALOGTransfer = ("ANALOGTransfer", 7, 121, "r", "i")
_IRTVGet = ("IRTVGet", 7, 122, "", "i")
_IRTVRead = ("IRTVRead", 7, 123, "", "i")
_IRTVFlush = ("IRTVFlush", 7, 124, "", "i")
_IRTVGetStatus = ("IRTVGetStatus", 7, 125, "", "i")
_RADIOInit = ("RADIOInit", 7, 126, "", "i")
_RADIOGetID = ("RADIOGetID", 7, 127, "", "i")
_RADIOSend = ("RADIOSend", 7, 128, "it", "i")
_RADIOReceive = ("RADIOReceive", 7, 129, "or", "i")
_RADIOCheck = ("RADIOCheck", 7, 130, "", "i")
_RADIOStatus = ("RADIOStatus", 7, 131, "R", "i")
_RADIORelease = ("RADIORelease", 7, 132, "", "i")
_SIMGetRobot = ("SIMGetRobot", 7, 133, "ioooo", "")
_SIMSetRobot = ("SIMSetRobot", 7, 134, "iiiii", "")
_SIMGetObject = ("SIMGetObject", 7, 135, "ioooo", "")
_SIMSetObject = ("SIMSetObject", 7, 136, "iiiii", "")
_SIMGetRobotCount = ("SIMGetRobotCount", 7, 137, "", "i")
_SIMGetObjectCount = ("SIMGetObjectCount", 7, 138, "", "i")

# ---- functions ----

def LCDClear():
    """Makes the display black; the cursor goes to row 0, column 0; the menu stays. Returns 0."""
    return _call(_LCDClear)[0]


def LCDSetPos(row, column):
    """Moves the cursor. Returns 0."""
    return _call(_LCDSetPos, row, column)[0]


def LCDGetPos():
    """Where the cursor is."""
    return tuple(_call(_LCDGetPos, None, None)[:2])


def LCDSetColor(fg, bg):
    """Colours of text from now on. Returns 0."""
    return _call(_LCDSetColor, fg, bg)[0]


def LCDSetFont(font, variation):
    """Font of text from now on: HELVETICA, TIMES or COURIER; NORMAL, BOLD or ITALICS. Returns 0, 1 for others."""
    return _call(_LCDSetFont, font, variation)[0]


def LCDSetFontSize(fontsize):
    """Size of text from now on: 8, 12, 14, 18 or 24. Returns 0, 1 for others."""
    return _call(_LCDSetFontSize, fontsize)[0]


def LCDSetMode(mode):
    """Modes, LCD_SCROLLING and the like, or-ed. Returns 0."""
    return _call(_LCDSetMode, mode)[0]


def LCDMenu(st1, st2, st3, st4):
    """Names the four keys under the display; an empty text clears a name. Returns 0."""
    return _call(_LCDMenu, st1, st2, st3, st4)[0]


def LCDMenuI(pos, string, fg, bg):
    """Names one key, 1 to 4, with colours of its own. Returns 0, 1 if there is no such key."""
    return _call(_LCDMenuI, pos, string, fg, bg)[0]


def LCDListLine(line, key, text, fg, bg):
    """Sets a line of a list menu, from 0, which is a key, such as KEY_LIST1, when touched, and shows the list; null ends the
    list before that line. LCDList stands on it; not of RoBIOS. Returns how many lines there is room for, 0 if there is
    no such line."""
    return _call(_LCDListLine, line, key, text, fg, bg)[0]


def LCDGetSize():
    """Size of the display in pixels."""
    return tuple(_call(_LCDGetSize, None, None)[:2])


def LCDPixel(x, y, col):
    """Draws one pixel; x to the right, y down, from the upper left corner. Returns 0, here and in all that draw: what lies
    outside of the display is left out."""
    return _call(_LCDPixel, x, y, col)[0]


def LCDGetPixel(x, y):
    """Colour of one pixel; 0 outside of the display."""
    return _call(_LCDGetPixel, x, y)[0]


def LCDLine(x1, y1, x2, y2, col):
    """Draws a line with both ends. Returns 0."""
    return _call(_LCDLine, x1, y1, x2, y2, col)[0]


def LCDArea(x1, y1, x2, y2, col, fill):
    """Draws a rectangle between two corners; fill: if not 0, filled. Returns 0."""
    return _call(_LCDArea, x1, y1, x2, y2, col, fill)[0]


def LCDCircle(x1, y1, size, col, fill):
    """Draws a circle; size: its radius in pixels. Returns 0."""
    return _call(_LCDCircle, x1, y1, size, col, fill)[0]


def LCDPixelInvert(x, y):
    """Inverts one pixel. Returns 0."""
    return _call(_LCDPixelInvert, x, y)[0]


def LCDLineInvert(x1, y1, x2, y2):
    """Inverts the pixels of a line. Returns 0."""
    return _call(_LCDLineInvert, x1, y1, x2, y2)[0]


def LCDAreaInvert(x1, y1, x2, y2):
    """Inverts a filled rectangle. Returns 0."""
    return _call(_LCDAreaInvert, x1, y1, x2, y2)[0]


def LCDCircleInvert(x1, y1, size):
    """Inverts a filled circle. Returns 0."""
    return _call(_LCDCircleInvert, x1, y1, size)[0]


def LCDRefresh():
    """Shows what has been drawn, where LCD_NOAUTOREFRESH is set. Returns 0."""
    return _call(_LCDRefresh)[0]


def KEYGet():
    """Waits for a key. Returns KEY1, KEY2, KEY3 or KEY4."""
    return _call(_KEYGet)[0]


def KEYRead():
    """The key that was pressed; NOKEY if none was. Does not wait."""
    return _call(_KEYRead)[0]


def KEYWait(key):
    """Waits for one key, or with ANYKEY for whichever. Returns the key, KEY_INVALID if there is no such key."""
    return _call(_KEYWait, key)[0]


def KEYGetXY():
    """Waits for a touch of the display, and tells its place in pixels."""
    return tuple(_call(_KEYGetXY, None, None)[:2])


def CAMRelease():
    """Switches the camera off. Returns 0, 1 if there is no camera."""
    return _call(_CAMRelease)[0]


def IPPRGB2Col(r, g, b):
    """The colour of red, green and blue."""
    return _call(_IPPRGB2Col, r, g, b)[0]


def IPPCol2RGB(col):
    """Red, green and blue of a colour."""
    return tuple(_call(_IPPCol2RGB, col, None, None, None)[:3])


def IPPCol2HSI(c):
    """Hue, saturation and intensity of a colour."""
    return tuple(_call(_IPPCol2HSI, c, None, None, None)[:3])


def IPPRGB2Hue(r, g, b):
    """Hue of red, green and blue; 0 for grey."""
    return _call(_IPPRGB2Hue, r, g, b)[0]


def IPPRGB2HSI(r, g, b):
    """Hue, saturation and intensity of red, green and blue."""
    return tuple(_call(_IPPRGB2HSI, r, g, b, None, None, None)[:3])


def OSMachineSpeed():
    """Clock rate of the processor in Hz."""
    return _call(_OSMachineSpeed)[0]


def OSMachineType():
    """The kind of machine: VEHICLE, PLATFORM or WALKER."""
    return _call(_OSMachineType)[0]


def OSMachineID():
    """The robot's number, unique in the scene; also its address on the radio."""
    return _call(_OSMachineID)[0]


def OSError(message, number, dead):
    """Shows an error: text and number, on the display and in the record of the run.
    dead: if not 0, the robot stops here for ever; else the program waits for a key and goes on. Returns 0."""
    return _call(_OSError, message, number, dead)[0]


def OSWait(n):
    """Waits n milliseconds. Returns 0."""
    return _call(_OSWait, n)[0]


def OSAttachTimer(scale, fct):
    """Calls a function every `scale` milliseconds. It may not wait. Returns the timer, 0 if there is no room for it."""
    return _call(_OSAttachTimer, scale, fct)[0]


def OSDetachTimer(t):
    """Ends a timer. Returns 0, 1 if there is none of that number."""
    return _call(_OSDetachTimer, t)[0]


def OSSetTime(hrs, mins, secs):
    """Sets the robot's clock. Returns 0, 1 for no time of a day."""
    return _call(_OSSetTime, hrs, mins, secs)[0]


def OSGetTime():
    """Reads the robot's clock; ticks: milliseconds."""
    return tuple(_call(_OSGetTime, None, None, None, None)[:4])


def OSShowTime():
    """Shows the robot's clock on the display. Returns 0."""
    return _call(_OSShowTime)[0]


def OSGetCount():
    """Milliseconds since the robot's start."""
    return _call(_OSGetCount)[0]


def SERInit(interface, baud, handshake):
    """Opens an interface, 1 to 16. handshake: 0 none, 1 RTS/CTS. Returns 0, 1 if there is no such interface."""
    return _call(_SERInit, interface, baud, handshake)[0]


def SERSendChar(interface, ch):
    """Sends a character. Returns 0, 1 if the interface is not open."""
    return _call(_SERSendChar, interface, ch)[0]


def SERSend(interface, buf):
    """Sends bytes. Returns 0, 1 if the interface is not open."""
    return _call(_SERSend, interface, buf)[0]


def SERReceiveChar(interface):
    """Waits for a character. Returns it, 0 if the interface is not open."""
    return _call(_SERReceiveChar, interface)[0]


def SERCheck(interface):
    """Whether something has come in."""
    return _call(_SERCheck, interface)[0]


def SERFlush(interface):
    """Forgets what has come in. Returns 0, 1 if the interface is not open."""
    return _call(_SERFlush, interface)[0]


def SERClose(interface):
    """Closes an interface. Returns 0, 1 if it is not open."""
    return _call(_SERClose, interface)[0]


def AUBeep():
    """Beeps. Returns 0."""
    return _call(_AUBeep)[0]


def AUPlay(sample):
    """Plays a sound file of this name, or the WAV file that is in memory there. Does not wait. Returns 0, 1 if it is none."""
    return _call(_AUPlay, sample)[0]


def AUDone():
    """Whether the sound is over: 1, else 0."""
    return _call(_AUDone)[0]


def AUMicrophone():
    """A value of the microphone, 0 to 255."""
    return _call(_AUMicrophone)[0]


def AUTone(freq_hz, time_ms):
    """Plays a tone. Does not wait. Returns 0, 1 for a frequency that cannot be played."""
    return _call(_AUTone, freq_hz, time_ms)[0]


def AUCheckTone():
    """Whether the tone is over: 1, else 0."""
    return _call(_AUCheckTone)[0]


def AUCheckPlay():
    """Whether the sound is over: 1, else 0."""
    return _call(_AUCheckPlay)[0]


def AUCheckRecord():
    """Whether the recording is over: 1, else 0."""
    return _call(_AUCheckRecord)[0]


def PSDGet(psd):
    """Distance of sensor 1 to 6 in millimetres, now; 9999 if there is nothing near, 0 if there is no such sensor."""
    return _call(_PSDGet, psd)[0]


def PSDGetRaw(psd):
    """The same as the sensor's own number; 0 if there is no such sensor."""
    return _call(_PSDGetRaw, psd)[0]


def LIDARSet(range, tilt, points):
    """Sets angle in degrees, 1 to 360, the scanner's tilt in degrees, and the number of points."""
    _call(_LIDARSet, range, tilt, points)


def SERVOSet(servo, angle):
    """Turns servo 1 to 14 to a position of 0 to 255. Returns 0, 1 if there is no such servo or position."""
    return _call(_SERVOSet, servo, angle)[0]


def SERVOSetRaw(servo, angle):
    """The same as the servo's own number, past its range. Returns 0, 1 if there is no such servo."""
    return _call(_SERVOSetRaw, servo, angle)[0]


def SERVORange(servo, low, high):
    """Sets what positions 0 and 255 mean, in the servo's own numbers. Returns 0, 1 if there is no such servo."""
    return _call(_SERVORange, servo, low, high)[0]


def MOTORDrive(motor, speed):
    """Drives motor 1 to 4 with -100 to 100 percent. Returns 0, 1 if there is no such motor."""
    return _call(_MOTORDrive, motor, speed)[0]


def MOTORDriveRaw(motor, speed):
    """The same as the motor's own number, -127 to 127. Returns 0, 1 if there is no such motor."""
    return _call(_MOTORDriveRaw, motor, speed)[0]


def MOTORPID(motor, p, i, d):
    """Sets the controller of a motor, each 1 to 255. Returns 0, 1 if there is no such motor."""
    return _call(_MOTORPID, motor, p, i, d)[0]


def MOTORPIDOff(motor):
    """Takes a motor's controller away. Returns 0, 1 if there is no such motor."""
    return _call(_MOTORPIDOff, motor)[0]


def MOTORSpeed(motor, ticks):
    """Drives a motor with a speed in encoder ticks a second. Returns 0, 1 if there is no such motor."""
    return _call(_MOTORSpeed, motor, ticks)[0]


def ENCODERRead(quad):
    """Ticks of encoder 1 to 4 since its reset; 0 if there is no such encoder."""
    return _call(_ENCODERRead, quad)[0]


def ENCODERReset(quad):
    """Sets an encoder to 0. Returns 0, 1 if there is no such encoder."""
    return _call(_ENCODERReset, quad)[0]


def VWSetSpeed(linSpeed, angSpeed):
    """Drives with a speed in mm/s and a turning speed in degrees/s, until the next command. Returns 0, 1 on failure."""
    return _call(_VWSetSpeed, linSpeed, angSpeed)[0]


def VWGetSpeed():
    """Speeds in mm/s and degrees/s."""
    return tuple(_call(_VWGetSpeed, None, None)[:2])


def VWSetPosition(x, y, phi):
    """Sets the position by odometry: mm, mm, degrees. Returns 0, 1 on failure."""
    return _call(_VWSetPosition, x, y, phi)[0]


def VWGetPosition():
    """Position by odometry: mm, mm, and degrees from -180 to 180."""
    return tuple(_call(_VWGetPosition, None, None, None)[:3])


def VWStraight(dist, lin_speed):
    """Starts to drive straight for dist mm; the sign is that of dist. Returns 0, 1 on failure."""
    return _call(_VWStraight, dist, lin_speed)[0]


def VWTurn(angle, ang_speed):
    """Starts to turn by angle degrees, to the left for positive ones. Returns 0, 1 on failure."""
    return _call(_VWTurn, angle, ang_speed)[0]


def VWCurve(dist, angle, lin_speed):
    """Starts to drive dist mm while turning by angle degrees. Returns 0, 1 on failure."""
    return _call(_VWCurve, dist, angle, lin_speed)[0]


def VWDrive(dx, dy, lin_speed):
    """Starts to drive in an arc to the place dx mm ahead and dy mm to the left. Returns 0, 1 on failure."""
    return _call(_VWDrive, dx, dy, lin_speed)[0]


def VWRemain():
    """What is left of the drive: mm, of a turn degrees; 0 when it is done."""
    return _call(_VWRemain)[0]


def VWDone():
    """1 when the drive is done or there was none, 0 while it goes on, -1 on failure."""
    return _call(_VWDone)[0]


def VWWait():
    """Waits for the drive's end. Returns 0, -1 on failure."""
    return _call(_VWWait)[0]


def VWStalled():
    """Which wheel stalls: 0 none, 1 the left, 2 the right, 3 both."""
    return _call(_VWStalled)[0]


def VWControl(Vv, Tv, Vw, Tw):
    """Starts the controllers of speed and turning speed, with parameters in tenths and hundredths as 70 30 70 10.
    Returns 0, 1 on failure."""
    return _call(_VWControl, Vv, Tv, Vw, Tw)[0]


def VWControlOff():
    """Stops the controllers. Returns 0, 1 on failure."""
    return _call(_VWControlOff)[0]


def DIGITALSetup(io, direction):
    """Direction of line 1 to 16: 'i' in, 'o' out, 'I' in with pull-up, 'J' in with pull-down. Returns 0, 1 for others."""
    return _call(_DIGITALSetup, io, direction)[0]


def DIGITALRead(io):
    """State of a line: 0 or 1; -1 if there is no such line."""
    return _call(_DIGITALRead, io)[0]


def DIGITALReadAll():
    """States of all lines, line 1 in the lowest bit."""
    return _call(_DIGITALReadAll)[0]


def DIGITALWrite(io, state):
    """Sets an output. Returns 0, 1 if there is no such line or it is no output."""
    return _call(_DIGITALWrite, io, state)[0]


def ANALOGRead(channel):
    """Value of channel 0 to 8; -1 if there is no such channel."""
    return _call(_ANALOGRead, channel)[0]


def ANALOGVoltage():
    """Voltage of the battery in hundredths of a volt."""
    return _call(_ANALOGVoltage)[0]


def ANALOGRecord(channel, iterations):
    """Starts to record a channel at 1 kHz. Does not wait. Returns 0, 1 if there is no such channel or it records."""
    return _call(_ANALOGRecord, channel, iterations)[0]


def IRTVGet():
    """Waits for a key of the remote control. Returns its code."""
    return _call(_IRTVGet)[0]


def IRTVRead():
    """A key of the remote control that was pressed, 0 if none was. Does not wait."""
    return _call(_IRTVRead)[0]


def IRTVFlush():
    """Forgets the keys that were pressed. Returns 0."""
    return _call(_IRTVFlush)[0]


def IRTVGetStatus():
    """Whether there is a receiver: 1, else 0."""
    return _call(_IRTVGetStatus)[0]


def RADIOInit():
    """Switches the radio on. Returns 0, 1 on failure."""
    return _call(_RADIOInit)[0]


def RADIOGetID():
    """The robot's address; 0 on failure."""
    return _call(_RADIOGetID)[0]


def RADIOSend(id, buf):
    """Sends text. Returns 0, 1 on failure."""
    return _call(_RADIOSend, id, buf)[0]


def RADIOCheck():
    """Number of messages that wait."""
    return _call(_RADIOCheck)[0]


def RADIORelease():
    """Switches the radio off. Returns 0, 1 on failure."""
    return _call(_RADIORelease)[0]


def SIMGetRobot(id):
    """True pose of a robot, 0 for the own one: mm, mm, mm, degrees."""
    return tuple(_call(_SIMGetRobot, id, None, None, None, None)[:4])


def SIMSetRobot(id, x, y, z, phi):
    """Puts a robot, 0 for the own one, at a pose."""
    _call(_SIMSetRobot, id, x, y, z, phi)


def SIMGetObject(id):
    """True pose of an object; objects are numbered on from the robots."""
    return tuple(_call(_SIMGetObject, id, None, None, None, None)[:4])


def SIMSetObject(id, x, y, z, phi):
    """Puts an object at a pose."""
    _call(_SIMSetObject, id, x, y, z, phi)


def SIMGetRobotCount():
    """Number of robots."""
    return _call(_SIMGetRobotCount)[0]


def SIMGetObjectCount():
    """Number of objects."""
    return _call(_SIMGetObjectCount)[0]

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
    """A flat image: one byte a pixel, or three. `numpy.asarray` gives it rows and columns."""

    width = height = 0

    def __array__(self, dtype=None, copy=None):
        import numpy

        shape = (self.height, self.width) if len(self) == self.width * self.height else (self.height, self.width, 3)
        array = numpy.frombuffer(self, numpy.uint8).reshape(shape)
        return array if dtype is None else array.astype(dtype)


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


def CAMInit(resolution):
    """Switches the camera on, with a resolution such as QVGA. Returns 0, 1 if there is no camera."""
    global CAMWIDTH, CAMHEIGHT, CAMPIXELS, CAMSIZE, CAMMODE, _shown_width, _shown_height
    if resolution in _SIZES:
        CAMWIDTH, CAMHEIGHT = _SIZES[resolution]
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
    """Waits for a message: address of its sender, and text."""
    sender, data, _result = _call(_RADIOReceive, None, size)
    return sender, _text(data)


def RADIOStatus():
    """Addresses of the robots on the radio."""
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
