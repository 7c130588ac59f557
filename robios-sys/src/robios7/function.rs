//! The list of RoBIOS-7 functions, from which table, trait, thunks, C header and C shim come.
//!
//! The doc of a function goes to rustdoc and to `eyebot.h`; names of parameters carry their unit where C's do not.
//! Where sources conflict, `docs/robios7.md` says which is followed.

use super::*;
use crate::param::{Bytes, Callback, Out, OutBytes, OutFloats, OutInts, Text};
use crate::table::function_table;

function_table! {
    /// The RoBIOS-7 functions as a program's library gets them.
    table Robios7Table, trait Robios7, call Robios7Call, number 7, version 1;

    family LCD "the colour display", source "RoBIOS-7 library, LCD output" {
        /// Prints as printf does, at the cursor. format: as of printf, with the values after it. Returns 0, 1 if format is
        /// NULL.
        fn LCDPrintf(text: Text) -> i32 = 1, c "int LCDPrintf(const char *format, ...)";

        /// Prints as printf does, at a position; the cursor stays after it. row, column: cells of a character of the
        /// current size, from 0. format: as of printf, with the values after it. Returns 0, 1 if format is NULL.
        fn LCDSetPrintf(row: i32, column: i32, text: Text) -> i32 = 1,
            c "int LCDSetPrintf(int row, int column, const char *format, ...)";

        /// Makes the display black; the cursor goes to row 0, column 0; the menu stays. Returns 0.
        fn LCDClear() -> i32 = 1;

        /// Moves the cursor. row, column: in characters of the current size, from 0. Returns 0.
        fn LCDSetPos(row: i32, column: i32) -> i32 = 1;

        /// Reads the position of the cursor. row, column: set to its position in characters of the current size, from
        /// 0. Returns 0.
        fn LCDGetPos(row: Out<i32>, column: Out<i32>) -> i32 = 1;

        /// Sets the colours of text from now on. fg: of the characters. bg: of the background. Returns 0.
        fn LCDSetColor(fg: Color, bg: Color) -> i32 = 1;

        /// Sets the font of text from now on. font: HELVETICA, TIMES or COURIER. variation: NORMAL, BOLD or ITALICS.
        /// Returns 0, 1 for other values.
        fn LCDSetFont(font: i32, variation: i32) -> i32 = 1;

        /// Sets the size of text from now on. fontsize: 8, 12, 14, 18 or 24. Returns 0, 1 for other values.
        fn LCDSetFontSize(fontsize: i32) -> i32 = 1;

        /// Sets modes of the display. mode: LCD_SCROLLING and the like, or-ed; other modes stay unchanged. Returns 0.
        fn LCDSetMode(mode: i32) -> i32 = 1;

        /// Sets the labels of the four keys under the display. st1, st2, st3, st4: the labels; an empty text clears a label,
        /// NULL leaves it. Returns 0.
        fn LCDMenu(st1: Text, st2: Text, st3: Text, st4: Text) -> i32 = 1;

        /// Sets the label of one key with its colours. pos: key 1 to 4. string: the label. fg: colour of the text. bg: background
        /// colour. Returns 0, 1 if there is no such key.
        fn LCDMenuI(pos: i32, string: Text, fg: Color, bg: Color) -> i32 = 1;

        /// Sets a line of a list menu and shows the list; a touch of the line is a key. Used by LCDList, not part of RoBIOS.
        /// line: from 0. key: the key of the line, such as KEY_LIST1. text: the line; NULL ends the list before it. fg: colour
        /// of the text. bg: background colour. Returns the number of lines that fit, 0 if there is no such line.
        fn LCDListLine(line: i32, key: i32, text: Text, fg: Color, bg: Color) -> i32 = 0;

        /// Reads the size of the display. x, y: set to columns and rows of pixels. Returns 0.
        fn LCDGetSize(x: Out<i32>, y: Out<i32>) -> i32 = 1;

        /// Draws one pixel; all drawing functions clip at the edges of the display. x: pixels to the right of the left edge. y:
        /// pixels below the upper edge. Returns 0.
        fn LCDPixel(x: i32, y: i32, col: Color) -> i32 = 1;

        /// Reads the colour of one pixel. x: pixels to the right of the left edge. y: pixels below the upper edge. Returns the
        /// colour; 0 outside of the display.
        fn LCDGetPixel(x: i32, y: i32) -> Color = 0;

        /// Draws a line with both ends. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper edge.
        /// Returns 0.
        fn LCDLine(x1: i32, y1: i32, x2: i32, y2: i32, col: Color) -> i32 = 1;

        /// Draws a rectangle between two corners. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper
        /// edge. fill: if not 0, filled; otherwise only its edge. Returns 0.
        fn LCDArea(x1: i32, y1: i32, x2: i32, y2: i32, col: Color, fill: i32) -> i32 = 1;

        /// Draws a circle. x1, y1: its centre, pixels to the right of the left edge and below the upper edge. size: its radius
        /// in pixels. fill: if not 0, filled; otherwise only its edge. Returns 0.
        fn LCDCircle(x1: i32, y1: i32, size: i32, col: Color, fill: i32) -> i32 = 1;

        /// Inverts one pixel. x: pixels to the right of the left edge. y: pixels below the upper edge. Returns 0.
        fn LCDPixelInvert(x: i32, y: i32) -> i32 = 1;

        /// Inverts the pixels of a line. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper edge.
        /// Returns 0.
        fn LCDLineInvert(x1: i32, y1: i32, x2: i32, y2: i32) -> i32 = 1;

        /// Inverts a filled rectangle. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper edge.
        /// Returns 0.
        fn LCDAreaInvert(x1: i32, y1: i32, x2: i32, y2: i32) -> i32 = 1;

        /// Inverts a filled circle. x1, y1: its centre, pixels to the right of the left edge and below the upper edge. size:
        /// its radius in pixels. Returns 0.
        fn LCDCircleInvert(x1: i32, y1: i32, size: i32) -> i32 = 1;

        /// Sets the size of the images that LCDImage and the like show. t: a resolution such as QVGA; CUSTOM: CAMWIDTH x
        /// CAMHEIGHT. Returns 0, 1 for another number.
        fn LCDImageSize(t: i32) -> i32 = 1, c "int LCDImageSize(int t)";

        /// Sets position and size of the images that LCDImage and the like show. x, y: upper left corner in pixels. xs,
        /// ys: columns and rows in pixels. Returns 0, 1 for a size below 1 or of more pixels than CAM5MP.
        fn LCDImageStart(x: i32, y: i32, xs: i32, ys: i32) -> i32 = 1, c "int LCDImageStart(int x, int y, int xs, int ys)";

        /// Shows a colour image of the size that LCDImageStart or LCDImageSize has set. img: 3 bytes per pixel: red, green, blue.
        /// Returns 0, 1 if img is NULL.
        fn LCDImage(width_px: i32, height_px: i32, img: Bytes) -> i32 = 1, c "int LCDImage(BYTE *img)";

        /// Shows a grey image. g: 1 byte per pixel, 0 is black. Returns 0, 1 if g is NULL.
        fn LCDImageGray(width_px: i32, height_px: i32, g: Bytes) -> i32 = 1, c "int LCDImageGray(BYTE *g)";

        /// Shows a binary image. b: 1 byte per pixel: 0 is white, everything else black. Returns 0, 1 if b is NULL.
        fn LCDImageBinary(width_px: i32, height_px: i32, b: Bytes) -> i32 = 1, c "int LCDImageBinary(BYTE *b)";

        /// Shows the drawings made while LCD_NOAUTOREFRESH is set. Returns 0.
        fn LCDRefresh() -> i32 = 1;
    }

    family KEY "the four keys, and touches of the display", source "RoBIOS-7 library, keys" {
        /// Waits for a key. Returns KEY1, KEY2, KEY3 or KEY4.
        fn KEYGet() -> i32 = 0;

        /// The key that was pressed, without waiting. Returns KEY1, KEY2, KEY3 or KEY4; NOKEY if none was.
        fn KEYRead() -> i32 = 0;

        /// Waits for one of the given keys and discards other keys. key: keys, or-ed, or ANYKEY. Returns the key,
        /// KEY_INVALID if there is no such key.
        fn KEYWait(key: i32) -> i32 = KEY_INVALID;

        /// Waits for a touch of the display. x, y: set to its position in pixels from the upper left corner; may be
        /// NULL. Returns 0.
        fn KEYGetXY(x: Out<i32>, y: Out<i32>) -> i32 = 1;

        /// The position of a touch of the display, without waiting. x, y: set to its position in pixels from the upper
        /// left corner; may be NULL. Returns 0 if there was one, otherwise 1.
        fn KEYReadXY(x: Out<i32>, y: Out<i32>) -> i32 = 1;
    }

    family CAM "the camera", source "RoBIOS-7 library, camera" {
        /// Switches the camera on. resolution: QQVGA to CAM5MP, or CUSTOM for CAMWIDTH x CAMHEIGHT. Returns 0, 1 if there is no
        /// camera or no such size.
        fn CAMInit(resolution: i32, width_px: i32, height_px: i32) -> i32 = 1, c "int CAMInit(int resolution)";

        /// Switches the camera off. Returns 0, 1 if there is no camera.
        fn CAMRelease() -> i32 = 1;

        /// Takes a colour image, row 0 at the top. buf: CAMSIZE bytes, 3 per pixel: red, green, blue. Returns 0, 1 if there
        /// is no camera.
        fn CAMGet(buf: OutBytes) -> i32 = 1, c "int CAMGet(BYTE *buf)";

        /// Takes a grey image, row 0 at the top. buf: CAMPIXELS bytes. Returns 0, 1 if there is no camera.
        fn CAMGetGray(buf: OutBytes) -> i32 = 1, c "int CAMGetGray(BYTE *buf)";
    }

    family IP "image processing", source "RoBIOS-7 library, image processing" {
        /// Sets the size of the images of all IP functions. resolution: QQVGA to CAM5MP; CUSTOM: what the program has written
        /// to IP_WIDTH and IP_HEIGHT. Returns 0, 1 for another number.
        fn IPSetSize(resolution: i32) -> i32 = 1, c "int IPSetSize(int resolution)";

        /// Reads a PNM file, P1 to P6, cropped or padded with black to the size of the images. Grey files become grey images,
        /// colour files colour images. filename: relative to the working folder, or to the scene. img: set to the image,
        /// IP_SIZE bytes at most. Returns the digit of P1 to P6, -1 if it cannot be read.
        fn IPReadFile(filename: Text, width_px: i32, height_px: i32, img: OutBytes) -> i32 = -1,
            c "int IPReadFile(const char *filename, BYTE *img)";

        /// Writes a colour image as PPM. filename: relative to the working folder. img: IP_SIZE bytes. Returns 0, 1 if it
        /// cannot be written.
        fn IPWriteFile(filename: Text, width_px: i32, height_px: i32, img: Bytes) -> i32 = 1,
            c "int IPWriteFile(const char *filename, BYTE *img)";

        /// Writes a grey image as PGM. filename: relative to the working folder. gray: IP_PIXELS bytes. Returns 0, 1 if it
        /// cannot be written.
        fn IPWriteFileGray(filename: Text, width_px: i32, height_px: i32, gray: Bytes) -> i32 = 1,
            c "int IPWriteFileGray(const char *filename, BYTE *gray)";

        /// Laplace edges of a grey image. grayIn: IP_PIXELS bytes. grayOut: set to IP_PIXELS bytes; may be the same buffer.
        fn IPLaplace(width_px: i32, height_px: i32, gray_in: Bytes, gray_out: OutBytes) -> () = (),
            c "void IPLaplace(BYTE *grayIn, BYTE *grayOut)";

        /// Sobel edges of a grey image. grayIn: IP_PIXELS bytes. grayOut: set to IP_PIXELS bytes; may be the same buffer.
        fn IPSobel(width_px: i32, height_px: i32, gray_in: Bytes, gray_out: OutBytes) -> () = (),
            c "void IPSobel(BYTE *grayIn, BYTE *grayOut)";

        /// Converts a colour image to grey. imgIn: IP_SIZE bytes. grayOut: set to IP_PIXELS bytes.
        fn IPCol2Gray(img_in: Bytes, gray_out: OutBytes) -> () = (), c "void IPCol2Gray(BYTE *imgIn, BYTE *grayOut)";

        /// Converts a grey image to a colour image. imgIn: IP_PIXELS bytes. colOut: set to IP_SIZE bytes.
        fn IPGray2Col(gray_in: Bytes, col_out: OutBytes) -> () = (), c "void IPGray2Col(BYTE *imgIn, BYTE *colOut)";

        /// Joins three channels to a colour image. r, g, b: IP_PIXELS bytes each. imgOut: set to IP_SIZE bytes.
        fn IPRGB2Col(r: Bytes, g: Bytes, b: Bytes, img_out: OutBytes) -> () = (),
            c "void IPRGB2Col(BYTE *r, BYTE *g, BYTE *b, BYTE *imgOut)";

        /// Splits a colour image into hue, saturation and intensity. img: IP_SIZE bytes. h, s, i: set to IP_PIXELS bytes each,
        /// 0 to 255.
        fn IPCol2HSI(img: Bytes, h: OutBytes, s: OutBytes, i: OutBytes) -> () = (),
            c "void IPCol2HSI(BYTE *img, BYTE *h, BYTE *s, BYTE *i)";

        /// Lays the second colour image over the first where the second is not black. c1, c2: IP_SIZE bytes each. cOut: set to
        /// IP_SIZE bytes.
        fn IPOverlay(c1: Bytes, c2: Bytes, c_out: OutBytes) -> () = (), c "void IPOverlay(BYTE *c1, BYTE *c2, BYTE *cOut)";

        /// Lays the second grey image over the first, in a colour, where the second is not 0. g1, g2: IP_PIXELS bytes each.
        /// cOut: set to IP_SIZE bytes.
        fn IPOverlayGray(g1: Bytes, g2: Bytes, col: Color, c_out: OutBytes) -> () = (),
            c "void IPOverlayGray(BYTE *g1, BYTE *g2, COLOR col, BYTE *cOut)";

        /// The colour of red, green and blue. r, g, b: 0 to 255. Returns the colour, 0xRRGGBB.
        fn IPPRGB2Col(r: u8, g: u8, b: u8) -> Color = 0;

        /// Splits a colour into red, green and blue. r, g, b: set to 0 to 255.
        fn IPPCol2RGB(col: Color, r: Out<u8>, g: Out<u8>, b: Out<u8>) -> () = ();

        /// Hue, saturation and intensity of a colour. h, s, i: set to 0 to 255.
        fn IPPCol2HSI(c: Color, h: Out<u8>, s: Out<u8>, i: Out<u8>) -> () = ();

        /// Hue of red, green and blue. r, g, b: 0 to 255. Returns 0 to 255; 0 for grey.
        fn IPPRGB2Hue(r: u8, g: u8, b: u8) -> u8 = 0;

        /// Hue, saturation and intensity of red, green and blue. r, g, b: 0 to 255. h, s, i: set to 0 to 255.
        fn IPPRGB2HSI(r: u8, g: u8, b: u8, h: Out<u8>, s: Out<u8>, i: Out<u8>) -> () = ();
    }

    family OS "the machine, time and timers", source "RoBIOS-7 library, system functions and timer" {
        /// Runs a shell command on the computer that runs the simulator, if allowed. command: the command. out: at least 4096
        /// bytes, set to its output as text. Returns 0, 1 if it is not allowed or has failed.
        fn OSExecute(command: Text, out: OutBytes) -> i32 = 1, c "int OSExecute(const char *command, char *out)";

        /// The version of RoBIOS as text. buf: at least 32 bytes, set to the text. Returns 0.
        fn OSVersion(buf: OutBytes) -> i32 = 1, c "int OSVersion(char *buf)";

        /// The version of the input and output board as text. buf: at least 32 bytes, set to the text. Returns 0.
        fn OSVersionIO(buf: OutBytes) -> i32 = 1, c "int OSVersionIO(char *buf)";

        /// The clock rate of the processor. Returns the rate in Hz.
        fn OSMachineSpeed() -> i32 = 700_000_000;

        /// The kind of machine. Returns VEHICLE, PLATFORM or WALKER.
        fn OSMachineType() -> i32 = VEHICLE;

        /// The name of the robot as text. buf: at least 32 bytes, set to the text. Returns 0.
        fn OSMachineName(buf: OutBytes) -> i32 = 1, c "int OSMachineName(char *buf)";

        /// The robot's number, unique in the scene; also its address on the radio. Returns the number, from 1.
        fn OSMachineID() -> i32 = 0;

        /// Shows an error, text and number, on the display and in the trace of the run. message: the text. number: the number
        /// shown after it. dead: if not 0, the robot stops here forever; otherwise the program waits for a key and continues.
        /// Returns 0.
        fn OSError(message: Text, number: i32, dead: i32) -> i32 = 1;

        /// Waits. n: milliseconds. Returns 0.
        fn OSWait(n: i32) -> i32 = 1;

        /// Calls a function periodically, inside the call in progress at that time. scale: period in milliseconds, at least 1.
        /// fct: the function; it must not wait. Returns the timer, 0 if there are too many timers.
        fn OSAttachTimer(scale: i32, fct: Callback) -> Timer = 0;

        /// Stops a timer. Returns 0, 1 if there is no timer with this number.
        fn OSDetachTimer(t: Timer) -> i32 = 1;

        /// Sets the robot's clock. hrs: 0 to 23. mins, secs: 0 to 59. Returns 0, 1 for an invalid time.
        fn OSSetTime(hrs: i32, mins: i32, secs: i32) -> i32 = 1;

        /// Reads the robot's clock; it starts at 0:00:00. hrs, mins, secs: set to hours, minutes and seconds. ticks: set to
        /// milliseconds. Returns 0.
        fn OSGetTime(hrs: Out<i32>, mins: Out<i32>, secs: Out<i32>, ticks: Out<i32>) -> i32 = 1;

        /// Shows the robot's clock on the display. Returns 0.
        fn OSShowTime() -> i32 = 1;

        /// Time since the robot's start. Returns milliseconds.
        fn OSGetCount() -> i32 = 0;
    }

    family SER "serial interfaces", source "RoBIOS-7 library, serial communication" {
        /// Opens an interface. interface: 1 to 16. baud: bits per second, 1 to 4000000. handshake: 0 none, 1 RTS/CTS.
        /// Returns 0, 1 for other values.
        fn SERInit(interface: i32, baud: i32, handshake: i32) -> i32 = 1;

        /// Sends a character. interface: 1 to 16. ch: the character. Returns 0, 1 if the interface is not open.
        fn SERSendChar(interface: i32, ch: Char) -> i32 = 1;

        /// Sends bytes. interface: 1 to 16. buf: the bytes. size: their number. Returns 0, 1 if the interface is not open.
        fn SERSend(interface: i32, buf: Bytes) -> i32 = 1, c "int SERSend(int interface, const char *buf, uint32_t size)";

        /// Waits for a character. interface: 1 to 16. Returns it, 0 if the interface is not open.
        fn SERReceiveChar(interface: i32) -> Char = 0;

        /// Reads the received bytes, without waiting. interface: 1 to 16. buf: at least 256 bytes, set to at most 255 bytes and
        /// a final 0. Returns their number, 0 if the interface is not open.
        fn SERReceive(interface: i32, buf: OutBytes) -> i32 = 0, c "int SERReceive(int interface, unsigned char *buf)";

        /// Checks whether bytes have been received. interface: 1 to 16. Returns 1 if they have, otherwise 0.
        fn SERCheck(interface: i32) -> Flag = 0;

        /// Discards received bytes. interface: 1 to 16. Returns 0, 1 if the interface is not open.
        fn SERFlush(interface: i32) -> i32 = 1;

        /// Closes an interface. interface: 1 to 16. Returns 0, 1 if it is not open.
        fn SERClose(interface: i32) -> i32 = 1;
    }

    family AU "sound", source "RoBIOS-7 library, audio" {
        /// Beeps. Returns 0.
        fn AUBeep() -> i32 = 1;

        /// Plays a sound; does not wait. sample: name of a WAV file, or a WAV file in memory. Returns 0, 1 if it is not a
        /// sound.
        fn AUPlay(sample: Bytes) -> i32 = 1, c "int AUPlay(const void *sample)";

        /// Checks whether the sound is over. Returns 1 if it is, otherwise 0.
        fn AUDone() -> i32 = 1;

        /// The current value of the microphone. Returns 0 to 255; 128 is silence.
        fn AUMicrophone() -> i32 = 128;

        /// Plays a tone; does not wait. freq_hz: frequency in Hz, 65 to 21000. time_ms: duration in milliseconds. Returns 0, 1
        /// for a frequency that cannot be played.
        fn AUTone(freq_hz: i32, time_ms: i32) -> i32 = 1;

        /// Checks whether the tone is over. Returns 1 if it is, otherwise 0.
        fn AUCheckTone() -> i32 = 1;

        /// Checks whether the sound is over. Returns 1 if it is, otherwise 0.
        fn AUCheckPlay() -> i32 = 1;

        /// Records the microphone into memory; does not wait. buf: set to time * freq / 1000 bytes, 0 to 255 each.
        /// time: duration in milliseconds. freq: values per second, at most 44100 Hz. Returns 0, 1 if buf is too small
        /// or freq is invalid.
        fn AURecord(buf: OutBytes, freq_hz: i64) -> i32 = 1, c "int AURecord(BYTE *buf, int time, long freq)";

        /// Checks whether the recording is over. Returns 1 if it is, otherwise 0.
        fn AUCheckRecord() -> i32 = 1;
    }

    family PSD "distance sensors", source "RoBIOS-7 library, distance sensors" {
        /// Measures the current distance of a sensor. psd: number of the sensor, such as PSD_FRONT. Returns millimetres; 9999
        /// if out of range, 0 if there is no such sensor.
        fn PSDGet(psd: i32) -> i32 = 0;

        /// Measures the current raw value of a sensor. psd: number of the sensor, such as PSD_FRONT. Returns 0 to 255; 0 if
        /// nothing is in range or there is no such sensor.
        fn PSDGetRaw(psd: i32) -> i32 = 0;
    }

    family LIDAR "the laser scanner", source "RoBIOS-7 library, LIDAR" {
        /// Scans once with the laser scanner, from left to right; the middle point (of n, that of index n/2) is straight
        /// ahead. distance: set to as many distances in millimetres as LIDARSet has set, initially as many as the
        /// robi states; 9999 if out of range.
        /// Returns 0, 1 if there is no scanner.
        fn LIDARGet(distance: OutInts) -> i32 = 1, c "int LIDARGet(int distance[])";

        /// Sets up the laser scanner. range: angle of the scan in degrees, 1 to 360. tilt: tilt of the scanner in degrees, -90
        /// to 90. points: number of points, 1 to 65536.
        fn LIDARSet(range: i32, tilt: i32, points: i32) -> () = (), c "void LIDARSet(int range, int tilt, int points)";
    }

    family SERVO "servos", source "RoBIOS-7 library, servos and motors" {
        /// Turns a servo. servo: 1 to 14. angle: position, 0 to 255. Returns 0, 1 if there is no such servo or position.
        fn SERVOSet(servo: i32, angle: i32) -> i32 = 1;

        /// Sets the raw position of a servo, ignoring its range. servo: 1 to 14. angle: raw position, 0 to 255. Returns 0, 1 if
        /// there is no such servo or position.
        fn SERVOSetRaw(servo: i32, angle: i32) -> i32 = 1;

        /// Sets the raw positions of a servo for 0 and 255. servo: 1 to 14. low, high: raw positions, 0 to 255. Returns 0, 1 if
        /// there is no such servo or position.
        fn SERVORange(servo: i32, low: i32, high: i32) -> i32 = 1;
    }

    family MOTOR "motors", source "RoBIOS-7 library, servos and motors" {
        /// Drives a motor. motor: 1 to 4. speed: -100 to 100 percent. Returns 0, 1 if there is no such motor.
        fn MOTORDrive(motor: i32, speed: i32) -> i32 = 1;

        /// Drives a motor with a raw value. motor: 1 to 4. speed: -127 to 127. Returns 0, 1 if there is no such motor.
        fn MOTORDriveRaw(motor: i32, speed: i32) -> i32 = 1;

        /// Sets the controller of a motor. motor: 1 to 4. p, i, d: gains, 0 to 255 each. Returns 0, 1 if there is no such
        /// motor.
        fn MOTORPID(motor: i32, p: i32, i: i32, d: i32) -> i32 = 1;

        /// Stops a motor's controller. motor: 1 to 4. Returns 0, 1 if there is no such motor.
        fn MOTORPIDOff(motor: i32) -> i32 = 1;

        /// Drives a motor with the speed of its encoder. motor: 1 to 4. ticks: encoder counts per second. Returns 0, 1
        /// if there is no such motor.
        fn MOTORSpeed(motor: i32, ticks: i32) -> i32 = 1;
    }

    family ENCODER "encoders", source "RoBIOS-7 library, servos and motors" {
        /// Reads an encoder. quad: 1 to 4. Returns counts since its reset; 0 if there is no such encoder.
        fn ENCODERRead(quad: i32) -> i32 = 0;

        /// Sets an encoder to 0. quad: 1 to 4. Returns 0, 1 if there is no such encoder.
        fn ENCODERReset(quad: i32) -> i32 = 1;
    }

    family VW "driving", source "RoBIOS-7 library, V-Omega driving" {
        /// Drives with a speed and a turning speed, until the next command. linSpeed: mm/s. angSpeed: degrees/s, positive = to
        /// the left. Returns 0, 1 on failure.
        fn VWSetSpeed(linSpeed: i32, angSpeed: i32) -> i32 = 1;

        /// Reads the speeds by odometry. linSpeed: set to mm/s. angSpeed: set to degrees/s, positive = to the left. Returns 0,
        /// 1 on failure.
        fn VWGetSpeed(linSpeed: Out<i32>, angSpeed: Out<i32>) -> i32 = 1;

        /// Sets the position by odometry; the robot does not move. x, y: mm. phi: degrees, counter-clockwise. Returns 0, 1 on
        /// failure.
        fn VWSetPosition(x: i32, y: i32, phi: i32) -> i32 = 1;

        /// Reads the position by odometry. x, y: set to mm. phi: set to degrees from -180 to 180, counter-clockwise. Returns 0,
        /// 1 on failure.
        fn VWGetPosition(x: Out<i32>, y: Out<i32>, phi: Out<i32>) -> i32 = 1;

        /// Starts to drive straight; does not wait. dist: mm, negative = backwards. lin_speed: mm/s; its sign is ignored.
        /// Returns 0, 1 on failure.
        fn VWStraight(dist: i32, lin_speed: i32) -> i32 = 1;

        /// Starts to turn on the spot; does not wait. angle: degrees, positive = to the left. ang_speed: degrees/s; its sign
        /// is ignored. Returns 0, 1 on failure.
        fn VWTurn(angle: i32, ang_speed: i32) -> i32 = 1;

        /// Starts to drive in an arc; does not wait. dist: length of the arc in mm, negative = backwards. angle: change of
        /// heading in degrees, positive = to the left. lin_speed: mm/s; its sign is ignored. Returns 0, 1 on failure.
        fn VWCurve(dist: i32, angle: i32, lin_speed: i32) -> i32 = 1;

        /// Starts to drive in an arc to a point; does not wait. dx: mm ahead. dy: mm to the left. lin_speed: mm/s; its sign
        /// is ignored. Returns 0, 1 on failure.
        fn VWDrive(dx: i32, dy: i32, lin_speed: i32) -> i32 = 1;

        /// Remainder of the drive. Returns mm, for a turn degrees; 0 when it is done.
        fn VWRemain() -> i32 = 0;

        /// Checks whether the drive is done. Returns 1 when it is done or there was none, 0 while it is in progress, -1 on failure.
        fn VWDone() -> i32 = -1;

        /// Waits for the drive's end. Returns 0, -1 on failure.
        fn VWWait() -> i32 = -1;

        /// Determines which wheels are stalled. Returns 0 for none, 1 for the left, 2 for the right, 3 for both.
        fn VWStalled() -> i32 = 0;

        /// Starts the controllers of speed and turning speed; typical: 70, 30, 70, 10. Vv: gain for the speed, in tenths. Tv:
        /// time for the speed, in hundredths of a second. Vw: gain for the turning speed, in tenths. Tw: time for the turning
        /// speed, in hundredths of a second. Returns 0, 1 on failure.
        fn VWControl(Vv: i32, Tv: i32, Vw: i32, Tw: i32) -> i32 = 1;

        /// Stops the controllers. Returns 0, 1 on failure.
        fn VWControlOff() -> i32 = 1;
    }

    family DIGITAL "digital inputs and outputs", source "RoBIOS-7 library, digital and analog I/O" {
        /// Sets the direction of a line. io: 1 to 16. direction: 'i' in, 'o' out, 'I' in with pull-up, 'J' in with
        /// pull-down. Returns 0, 1 for other values.
        fn DIGITALSetup(io: i32, direction: Char) -> i32 = 1;

        /// Reads a line. io: 1 to 16. Returns 0 or 1; -1 if there is no such line.
        fn DIGITALRead(io: i32) -> i32 = -1;

        /// Reads all lines. Returns their states, line 1 in the lowest bit.
        fn DIGITALReadAll() -> i32 = 0;

        /// Sets an output. io: 1 to 16. state: 0 or 1. Returns 0, 1 if there is no such line or it is not an output.
        fn DIGITALWrite(io: i32, state: i32) -> i32 = 1;
    }

    family ANALOG "analog inputs", source "RoBIOS-7 library, digital and analog I/O" {
        /// Reads an analog input. channel: 0 to 8. Returns 0 to 1023; -1 if there is no such channel.
        fn ANALOGRead(channel: i32) -> i32 = -1;

        /// The voltage of the battery. Returns hundredths of a volt.
        fn ANALOGVoltage() -> i32 = 0;

        /// Starts to record a channel at 1 kHz; does not wait. channel: 0 to 8. iterations: number of values, 1 to 1048576.
        /// Returns 0, 1 if there is no such channel or a recording is in progress.
        fn ANALOGRecord(channel: i32, iterations: i32) -> i32 = 1;

        /// Moves the whole recording to a buffer. buffer: one byte per value, the upper 8 bits. Returns the number of bytes, 0
        /// while the recording is in progress.
        fn ANALOGTransfer(buffer: OutBytes) -> i32 = 0, c "int ANALOGTransfer(BYTE *buffer)";
    }

    family IRTV "the remote control", source "RoBIOS-7 library, IR remote control" {
        /// Waits for a key of the remote control. Returns its code.
        fn IRTVGet() -> i32 = 0;

        /// A key of the remote control that was pressed, without waiting. Returns its code, 0 if none was.
        fn IRTVRead() -> i32 = 0;

        /// Discards the keys that were pressed. Returns 0.
        fn IRTVFlush() -> i32 = 1;

        /// Checks whether there is a receiver. Returns 1 if there is one, otherwise 0.
        fn IRTVGetStatus() -> i32 = 0;
    }

    family RADIO "messages between robots", source "RoBIOS-7 library, radio communication" {
        /// Switches the radio on. Returns 0, 1 if it is on already.
        fn RADIOInit() -> i32 = 1;

        /// The robot's address. Returns its number.
        fn RADIOGetID() -> i32 = 0;

        /// Sends text, without waiting for the transmission and without acknowledgement. id: the receiver, 0 for all robots.
        /// buf: text of up to 1023 bytes. Returns 0, or 1 if the radio is off, buf is NULL or too long, id is negative, or 1024
        /// bytes wait to be sent already.
        fn RADIOSend(id: i32, buf: Text) -> i32 = 1;

        /// Waits for a message, which may be damaged: there is no checksum. id: set to the address of its sender; may be NULL.
        /// buf: set to the text up to its first 0, cut to fit, and a final 0. size: capacity of buf. Returns 0, or 1 immediately if
        /// the radio is off, buf is NULL or has no room.
        fn RADIOReceive(id: Out<i32>, buf: OutBytes) -> i32 = 1, c "int RADIOReceive(int *id, char *buf, int size)";

        /// Counts the messages that wait. Returns their number; 0 if the radio is off.
        fn RADIOCheck() -> i32 = 0, c "int RADIOCheck(EYESIM_ANY)";

        /// Lists the robots whose radios are on, including this one. IDlist: room for 256 numbers, set to their addresses in
        /// order of the robots. In the slot of RADIOInit it waits for the end of the slot; in a timer's function it does not
        /// wait, and may list only this robot. Returns their number, 0 if the radio of this robot is off or IDlist is NULL.
        fn RADIOStatus(IDlist: OutInts) -> i32 = 0, c "int RADIOStatus(int IDlist[])";

        /// Switches the radio off: messages that wait or are in transit are lost. Returns 0, 1 if it is off.
        fn RADIORelease() -> i32 = 1;
    }

    family SIM "ground truth, in simulation only", source "EyeSim VR, simulation functions" {
        /// True pose of a robot. id: the robot's number; 0 is this one. x, y, z: set to mm. phi: set to degrees,
        /// counter-clockwise.
        fn SIMGetRobot(id: i32, x: Out<i32>, y: Out<i32>, z: Out<i32>, phi: Out<i32>) -> () = ();

        /// Moves a robot to a pose. id: the robot's number; 0 is this one. x, y, z: mm. phi: degrees, counter-clockwise.
        fn SIMSetRobot(id: i32, x: i32, y: i32, z: i32, phi: i32) -> () = ();

        /// True pose of an object. id: objects are numbered after the robots. x, y, z: set to mm. phi: set to degrees,
        /// counter-clockwise.
        fn SIMGetObject(id: i32, x: Out<i32>, y: Out<i32>, z: Out<i32>, phi: Out<i32>) -> () = ();

        /// Moves an object to a pose. id: objects are numbered after the robots. x, y, z: mm. phi: degrees, counter-clockwise.
        fn SIMSetObject(id: i32, x: i32, y: i32, z: i32, phi: i32) -> () = ();

        /// Counts the robots. Returns their number.
        fn SIMGetRobotCount() -> i32 = 0;

        /// Counts the objects. Returns their number.
        fn SIMGetObjectCount() -> i32 = 0;
    }
    family RANGE "range sensors beyond RoBIOS", source "our choice: RoBIOS has none" {
        /// Signal underlying the distance of a sensor: that of a reflectance sensor, in 1/m; the echo energy of a sonar, 1 for
        /// a perfect reflector 1 m ahead; for other sensors 1 with an echo, 0 without. psd: number of the sensor. Returns the
        /// signal, -1 if there is no such sensor.
        fn PSDGetSignal(psd: i32) -> f32 = -1.0;
    }
    family TRUTH "what the camera's last image shows, in simulation only", source "our choice: RoBIOS has none" {
        /// Depth of each pixel of the last image: distance along the line of sight, in mm, without noise; INFINITY for the sky.
        /// mm: CAMPIXELS numbers, row 0 at the top. Returns 0, 1 if mm is 0 or no image has been taken.
        fn CAMGetDepth(mm: OutFloats) -> i32 = 1, c "int CAMGetDepth(float *mm)";

        /// Label of each pixel of the last image: CAM_SKY, CAM_FLOOR, CAM_WALL, or CAM_BODY + n for robot or object n, numbered as in
        /// SIMGetRobot and SIMGetObject: robots from 1, then the objects.
        /// labels: CAMPIXELS numbers, row 0 at the top. Returns 0, 1 if labels is 0 or no image has been taken.
        fn CAMGetLabels(labels: OutInts) -> i32 = 1, c "int CAMGetLabels(int *labels)";
    }
    family LEG "legs", source "our choice: RoBIOS has none" {
        /// The number of legs. Legs, joints, links and gaits are numbered from 1, in the order of the robi file. Returns the
        /// number; 0 if the robot has no legs.
        fn LEGCount() -> i32 = 0;

        /// Switches to another gait; each leg changes when it is next lifted.
        /// gait: from 1. Returns 0, -1 if there are no legs or no such gait.
        fn LEGSetGait(gait: i32) -> i32 = -1;

        /// Walks at this speed until the next command, sideways too; 0, 0, 0 stops. A twist beyond the capability of the legs
        /// is scaled down as a whole. vx_mmps: mm/s forward. vy_mmps: mm/s to the left. omega_degps: degrees/s
        /// counter-clockwise. Returns 0, -1 if there are no legs.
        fn LEGSetSpeed(vx_mmps: i32, vy_mmps: i32, omega_degps: i32) -> i32 = -1;

        /// Sets the height to which feet are lifted; each leg applies it from its next step on.
        /// height_mm: 0 or more. Returns 0, -1 if there are no legs or the height is negative or beyond the legs.
        fn LEGSetStep(height_mm: i32) -> i32 = -1;

        /// Current angle of a joint from its encoder, without noise. leg: from 1. joint: from 1 at the body. degrees: positive
        /// as in the robi file: yaw to the left, roll, thigh forward, knee bent, toes up. Returns 0, -1 if there is no such leg
        /// or joint or degrees is 0.
        fn LEGGetJoint(leg: i32, joint: i32, degrees: Out<f32>) -> i32 = -1;

        /// Current pose of a link of a leg in the frame of the body, computed from the joint angles. leg: from 1. link: from 1,
        /// the thigh. pose: set to 6 numbers: x forward, y left, z up, in mm; roll, pitch, yaw in degrees. Returns 0, -1 if
        /// there is no such leg or link or pose is 0.
        fn LEGGetLink(leg: i32, link: i32, pose: OutFloats) -> i32 = -1, c "int LEGGetLink(int leg, int link, float pose[6])";

        /// Current height of the body frame above the world's floor, computed from the legs: 0 upright on the floor. mm: set to
        /// millimetres up. Returns 0, -1 if there are no legs or mm is 0.
        fn LEGGetHeight(mm: Out<f32>) -> i32 = -1;

        /// Checks whether a foot is on the ground. leg: from 1. Returns 1 if it is, 0 if it is in the air, -1 if there is no such
        /// leg.
        fn LEGGetFoot(leg: i32) -> i32 = -1;

        /// Corrects the steps of a leg, from the next instant at which its foot is in the air until the next correction. leg:
        /// from 1. dx_mm: mm forward of the foothold of the gait. dy_mm: mm to the left of the foothold of the gait. dz_mm:
        /// additional lift of the foot, mm. Returns 0, -1 if there is no such leg or the foothold is out of its reach.
        fn LEGCorrect(leg: i32, dx_mm: i32, dy_mm: i32, dz_mm: i32) -> i32 = -1;
    }
    family OLDER "functions of older libraries", source "eye.py of EyeSim X" {
        /// Last position set for a servo. servo: 1 to 14. Returns 0 to 255, initially the middle; -1 if there is no such servo.
        fn SERVOGet(servo: i32) -> i32 = -1;
    }
}
