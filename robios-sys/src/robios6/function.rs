//! The list of RoBIOS 6 functions, from which table, trait, thunks, C header and C shim come.
//!
//! The doc of a function goes to rustdoc and to `eyebot.h`; names of parameters carry their unit.

use super::*;
use crate::param::{Bytes, Callback, In, InOut, Out, OutBytes, OutFloats, OutInts, Text};
use crate::table::function_table;

function_table! {
    /// The RoBIOS 6 functions as a program's library gets them.
    table Robios6Table, trait Robios6, call Robios6Call, number 6, version 1;

    family OS "the machine, its errors and variables", source "RoBIOS 6 library, system functions" {
        /// The version of RoBIOS as text. In C the text stays valid and unchanged until the program ends; it may not be written
        /// to. Returns the text, such as `6.5`.
        fn OSVersion(text: OutBytes) -> i32 = 0, c "char *OSVersion(void)";

        /// Shows an error, text and number, on the LCD and in the trace of the run. message: the text. number: the number
        /// shown after it. dead: if not 0, the robot stops here forever; otherwise the program waits for a key and continues.
        /// Returns 0.
        fn OSError(message: Text, number: i32, dead: Bool) -> i32 = -1;

        /// The kind of machine. Returns VEHICLE, PLATFORM or WALKER.
        fn OSMachineType() -> i32 = VEHICLE;

        /// The clock rate of the processor. Returns the rate in Hz.
        fn OSMachineSpeed() -> i32 = 25_000_000;

        /// The name of the robot as text. In C the text stays valid and unchanged until the program ends; it may not be written
        /// to. Returns the text.
        fn OSMachineName(text: OutBytes) -> i32 = 0, c "char *OSMachineName(void)";

        /// The robot's number, unique in the scene; also its address on the radio. Returns 1 to 255.
        fn OSMachineID() -> u8 = 0;

        /// Enables interrupts again: timers run. Returns 0.
        fn OSEnable() -> i32 = -1;

        /// Disables interrupts: timers do not run until OSEnable. Returns 0.
        fn OSDisable() -> i32 = -1;

        /// Value of a system variable; 0 if it was never set.
        /// num: its number, 0 to 15. Returns the value, 0 for another num.
        fn OSGetVar(num: i32) -> i32 = 0;

        /// Sets a system variable of this robot. num: its number, 0 to 15. value: any number. Returns 0, or -1 for another num.
        fn OSPutVar(num: i32, value: i32) -> i32 = -1;
    }

    family HDT "the table of the robot's devices", source "RoBIOS 6 library, hardware description table; layout of an entry: our choice" {
        /// Checks the device table. Returns 0 if it is valid.
        fn HDT_Validate() -> i32 = -1;

        /// Searches for a device.
        /// type_id: HDT_MOTOR and so on, 0 for any. semantics: MOTOR_LEFT and so on.
        /// Returns a pointer to an HDT_entry_type that stays valid until the next call, or 0 if there is no such
        /// device.
        fn HDT_FindEntry(type_id: TypeID, semantics: DeviceSemantics, entry: Out<HDTEntry>) -> i32 = 0,
            c "void *HDT_FindEntry(TypeID type_id, DeviceSemantics semantics)";

        /// Finds the n-th device of a kind, to iterate over all of them.
        /// type_id: HDT_MOTOR and so on. index: 0 for the first one. entry: set to the device.
        /// Returns 0, or -1 if there are fewer devices or a pointer is 0.
        fn HDT_FindTable(type_id: TypeID, index: i32, entry: Out<HDTEntry>) -> i32 = -1;

        /// Number of devices of a kind.
        /// type_id: HDT_MOTOR and so on. Returns the number, 0 for an unknown kind.
        fn HDT_TypeCount(type_id: TypeID) -> i32 = 0;
    }

    family LCD "the display: 128 x 64 pixels, 7 lines of 16 characters, the last one for the menu", source "RoBIOS 6 library, LCD output" {
        /// Prints formatted text at the cursor, as printf does; \n starts a new line. format: as of printf, with the
        /// values after it. Returns 0, or -1 if format is 0.
        fn LCDPrintf(text: Text) -> i32 = -1, c "int LCDPrintf(const char *format, ...)";

        /// Prints formatted text at a position, as printf does; the cursor stays after it. row: 0 (top) to 6. column: 0 (left) to
        /// 15. format: as of printf, with the values after it. Returns 0, or -1 if format is 0 or the position is not on the LCD.
        fn LCDSetPrintf(row: i32, column: i32, text: Text) -> i32 = -1,
            c "int LCDSetPrintf(int row, int column, const char *format, ...)";

        /// Clears the LCD and moves the cursor to the top left; the menu is cleared too. Returns 0.
        fn LCDClear() -> i32 = -1;

        /// Writes a character at the cursor, which moves on. c: the character. Returns 0.
        fn LCDPutChar(c: Char) -> i32 = -1;

        /// Writes a character at a position; the cursor stays after it. row: 0 (top) to 6. column: 0 (left) to 15. c: the
        /// character. Returns 0, or -1 if the position is not on the LCD.
        fn LCDSetChar(row: i32, column: i32, c: Char) -> i32 = -1;

        /// Writes text at the cursor, which moves on; \n starts a new line. s: the text. Returns 0, or -1 if s is 0.
        fn LCDPutString(s: Text) -> i32 = -1;

        /// Writes text at a position; the cursor stays after it. row: 0 (top) to 6. column: 0 (left) to 15. s: the text. Returns
        /// 0, or -1 if s is 0 or the position is not on the LCD.
        fn LCDSetString(row: i32, column: i32, s: Text) -> i32 = -1;

        /// Writes a number in hexadecimal, 8 digits. v: the number. Returns 0.
        fn LCDPutHex(v: i32) -> i32 = -1;

        /// Writes the lowest byte of a number in hexadecimal, 2 digits. v: the number. Returns 0.
        fn LCDPutHex1(v: i32) -> i32 = -1;

        /// Writes a number in decimal. v: the number. Returns 0.
        fn LCDPutInt(v: i32) -> i32 = -1;

        /// Writes a number in decimal, right-aligned. v: the number. spaces: minimum number of characters. Returns 0.
        fn LCDPutIntS(v: i32, spaces: i32) -> i32 = -1;

        /// Writes a number with its decimals, as %f of printf. v: the number. Returns 0.
        fn LCDPutFloat(v: f32) -> i32 = -1;

        /// Writes a number with its decimals, right-aligned. v: the number. spaces: minimum number of characters. decimals:
        /// digits after the point. Returns 0.
        fn LCDPutFloatS(v: f32, spaces: i32, decimals: i32) -> i32 = -1;

        /// Sets the text mode.
        /// mode: SCROLLING or NONSCROLLING, and CURSOR or NOCURSOR, OR-ed. Returns 0.
        fn LCDMode(mode: i32) -> i32 = -1;

        /// Moves the cursor.
        /// row: 0 (top) to 6. column: 0 (left) to 15. Returns 0, or -1 if the position is not on the LCD.
        fn LCDSetPos(row: i32, column: i32) -> i32 = -1;

        /// Reads the position of the cursor. row: set to 0 (top) to 6. column: set to 0 (left) to 15. Returns 0, or -1 if a
        /// pointer is 0.
        fn LCDGetPos(row: Out<i32>, column: Out<i32>) -> i32 = -1;

        /// Shows the upper 54 rows of a grey image at the left of the LCD, so that the menu stays visible.
        /// Returns 0, or -1 if buf is 0.
        fn LCDPutGraphic(buf: In<Image>) -> i32 = -1;

        /// Shows the upper 54 rows of a colour image in black and white, like LCDPutGraphic. buf: colour image of 82 x 62 x
        /// 3 bytes; overwritten with the black and white image. Returns 0, or -1 if buf is 0.
        fn LCDPutColorGraphic(buf: InOut<ColImage>) -> i32 = -1;

        /// Sets all 128 x 64 pixels.
        /// buf: 1024 bytes, 16 per row, the left pixel in the highest bit, 1 is black. Returns 0, or -1 if buf is 0.
        fn LCDPutImage(buf: In<BitImage>) -> i32 = -1;

        /// Writes the texts of the menu, above the keys. s1, s2, s3, s4: at most 4 characters each; "" (or 0) leaves an entry
        /// as it is, " " clears it. Returns 0.
        fn LCDMenu(s1: Text, s2: Text, s3: Text, s4: Text) -> i32 = -1;

        /// Writes one text of the menu.
        /// pos: 1 (left) to 4. s: at most 4 characters. Returns 0, or -1 for another pos or if s is 0.
        fn LCDMenuI(pos: i32, s: Text) -> i32 = -1;

        /// Sets a pixel.
        /// row: 0 (top) to 63. col: 0 (left) to 127. val: 0 clear, 1 set, 2 invert.
        /// Returns 0, or -1 if it is not on the LCD or for another val.
        fn LCDSetPixel(row: i32, col: i32, val: i32) -> i32 = -1;

        /// Inverts a pixel.
        /// row: 0 (top) to 63. col: 0 (left) to 127. Returns 0, or -1 if it is not on the LCD.
        fn LCDInvertPixel(row: i32, col: i32) -> i32 = -1;

        /// Reads a pixel. row: 0 (top) to 63. col: 0 (left) to 127. Returns 0 clear, 1 set, -1 if it is not on the LCD.
        fn LCDGetPixel(row: i32, col: i32) -> i32 = -1;

        /// Draws a line between two pixels, both included; parts outside of the LCD are clipped. x1, x2: 0 (left) to 127. y1,
        /// y2: 0 (top) to 63. col: 0 white, 1 black, 2 inverted. Returns 0, or -1 for another col.
        fn LCDLine(x1: i32, y1: i32, x2: i32, y2: i32, col: i32) -> i32 = -1;

        /// Fills a rectangle, all edges included; parts outside of the LCD are clipped. x1, x2: 0 (left) to 127, x1 < x2. y1,
        /// y2: 0 (top) to 63, y1 < y2. col: 0 white, 1 black, 2 inverted. Returns 0, or -1 for another col or corners in
        /// another order.
        fn LCDArea(x1: i32, y1: i32, x2: i32, y2: i32, col: i32) -> i32 = -1;
    }

    family KEY "the four keys under the LCD", source "RoBIOS 6 library, key input" {
        /// Waits for a key and stores its code. buf: set to KEY1 to KEY4. Returns 0, or -1 immediately if buf is 0.
        fn KEYGetBuf(buf: Out<Char>) -> i32 = -1;

        /// Waits for a key. Returns its code, KEY1 to KEY4.
        fn KEYGet() -> i32 = 0;

        /// The key that is pressed and has not been read yet, without waiting. Returns its code, 0 if there is none.
        fn KEYRead() -> i32 = 0;

        /// Waits for a certain key; other keys are discarded.
        /// excode: KEY1 to KEY4, several OR-ed, or ANYKEY. Returns 0, or -1 immediately for another excode.
        fn KEYWait(excode: i32) -> i32 = -1;
    }

    family CAM "the camera", source "RoBIOS 6 library, camera" {
        /// Starts the camera.
        /// mode: NORMAL, WIDE or TELE. Returns the camera's version (COLCAM or more: colour); 200 and more are
        /// failures: INITERROR, and NOCAM if there is none.
        fn CAMInit(mode: i32) -> i32 = NOCAM;

        /// Stops the camera. Returns 0, or -1 if it was not started.
        fn CAMRelease() -> i32 = -1;

        /// Takes a grey image and waits for it. Returns 0, or -1 if there is no camera or buf is 0.
        fn CAMGetFrame(buf: Out<Image>) -> i32 = -1;

        /// Takes a colour image and waits for it.
        /// convert: 0 leaves red, green, blue; 1 converts it to 8-bit grey, of which only an `image` is written.
        /// Returns 0, or -1 if there is no colour camera or buf is 0.
        fn CAMGetColFrame(buf: Out<ColImage>, convert: i32) -> i32 = -1,
            c "int CAMGetColFrame(colimage *buf, int convert)";

        /// Takes a grey image without border: 60 rows of 80 bytes. Returns 0, or -1 if there is no camera or buf is 0.
        fn CAMGetFrameMono(buf: Out<MonoFrame>) -> i32 = -1;

        /// Takes a colour image without border: 60 rows of 80 times red, green, blue.
        /// Returns 0, or -1 if there is no camera or buf is 0.
        fn CAMGetFrameColor(buf: Out<ColorFrame>) -> i32 = -1;

        /// Takes a colour image without border, as CAMGetFrameColor. Returns 0, or -1 if there is no camera or buf is 0.
        fn CAMGetFrameRGB(buf: Out<ColorFrame>) -> i32 = -1;

        /// Takes the camera's raw values: 120 rows of 160 bytes, through its colour filter.
        /// Returns 0, or -1 if there is no camera or buf is 0.
        fn CAMGetFrameBayer(buf: Out<BayerFrame>) -> i32 = -1;

        /// Sets the levels or the frame rate of the camera. p1: brightness, 0 to 255; of an EyeCam the frame rate, FPS60 to
        /// FPS0_46875, with p2 and p3 0. p2: hue of colour images, offset of grey ones, 0 to 255. p3: saturation of colour
        /// images, contrast of grey ones, 0 to 255. Returns 0, or -1 if there is no camera.
        fn CAMSet(p1: i32, p2: i32, p3: i32) -> i32 = -1;

        /// Reads the values set by CAMSet. p1, p2, p3: set to these values. Returns 0, or -1 if there is no camera or a pointer
        /// is 0.
        fn CAMGet(p1: Out<i32>, p2: Out<i32>, p3: Out<i32>) -> i32 = -1;

        /// Switches automatic brightness on or off.
        /// mode: AUTOBRIGHTNESS or NOAUTOBRIGHTNESS. Returns 0, or -1 if there is no camera.
        fn CAMMode(mode: i32) -> i32 = -1;
    }

    family IP "image processing on images of 82 x 62 with a border of 1 pixel", source "RoBIOS 6 library, image processing" {
        /// Laplace operator. src and dest may be the same. Returns 0, or -1 if a pointer is 0.
        fn IPLaplace(src: In<Image>, dest: Out<Image>) -> i32 = -1;

        /// Sobel operator. src and dest may be the same. Returns 0, or -1 if a pointer is 0.
        fn IPSobel(src: In<Image>, dest: Out<Image>) -> i32 = -1;

        /// Converts grey to black and white with a pattern of 2 x 2. Returns 0, or -1 if a pointer is 0.
        fn IPDither(src: In<Image>, dest: Out<Image>) -> i32 = -1;

        /// Absolute difference of two images. Returns 0, or -1 if a pointer is 0.
        fn IPDiffer(current: In<Image>, last: In<Image>, dest: Out<Image>) -> i32 = -1;

        /// Converts colour to grey. Returns 0, or -1 if a pointer is 0.
        fn IPColor2Grey(src: In<ColImage>, dest: Out<Image>) -> i32 = -1;
    }

    family MT "multi-tasking", source "RoBIOS 6 library, multi-tasking" {
        /// Starts multi-tasking; the program becomes the first task, of priority IDLE_PRI.
        /// mode: COOP (or DEFAULT): tasks switch only when one yields or waits. PREEMPT: after OSPermit also every
        /// 10 ms and when one of higher priority is ready. Returns 0, or -1 for another mode or if it was started before.
        fn OSMTInit(mode: Byte) -> i32 = -1, c "int OSMTInit(BYTE mode)";

        /// Creates a task, which is not ready yet: see OSReady. It ends when its function returns.
        /// name: shown in messages; may be 0. code: its function. stksiz: bytes of stack, 0 to 4194304; it gets at
        /// least 8 MiB. pri: MIN_PRI to MAX_PRI. uid: a number for OSGetUID.
        /// Returns the task, valid until the program ends; 0 before OSMTInit, for a wrong argument, or with 256 tasks.
        fn OSSpawn(name: Text, code: Callback, stksiz: i32, pri: i32, uid: i32) -> i32 = 0,
            c "struct tcb *OSSpawn(const char *name, void (*code)(void), int stksiz, int pri, int uid)";

        /// The mode of multi-tasking. Returns COOP, PREEMPT, or NOTASK if it was not started.
        fn OSMTStatus() -> i32 = NOTASK;

        /// Makes a task that is new or suspended ready to run, the last among those of its priority.
        /// thread: 0 is the current one. Returns 0, or -1 without multi-tasking or if the task has ended.
        fn OSReady(thread: Task) -> i32 = -1;

        /// Suspends a task until it is made ready.
        /// thread: 0 is the current one. Returns 0, or -1 without multi-tasking or if the task has ended.
        fn OSSuspend(thread: Task) -> i32 = -1;

        /// Lets the next ready task of the same or a higher priority run. Returns 0, or -1 without multi-tasking.
        fn OSReschedule() -> i32 = -1;

        /// Suspends the current task until it is made ready. Returns 0, or -1 without multi-tasking.
        fn OSYield() -> i32 = -1;

        /// Makes a task ready as OSReady does, then lets the next one run as OSReschedule does.
        /// Returns 0, or -1 without multi-tasking or if the task has ended.
        fn OSRun(thread: Task) -> i32 = -1;

        /// The number that a task was created with.
        /// thread: 0 is the current one. Returns the number; 0 for the first task, or if the task has ended.
        fn OSGetUID(thread: Task) -> i32 = 0;

        /// Ends a task immediately; its destructors run. Ending the first task ends the program. thread: 0 is the
        /// current one. Returns 0, or -1 without multi-tasking or if the task has ended.
        fn OSKill(thread: Task) -> i32 = -1, c "int OSKill(struct tcb *thread)";

        /// Ends the current task; without multi-tasking, and from the first task, the program, as exit(code) does. code: exit
        /// code of the program. Returns nothing: the call does not return.
        fn OSExit(code: i32) -> i32 = -1, c "int OSExit(int code)";

        /// Shows a text and stops the robot forever. message: the text. Returns nothing: the call does not return.
        fn OSPanic(message: Text) -> i32 = -1, c "int OSPanic(const char *message)";

        /// Lets the other tasks run for a time; without multi-tasking the same as OSWait.
        /// n: hundredths of a second. Returns 0.
        fn OSSleep(n: i32) -> i32 = -1;

        /// Switches pre-emption off, until OSPermit. Returns 0, or -1 without multi-tasking.
        fn OSForbid() -> i32 = -1;

        /// Switches pre-emption on, in mode PREEMPT. Returns 0, or -1 without multi-tasking.
        fn OSPermit() -> i32 = -1;

        /// Initialises a semaphore; a repeated initialisation creates a new one.
        /// sem: a variable of the program. val: initial number of permits. Returns 0, or -1 if sem is 0 or val below 0.
        fn OSSemInit(sem: InOut<Semaphore>, val: i32) -> i32 = -1, c "int OSSemInit(struct sem *sem, int val)";

        /// Takes a permit of a semaphore or waits for one: first come, first served. Works without multi-tasking too.
        /// Returns 0, or -1 if sem is 0 or was not initialised.
        fn OSSemP(sem: Semaphore) -> i32 = -1, c "int OSSemP(struct sem *sem)";

        /// Adds a permit to a semaphore; it goes to the task that has waited longest, if any.
        /// Returns 0, or -1 if sem is 0 or was not initialised.
        fn OSSemV(sem: Semaphore) -> i32 = -1, c "int OSSemV(struct sem *sem)";
    }

    family Time "time and timers", source "RoBIOS 6 library, timer" {
        /// Sets the clock of this robot.
        /// h: 0 to 23. m, s: 0 to 59. Returns 0, or -1 for another time.
        fn OSSetTime(h: i32, m: i32, s: i32) -> i32 = -1;

        /// Reads the clock of this robot; it starts at 0:00:00. h, m, s: set to hours, minutes and seconds; may be 0. ticks:
        /// set to hundredths of a second; may be 0. Returns 0.
        fn OSGetTime(h: Out<i32>, m: Out<i32>, s: Out<i32>, ticks: Out<i32>) -> i32 = -1;

        /// Writes the clock to the LCD, at the cursor. Returns 0.
        fn OSShowTime() -> i32 = -1;

        /// Time since the robot's start. Returns hundredths of a second.
        fn OSGetCount() -> i32 = 0;

        /// Waits. n: hundredths of a second. Returns 0.
        fn OSWait(n: i32) -> i32 = -1;

        /// Calls a function periodically, inside the call in progress at that time; it is never re-entered. scale: period in
        /// hundredths of a second, at least 1. f: the function; it must be short and must not wait. Returns a handle, or 0 if
        /// the list is full, scale is below 1 or f is 0.
        fn OSAttachTimer(scale: i32, f: Callback) -> TimerHandle = 0;

        /// Stops a timer of OSAttachTimer. Returns 1, or 0 if handle is invalid.
        fn OSDetachTimer(handle: TimerHandle) -> i32 = 0;
    }

    family RS232 "serial interfaces and download", source "RoBIOS 6 library, serial communication" {
        /// Opens a serial interface.
        /// baud: SER4800 to SER115200. handshake: NONE or RTSCTS. interface: SERIAL1 to SERIAL3.
        /// Returns 0, or not 0 for other values.
        fn OSInitRS232(baud: i32, handshake: i32, interface: i32) -> i32 = -1;

        /// Sends a byte. chr: the byte. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure.
        fn OSSendCharRS232(chr: Char, interface: i32) -> i32 = -1;

        /// Sends text. s: the text. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure or if s is 0.
        fn OSSendRS232(s: Text, interface: i32) -> i32 = -1;

        /// Waits for a byte. buf: set to the byte. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure or if buf is
        /// 0.
        fn OSRecvRS232(buf: Out<Char>, interface: i32) -> i32 = -1;

        /// Discards received bytes. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure.
        fn OSFlushInRS232(interface: i32) -> i32 = -1;

        /// Discards bytes not yet sent. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure.
        fn OSFlushOutRS232(interface: i32) -> i32 = -1;

        /// Counts the bytes received and not yet read. interface: SERIAL1 to SERIAL3. Returns their number; below 0 on failure.
        fn OSCheckInRS232(interface: i32) -> i32 = -1;

        /// Counts the bytes not yet sent. interface: SERIAL1 to SERIAL3. Returns their number; below 0 on failure.
        fn OSCheckOutRS232(interface: i32) -> i32 = -1;

        /// Loads a user program over a serial interface; not available on a simulated robot. name: at least 16 bytes for the
        /// program's name. bytes: set to the number of bytes loaded. baud: SER4800 to SER115200. handshake: NONE or RTSCTS.
        /// interface: SERIAL1 to SERIAL3. Returns 0 when done, 99 to be called again, or another number on failure.
        fn OSDownload(name: Out<[u8; 16]>, bytes: Out<i32>, baud: i32, handshake: i32, interface: i32) -> i32 = 1;

        /// Starts the loaded user program; a simulated robot has none. Returns -1.
        fn USRStart() -> i32 = -1;

        /// Keeps the loaded user program over a reset.
        /// name: what it is called. mode: SET (TRUE) or RESET (FALSE). Returns 0, or -1 if there is none.
        fn USRResident(name: Text, mode: Bool) -> i32 = -1;
    }

    family AU "sound", source "RoBIOS 6 library, audio" {
        /// Plays a sample; does not wait.
        /// sample: a WAV file in memory, or the name of one. Returns its rate in Hz, or 0 if it is not one.
        fn AUPlaySample(sample: Bytes) -> i32 = 0, c "int AUPlaySample(char *sample)";

        /// Checks whether the sample is over. Returns FALSE while a sample is being played, otherwise TRUE.
        fn AUCheckSample() -> i32 = TRUE;

        /// Plays a tone; does not wait.
        /// freq_hz: 65 to 21000. span_ms: milliseconds. Returns 0, or -1 for other values.
        fn AUTone(freq_hz: i32, span_ms: i32) -> i32 = -1;

        /// Checks whether the tone is over. Returns FALSE while a tone is being played, otherwise TRUE.
        fn AUCheckTone() -> i32 = TRUE;

        /// Plays a short tone; does not wait. Returns 0.
        fn AUBeep() -> i32 = -1;

        /// Records from the microphone.
        /// buf: buffer for the sample, written before the return. len: its size in bytes. freq: wanted rate in Hz.
        /// Returns the rate in Hz, or 0 if buf is 0 or len is not positive.
        fn AURecordSample(buf: OutBytes, freq_hz: i64) -> i32 = 0,
            c "int AURecordSample(BYTE *buf, long len, long freq)";

        /// Checks whether the recording is over. Returns FALSE while a recording is in progress, otherwise TRUE.
        fn AUCheckRecord() -> i32 = TRUE;

        /// The current value of the microphone. Returns 0 to 1023; 512 is silence.
        fn AUCaptureMic() -> i32 = 512;
    }

    family PSD "infrared distance sensors, results in millimetres", source "RoBIOS 6 library, position sensing devices" {
        /// Initialises a PSD sensor.
        /// semantics: PSD_FRONT and so on. Returns a handle (one bit), or 0 if the robot has no such sensor.
        fn PSDInit(semantics: DeviceSemantics) -> PSDHandle = 0;

        /// Stops measuring and releases all PSD sensors. Returns 0.
        fn PSDRelease() -> i32 = -1;

        /// Starts measuring.
        /// bitmask: handles, OR-ed. cycle: TRUE measures continuously, FALSE once.
        /// Returns 0, 1 if another measurement is still in progress, or -1 if bitmask has a bit that is not a handle.
        fn PSDStart(bitmask: PSDHandle, cycle: Bool) -> i32 = -1;

        /// Stops measuring at the end of the cycle in progress. Returns 0.
        fn PSDStop() -> i32 = -1;

        /// Checks whether there is a valid result, that is after the first complete cycle. Returns TRUE or FALSE.
        fn PSDCheck() -> Bool = FALSE;

        /// Distance measured by the last complete cycle. handle: of PSDInit; 0 asks for the time stamp of the measurement.
        /// Returns millimetres, PSD_OUT_OF_RANGE if nothing is within range or handle is invalid; for handle 0 hundredths of a
        /// second.
        fn PSDGet(handle: PSDHandle) -> i32 = PSD_OUT_OF_RANGE;

        /// Raw value measured by the last complete cycle. handle: of PSDInit; 0 asks for the time stamp of the measurement.
        /// Returns 0 to 255, 0 if nothing is within range; for handle 0 hundredths of a second.
        fn PSDGetRaw(handle: PSDHandle) -> i32 = 0;
    }

    family SERVO "servos", source "RoBIOS 6 library, servos and motors" {
        /// Initialises a servo.
        /// semantics: SERVO1 and so on. Returns a handle, or 0 if the robot has no such servo.
        fn SERVOInit(semantics: DeviceSemantics) -> ServoHandle = 0;

        /// Releases servos.
        /// handle: handles, OR-ed. Returns 0; 0x11110000 if no handle is valid; otherwise the handles not released.
        fn SERVORelease(handle: ServoHandle) -> i32 = 0x1111_0000;

        /// Turns a servo.
        /// handle: of SERVOInit. angle: 0 to 255, the middle is 127 or 128. Returns 0, or -1 if handle or angle is
        /// invalid.
        fn SERVOSet(handle: ServoHandle, angle: i32) -> i32 = -1;
    }

    family MOTOR "motors", source "RoBIOS 6 library, servos and motors" {
        /// Initialises a motor.
        /// semantics: MOTOR_LEFT and so on. Returns a handle, or 0 if the robot has no such motor or VW uses it.
        fn MOTORInit(semantics: DeviceSemantics) -> MotorHandle = 0;

        /// Stops and releases motors.
        /// handle: handles, OR-ed. Returns 0; 0x11110000 if no handle is valid; otherwise the handles not released.
        fn MOTORRelease(handle: MotorHandle) -> i32 = 0x1111_0000;

        /// Sets a motor's speed.
        /// handle: handles, OR-ed. speed_percent: -100 (full backwards) to 100.
        /// Returns 0, or -1 if one of the handles is invalid.
        fn MOTORDrive(handle: MotorHandle, speed_percent: i32) -> i32 = -1;
    }

    family QUAD "wheel encoders", source "RoBIOS 6 library, encoders" {
        /// Initialises an encoder; its count starts at 0.
        /// semantics: QUAD_LEFT and so on. Returns a handle, or 0 if the robot has no such encoder.
        fn QUADInit(semantics: DeviceSemantics) -> QuadHandle = 0;

        /// Releases encoders.
        /// handle: handles, OR-ed. Returns 0, or -1 if no handle is valid.
        fn QUADRelease(handle: QuadHandle) -> i32 = -1;

        /// Sets the counts of encoders to 0.
        /// handle: handles, OR-ed. Returns 0, or -1 if one of them is invalid.
        fn QUADReset(handle: QuadHandle) -> i32 = -1;

        /// Count of an encoder since its reset, increasing when the wheel turns forward. Returns counts; 0 if handle
        /// is invalid.
        fn QUADRead(handle: QuadHandle) -> i32 = 0;

        /// The motor of an encoder's wheel.
        /// semantics: QUAD_LEFT and so on. Returns MOTOR_LEFT and so on, or 0 if the robot has no such encoder.
        fn QUADGetMotor(semantics: DeviceSemantics) -> DeviceSemantics = 0;

        /// Distance rolled by a wheel since QUADODOReset. Returns metres; 0 if handle is invalid.
        fn QUADODORead(handle: QuadHandle) -> f32 = 0.0;

        /// Sets the rolled distance of wheels to 0; their counts stay.
        /// handle: handles, OR-ed. Returns 0, or -1 if one of them is invalid.
        fn QUADODOReset(handle: QuadHandle) -> i32 = -1;
    }

    family VW "driving: metres, radians, seconds; x forward, y left, phi counter-clockwise", source "RoBIOS 6 library, VW interface" {
        /// Initialises the driving interface and sets position and heading to 0; it takes motors and encoders.
        /// semantics: VW_DRIVE. Timescale: control runs at 100 Hz/Timescale, usually 1.
        /// Returns a handle, or 0 if the robot cannot drive, it is already in use or Timescale is below 1.
        fn VWInit(semantics: DeviceSemantics, Timescale: i32) -> VWHandle = 0;

        /// Stops the robot and releases the driving interface. Returns 0, or -1 if handle is invalid.
        fn VWRelease(handle: VWHandle) -> i32 = -1;

        /// Sets the speed, until the next command; starts at the end of the call and replaces a drive in progress. v_mps: m/s,
        /// negative = backwards. w_radps: rad/s, positive = counter-clockwise. Returns 0, or -1 if handle is invalid.
        fn VWSetSpeed(handle: VWHandle, v_mps: MetrePerSecond, w_radps: RadianPerSecond) -> i32 = -1;

        /// Reads the speed by odometry. vw: set to v in m/s and w in rad/s. Returns 0, or -1 if handle is invalid or vw is 0.
        fn VWGetSpeed(handle: VWHandle, vw: Out<SpeedType>) -> i32 = -1;

        /// Sets the position of the odometry; the robot does not move.
        /// x_m, y_m: metres. phi_rad: radians. Returns 0, or -1 if handle is invalid.
        fn VWSetPosition(handle: VWHandle, x_m: Metre, y_m: Metre, phi_rad: Radian) -> i32 = -1;

        /// Reads the position by odometry. pos: set to x and y in metres and phi in radians. Returns 0, or -1 if handle is
        /// invalid or pos is 0.
        fn VWGetPosition(handle: VWHandle, pos: Out<PositionType>) -> i32 = -1;

        /// Starts the PI controllers of speed and rate of turn: output = V * (e + 1/T * integral of e). Typical: 7, 0.3, 10,
        /// 0.1. Vv: gain for the speed. Tv: time for the speed, in seconds. Vw: gain for the rate of turn. Tw: time for the
        /// rate of turn, in seconds. Returns 0, or -1 if handle is invalid.
        fn VWStartControl(handle: VWHandle, Vv: f32, Tv: f32, Vw: f32, Tw: f32) -> i32 = -1;

        /// Stops the PI controllers: speeds are open loop again. Returns 0, or -1 if handle is invalid.
        fn VWStopControl(handle: VWHandle) -> i32 = -1;

        /// Drives straight ahead; starts at the end of the call, replaces a drive in progress and does not wait. delta_m:
        /// distance in metres, negative = backwards. v_mps: speed in m/s, > 0. Returns 0, or -1 if handle is invalid.
        fn VWDriveStraight(handle: VWHandle, delta_m: Metre, v_mps: MetrePerSecond) -> i32 = -1;

        /// Turns on the spot; starts at the end of the call, replaces a drive in progress and does not wait. delta_rad: angle
        /// in radians, positive = counter-clockwise. w_radps: rate in rad/s, > 0. Returns 0, or -1 if handle is invalid.
        fn VWDriveTurn(handle: VWHandle, delta_rad: Radian, w_radps: RadianPerSecond) -> i32 = -1;

        /// Drives along a circular arc; starts at the end of the call, replaces a drive in progress and does not wait.
        /// delta_l_m: length of the arc in metres, negative = backwards. delta_phi_rad: change of heading in radians, positive
        /// = counter-clockwise. v_mps: speed in m/s, > 0. Returns 0, or -1 if handle is invalid.
        fn VWDriveCurve(handle: VWHandle, delta_l_m: Metre, delta_phi_rad: Radian, v_mps: MetrePerSecond) -> i32 = -1;

        /// Remainder of the drive in progress. Returns metres, for a turn radians, for a curve its length; 0 when done or if
        /// handle is invalid.
        fn VWDriveRemain(handle: VWHandle) -> f32 = 0.0;

        /// Checks whether the drive has ended. Returns 1 if it has ended, 0 if it is in progress, -1 if handle is invalid.
        fn VWDriveDone(handle: VWHandle) -> i32 = -1;

        /// Waits until the drive has ended. Returns 0, or -1 immediately if handle is invalid.
        fn VWDriveWait(handle: VWHandle) -> i32 = -1;

        /// Checks whether a motor is stalled. Returns 1 if one is, 0 if none is or there is no command, -1 if handle is invalid.
        fn VWStalled(handle: VWHandle) -> i32 = -1;
    }

    family BUMP "bumpers", source "RoBIOS 6 library, bumper and infrared sensors" {
        /// Initialises a bumper.
        /// semantics: BUMP_LEFT and so on. Returns a handle, or 0 if the robot has no such bumper.
        fn BUMPInit(semantics: DeviceSemantics) -> BumpHandle = 0;

        /// Releases bumpers.
        /// handle: handles, OR-ed. Returns 0; 0x11110000 if no handle is valid; otherwise the handles not released.
        fn BUMPRelease(handle: BumpHandle) -> i32 = 0x1111_0000;

        /// Checks a bumper for contacts since the last check.
        /// timestamp: time of the first contact, in hundredths of a second; may be 0.
        /// Returns 0 if there was a contact, -1 if there was none or handle is invalid.
        fn BUMPCheck(handle: BumpHandle, timestamp: Out<i32>) -> i32 = -1;
    }

    family IR "infrared proximity sensors", source "RoBIOS 6 library, bumper and infrared sensors" {
        /// Initialises an infrared sensor.
        /// semantics: IR_LEFT and so on. Returns a handle, or 0 if the robot has no such sensor.
        fn IRInit(semantics: DeviceSemantics) -> IRHandle = 0;

        /// Releases infrared sensors.
        /// handle: handles, OR-ed. Returns 0; 0x11110000 if no handle is valid; otherwise the handles not released.
        fn IRRelease(handle: IRHandle) -> i32 = 0x1111_0000;

        /// Reads an infrared sensor. Returns 1 if an object is near, 0 if not, -1 if handle is invalid.
        fn IRRead(handle: IRHandle) -> i32 = -1;
    }

    family Latch "latches, parallel port, analogue inputs", source "RoBIOS 6 library, latches, parallel port and A/D" {
        /// Reads an input latch. n: its number, 0 to 3. Returns its byte, 0 for another n.
        fn OSReadInLatch(n: i32) -> u8 = 0;

        /// Writes an output latch: new = (old & mask) | value. n: its number, 0 to 3. mask: bits to keep. value: bits to set.
        /// Returns the old byte, 0 for another n.
        fn OSWriteOutLatch(n: i32, mask: Byte, value: Byte) -> u8 = 0;

        /// Reads an output latch. n: its number, 0 to 3. Returns its byte, 0 for another n.
        fn OSReadOutLatch(n: i32) -> u8 = 0;

        /// Reads the data byte of the parallel port. Returns the byte.
        fn OSReadParData() -> u8 = 0;

        /// Writes the data byte of the parallel port. value: the byte.
        fn OSWriteParData(value: Byte) -> () = ();

        /// Reads the status byte of the parallel port. Returns the byte.
        fn OSReadParSR() -> u8 = 0;

        /// Writes the control byte of the parallel port. value: the byte.
        fn OSWriteParCTRL(value: Byte) -> () = ();

        /// Reads the control byte of the parallel port. Returns the byte.
        fn OSReadParCTRL() -> u8 = 0;

        /// Reads an analogue input. channel: 0 to 15. Returns 0 to 1023, -1 for another channel.
        fn OSGetAD(channel: i32) -> i32 = -1;

        /// Switches the analogue converter off. mode: 1 idle, 0 off. Returns 0.
        fn OSOffAD(mode: i32) -> i32 = -1;
    }

    family COMPASS "the compass", source "RoBIOS 6 library, compass" {
        /// Initialises the compass. semantics: COMPASS. Returns 0, or not 0 if the robot has none.
        fn COMPASSInit(semantics: DeviceSemantics) -> i32 = -1;

        /// Starts measuring. cycle: TRUE measures continuously, FALSE once. Returns 0, or 1 if it is not ready.
        fn COMPASSStart(cycle: Bool) -> i32 = 1;

        /// Checks whether a result is available. Returns 1 if it is, otherwise 0.
        fn COMPASSCheck() -> i32 = 0;

        /// Stops measuring. Returns 0, or 1 if it is not ready.
        fn COMPASSStop() -> i32 = 1;

        /// Releases the compass. Returns 0, or 1 if it is not ready.
        fn COMPASSRelease() -> i32 = 1;

        /// The last result of the compass. Returns 0 to 359 degrees, clockwise from north (the world's +y); -1 if there is
        /// none.
        fn COMPASSGet() -> i32 = -1;

        /// Calibrates. mode: 1 resets the calibration, 0 is called in two opposite headings.
        /// Returns 0, or 1 if it is not ready.
        fn COMPASSCalibrate(mode: i32) -> i32 = 1;
    }

    family IRTV "TV remote control", source "RoBIOS 6 library, infrared remote control" {
        /// Starts receiving with the settings of the device table.
        /// semantics: IRTV. Returns 0, or not 0 if the robot has no receiver.
        fn IRTVInitHDT(semantics: DeviceSemantics) -> i32 = -1;

        /// Starts receiving.
        /// type_code: SPACE_CODE, PULSE_CODE, MANCHESTER_CODE or RAW_CODE. length: bits of a code.
        /// tog_mask: bits that toggle. inv_mask: bits that are inverted. mode: DEFAULT_MODE, SLOPPY_MODE or
        /// REPCODE_MODE. bufsize: capacity of the buffer in codes, 1 to 4. delay: hundredths of a second before a key repeats.
        /// Returns 0, or not 0 if the robot has no receiver.
        fn IRTVInit(type_code: i32, length: i32, tog_mask: i32, inv_mask: i32, mode: i32, bufsize: i32, delay: i32)
            -> i32 = -1;

        /// Stops receiving.
        fn IRTVTerm() -> () = ();

        /// The code that is being received, without waiting. Returns the code; 0 if there is none.
        fn IRTVPressed() -> i32 = 0;

        /// The next code that has been received, without waiting. Returns the code; 0 if there is none.
        fn IRTVRead() -> i32 = 0;

        /// Waits for the next code. Returns the code; 0 immediately if nothing is being received.
        fn IRTVGet() -> i32 = 0;

        /// Discards received codes.
        fn IRTVFlush() -> () = ();

        /// Reads the settings of IRTVInit. type_code, length, tog_mask, inv_mask, mode, bufsize, delay: set to those of
        /// IRTVInit; may be 0.
        fn IRTVGetStatus(
            type_code: Out<i32>, length: Out<i32>, tog_mask: Out<i32>, inv_mask: Out<i32>, mode: Out<i32>,
            bufsize: Out<i32>, delay: Out<i32>
        ) -> () = ();
    }

    family RADIO "radio between robots", source "RoBIOS 6 library, radio communication; fields of RadioStatus: our choice" {
        /// Switches the radio on, with the settings of RADIOSetIoctl. Returns 0, -1 if it is on already.
        fn RADIOInit() -> i32 = -1;

        /// Switches the radio off: messages that wait or are in transit are lost. Returns 0, -1 if it is off.
        fn RADIOTerm() -> i32 = -1;

        /// Sends a message, without waiting for the transmission and without acknowledgement. id: the receiver, BROADCAST for
        /// all robots. byteCount: 0 to MAXMSGLEN. buffer: the bytes. Returns 0, or 1 if the radio is off, the message is too
        /// long, buffer is 0, or 1024 bytes are already waiting to be sent.
        fn RADIOSend(id: Byte, buffer: Bytes) -> i32 = 1, c "int RADIOSend(BYTE id, int byteCount, BYTE *buffer)";

        /// Counts the messages that wait to be received. Returns their number; 0 if the radio is off.
        fn RADIOCheck() -> i32 = 0, c "int RADIOCheck()";

        /// Waits for a message, which may be damaged: there is no checksum. id: set to the address of its sender; may be 0.
        /// bytesReceived: set to its length; may be 0. buffer: at least MAXMSGLEN bytes; a longer message is cut to these.
        /// Returns 0, or -1 immediately if the radio is off or buffer is 0.
        fn RADIORecv(id: Out<Byte>, bytesReceived: Out<i32>, buffer: OutBytes) -> i32 = -1,
            c "int RADIORecv(BYTE *id, int *bytesReceived, BYTE *buffer)";

        /// Reads the settings of the radio. p: set to the settings. Returns 0, or -1 if p is 0.
        fn RADIOGetIoctl(p: Out<RadioIOParameters>) -> i32 = -1;

        /// Changes the settings of the radio, before RADIOInit. p: the settings; speed and id have an effect, the others are only stored.
        /// Returns 0, or -1 if p is 0, a setting is invalid, or the radio is on; then nothing changes.
        fn RADIOSetIoctl(p: In<RadioIOParameters>) -> i32 = -1;

        /// Reads the state of the radio. s: set to the state. Returns 0, or -1 if the radio is off or s is 0.
        fn RADIOGetStatus(s: Out<RadioStatus>) -> i32 = -1;
    }
    family RANGE "range sensors beyond RoBIOS", source "our choice: RoBIOS has none" {
        /// Signal underlying the distance of the last complete cycle: that of a reflectance sensor, in 1/m; the echo energy of
        /// a sonar, 1 for a perfect reflector 1 m ahead; for other sensors 1 with an echo, 0 without. handle: of PSDInit.
        /// Returns the signal, -1 if handle is invalid, or nothing has been measured.
        fn PSDGetSignal(handle: PSDHandle) -> f32 = -1.0;

        /// Scans once with the laser scanner, from left to right; the middle point (of n, that of index n/2) is straight
        /// ahead. distance: set to distances in millimetres, 9999 if out of range. size: capacity of distance; as many points
        /// as fit are written. Returns the number of points of the scan, or -1 if there is no scanner or distance is 0.
        fn LIDARScan(distance: OutInts) -> i32 = -1, c "int LIDARScan(int distance[], int size)";
    }
    family TRUTH "what the camera's last image shows, in simulation only", source "our choice: RoBIOS has none" {
        /// Depth of each pixel of the last image: distance along the line of sight, in mm, without noise; INFINITY for the sky.
        /// mm: 60 rows of 80 numbers, row 0 at the top. Returns 0, -1 if mm is 0 or no image has been taken.
        fn CAMGetDepth(mm: OutFloats) -> i32 = -1, c "int CAMGetDepth(float *mm)";

        /// Label of each pixel of the last image: CAM_SKY, CAM_FLOOR, CAM_WALL, or CAM_BODY + n for robot or object n, numbered as in
        /// SIMGetRobot and SIMGetObject: robots from 1, then the objects.
        /// labels: 60 rows of 80 numbers, row 0 at the top. Returns 0, -1 if labels is 0 or no image has been taken.
        fn CAMGetLabels(labels: OutInts) -> i32 = -1, c "int CAMGetLabels(int *labels)";
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
}
