/* RoBIOS 6 for robot programs.
 *
 * Every call takes effect, and takes its readings, at its end. Calls that wait say so; all others return immediately.
 * [any task of the robot] marks who may call a function: all may be called from timer functions too, where those
 * that wait are errors. No call keeps a pointer. Null pointers and wrong handles give the documented failure.
 *
 * Written from the lists of functions and constants of eyesim. */
#ifndef EYESIM_EYEBOT_H
#define EYESIM_EYEBOT_H

#include "types.h"
#include "hdt_sem.h"

#undef TRUE
#define TRUE                   1 /* BOOL: yes. */
#undef FALSE
#define FALSE                  0 /* BOOL: no. */
#define NOKEY                  0 /* KEYRead: no key is pressed. */
#define KEY1                   1 /* The left key under the LCD. */
#define KEY2                   2 /* The second key from the left. */
#define KEY3                   4 /* The third key from the left. */
#define KEY4                   8 /* The right key. */
#define ANYKEY              (-1) /* KEYWait: any key. */
#define NONSCROLLING           0 /* LCDMode: text that leaves the last line starts again in the first. */
#define NOSCROLLING            0 /* The same as NONSCROLLING. */
#define SCROLLING              1 /* LCDMode: text that leaves the last line moves all lines up. */
#define NOCURSOR               0 /* LCDMode: the cursor is not shown. */
#define CURSOR                 2 /* LCDMode: the cursor is shown. */
#define NORMAL                 0 /* CAMInit: normal angle of view. */
#define WIDE                   1 /* CAMInit: wide angle of view. */
#define TELE                   2 /* CAMInit: narrow angle of view. */
#define COLCAM                16 /* CAMInit returns at least this for a colour camera. */
#define INITERROR            200 /* CAMInit: the camera could not be initialised; 200 and more are failures. */
#define NOCAM                255 /* CAMInit: there is no camera. */
#define NOAUTOBRIGHTNESS       0 /* CAMMode: brightness as set by CAMSet. */
#define AUTOBRIGHTNESS         1 /* CAMMode: brightness follows the scene. */
#define CAM_SKY                0 /* CAMGetLabels: nothing. */
#define CAM_FLOOR              1 /* CAMGetLabels: the floor, with what is painted on it, or a terrain. */
#define CAM_WALL               2 /* CAMGetLabels: a wall. */
#define CAM_BODY              10 /* CAMGetLabels: robot or object n is this + n. */
#define FPS60                  0 /* CAMSet: 60 frames per second. */
#define FPS30                  1 /* CAMSet: 30 frames per second. */
#define FPS15                  2 /* CAMSet: 15 frames per second. */
#define FPS7_5                 3 /* CAMSet: 7.5 frames per second. */
#define FPS3_75                4 /* CAMSet: 3.75 frames per second. */
#define FPS1_875               5 /* CAMSet: 1.875 frames per second. */
#define FPS0_9375              6 /* CAMSet: 0.9375 frames per second. */
#define FPS0_46875             7 /* CAMSet: 0.46875 frames per second. */
#define VEHICLE                1 /* OSMachineType: a vehicle. */
#define PLATFORM               2 /* OSMachineType: a platform. */
#define WALKER                 3 /* OSMachineType: a walking machine. */
#define COOP                   0 /* OSMTInit: tasks switch only when one yields or waits. */
#define DEFAULT                0 /* OSMTInit: the same as COOP. */
#define PREEMPT                1 /* OSMTInit: tasks take turns. */
#define NOTASK               255 /* OSMTStatus: no multi-tasking. */
#define TASK_NEW               0 /* State of a task: created. */
#define TASK_READY             1 /* State of a task: ready to run. */
#define TASK_SUSPEND           2 /* State of a task: suspended. */
#define TASK_RUNNING           3 /* State of a task: running. */
#define MAX_PRI                8 /* OSSpawn: the highest priority. */
#define MIN_PRI                1 /* OSSpawn: the lowest priority. */
#define IDLE_PRI               0 /* Priority of the idle task. */
#define IDLE_STACKSIZE       128 /* Stack of the idle task in bytes. */
#define SMALL_STACKSIZE     2048 /* OSSpawn: a small stack, in bytes. */
#define DEFAULT_STACKSIZE   4096 /* OSSpawn: the usual stack, in bytes. */
#define SER4800             4800 /* OSInitRS232: 4,800 baud. The constant is the rate, so that plain numbers do as well. */
#define SER9600             9600 /* OSInitRS232: 9,600 baud. */
#define SER19200           19200 /* OSInitRS232: 19,200 baud. */
#define SER38400           38400 /* OSInitRS232: 38,400 baud. */
#define SER57600           57600 /* OSInitRS232: 57,600 baud. */
#define SER115200         0x01C200 /* OSInitRS232: 115,200 baud. */
#define NONE                   0 /* OSInitRS232: no handshake. */
#define RTSCTS                 1 /* OSInitRS232: handshake by RTS and CTS. */
#define SERIAL1                1 /* The first serial interface. */
#define SERIAL2                2 /* The second serial interface. */
#define SERIAL3                3 /* The third serial interface. */
#define PSD_OUT_OF_RANGE    9999 /* PSDGet: nothing within the sensor's range. */
#define BROADCAST              0 /* RADIOSend: to every robot. */
#define MAXMSGLEN             35 /* The longest message of the radio, in bytes. */
#define SPACE_CODE             0 /* IRTVInit: bits are distinguished by the length of the pause between pulses. */
#define PULSE_CODE             1 /* IRTVInit: bits are distinguished by the length of the pulses. */
#define MANCHESTER_CODE        2 /* IRTVInit: bits are distinguished by the direction of an edge. */
#define RAW_CODE               3 /* IRTVInit: codes are a raw sequence of lengths. */
#define DEFAULT_MODE           0 /* IRTVInit: only complete codes count. */
#define SLOPPY_MODE            1 /* IRTVInit: incomplete codes count. */
#define REPCODE_MODE           2 /* IRTVInit: a special code repeats the last one. */

#ifdef __cplusplus
extern "C" {
#endif

/* ---- OS: the machine, its errors and variables ---- */

/* The version of RoBIOS as text. In C the text stays valid and unchanged until the program ends; it may not be written
 * to. Returns the text, such as `6.5`.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, system functions. */
char *OSVersion(void);

/* Shows an error, text and number, on the LCD and in the trace of the run. message: the text. number: the number
 * shown after it. dead: if not 0, the robot stops here forever; otherwise the program waits for a key and continues.
 * Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, system functions. */
int OSError(const char *message, int number, BOOL dead);

/* The kind of machine. Returns VEHICLE, PLATFORM or WALKER.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSMachineType(void);

/* The clock rate of the processor. Returns the rate in Hz.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSMachineSpeed(void);

/* The name of the robot as text. In C the text stays valid and unchanged until the program ends; it may not be written
 * to. Returns the text.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, system functions. */
char *OSMachineName(void);

/* The robot's number, unique in the scene; also its address on the radio. Returns 1 to 255.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
BYTE OSMachineID(void);

/* Enables interrupts again: timers run. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSEnable(void);

/* Disables interrupts: timers do not run until OSEnable. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSDisable(void);

/* Value of a system variable; 0 if it was never set.
 * num: its number, 0 to 15. Returns the value, 0 for another num.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSGetVar(int num);

/* Sets a system variable of this robot. num: its number, 0 to 15. value: any number. Returns 0, or -1 for another num.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSPutVar(int num, int value);

/* ---- HDT: the table of the robot's devices ---- */

/* Checks the device table. Returns 0 if it is valid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, hardware description table; layout of an entry: our choice. */
int HDT_Validate(void);

/* Searches for a device.
 * type_id: HDT_MOTOR and so on, 0 for any. semantics: MOTOR_LEFT and so on.
 * Returns a pointer to an HDT_entry_type that stays valid until the next call, or 0 if there is no such
 * device.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, hardware description table; layout of an entry: our choice. */
void *HDT_FindEntry(TypeID type_id, DeviceSemantics semantics);

/* Finds the n-th device of a kind, to iterate over all of them.
 * type_id: HDT_MOTOR and so on. index: 0 for the first one. entry: set to the device.
 * Returns 0, or -1 if there are fewer devices or a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, hardware description table; layout of an entry: our choice. */
int HDT_FindTable(TypeID type_id, int index, HDT_entry_type *entry);

/* Number of devices of a kind.
 * type_id: HDT_MOTOR and so on. Returns the number, 0 for an unknown kind.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, hardware description table; layout of an entry: our choice. */
int HDT_TypeCount(TypeID type_id);

/* ---- LCD: the display: 128 x 64 pixels, 7 lines of 16 characters, the last one for the menu ---- */

/* Prints formatted text at the cursor, as printf does; \n starts a new line. format: as of printf, with the
 * values after it. Returns 0, or -1 if format is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPrintf(const char *format, ...) EYESIM_PRINTF(1, 2);

/* Prints formatted text at a position, as printf does; the cursor stays after it. row: 0 (top) to 6. column: 0 (left) to
 * 15. format: as of printf, with the values after it. Returns 0, or -1 if format is 0 or the position is not on the LCD.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDSetPrintf(int row, int column, const char *format, ...) EYESIM_PRINTF(3, 4);

/* Clears the LCD and moves the cursor to the top left; the menu is cleared too. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDClear(void);

/* Writes a character at the cursor, which moves on. c: the character. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutChar(char c);

/* Writes a character at a position; the cursor stays after it. row: 0 (top) to 6. column: 0 (left) to 15. c: the
 * character. Returns 0, or -1 if the position is not on the LCD.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDSetChar(int row, int column, char c);

/* Writes text at the cursor, which moves on; \n starts a new line. s: the text. Returns 0, or -1 if s is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutString(const char *s);

/* Writes text at a position; the cursor stays after it. row: 0 (top) to 6. column: 0 (left) to 15. s: the text. Returns
 * 0, or -1 if s is 0 or the position is not on the LCD.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDSetString(int row, int column, const char *s);

/* Writes a number in hexadecimal, 8 digits. v: the number. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutHex(int v);

/* Writes the lowest byte of a number in hexadecimal, 2 digits. v: the number. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutHex1(int v);

/* Writes a number in decimal. v: the number. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutInt(int v);

/* Writes a number in decimal, right-aligned. v: the number. spaces: minimum number of characters. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutIntS(int v, int spaces);

/* Writes a number with its decimals, as %f of printf. v: the number. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutFloat(float v);

/* Writes a number with its decimals, right-aligned. v: the number. spaces: minimum number of characters. decimals:
 * digits after the point. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutFloatS(float v, int spaces, int decimals);

/* Sets the text mode.
 * mode: SCROLLING or NONSCROLLING, and CURSOR or NOCURSOR, OR-ed. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDMode(int mode);

/* Moves the cursor.
 * row: 0 (top) to 6. column: 0 (left) to 15. Returns 0, or -1 if the position is not on the LCD.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDSetPos(int row, int column);

/* Reads the position of the cursor. row: set to 0 (top) to 6. column: set to 0 (left) to 15. Returns 0, or -1 if a
 * pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDGetPos(int *row, int *column);

/* Shows the upper 54 rows of a grey image at the left of the LCD, so that the menu stays visible.
 * Returns 0, or -1 if buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutGraphic(image *buf);

/* Shows the upper 54 rows of a colour image in black and white, like LCDPutGraphic. buf: colour image of 82 x 62 x
 * 3 bytes; overwritten with the black and white image. Returns 0, or -1 if buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutColorGraphic(colimage *buf);

/* Sets all 128 x 64 pixels.
 * buf: 1024 bytes, 16 per row, the left pixel in the highest bit, 1 is black. Returns 0, or -1 if buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutImage(BYTE *buf);

/* Writes the texts of the menu, above the keys. s1, s2, s3, s4: at most 4 characters each; "" (or 0) leaves an entry
 * as it is, " " clears it. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDMenu(const char *s1, const char *s2, const char *s3, const char *s4);

/* Writes one text of the menu.
 * pos: 1 (left) to 4. s: at most 4 characters. Returns 0, or -1 for another pos or if s is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDMenuI(int pos, const char *s);

/* Sets a pixel.
 * row: 0 (top) to 63. col: 0 (left) to 127. val: 0 clear, 1 set, 2 invert.
 * Returns 0, or -1 if it is not on the LCD or for another val.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDSetPixel(int row, int col, int val);

/* Inverts a pixel.
 * row: 0 (top) to 63. col: 0 (left) to 127. Returns 0, or -1 if it is not on the LCD.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDInvertPixel(int row, int col);

/* Reads a pixel. row: 0 (top) to 63. col: 0 (left) to 127. Returns 0 clear, 1 set, -1 if it is not on the LCD.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDGetPixel(int row, int col);

/* Draws a line between two pixels, both included; parts outside of the LCD are clipped. x1, x2: 0 (left) to 127. y1,
 * y2: 0 (top) to 63. col: 0 white, 1 black, 2 inverted. Returns 0, or -1 for another col.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDLine(int x1, int y1, int x2, int y2, int col);

/* Fills a rectangle, all edges included; parts outside of the LCD are clipped. x1, x2: 0 (left) to 127, x1 < x2. y1,
 * y2: 0 (top) to 63, y1 < y2. col: 0 white, 1 black, 2 inverted. Returns 0, or -1 for another col or corners in
 * another order.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDArea(int x1, int y1, int x2, int y2, int col);

/* ---- KEY: the four keys under the LCD ---- */

/* Waits for a key and stores its code. buf: set to KEY1 to KEY4. Returns 0, or -1 immediately if buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, key input. */
int KEYGetBuf(char *buf);

/* Waits for a key. Returns its code, KEY1 to KEY4.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, key input. */
int KEYGet(void);

/* The key that is pressed and has not been read yet, without waiting. Returns its code, 0 if there is none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, key input. */
int KEYRead(void);

/* Waits for a certain key; other keys are discarded.
 * excode: KEY1 to KEY4, several OR-ed, or ANYKEY. Returns 0, or -1 immediately for another excode.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, key input. */
int KEYWait(int excode);

/* ---- CAM: the camera ---- */

/* Starts the camera.
 * mode: NORMAL, WIDE or TELE. Returns the camera's version (COLCAM or more: colour); 200 and more are
 * failures: INITERROR, and NOCAM if there is none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, camera. */
int CAMInit(int mode);

/* Stops the camera. Returns 0, or -1 if it was not started.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, camera. */
int CAMRelease(void);

/* Takes a grey image and waits for it. Returns 0, or -1 if there is no camera or buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, camera. */
int CAMGetFrame(image *buf);

/* Takes a colour image and waits for it.
 * convert: 0 leaves red, green, blue; 1 converts it to 8-bit grey, of which only an `image` is written.
 * Returns 0, or -1 if there is no colour camera or buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, camera. */
int CAMGetColFrame(colimage *buf, int convert);

/* Takes a grey image without border: 60 rows of 80 bytes. Returns 0, or -1 if there is no camera or buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, camera. */
int CAMGetFrameMono(BYTE *buf);

/* Takes a colour image without border: 60 rows of 80 times red, green, blue.
 * Returns 0, or -1 if there is no camera or buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, camera. */
int CAMGetFrameColor(BYTE *buf);

/* Takes a colour image without border, as CAMGetFrameColor. Returns 0, or -1 if there is no camera or buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, camera. */
int CAMGetFrameRGB(BYTE *buf);

/* Takes the camera's raw values: 120 rows of 160 bytes, through its colour filter.
 * Returns 0, or -1 if there is no camera or buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, camera. */
int CAMGetFrameBayer(BYTE *buf);

/* Sets the levels or the frame rate of the camera. p1: brightness, 0 to 255; of an EyeCam the frame rate, FPS60 to
 * FPS0_46875, with p2 and p3 0. p2: hue of colour images, offset of grey ones, 0 to 255. p3: saturation of colour
 * images, contrast of grey ones, 0 to 255. Returns 0, or -1 if there is no camera.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, camera. */
int CAMSet(int p1, int p2, int p3);

/* Reads the values set by CAMSet. p1, p2, p3: set to these values. Returns 0, or -1 if there is no camera or a pointer
 * is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, camera. */
int CAMGet(int *p1, int *p2, int *p3);

/* Switches automatic brightness on or off.
 * mode: AUTOBRIGHTNESS or NOAUTOBRIGHTNESS. Returns 0, or -1 if there is no camera.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, camera. */
int CAMMode(int mode);

/* ---- IP: image processing on images of 82 x 62 with a border of 1 pixel ---- */

/* Laplace operator. src and dest may be the same. Returns 0, or -1 if a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, image processing. */
int IPLaplace(image *src, image *dest);

/* Sobel operator. src and dest may be the same. Returns 0, or -1 if a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, image processing. */
int IPSobel(image *src, image *dest);

/* Converts grey to black and white with a pattern of 2 x 2. Returns 0, or -1 if a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, image processing. */
int IPDither(image *src, image *dest);

/* Absolute difference of two images. Returns 0, or -1 if a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, image processing. */
int IPDiffer(image *current, image *last, image *dest);

/* Converts colour to grey. Returns 0, or -1 if a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, image processing. */
int IPColor2Grey(colimage *src, image *dest);

/* ---- MT: multi-tasking ---- */

/* Starts multi-tasking; the program becomes the first task, of priority IDLE_PRI.
 * mode: COOP (or DEFAULT): tasks switch only when one yields or waits. PREEMPT: after OSPermit also every
 * 10 ms and when one of higher priority is ready. Returns 0, or -1 for another mode or if it was started before.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSMTInit(BYTE mode);

/* Creates a task, which is not ready yet: see OSReady. It ends when its function returns.
 * name: shown in messages; may be 0. code: its function. stksiz: bytes of stack, 0 to 4194304; it gets at
 * least 8 MiB. pri: MIN_PRI to MAX_PRI. uid: a number for OSGetUID.
 * Returns the task, valid until the program ends; 0 before OSMTInit, for a wrong argument, or with 256 tasks.
 * [any task of the robot]  The function is kept until the program ends.
 * Source: RoBIOS 6 library, multi-tasking. */
struct tcb *OSSpawn(const char *name, void (*code)(void), int stksiz, int pri, int uid);

/* The mode of multi-tasking. Returns COOP, PREEMPT, or NOTASK if it was not started.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSMTStatus(void);

/* Makes a task that is new or suspended ready to run, the last among those of its priority.
 * thread: 0 is the current one. Returns 0, or -1 without multi-tasking or if the task has ended.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSReady(struct tcb *thread);

/* Suspends a task until it is made ready.
 * thread: 0 is the current one. Returns 0, or -1 without multi-tasking or if the task has ended.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSSuspend(struct tcb *thread);

/* Lets the next ready task of the same or a higher priority run. Returns 0, or -1 without multi-tasking.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSReschedule(void);

/* Suspends the current task until it is made ready. Returns 0, or -1 without multi-tasking.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSYield(void);

/* Makes a task ready as OSReady does, then lets the next one run as OSReschedule does.
 * Returns 0, or -1 without multi-tasking or if the task has ended.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSRun(struct tcb *thread);

/* The number that a task was created with.
 * thread: 0 is the current one. Returns the number; 0 for the first task, or if the task has ended.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSGetUID(struct tcb *thread);

/* Ends a task immediately; its destructors run. Ending the first task ends the program. thread: 0 is the
 * current one. Returns 0, or -1 without multi-tasking or if the task has ended.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSKill(struct tcb *thread);

/* Ends the current task; without multi-tasking, and from the first task, the program, as exit(code) does. code: exit
 * code of the program. Returns nothing: the call does not return.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSExit(int code);

/* Shows a text and stops the robot forever. message: the text. Returns nothing: the call does not return.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSPanic(const char *message);

/* Lets the other tasks run for a time; without multi-tasking the same as OSWait.
 * n: hundredths of a second. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSSleep(int n);

/* Switches pre-emption off, until OSPermit. Returns 0, or -1 without multi-tasking.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSForbid(void);

/* Switches pre-emption on, in mode PREEMPT. Returns 0, or -1 without multi-tasking.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSPermit(void);

/* Initialises a semaphore; a repeated initialisation creates a new one.
 * sem: a variable of the program. val: initial number of permits. Returns 0, or -1 if sem is 0 or val below 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSSemInit(struct sem *sem, int val);

/* Takes a permit of a semaphore or waits for one: first come, first served. Works without multi-tasking too.
 * Returns 0, or -1 if sem is 0 or was not initialised.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSSemP(struct sem *sem);

/* Adds a permit to a semaphore; it goes to the task that has waited longest, if any.
 * Returns 0, or -1 if sem is 0 or was not initialised.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSSemV(struct sem *sem);

/* ---- Time: time and timers ---- */

/* Sets the clock of this robot.
 * h: 0 to 23. m, s: 0 to 59. Returns 0, or -1 for another time.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, timer. */
int OSSetTime(int h, int m, int s);

/* Reads the clock of this robot; it starts at 0:00:00. h, m, s: set to hours, minutes and seconds; may be 0. ticks:
 * set to hundredths of a second; may be 0. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, timer. */
int OSGetTime(int *h, int *m, int *s, int *ticks);

/* Writes the clock to the LCD, at the cursor. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, timer. */
int OSShowTime(void);

/* Time since the robot's start. Returns hundredths of a second.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, timer. */
int OSGetCount(void);

/* Waits. n: hundredths of a second. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, timer. */
int OSWait(int n);

/* Calls a function periodically, inside the call in progress at that time; it is never re-entered. scale: period in
 * hundredths of a second, at least 1. f: the function; it must be short and must not wait. Returns a handle, or 0 if
 * the list is full, scale is below 1 or f is 0.
 * [any task of the robot]  The function is kept until the program ends.
 * Source: RoBIOS 6 library, timer. */
TimerHandle OSAttachTimer(int scale, TimerFnc f);

/* Stops a timer of OSAttachTimer. Returns 1, or 0 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, timer. */
int OSDetachTimer(TimerHandle handle);

/* ---- RS232: serial interfaces and download ---- */

/* Opens a serial interface.
 * baud: SER4800 to SER115200. handshake: NONE or RTSCTS. interface: SERIAL1 to SERIAL3.
 * Returns 0, or not 0 for other values.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSInitRS232(int baud, int handshake, int interface);

/* Sends a byte. chr: the byte. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSSendCharRS232(char chr, int interface);

/* Sends text. s: the text. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure or if s is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, serial communication. */
int OSSendRS232(const char *s, int interface);

/* Waits for a byte. buf: set to the byte. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure or if buf is
 * 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, serial communication. */
int OSRecvRS232(char *buf, int interface);

/* Discards received bytes. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSFlushInRS232(int interface);

/* Discards bytes not yet sent. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSFlushOutRS232(int interface);

/* Counts the bytes received and not yet read. interface: SERIAL1 to SERIAL3. Returns their number; below 0 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSCheckInRS232(int interface);

/* Counts the bytes not yet sent. interface: SERIAL1 to SERIAL3. Returns their number; below 0 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSCheckOutRS232(int interface);

/* Loads a user program over a serial interface; not available on a simulated robot. name: at least 16 bytes for the
 * program's name. bytes: set to the number of bytes loaded. baud: SER4800 to SER115200. handshake: NONE or RTSCTS.
 * interface: SERIAL1 to SERIAL3. Returns 0 when done, 99 to be called again, or another number on failure.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, serial communication. */
int OSDownload(char *name, int *bytes, int baud, int handshake, int interface);

/* Starts the loaded user program; a simulated robot has none. Returns -1.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int USRStart(void);

/* Keeps the loaded user program over a reset.
 * name: what it is called. mode: SET (TRUE) or RESET (FALSE). Returns 0, or -1 if there is none.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, serial communication. */
int USRResident(const char *name, BOOL mode);

/* ---- AU: sound ---- */

/* Plays a sample; does not wait.
 * sample: a WAV file in memory, or the name of one. Returns its rate in Hz, or 0 if it is not one.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, audio. */
int AUPlaySample(char *sample);

/* Checks whether the sample is over. Returns FALSE while a sample is being played, otherwise TRUE.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUCheckSample(void);

/* Plays a tone; does not wait.
 * freq_hz: 65 to 21000. span_ms: milliseconds. Returns 0, or -1 for other values.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUTone(int freq_hz, int span_ms);

/* Checks whether the tone is over. Returns FALSE while a tone is being played, otherwise TRUE.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUCheckTone(void);

/* Plays a short tone; does not wait. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUBeep(void);

/* Records from the microphone.
 * buf: buffer for the sample, written before the return. len: its size in bytes. freq: wanted rate in Hz.
 * Returns the rate in Hz, or 0 if buf is 0 or len is not positive.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, audio. */
int AURecordSample(BYTE *buf, long len, long freq);

/* Checks whether the recording is over. Returns FALSE while a recording is in progress, otherwise TRUE.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUCheckRecord(void);

/* The current value of the microphone. Returns 0 to 1023; 512 is silence.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUCaptureMic(void);

/* ---- PSD: infrared distance sensors, results in millimetres ---- */

/* Initialises a PSD sensor.
 * semantics: PSD_FRONT and so on. Returns a handle (one bit), or 0 if the robot has no such sensor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
PSDHandle PSDInit(DeviceSemantics semantics);

/* Stops measuring and releases all PSD sensors. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
int PSDRelease(void);

/* Starts measuring.
 * bitmask: handles, OR-ed. cycle: TRUE measures continuously, FALSE once.
 * Returns 0, 1 if another measurement is still in progress, or -1 if bitmask has a bit that is not a handle.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
int PSDStart(PSDHandle bitmask, BOOL cycle);

/* Stops measuring at the end of the cycle in progress. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
int PSDStop(void);

/* Checks whether there is a valid result, that is after the first complete cycle. Returns TRUE or FALSE.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
BOOL PSDCheck(void);

/* Distance measured by the last complete cycle. handle: of PSDInit; 0 asks for the time stamp of the measurement.
 * Returns millimetres, PSD_OUT_OF_RANGE if nothing is within range or handle is invalid; for handle 0 hundredths of a
 * second.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
int PSDGet(PSDHandle handle);

/* Raw value measured by the last complete cycle. handle: of PSDInit; 0 asks for the time stamp of the measurement.
 * Returns 0 to 255, 0 if nothing is within range; for handle 0 hundredths of a second.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
int PSDGetRaw(PSDHandle handle);

/* ---- SERVO: servos ---- */

/* Initialises a servo.
 * semantics: SERVO1 and so on. Returns a handle, or 0 if the robot has no such servo.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
ServoHandle SERVOInit(DeviceSemantics semantics);

/* Releases servos.
 * handle: handles, OR-ed. Returns 0; 0x11110000 if no handle is valid; otherwise the handles not released.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
int SERVORelease(ServoHandle handle);

/* Turns a servo.
 * handle: of SERVOInit. angle: 0 to 255, the middle is 127 or 128. Returns 0, or -1 if handle or angle is
 * invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
int SERVOSet(ServoHandle handle, int angle);

/* ---- MOTOR: motors ---- */

/* Initialises a motor.
 * semantics: MOTOR_LEFT and so on. Returns a handle, or 0 if the robot has no such motor or VW uses it.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
MotorHandle MOTORInit(DeviceSemantics semantics);

/* Stops and releases motors.
 * handle: handles, OR-ed. Returns 0; 0x11110000 if no handle is valid; otherwise the handles not released.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
int MOTORRelease(MotorHandle handle);

/* Sets a motor's speed.
 * handle: handles, OR-ed. speed_percent: -100 (full backwards) to 100.
 * Returns 0, or -1 if one of the handles is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
int MOTORDrive(MotorHandle handle, int speed_percent);

/* ---- QUAD: wheel encoders ---- */

/* Initialises an encoder; its count starts at 0.
 * semantics: QUAD_LEFT and so on. Returns a handle, or 0 if the robot has no such encoder.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
QuadHandle QUADInit(DeviceSemantics semantics);

/* Releases encoders.
 * handle: handles, OR-ed. Returns 0, or -1 if no handle is valid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
int QUADRelease(QuadHandle handle);

/* Sets the counts of encoders to 0.
 * handle: handles, OR-ed. Returns 0, or -1 if one of them is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
int QUADReset(QuadHandle handle);

/* Count of an encoder since its reset, increasing when the wheel turns forward. Returns counts; 0 if handle
 * is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
int QUADRead(QuadHandle handle);

/* The motor of an encoder's wheel.
 * semantics: QUAD_LEFT and so on. Returns MOTOR_LEFT and so on, or 0 if the robot has no such encoder.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
DeviceSemantics QUADGetMotor(DeviceSemantics semantics);

/* Distance rolled by a wheel since QUADODOReset. Returns metres; 0 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
float QUADODORead(QuadHandle handle);

/* Sets the rolled distance of wheels to 0; their counts stay.
 * handle: handles, OR-ed. Returns 0, or -1 if one of them is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
int QUADODOReset(QuadHandle handle);

/* ---- VW: driving: metres, radians, seconds; x forward, y left, phi counter-clockwise ---- */

/* Initialises the driving interface and sets position and heading to 0; it takes motors and encoders.
 * semantics: VW_DRIVE. Timescale: control runs at 100 Hz/Timescale, usually 1.
 * Returns a handle, or 0 if the robot cannot drive, it is already in use or Timescale is below 1.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
VWHandle VWInit(DeviceSemantics semantics, int Timescale);

/* Stops the robot and releases the driving interface. Returns 0, or -1 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWRelease(VWHandle handle);

/* Sets the speed, until the next command; starts at the end of the call and replaces a drive in progress. v_mps: m/s,
 * negative = backwards. w_radps: rad/s, positive = counter-clockwise. Returns 0, or -1 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWSetSpeed(VWHandle handle, meterPerSec v_mps, radPerSec w_radps);

/* Reads the speed by odometry. vw: set to v in m/s and w in rad/s. Returns 0, or -1 if handle is invalid or vw is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, VW interface. */
int VWGetSpeed(VWHandle handle, SpeedType *vw);

/* Sets the position of the odometry; the robot does not move.
 * x_m, y_m: metres. phi_rad: radians. Returns 0, or -1 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWSetPosition(VWHandle handle, meter x_m, meter y_m, radians phi_rad);

/* Reads the position by odometry. pos: set to x and y in metres and phi in radians. Returns 0, or -1 if handle is
 * invalid or pos is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, VW interface. */
int VWGetPosition(VWHandle handle, PositionType *pos);

/* Starts the PI controllers of speed and rate of turn: output = V * (e + 1/T * integral of e). Typical: 7, 0.3, 10,
 * 0.1. Vv: gain for the speed. Tv: time for the speed, in seconds. Vw: gain for the rate of turn. Tw: time for the
 * rate of turn, in seconds. Returns 0, or -1 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWStartControl(VWHandle handle, float Vv, float Tv, float Vw, float Tw);

/* Stops the PI controllers: speeds are open loop again. Returns 0, or -1 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWStopControl(VWHandle handle);

/* Drives straight ahead; starts at the end of the call, replaces a drive in progress and does not wait. delta_m:
 * distance in metres, negative = backwards. v_mps: speed in m/s, > 0. Returns 0, or -1 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWDriveStraight(VWHandle handle, meter delta_m, meterPerSec v_mps);

/* Turns on the spot; starts at the end of the call, replaces a drive in progress and does not wait. delta_rad: angle
 * in radians, positive = counter-clockwise. w_radps: rate in rad/s, > 0. Returns 0, or -1 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWDriveTurn(VWHandle handle, radians delta_rad, radPerSec w_radps);

/* Drives along a circular arc; starts at the end of the call, replaces a drive in progress and does not wait.
 * delta_l_m: length of the arc in metres, negative = backwards. delta_phi_rad: change of heading in radians, positive
 * = counter-clockwise. v_mps: speed in m/s, > 0. Returns 0, or -1 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWDriveCurve(VWHandle handle, meter delta_l_m, radians delta_phi_rad, meterPerSec v_mps);

/* Remainder of the drive in progress. Returns metres, for a turn radians, for a curve its length; 0 when done or if
 * handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
float VWDriveRemain(VWHandle handle);

/* Checks whether the drive has ended. Returns 1 if it has ended, 0 if it is in progress, -1 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWDriveDone(VWHandle handle);

/* Waits until the drive has ended. Returns 0, or -1 immediately if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWDriveWait(VWHandle handle);

/* Checks whether a motor is stalled. Returns 1 if one is, 0 if none is or there is no command, -1 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWStalled(VWHandle handle);

/* ---- BUMP: bumpers ---- */

/* Initialises a bumper.
 * semantics: BUMP_LEFT and so on. Returns a handle, or 0 if the robot has no such bumper.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
BumpHandle BUMPInit(DeviceSemantics semantics);

/* Releases bumpers.
 * handle: handles, OR-ed. Returns 0; 0x11110000 if no handle is valid; otherwise the handles not released.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
int BUMPRelease(BumpHandle handle);

/* Checks a bumper for contacts since the last check.
 * timestamp: time of the first contact, in hundredths of a second; may be 0.
 * Returns 0 if there was a contact, -1 if there was none or handle is invalid.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
int BUMPCheck(BumpHandle handle, int *timestamp);

/* ---- IR: infrared proximity sensors ---- */

/* Initialises an infrared sensor.
 * semantics: IR_LEFT and so on. Returns a handle, or 0 if the robot has no such sensor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
IRHandle IRInit(DeviceSemantics semantics);

/* Releases infrared sensors.
 * handle: handles, OR-ed. Returns 0; 0x11110000 if no handle is valid; otherwise the handles not released.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
int IRRelease(IRHandle handle);

/* Reads an infrared sensor. Returns 1 if an object is near, 0 if not, -1 if handle is invalid.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
int IRRead(IRHandle handle);

/* ---- Latch: latches, parallel port, analogue inputs ---- */

/* Reads an input latch. n: its number, 0 to 3. Returns its byte, 0 for another n.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSReadInLatch(int n);

/* Writes an output latch: new = (old & mask) | value. n: its number, 0 to 3. mask: bits to keep. value: bits to set.
 * Returns the old byte, 0 for another n.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSWriteOutLatch(int n, BYTE mask, BYTE value);

/* Reads an output latch. n: its number, 0 to 3. Returns its byte, 0 for another n.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSReadOutLatch(int n);

/* Reads the data byte of the parallel port. Returns the byte.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSReadParData(void);

/* Writes the data byte of the parallel port. value: the byte.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
void OSWriteParData(BYTE value);

/* Reads the status byte of the parallel port. Returns the byte.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSReadParSR(void);

/* Writes the control byte of the parallel port. value: the byte.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
void OSWriteParCTRL(BYTE value);

/* Reads the control byte of the parallel port. Returns the byte.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSReadParCTRL(void);

/* Reads an analogue input. channel: 0 to 15. Returns 0 to 1023, -1 for another channel.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
int OSGetAD(int channel);

/* Switches the analogue converter off. mode: 1 idle, 0 off. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
int OSOffAD(int mode);

/* ---- COMPASS: the compass ---- */

/* Initialises the compass. semantics: COMPASS. Returns 0, or not 0 if the robot has none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSInit(DeviceSemantics semantics);

/* Starts measuring. cycle: TRUE measures continuously, FALSE once. Returns 0, or 1 if it is not ready.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSStart(BOOL cycle);

/* Checks whether a result is available. Returns 1 if it is, otherwise 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSCheck(void);

/* Stops measuring. Returns 0, or 1 if it is not ready.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSStop(void);

/* Releases the compass. Returns 0, or 1 if it is not ready.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSRelease(void);

/* The last result of the compass. Returns 0 to 359 degrees, clockwise from north (the world's +y); -1 if there is
 * none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSGet(void);

/* Calibrates. mode: 1 resets the calibration, 0 is called in two opposite headings.
 * Returns 0, or 1 if it is not ready.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSCalibrate(int mode);

/* ---- IRTV: TV remote control ---- */

/* Starts receiving with the settings of the device table.
 * semantics: IRTV. Returns 0, or not 0 if the robot has no receiver.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
int IRTVInitHDT(DeviceSemantics semantics);

/* Starts receiving.
 * type_code: SPACE_CODE, PULSE_CODE, MANCHESTER_CODE or RAW_CODE. length: bits of a code.
 * tog_mask: bits that toggle. inv_mask: bits that are inverted. mode: DEFAULT_MODE, SLOPPY_MODE or
 * REPCODE_MODE. bufsize: capacity of the buffer in codes, 1 to 4. delay: hundredths of a second before a key repeats.
 * Returns 0, or not 0 if the robot has no receiver.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
int IRTVInit(int type_code, int length, int tog_mask, int inv_mask, int mode, int bufsize, int delay);

/* Stops receiving.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
void IRTVTerm(void);

/* The code that is being received, without waiting. Returns the code; 0 if there is none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
int IRTVPressed(void);

/* The next code that has been received, without waiting. Returns the code; 0 if there is none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
int IRTVRead(void);

/* Waits for the next code. Returns the code; 0 immediately if nothing is being received.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
int IRTVGet(void);

/* Discards received codes.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
void IRTVFlush(void);

/* Reads the settings of IRTVInit. type_code, length, tog_mask, inv_mask, mode, bufsize, delay: set to those of
 * IRTVInit; may be 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, infrared remote control. */
void IRTVGetStatus(int *type_code, int *length, int *tog_mask, int *inv_mask, int *mode, int *bufsize, int *delay);

/* ---- RADIO: radio between robots ---- */

/* Switches the radio on, with the settings of RADIOSetIoctl. Returns 0, -1 if it is on already.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOInit(void);

/* Switches the radio off: messages that wait or are in transit are lost. Returns 0, -1 if it is off.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOTerm(void);

/* Sends a message, without waiting for the transmission and without acknowledgement. id: the receiver, BROADCAST for
 * all robots. byteCount: 0 to MAXMSGLEN. buffer: the bytes. Returns 0, or 1 if the radio is off, the message is too
 * long, buffer is 0, or 1024 bytes are already waiting to be sent.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOSend(BYTE id, int byteCount, BYTE *buffer);

/* Counts the messages that wait to be received. Returns their number; 0 if the radio is off.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOCheck();

/* Waits for a message, which may be damaged: there is no checksum. id: set to the address of its sender; may be 0.
 * bytesReceived: set to its length; may be 0. buffer: at least MAXMSGLEN bytes; a longer message is cut to these.
 * Returns 0, or -1 immediately if the radio is off or buffer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIORecv(BYTE *id, int *bytesReceived, BYTE *buffer);

/* Reads the settings of the radio. p: set to the settings. Returns 0, or -1 if p is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOGetIoctl(RadioIOParameters *p);

/* Changes the settings of the radio, before RADIOInit. p: the settings; speed and id have an effect, the others are only stored.
 * Returns 0, or -1 if p is 0, a setting is invalid, or the radio is on; then nothing changes.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOSetIoctl(RadioIOParameters *p);

/* Reads the state of the radio. s: set to the state. Returns 0, or -1 if the radio is off or s is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOGetStatus(RadioStatus *s);

/* ---- RANGE: range sensors beyond RoBIOS ---- */

/* Signal underlying the distance of the last complete cycle: that of a reflectance sensor, in 1/m; the echo energy of
 * a sonar, 1 for a perfect reflector 1 m ahead; for other sensors 1 with an echo, 0 without. handle: of PSDInit.
 * Returns the signal, -1 if handle is invalid, or nothing has been measured.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
float PSDGetSignal(PSDHandle handle);

/* Scans once with the laser scanner, from left to right; the middle point (of n, that of index n/2) is straight
 * ahead. distance: set to distances in millimetres, 9999 if out of range. size: capacity of distance; as many points
 * as fit are written. Returns the number of points of the scan, or -1 if there is no scanner or distance is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int LIDARScan(int distance[], int size);

/* ---- TRUTH: what the camera's last image shows, in simulation only ---- */

/* Depth of each pixel of the last image: distance along the line of sight, in mm, without noise; INFINITY for the sky.
 * mm: 60 rows of 80 numbers, row 0 at the top. Returns 0, -1 if mm is 0 or no image has been taken.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int CAMGetDepth(float *mm);

/* Label of each pixel of the last image: CAM_SKY, CAM_FLOOR, CAM_WALL, or CAM_BODY + n for robot or object n, numbered as in
 * SIMGetRobot and SIMGetObject: robots from 1, then the objects.
 * labels: 60 rows of 80 numbers, row 0 at the top. Returns 0, -1 if labels is 0 or no image has been taken.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int CAMGetLabels(int *labels);

/* ---- LEG: legs ---- */

/* The number of legs. Legs, joints, links and gaits are numbered from 1, in the order of the robi file. Returns the
 * number; 0 if the robot has no legs.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGCount(void);

/* Switches to another gait; each leg changes when it is next lifted.
 * gait: from 1. Returns 0, -1 if there are no legs or no such gait.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGSetGait(int gait);

/* Walks at this speed until the next command, sideways too; 0, 0, 0 stops. A twist beyond the capability of the legs
 * is scaled down as a whole. vx_mmps: mm/s forward. vy_mmps: mm/s to the left. omega_degps: degrees/s
 * counter-clockwise. Returns 0, -1 if there are no legs.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGSetSpeed(int vx_mmps, int vy_mmps, int omega_degps);

/* Sets the height to which feet are lifted; each leg applies it from its next step on.
 * height_mm: 0 or more. Returns 0, -1 if there are no legs or the height is negative or beyond the legs.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGSetStep(int height_mm);

/* Current angle of a joint from its encoder, without noise. leg: from 1. joint: from 1 at the body. degrees: positive
 * as in the robi file: yaw to the left, roll, thigh forward, knee bent, toes up. Returns 0, -1 if there is no such leg
 * or joint or degrees is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int LEGGetJoint(int leg, int joint, float *degrees);

/* Current pose of a link of a leg in the frame of the body, computed from the joint angles. leg: from 1. link: from 1,
 * the thigh. pose: set to 6 numbers: x forward, y left, z up, in mm; roll, pitch, yaw in degrees. Returns 0, -1 if
 * there is no such leg or link or pose is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int LEGGetLink(int leg, int link, float pose[6]);

/* Current height of the body frame above the world's floor, computed from the legs: 0 upright on the floor. mm: set to
 * millimetres up. Returns 0, -1 if there are no legs or mm is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int LEGGetHeight(float *mm);

/* Checks whether a foot is on the ground. leg: from 1. Returns 1 if it is, 0 if it is in the air, -1 if there is no such
 * leg.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGGetFoot(int leg);

/* Corrects the steps of a leg, from the next instant at which its foot is in the air until the next correction. leg:
 * from 1. dx_mm: mm forward of the foothold of the gait. dy_mm: mm to the left of the foothold of the gait. dz_mm:
 * additional lift of the foot, mm. Returns 0, -1 if there is no such leg or the foothold is out of its reach.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGCorrect(int leg, int dx_mm, int dy_mm, int dz_mm);

#ifdef __cplusplus
}
#endif

#include "variants.h"

#endif
