"""RoBIOS-7 for functions as robot programs. `python/tests/test_stub.py` writes this file."""

import os as os
import sys as sys
from ctypes import *
from typing import Any

import ctypes as ctypes

lib: Any
np: Any
def ANALOGRead(*arguments: Any, **named: Any) -> Any:
    """ANALOGRead(channel)

    Reads an analog input. channel: 0 to 8. Returns 0 to 1023; -1 if there is no such channel."""
def ANALOGRecord(*arguments: Any, **named: Any) -> Any:
    """ANALOGRecord(channel, iterations)

    Starts to record a channel at 1 kHz; does not wait. channel: 0 to 8. iterations: number of values, 1 to 1048576.
    Returns 0, 1 if there is no such channel or a recording is in progress."""
def ANALOGTransfer(*arguments: Any, **named: Any) -> Any:
    """ANALOGTransfer(buffer=None)

    The recording of ANALOGRecord; empty while it continues."""
def ANALOGVoltage(*arguments: Any, **named: Any) -> Any:
    """ANALOGVoltage()

    The voltage of the battery. Returns hundredths of a volt."""
ANYKEY: int
def AUBeep(*arguments: Any, **named: Any) -> Any:
    """AUBeep()

    Beeps. Returns 0."""
def AUCheckPlay(*arguments: Any, **named: Any) -> Any:
    """AUCheckPlay()

    Checks whether the sound is over. Returns 1 if it is, otherwise 0."""
def AUCheckRecord(*arguments: Any, **named: Any) -> Any:
    """AUCheckRecord()

    Checks whether the recording is over. Returns 1 if it is, otherwise 0."""
def AUCheckTone(*arguments: Any, **named: Any) -> Any:
    """AUCheckTone()

    Checks whether the tone is over. Returns 1 if it is, otherwise 0."""
def AUDone(*arguments: Any, **named: Any) -> Any:
    """AUDone()

    Checks whether the sound is over. Returns 1 if it is, otherwise 0."""
def AUMicrophone(*arguments: Any, **named: Any) -> Any:
    """AUMicrophone()

    The current value of the microphone. Returns 0 to 255; 128 is silence."""
def AUPlay(*arguments: Any, **named: Any) -> Any:
    """AUPlay(sample)

    Plays a sound; does not wait. sample: name of a WAV file, or a WAV file in memory. Returns 0, 1 if it is not a
    sound."""
def AURecord(*arguments: Any, **named: Any) -> Any:
    """AURecord(*arguments)

    AURecord(time, freq) records the microphone: a value of 0 to 255 for each sample; AURecord(buf, time, freq) into a
    buffer. Times in milliseconds, rates in Hz."""
def AUTone(*arguments: Any, **named: Any) -> Any:
    """AUTone(freq_hz, time_ms)

    Plays a tone; does not wait. freq_hz: frequency in Hz, 65 to 21000. time_ms: duration in milliseconds. Returns 0, 1
    for a frequency that cannot be played."""
BLACK: int
BLUE: int
BOLD: int
BYTE: Any
CAM1MP: int
CAM1MP_PIXELS: int
CAM1MP_SIZE: int
CAM1MP_X: int
CAM1MP_Y: int
CAM1MPcol: Any
CAM1MPgray: Any
CAM5MP: int
CAM5MP_PIXELS: int
CAM5MP_SIZE: int
CAM5MP_X: int
CAM5MP_Y: int
CAM5MPcol: Any
CAM5MPgray: Any
def CAMGet(*arguments: Any, **named: Any) -> Any:
    """CAMGet(buf=None)

    A colour image of CAMSIZE bytes, row 0 at the top; black if there is no camera."""
def CAMGetDepth(*arguments: Any, **named: Any) -> Any:
    """CAMGetDepth()

    Depth image of the last image: the distance along each pixel's ray, in mm, infinite for the sky. An
    array of CAMPIXELS numbers, row 0 at the top; None if no image has been taken."""
def CAMGetGray(*arguments: Any, **named: Any) -> Any:
    """CAMGetGray(buf=None)

    A grey image of CAMPIXELS bytes; black if there is no camera."""
def CAMGetLabels(*arguments: Any, **named: Any) -> Any:
    """CAMGetLabels()

    Label of each pixel of the last image: CAM_SKY, CAM_FLOOR, CAM_WALL, or CAM_BODY + n for robot or object n. An array
    of CAMPIXELS numbers, row 0 at the top; None if no image has been taken."""
CAMHD: int
CAMHD_PIXELS: int
CAMHD_SIZE: int
CAMHD_X: int
CAMHD_Y: int
CAMHDcol: Any
CAMHDgray: Any
CAMHEIGHT: int
CAMHEIGHTARR: Any
def CAMInit(*arguments: Any, **named: Any) -> Any:
    """CAMInit(resolution, width=None, height=None)

    Switches the camera on, with a resolution such as QVGA; CUSTOM with width and height. Returns 0, 1 if there is no
    camera."""
CAMMODE: int
CAMPIXELS: int
CAMPIXELSARR: Any
def CAMRelease(*arguments: Any, **named: Any) -> Any:
    """CAMRelease()

    Switches the camera off. Returns 0, 1 if there is no camera."""
CAMSIZE: int
CAMSIZEARR: Any
CAMWIDTH: int
CAMWIDTHARR: Any
CAM_BODY: int
CAM_FAILURE: int
CAM_FLOOR: int
CAM_SKY: int
CAM_SUCCESS: int
CAM_WALL: int
COLOR: Any
COURIER: int
CUSTOM: int
CYAN: int
DARKGRAY: int
def DIGITALRead(*arguments: Any, **named: Any) -> Any:
    """DIGITALRead(io)

    Reads a line. io: 1 to 16. Returns 0 or 1; -1 if there is no such line."""
def DIGITALReadAll(*arguments: Any, **named: Any) -> Any:
    """DIGITALReadAll()

    Reads all lines. Returns their states, line 1 in the lowest bit."""
def DIGITALSetup(*arguments: Any, **named: Any) -> Any:
    """DIGITALSetup(io, direction)

    Sets the direction of a line. io: 1 to 16. direction: 'i' in, 'o' out, 'I' in with pull-up, 'J' in with
    pull-down. Returns 0, 1 for other values."""
def DIGITALWrite(*arguments: Any, **named: Any) -> Any:
    """DIGITALWrite(io, state)

    Sets an output. io: 1 to 16. state: 0 or 1. Returns 0, 1 if there is no such line or it is not an output."""
def ENCODERRead(*arguments: Any, **named: Any) -> Any:
    """ENCODERRead(quad)

    Reads an encoder. quad: 1 to 4. Returns counts since its reset; 0 if there is no such encoder."""
def ENCODERReset(*arguments: Any, **named: Any) -> Any:
    """ENCODERReset(quad)

    Sets an encoder to 0. quad: 1 to 4. Returns 0, 1 if there is no such encoder."""
EYESIM_OCCUPIED: int
EYESIM_ODOMETRY: int
EYESIM_UNKNOWN: int
EYESIM_WORLD: int
GRAY: int
GREEN: int
HELVETICA: int
def IPCol2Gray(*arguments: Any, **named: Any) -> Any:
    """IPCol2Gray(img, out=None)

    Converts a colour image to a grey image."""
def IPCol2HSI(*arguments: Any, **named: Any) -> Any:
    """IPCol2HSI(img, h=None, s=None, i=None)

    Hue, saturation and intensity of a colour image, a channel each."""
def IPGray2Col(*arguments: Any, **named: Any) -> Any:
    """IPGray2Col(gray, out=None)

    Converts a grey image to a colour image."""
def IPLaplace(*arguments: Any, **named: Any) -> Any:
    """IPLaplace(gray, out=None)

    Laplace edges of a grey image."""
def IPOverlay(*arguments: Any, **named: Any) -> Any:
    """IPOverlay(c1, c2, out=None)

    Lays the second colour image over the first where the second is not black."""
def IPOverlayGray(*arguments: Any, **named: Any) -> Any:
    """IPOverlayGray(g1, g2, col, out=None)

    Lays the second grey image over the first, in a colour, where the second is not 0."""
def IPPCol2HSI(*arguments: Any, **named: Any) -> Any:
    """IPPCol2HSI(c, h=None, s=None, i=None)

    Hue, saturation and intensity of a colour. h, s, i: set to 0 to 255."""
def IPPCol2RGB(*arguments: Any, **named: Any) -> Any:
    """IPPCol2RGB(col, r=None, g=None, b=None)

    Splits a colour into red, green and blue. r, g, b: set to 0 to 255."""
def IPPRGB2Col(*arguments: Any, **named: Any) -> Any:
    """IPPRGB2Col(r, g, b)

    The colour of red, green and blue. r, g, b: 0 to 255. Returns the colour, 0xRRGGBB."""
def IPPRGB2HSI(*arguments: Any, **named: Any) -> Any:
    """IPPRGB2HSI(r, g, b, h=None, s=None, i=None)

    Hue, saturation and intensity of red, green and blue. r, g, b: 0 to 255. h, s, i: set to 0 to 255."""
def IPPRGB2Hue(*arguments: Any, **named: Any) -> Any:
    """IPPRGB2Hue(r, g, b)

    Hue of red, green and blue. r, g, b: 0 to 255. Returns 0 to 255; 0 for grey."""
def IPRGB2Col(*arguments: Any, **named: Any) -> Any:
    """IPRGB2Col(r, g, b, out=None)

    Composes a colour image from its three channels."""
def IPReadFile(*arguments: Any, **named: Any) -> Any:
    """IPReadFile(filename, img=None)

    Reads a PNM file: a grey or a colour image of the size that IPSetSize has set; None if it cannot be read. Unpacked into
    two names it is the digit of P1 to P6 and the image."""
def IPSetSize(*arguments: Any, **named: Any) -> Any:
    """IPSetSize(resolution, width=None, height=None)

    Sets the size of the images of all IP functions; CUSTOM with width and height. Returns 0, 1 for another number."""
def IPSobel(*arguments: Any, **named: Any) -> Any:
    """IPSobel(gray, out=None)

    Sobel edges of a grey image."""
def IPWriteFile(*arguments: Any, **named: Any) -> Any:
    """IPWriteFile(filename, img)

    Writes a colour image as PPM. Returns 0, 1 if it cannot be written."""
def IPWriteFileGray(*arguments: Any, **named: Any) -> Any:
    """IPWriteFileGray(filename, gray)

    Writes a grey image as PGM. Returns 0, 1 if it cannot be written."""
IP_HEIGHT: int
IP_PIXELS: int
IP_SIZE: int
IP_WIDTH: int
def IRTVFlush(*arguments: Any, **named: Any) -> Any:
    """IRTVFlush()

    Discards the keys that were pressed. Returns 0."""
def IRTVGet(*arguments: Any, **named: Any) -> Any:
    """IRTVGet()

    Waits for a key of the remote control. Returns its code."""
def IRTVGetStatus(*arguments: Any, **named: Any) -> Any:
    """IRTVGetStatus()

    Checks whether there is a receiver. Returns 1 if there is one, otherwise 0."""
def IRTVRead(*arguments: Any, **named: Any) -> Any:
    """IRTVRead()

    A key of the remote control that was pressed, without waiting. Returns its code, 0 if none was."""
IRTV_0: int
IRTV_1: int
IRTV_2: int
IRTV_3: int
IRTV_4: int
IRTV_5: int
IRTV_6: int
IRTV_7: int
IRTV_8: int
IRTV_9: int
IRTV_BLUE: int
IRTV_DOWN: int
IRTV_GREEN: int
IRTV_LEFT: int
IRTV_OK: int
IRTV_POWER: int
IRTV_RED: int
IRTV_RIGHT: int
IRTV_UP: int
IRTV_YELLOW: int
ITALICS: int
Image: Any
KEY1: int
KEY2: int
KEY3: int
KEY4: int
def KEYGet(*arguments: Any, **named: Any) -> Any:
    """KEYGet()

    Waits for a key. Returns KEY1, KEY2, KEY3 or KEY4."""
def KEYGetXY(*arguments: Any, **named: Any) -> Any:
    """KEYGetXY(x=None, y=None)

    Waits for a touch of the display. x, y: set to its position in pixels from the upper left corner; may be
    NULL."""
def KEYRead(*arguments: Any, **named: Any) -> Any:
    """KEYRead()

    The key that was pressed, without waiting. Returns KEY1, KEY2, KEY3 or KEY4; NOKEY if none was."""
def KEYReadXY(*arguments: Any, **named: Any) -> Any:
    """KEYReadXY(x=None, y=None)

    The position of a touch of the display as (x, y), None if there was none. Does not wait."""
KEYTM_CLASSIC: int
KEYTM_LISTMENU: int
KEYTM_REGIONS: int
KEYTM_STANDARD: int
KEYTM_UNKNOWN: int
def KEYWait(*arguments: Any, **named: Any) -> Any:
    """KEYWait(key)

    Waits for one of the given keys and discards other keys. key: keys, or-ed, or ANYKEY. Returns the key,
    KEY_INVALID if there is no such key."""
KEY_ESCAPE: int
KEY_INVALID: int
KEY_LIST1: int
KEY_LIST2: int
KEY_LIST3: int
KEY_LIST4: int
KEY_LIST5: int
KEY_LIST6: int
KEY_LIST7: int
KEY_LIST8: int
KEY_LISTDN: int
KEY_LISTTL: int
KEY_LISTUP: int
def LCDArea(*arguments: Any, **named: Any) -> Any:
    """LCDArea(x1, y1, x2, y2, col, fill)

    Draws a rectangle between two corners. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper
    edge. fill: if not 0, filled; otherwise only its edge. Returns 0."""
def LCDAreaInvert(*arguments: Any, **named: Any) -> Any:
    """LCDAreaInvert(x1, y1, x2, y2)

    Inverts a filled rectangle. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper edge.
    Returns 0."""
def LCDCircle(*arguments: Any, **named: Any) -> Any:
    """LCDCircle(x1, y1, size, col, fill)

    Draws a circle. x1, y1: its centre, pixels to the right of the left edge and below the upper edge. size: its radius
    in pixels. fill: if not 0, filled; otherwise only its edge. Returns 0."""
def LCDCircleInvert(*arguments: Any, **named: Any) -> Any:
    """LCDCircleInvert(x1, y1, size)

    Inverts a filled circle. x1, y1: its centre, pixels to the right of the left edge and below the upper edge. size:
    its radius in pixels. Returns 0."""
def LCDClear(*arguments: Any, **named: Any) -> Any:
    """LCDClear()

    Makes the display black; the cursor goes to row 0, column 0; the menu stays. Returns 0."""
def LCDFontSize(*arguments: Any, **named: Any) -> Any:
    """LCDFontSize(fontsize)

    Sets the size of text from now on. fontsize: 8, 12, 14, 18 or 24. Returns 0, 1 for other values."""
def LCDGetPixel(*arguments: Any, **named: Any) -> Any:
    """LCDGetPixel(x, y)

    Reads the colour of one pixel. x: pixels to the right of the left edge. y: pixels below the upper edge. Returns the
    colour; 0 outside of the display."""
def LCDGetPos(*arguments: Any, **named: Any) -> Any:
    """LCDGetPos(row=None, column=None)

    Reads the position of the cursor. row, column: set to its position in characters of the current size, from
    0."""
def LCDGetSize(*arguments: Any, **named: Any) -> Any:
    """LCDGetSize(x=None, y=None)

    Reads the size of the display. x, y: set to columns and rows of pixels."""
def LCDImage(*arguments: Any, **named: Any) -> Any:
    """LCDImage(img)

    Shows a colour image, 3 bytes per pixel, of the size that LCDImageStart or LCDImageSize has set. Returns 0."""
def LCDImageBinary(*arguments: Any, **named: Any) -> Any:
    """LCDImageBinary(b)

    Shows a binary image, 1 byte per pixel: 0 is white, everything else black. Returns 0."""
def LCDImageGray(*arguments: Any, **named: Any) -> Any:
    """LCDImageGray(g)

    Shows a grey image, 1 byte per pixel. Returns 0."""
def LCDImageSize(*arguments: Any, **named: Any) -> Any:
    """LCDImageSize(t)

    Sets the size of the images that LCDImage and similar functions show, a resolution such as QVGA. Returns 0, 1 for another number."""
def LCDImageStart(*arguments: Any, **named: Any) -> Any:
    """LCDImageStart(x, y, xs, ys)

    Sets position and size in pixels of the images that LCDImage and similar functions show. Returns 0, 1 for a size below 1."""
def LCDInit(*arguments: Any, **named: Any) -> Any:
    """LCDInit()

    Function of the library of 2016; the display always exists. Returns 0."""
def LCDLine(*arguments: Any, **named: Any) -> Any:
    """LCDLine(x1, y1, x2, y2, col)

    Draws a line with both ends. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper edge.
    Returns 0."""
def LCDLineInvert(*arguments: Any, **named: Any) -> Any:
    """LCDLineInvert(x1, y1, x2, y2)

    Inverts the pixels of a line. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper edge.
    Returns 0."""
def LCDListLine(*arguments: Any, **named: Any) -> Any:
    """LCDListLine(line, key, text, fg, bg)

    Sets a line of a list menu and shows the list; a touch of the line is a key. Used by LCDList, not part of RoBIOS.
    line: from 0. key: the key of the line, such as KEY_LIST1. text: the line; NULL ends the list before it. fg: colour
    of the text. bg: background colour. Returns the number of lines that fit, 0 if there is no such line."""
def LCDMenu(*arguments: Any, **named: Any) -> Any:
    """LCDMenu(st1, st2, st3, st4)

    Sets the labels of the four keys under the display. st1, st2, st3, st4: the labels; an empty text clears a label,
    NULL leaves it. Returns 0."""
def LCDMenuI(*arguments: Any, **named: Any) -> Any:
    """LCDMenuI(pos, string, fg, bg)

    Sets the label of one key with its colours. pos: key 1 to 4. string: the label. fg: colour of the text. bg: background
    colour. Returns 0, 1 if there is no such key."""
def LCDPixel(*arguments: Any, **named: Any) -> Any:
    """LCDPixel(x, y, col)

    Draws one pixel; all drawing functions clip at the edges of the display. x: pixels to the right of the left edge. y:
    pixels below the upper edge. Returns 0."""
def LCDPixelInvert(*arguments: Any, **named: Any) -> Any:
    """LCDPixelInvert(x, y)

    Inverts one pixel. x: pixels to the right of the left edge. y: pixels below the upper edge. Returns 0."""
def LCDPrintf(*arguments: Any, **named: Any) -> Any:
    """LCDPrintf(text, *values)

    Prints at the cursor; with further values as `text % values`. Returns 0."""
def LCDRefresh(*arguments: Any, **named: Any) -> Any:
    """LCDRefresh()

    Shows the drawings made while LCD_NOAUTOREFRESH is set. Returns 0."""
def LCDSetColor(*arguments: Any, **named: Any) -> Any:
    """LCDSetColor(fg, bg)

    Sets the colours of text from now on. fg: of the characters. bg: of the background. Returns 0."""
def LCDSetFont(*arguments: Any, **named: Any) -> Any:
    """LCDSetFont(font, variation)

    Sets the font of text from now on. font: HELVETICA, TIMES or COURIER. variation: NORMAL, BOLD or ITALICS.
    Returns 0, 1 for other values."""
def LCDSetFontSize(*arguments: Any, **named: Any) -> Any:
    """LCDSetFontSize(fontsize)

    Sets the size of text from now on. fontsize: 8, 12, 14, 18 or 24. Returns 0, 1 for other values."""
def LCDSetMode(*arguments: Any, **named: Any) -> Any:
    """LCDSetMode(mode)

    Sets modes of the display. mode: LCD_SCROLLING and the like, or-ed; other modes stay unchanged. Returns 0."""
def LCDSetPos(*arguments: Any, **named: Any) -> Any:
    """LCDSetPos(row, column)

    Moves the cursor. row, column: in characters of the current size, from 0. Returns 0."""
def LCDSetPrintf(*arguments: Any, **named: Any) -> Any:
    """LCDSetPrintf(row, column, text, *values)

    Prints at a row and a column of characters, both from 0. Returns 0."""
LCD_AUTOREFRESH: int
LCD_BGCOL_INVERSE: int
LCD_BGCOL_NOINVERSE: int
LCD_BGCOL_NOTRANSPARENT: int
LCD_BGCOL_TRANSPARENT: int
LCD_CLASSICMENU: int
LCD_FB_NOROTATION: int
LCD_FB_ROTATE: int
LCD_FGCOL_INVERSE: int
LCD_FGCOL_NOINVERSE: int
LCD_HIDEMENU: int
LCD_LINEFEED: int
LCD_LISTMENU: int
LCD_NOAUTOREFRESH: int
LCD_NOLINEFEED: int
LCD_NOSCROLLING: int
LCD_SCROLLING: int
LCD_SHOWMENU: int
def LEGCorrect(*arguments: Any, **named: Any) -> Any:
    """LEGCorrect(leg, dx_mm, dy_mm, dz_mm)

    Corrects the steps of a leg, from the next instant at which its foot is in the air until the next correction. leg:
    from 1. dx_mm: mm forward of the foothold of the gait. dy_mm: mm to the left of the foothold of the gait. dz_mm:
    additional lift of the foot, mm. Returns 0, -1 if there is no such leg or the foothold is out of its reach."""
def LEGCount(*arguments: Any, **named: Any) -> Any:
    """LEGCount()

    The number of legs. Legs, joints, links and gaits are numbered from 1, in the order of the robi file. Returns the
    number; 0 if the robot has no legs."""
def LEGGetFoot(*arguments: Any, **named: Any) -> Any:
    """LEGGetFoot(leg)

    Checks whether a foot is on the ground. leg: from 1. Returns 1 if it is, 0 if it is in the air, -1 if there is no such
    leg."""
def LEGGetHeight(*arguments: Any, **named: Any) -> Any:
    """LEGGetHeight(mm=None)

    Current height of the body's frame above the world's floor, in mm. None if there are no legs."""
def LEGGetJoint(*arguments: Any, **named: Any) -> Any:
    """LEGGetJoint(leg, joint, degrees=None)

    Current angle of a joint, in degrees; leg and joint numbers start at 1. None if there is no such leg or joint."""
def LEGGetLink(*arguments: Any, **named: Any) -> Any:
    """LEGGetLink(leg, link, pose=None)

    Current pose of a link of a leg in the frame of the body: [x, y, z, roll, pitch, yaw] in mm and degrees; leg and link
    from 1. None if there is no such leg or link."""
def LEGSetGait(*arguments: Any, **named: Any) -> Any:
    """LEGSetGait(gait)

    Switches to another gait; each leg changes when it is next lifted.
    gait: from 1. Returns 0, -1 if there are no legs or no such gait."""
def LEGSetSpeed(*arguments: Any, **named: Any) -> Any:
    """LEGSetSpeed(vx_mmps, vy_mmps, omega_degps)

    Walks at this speed until the next command, sideways too; 0, 0, 0 stops. A twist beyond the capability of the legs
    is scaled down as a whole. vx_mmps: mm/s forward. vy_mmps: mm/s to the left. omega_degps: degrees/s
    counter-clockwise. Returns 0, -1 if there are no legs."""
def LEGSetStep(*arguments: Any, **named: Any) -> Any:
    """LEGSetStep(height_mm)

    Sets the height to which feet are lifted; each leg applies it from its next step on.
    height_mm: 0 or more. Returns 0, -1 if there are no legs or the height is negative or beyond the legs."""
def LIDARGet(*arguments: Any, **named: Any) -> Any:
    """LIDARGet(distance=None)

    Distances in millimetres from left to right, the middle one (of n, that of index n/2) straight ahead; 9999 if
    nothing is in range. A list, empty if there is no scanner."""
def LIDARSet(*arguments: Any, **named: Any) -> Any:
    """LIDARSet(range, tilt, points)

    Sets angle in degrees, 1 to 360, the scanner's tilt in degrees, and the number of points."""
LIDAR_RESOLUTION: int
LIGHTGRAY: int
MACHINE_ID: int
MACHINE_NAME: str
MACHINE_SPEED: int
MACHINE_TYPE: int
MAGENTA: int
MAROON: int
def MOTORDrive(*arguments: Any, **named: Any) -> Any:
    """MOTORDrive(motor, speed)

    Drives a motor. motor: 1 to 4. speed: -100 to 100 percent. Returns 0, 1 if there is no such motor."""
def MOTORDriveRaw(*arguments: Any, **named: Any) -> Any:
    """MOTORDriveRaw(motor, speed)

    Drives a motor with a raw value. motor: 1 to 4. speed: -127 to 127. Returns 0, 1 if there is no such motor."""
def MOTORPID(*arguments: Any, **named: Any) -> Any:
    """MOTORPID(motor, p, i, d)

    Sets the controller of a motor. motor: 1 to 4. p, i, d: gains, 0 to 255 each. Returns 0, 1 if there is no such
    motor."""
def MOTORPIDOff(*arguments: Any, **named: Any) -> Any:
    """MOTORPIDOff(motor)

    Stops a motor's controller. motor: 1 to 4. Returns 0, 1 if there is no such motor."""
def MOTORPIDoff(*arguments: Any, **named: Any) -> Any:
    """MOTORPIDoff(motor)

    Stops a motor's controller. motor: 1 to 4. Returns 0, 1 if there is no such motor."""
def MOTORSpeed(*arguments: Any, **named: Any) -> Any:
    """MOTORSpeed(motor, ticks)

    Drives a motor with the speed of its encoder. motor: 1 to 4. ticks: encoder counts per second. Returns 0, 1
    if there is no such motor."""
NAVY: int
NOKEY: int
NORMAL: int
OLIVE: int
ORANGE: int
def OSAttachTimer(*arguments: Any, **named: Any) -> Any:
    """OSAttachTimer(scale, fct)

    Calls a function periodically, inside the call in progress at that time. scale: period in milliseconds, at least 1.
    fct: the function; it must not wait. Returns the timer, 0 if there are too many timers."""
def OSDetachTimer(*arguments: Any, **named: Any) -> Any:
    """OSDetachTimer(t)

    Stops a timer. Returns 0, 1 if there is no timer with this number."""
def OSError(*arguments: Any, **named: Any) -> Any:
    """OSError(message, number, dead)

    Shows an error, text and number, on the display and in the trace of the run. message: the text. number: the number
    shown after it. dead: if not 0, the robot stops here forever; otherwise the program waits for a key and continues.
    Returns 0."""
def OSExecute(*arguments: Any, **named: Any) -> Any:
    """OSExecute(command, out=None)

    Runs a command on the machine that runs the simulator, if allowed; returns its output."""
def OSGetCount(*arguments: Any, **named: Any) -> Any:
    """OSGetCount()

    Time since the robot's start. Returns milliseconds."""
def OSGetTime(*arguments: Any, **named: Any) -> Any:
    """OSGetTime(hrs=None, mins=None, secs=None, ticks=None)

    Reads the robot's clock; it starts at 0:00:00. hrs, mins, secs: set to hours, minutes and seconds. ticks: set to
    milliseconds."""
def OSMachineID(*arguments: Any, **named: Any) -> Any:
    """OSMachineID()

    The robot's number, unique in the scene; also its address on the radio. Returns the number, from 1."""
def OSMachineName(*arguments: Any, **named: Any) -> Any:
    """OSMachineName(buf=None)

    Name of the robot."""
def OSMachineSpeed(*arguments: Any, **named: Any) -> Any:
    """OSMachineSpeed()

    The clock rate of the processor. Returns the rate in Hz."""
def OSMachineType(*arguments: Any, **named: Any) -> Any:
    """OSMachineType()

    The kind of machine. Returns VEHICLE, PLATFORM or WALKER."""
def OSSetTime(*arguments: Any, **named: Any) -> Any:
    """OSSetTime(hrs, mins, secs)

    Sets the robot's clock. hrs: 0 to 23. mins, secs: 0 to 59. Returns 0, 1 for an invalid time."""
def OSShowTime(*arguments: Any, **named: Any) -> Any:
    """OSShowTime()

    Shows the robot's clock on the display. Returns 0."""
def OSVersion(*arguments: Any, **named: Any) -> Any:
    """OSVersion(buf=None)

    Version of RoBIOS."""
def OSVersionIO(*arguments: Any, **named: Any) -> Any:
    """OSVersionIO(buf=None)

    Version of the input and output board."""
def OSWait(*arguments: Any, **named: Any) -> Any:
    """OSWait(n)

    Waits. n: milliseconds. Returns 0."""
PLATFORM: int
def PSDGet(*arguments: Any, **named: Any) -> Any:
    """PSDGet(psd)

    Measures the current distance of a sensor. psd: number of the sensor, such as PSD_FRONT. Returns millimetres; 9999
    if out of range, 0 if there is no such sensor."""
def PSDGetRaw(*arguments: Any, **named: Any) -> Any:
    """PSDGetRaw(psd)

    Measures the current raw value of a sensor. psd: number of the sensor, such as PSD_FRONT. Returns 0 to 255; 0 if
    nothing is in range or there is no such sensor."""
def PSDGetSignal(*arguments: Any, **named: Any) -> Any:
    """PSDGetSignal(psd)

    Signal underlying the distance of a sensor: that of a reflectance sensor, in 1/m; the echo energy of a sonar, 1 for
    a perfect reflector 1 m ahead; for other sensors 1 with an echo, 0 without. psd: number of the sensor. Returns the
    signal, -1 if there is no such sensor."""
PSD_BACK: int
PSD_FRONT: int
PSD_FRONT2: int
PSD_LEFT: int
PSD_LEFTDIAG: int
PSD_RIGHT: int
PSD_RIGHTDIAG: int
PURPLE: int
QQVGA: int
QQVGA_PIXELS: int
QQVGA_SIZE: int
QQVGA_X: int
QQVGA_Y: int
QQVGAcol: Any
QQVGAgray: Any
QVGA: int
QVGA_PIXELS: int
QVGA_SIZE: int
QVGA_X: int
QVGA_Y: int
QVGAcol: Any
QVGAgray: Any
def RADIOCheck(*arguments: Any, **named: Any) -> Any:
    """RADIOCheck(id=None)

    Number of waiting messages; 0 if the radio is off."""
def RADIOGetID(*arguments: Any, **named: Any) -> Any:
    """RADIOGetID()

    The robot's address. Returns its number."""
def RADIOInit(*arguments: Any, **named: Any) -> Any:
    """RADIOInit()

    Switches the radio on. Returns 0, 1 if it is on already."""
def RADIOReceive(*arguments: Any, **named: Any) -> Any:
    """RADIOReceive(*arguments)

    RADIOReceive(size=1024) waits for a message: address of its sender, and text; 0 and no text if the radio is off. Bytes
    that are not UTF-8, for example after bit errors, become the replacement character. RADIOReceive(id, buf, size) is as in C."""
def RADIORelease(*arguments: Any, **named: Any) -> Any:
    """RADIORelease()

    Switches the radio off: messages that wait or are in transit are lost. Returns 0, 1 if it is off."""
def RADIOSend(*arguments: Any, **named: Any) -> Any:
    """RADIOSend(id, buf, size=None)

    Sends a text of up to 1023 bytes to a robot, 0 for all robots; `size` limits the text. Returns 0, 1 on failure."""
def RADIOStatus(*arguments: Any, **named: Any) -> Any:
    """RADIOStatus(IDlist=None)

    Addresses of all robots whose radio is on, including this robot; none if its radio is off."""
RED: int
def SERCheck(*arguments: Any, **named: Any) -> Any:
    """SERCheck(interface)

    Checks whether bytes have been received. interface: 1 to 16. Returns 1 if they have, otherwise 0."""
def SERClose(*arguments: Any, **named: Any) -> Any:
    """SERClose(interface)

    Closes an interface. interface: 1 to 16. Returns 0, 1 if it is not open."""
def SERFlush(*arguments: Any, **named: Any) -> Any:
    """SERFlush(interface)

    Discards received bytes. interface: 1 to 16. Returns 0, 1 if the interface is not open."""
def SERInit(*arguments: Any, **named: Any) -> Any:
    """SERInit(interface, baud, handshake)

    Opens an interface. interface: 1 to 16. baud: bits per second, 1 to 4000000. handshake: 0 none, 1 RTS/CTS.
    Returns 0, 1 for other values."""
def SERReceive(*arguments: Any, **named: Any) -> Any:
    """SERReceive(interface, buf=None, size=256)

    The received bytes, at most 255. Does not wait."""
def SERReceiveChar(*arguments: Any, **named: Any) -> Any:
    """SERReceiveChar(interface)

    Waits for a character. interface: 1 to 16. Returns it, 0 if the interface is not open."""
def SERSend(*arguments: Any, **named: Any) -> Any:
    """SERSend(interface, buf, size=None)

    Sends a text, or `size` bytes. Returns 0, 1 if the interface is not open."""
def SERSendChar(*arguments: Any, **named: Any) -> Any:
    """SERSendChar(interface, ch)

    Sends a character. interface: 1 to 16. ch: the character. Returns 0, 1 if the interface is not open."""
def SERVODone(*arguments: Any, **named: Any) -> Any:
    """SERVODone(servo)

    Returns 1 if a servo has reached its position, which it does at once; 0 if there is no such servo."""
def SERVOGet(*arguments: Any, **named: Any) -> Any:
    """SERVOGet(servo)

    Last position set for a servo. servo: 1 to 14. Returns 0 to 255, initially the middle; -1 if there is no such servo."""
def SERVORange(*arguments: Any, **named: Any) -> Any:
    """SERVORange(servo, low, high)

    Sets the raw positions of a servo for 0 and 255. servo: 1 to 14. low, high: raw positions, 0 to 255. Returns 0, 1 if
    there is no such servo or position."""
def SERVOSet(*arguments: Any, **named: Any) -> Any:
    """SERVOSet(servo, angle)

    Turns a servo. servo: 1 to 14. angle: position, 0 to 255. Returns 0, 1 if there is no such servo or position."""
def SERVOSetRaw(*arguments: Any, **named: Any) -> Any:
    """SERVOSetRaw(servo, angle)

    Sets the raw position of a servo, ignoring its range. servo: 1 to 14. angle: raw position, 0 to 255. Returns 0, 1 if
    there is no such servo or position."""
def SERVOWait(*arguments: Any, **named: Any) -> Any:
    """SERVOWait(servo)

    Waits until a servo has reached its position. Returns 0, 1 if there is no such servo."""
SILVER: int
def SIMGetObject(*arguments: Any, **named: Any) -> Any:
    """SIMGetObject(id, *targets)

    True pose of an object: x, y, phi, or x, y, z, phi for four names; the numbers of objects follow those of robots."""
def SIMGetObjectCount(*arguments: Any, **named: Any) -> Any:
    """SIMGetObjectCount()

    Counts the objects. Returns their number."""
def SIMGetPose(*arguments: Any, **named: Any) -> Any:
    """SIMGetPose(x=None, y=None, phi=None)

    Ground-truth pose of this robot: mm, mm, degrees."""
def SIMGetRobot(*arguments: Any, **named: Any) -> Any:
    """SIMGetRobot(id=0, x=None, y=None, z=None, phi=None)

    Ground-truth pose of a robot (0 is the calling robot): mm, mm, mm, degrees."""
def SIMGetRobotCount(*arguments: Any, **named: Any) -> Any:
    """SIMGetRobotCount()

    Counts the robots. Returns their number."""
def SIMLaserScan(*arguments: Any, **named: Any) -> Any:
    """SIMLaserScan(distance=None)

    Distances in millimetres from left to right, the middle one (of n, that of index n/2) straight ahead; 9999 if
    nothing is in range. A list, empty if there is no scanner."""
def SIMSetObject(*arguments: Any, **named: Any) -> Any:
    """SIMSetObject(*arguments)

    SIMSetObject(id, x, y, z, phi), or (id, x, y, phi), places an object."""
def SIMSetPose(*arguments: Any, **named: Any) -> Any:
    """SIMSetPose(x, y, phi)

    Places this robot."""
def SIMSetRobot(*arguments: Any, **named: Any) -> Any:
    """SIMSetRobot(*arguments)

    SIMSetRobot(id, x, y, z, phi) places a robot (0 is the calling robot). Older programs leave out the id, if x is no number of a robot:
    (x, y, z, phi) and (x, y, phi) place the calling robot."""
TEAL: int
TIMER: Any
TIMES: int
VEHICLE: int
VERSION: str
VGA: int
VGA_PIXELS: int
VGA_SIZE: int
VGA_X: int
VGA_Y: int
VGAcol: Any
VGAgray: Any
def VWControl(*arguments: Any, **named: Any) -> Any:
    """VWControl(Vv, Tv, Vw, Tw)

    Starts the controllers of speed and turning speed; typical: 70, 30, 70, 10. Vv: gain for the speed, in tenths. Tv:
    time for the speed, in hundredths of a second. Vw: gain for the turning speed, in tenths. Tw: time for the turning
    speed, in hundredths of a second. Returns 0, 1 on failure."""
def VWControlOff(*arguments: Any, **named: Any) -> Any:
    """VWControlOff()

    Stops the controllers. Returns 0, 1 on failure."""
def VWCurve(*arguments: Any, **named: Any) -> Any:
    """VWCurve(dist, angle, lin_speed)

    Starts to drive in an arc; does not wait. dist: length of the arc in mm, negative = backwards. angle: change of
    heading in degrees, positive = to the left. lin_speed: mm/s; its sign is ignored. Returns 0, 1 on failure."""
def VWDone(*arguments: Any, **named: Any) -> Any:
    """VWDone()

    Checks whether the drive is done. Returns 1 when it is done or there was none, 0 while it is in progress, -1 on failure."""
def VWDrive(*arguments: Any, **named: Any) -> Any:
    """VWDrive(dx, dy, lin_speed)

    Starts to drive in an arc to a point; does not wait. dx: mm ahead. dy: mm to the left. lin_speed: mm/s; its sign
    is ignored. Returns 0, 1 on failure."""
def VWDriveDone(*arguments: Any, **named: Any) -> Any:
    """VWDriveDone()

    Checks whether the drive is done. Returns 1 when it is done or there was none, 0 while it is in progress, -1 on failure."""
def VWDriveReady(*arguments: Any, **named: Any) -> Any:
    """VWDriveReady()

    Checks whether the drive is done. Returns 1 when it is done or there was none, 0 while it is in progress, -1 on failure."""
def VWDriveRemain(*arguments: Any, **named: Any) -> Any:
    """VWDriveRemain()

    Remainder of the drive. Returns mm, for a turn degrees; 0 when it is done."""
def VWDriveWait(*arguments: Any, **named: Any) -> Any:
    """VWDriveWait()

    Waits for the drive's end. Returns 0, -1 on failure."""
def VWGetPosition(*arguments: Any, **named: Any) -> Any:
    """VWGetPosition(x=None, y=None, phi=None)

    Reads the position by odometry. x, y: set to mm. phi: set to degrees from -180 to 180, counter-clockwise."""
def VWGetSpeed(*arguments: Any, **named: Any) -> Any:
    """VWGetSpeed(linSpeed=None, angSpeed=None)

    Reads the speeds by odometry. linSpeed: set to mm/s. angSpeed: set to degrees/s, positive = to the left."""
def VWRemain(*arguments: Any, **named: Any) -> Any:
    """VWRemain()

    Remainder of the drive. Returns mm, for a turn degrees; 0 when it is done."""
def VWSetPosition(*arguments: Any, **named: Any) -> Any:
    """VWSetPosition(x, y, phi)

    Sets the position by odometry; the robot does not move. x, y: mm. phi: degrees, counter-clockwise. Returns 0, 1 on
    failure."""
def VWSetSpeed(*arguments: Any, **named: Any) -> Any:
    """VWSetSpeed(linSpeed, angSpeed)

    Drives with a speed and a turning speed, until the next command. linSpeed: mm/s. angSpeed: degrees/s, positive = to
    the left. Returns 0, 1 on failure."""
def VWStalled(*arguments: Any, **named: Any) -> Any:
    """VWStalled()

    Determines which wheels are stalled. Returns 0 for none, 1 for the left, 2 for the right, 3 for both."""
def VWStraight(*arguments: Any, **named: Any) -> Any:
    """VWStraight(dist, lin_speed)

    Starts to drive straight; does not wait. dist: mm, negative = backwards. lin_speed: mm/s; its sign is ignored.
    Returns 0, 1 on failure."""
def VWTurn(*arguments: Any, **named: Any) -> Any:
    """VWTurn(angle, ang_speed)

    Starts to turn on the spot; does not wait. angle: degrees, positive = to the left. ang_speed: degrees/s; its sign
    is ignored. Returns 0, 1 on failure."""
def VWWait(*arguments: Any, **named: Any) -> Any:
    """VWWait()

    Waits for the drive's end. Returns 0, -1 on failure."""
WALKER: int
WHITE: int
YELLOW: int
def eyesim_show_grid(*arguments: Any, **named: Any) -> Any:
    """eyesim_show_grid(name, frame, x_m, y_m, cell_m, columns, rows, cells)

    Shows a grid as the layer of this name in the window: one byte per cell, row by row from the smallest y, 0 (free) to 100
    (occupied) or EYESIM_UNKNOWN; or a list of rows. Its lower left corner is at x_m, y_m. Returns 0, 1 on failure."""
def eyesim_show_line(*arguments: Any, **named: Any) -> Any:
    """eyesim_show_line(name, frame, points)

    Like eyesim_show_points, for a line through the points."""
def eyesim_show_points(*arguments: Any, **named: Any) -> Any:
    """eyesim_show_points(name, frame, points)

    Shows points as the layer of this name in the window: a list of (x, y) or (x, y, z) in metres. Returns 0, 1 on failure."""
