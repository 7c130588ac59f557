/* RoBIOS 6 for robot programs.
 *
 * Every call takes effect, and reads what it reads, at its end. Those that wait say so; the others return at once.
 * [any task of the robot] marks who may call a function: all may be called from timer functions too, where those
 * that wait are errors. No call keeps a pointer. Null pointers and wrong handles give the documented failure.
 *
 * Generated from the lists in robios-sys/src; change them, then: cargo run -p robios-sys --bin generate */
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
#define ANYKEY              (-1) /* KEYWait: whichever key. */
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
#define FPS60                  0 /* CAMSet: 60 frames a second. */
#define FPS30                  1 /* CAMSet: 30 frames a second. */
#define FPS15                  2 /* CAMSet: 15 frames a second. */
#define FPS7_5                 3 /* CAMSet: 7.5 frames a second. */
#define FPS3_75                4 /* CAMSet: 3.75 frames a second. */
#define FPS1_875               5 /* CAMSet: 1.875 frames a second. */
#define FPS0_9375              6 /* CAMSet: 0.9375 frames a second. */
#define FPS0_46875             7 /* CAMSet: 0.46875 frames a second. */
#define VEHICLE                1 /* OSMachineType: a vehicle. */
#define PLATFORM               2 /* OSMachineType: a platform. */
#define WALKER                 3 /* OSMachineType: a walking machine. */
#define COOP                   0 /* OSMTInit: tasks give the processor up themselves. */
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
#define SPACE_CODE             0 /* IRTVInit: bits are told by the length of the pause between pulses. */
#define PULSE_CODE             1 /* IRTVInit: bits are told by the length of the pulses. */
#define MANCHESTER_CODE        2 /* IRTVInit: bits are told by the direction of an edge. */
#define RAW_CODE               3 /* IRTVInit: codes are a raw sequence of lengths. */
#define DEFAULT_MODE           0 /* IRTVInit: only complete codes count. */
#define SLOPPY_MODE            1 /* IRTVInit: incomplete codes count. */
#define REPCODE_MODE           2 /* IRTVInit: a special code repeats the last one. */

#ifdef __cplusplus
extern "C" {
#endif

/* ---- OS: the machine, its errors and variables ---- */

/* Version of RoBIOS as text, such as `6.5`.
 * In C the text stays valid and unchanged until the program ends; it may not be written to.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, system functions. */
char *OSVersion(void);

/* Shows an error: text and number on the LCD and in the record of the run.
 * dead: if not 0, the robot stops here for ever; else the program waits for a key and goes on.
 * Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, system functions. */
int OSError(const char *message, int number, BOOL dead);

/* The kind of machine: VEHICLE, PLATFORM or WALKER.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSMachineType(void);

/* Clock rate of the processor in Hz.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSMachineSpeed(void);

/* Name of the robot as text.
 * In C the text stays valid and unchanged until the program ends; it may not be written to.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, system functions. */
char *OSMachineName(void);

/* The robot's number, 1 to 255, unique in the scene; also its address on the radio.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
BYTE OSMachineID(void);

/* Lets interrupts through again: timers run. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSEnable(void);

/* Holds interrupts back: timers do not run until OSEnable. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSDisable(void);

/* Value of a system variable; 0 if it was never set.
 * num: which one, 0 to 15. Returns the value, 0 for another num.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSGetVar(int num);

/* Sets a system variable of this robot.
 * num: which one, 0 to 15. Returns 0, or -1 for another num.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, system functions. */
int OSPutVar(int num, int value);

/* ---- HDT: the table of the robot's devices ---- */

/* Whether the table of devices is sound. Returns 0 if it is.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, hardware description table; layout of an entry: our choice. */
int HDT_Validate(void);

/* Looks a device up.
 * type_id: HDT_MOTOR and so on, 0 for any. semantics: MOTOR_LEFT and so on.
 * Returns a pointer to an HDT_entry_type that stays valid until the next call, or 0 if there is no such
 * device.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, hardware description table; layout of an entry: our choice. */
void *HDT_FindEntry(TypeID type_id, DeviceSemantics semantics);

/* Looks the n-th device of a kind up, for going through all of them.
 * type_id: HDT_MOTOR and so on. index: 0 for the first one. entry: where the device goes.
 * Returns 0, or -1 if there are not as many or a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, hardware description table; layout of an entry: our choice. */
int HDT_FindTable(TypeID type_id, int index, HDT_entry_type *entry);

/* How many devices of a kind the robot has.
 * type_id: HDT_MOTOR and so on. Returns the number, 0 for an unknown kind.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, hardware description table; layout of an entry: our choice. */
int HDT_TypeCount(TypeID type_id);

/* ---- LCD: the display: 128 x 64 pixels, 7 lines of 16 characters, the last one for the menu ---- */

/* Prints formatted text at the cursor, as printf does. \n starts a new line.
 * Returns 0, or -1 if format is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPrintf(const char *format, ...) EYESIM_PRINTF(1, 2);

/* Prints formatted text at a place, as printf does; the cursor stays behind it.
 * row: 0 (top) to 6. column: 0 (left) to 15. Returns 0, or -1 if format is 0 or the place is not on the LCD.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDSetPrintf(int row, int column, const char *format, ...) EYESIM_PRINTF(3, 4);

/* Clears the LCD and puts the cursor to the top left; the menu is cleared too. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDClear(void);

/* Writes a character at the cursor, which moves on. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutChar(char c);

/* Writes a character at a place; the cursor stays behind it.
 * row: 0 (top) to 6. column: 0 (left) to 15. Returns 0, or -1 if the place is not on the LCD.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDSetChar(int row, int column, char c);

/* Writes text at the cursor, which moves on. \n starts a new line.
 * Returns 0, or -1 if s is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutString(const char *s);

/* Writes text at a place; the cursor stays behind it.
 * row: 0 (top) to 6. column: 0 (left) to 15. Returns 0, or -1 if s is 0 or the place is not on the LCD.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDSetString(int row, int column, const char *s);

/* Writes a number in hexadecimal, 8 digits. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutHex(int v);

/* Writes the lowest byte of a number in hexadecimal, 2 digits. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutHex1(int v);

/* Writes a number in decimal. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutInt(int v);

/* Writes a number in decimal, right-aligned.
 * spaces: least number of characters. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutIntS(int v, int spaces);

/* Writes a number with its decimals, as %f of printf. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutFloat(float v);

/* Writes a number with its decimals, right-aligned.
 * spaces: least number of characters. decimals: digits after the point. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutFloatS(float v, int spaces, int decimals);

/* Sets how text behaves.
 * mode: SCROLLING or NONSCROLLING, and CURSOR or NOCURSOR, OR-ed. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDMode(int mode);

/* Moves the cursor.
 * row: 0 (top) to 6. column: 0 (left) to 15. Returns 0, or -1 if the place is not on the LCD.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDSetPos(int row, int column);

/* Where the cursor is. Returns 0, or -1 if a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDGetPos(int *row, int *column);

/* Shows the upper 54 rows of a grey image at the left of the LCD, so that the menu stays visible.
 * Returns 0, or -1 if buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutGraphic(image *buf);

/* Shows the upper 54 rows of a colour image in black and white, as LCDPutGraphic does.
 * buf is overwritten: it holds the black and white image afterwards.
 * Returns 0, or -1 if buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutColorGraphic(colimage *buf);

/* Sets all 128 x 64 pixels.
 * buf: 1024 bytes, 16 a row, the left pixel in the highest bit, 1 is black. Returns 0, or -1 if buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, LCD output. */
int LCDPutImage(BYTE *buf);

/* Writes the texts of the menu, above the keys.
 * Each at most 4 characters; "" (or 0) leaves an entry as it is, " " clears it. Returns 0.
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
 * Returns 0, or -1 if it is not on the LCD or val is another.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDSetPixel(int row, int col, int val);

/* Inverts a pixel.
 * row: 0 (top) to 63. col: 0 (left) to 127. Returns 0, or -1 if it is not on the LCD.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDInvertPixel(int row, int col);

/* A pixel: 0 clear, 1 set, -1 if it is not on the LCD.
 * row: 0 (top) to 63. col: 0 (left) to 127.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDGetPixel(int row, int col);

/* Draws a line between two pixels, both included; what lies outside of the LCD is left out.
 * x: 0 (left) to 127. y: 0 (top) to 63. col: 0 white, 1 black, 2 inverted. Returns 0, or -1 for another col.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDLine(int x1, int y1, int x2, int y2, int col);

/* Fills a rectangle, all edges included; what lies outside of the LCD is left out.
 * x: 0 (left) to 127, x1 < x2. y: 0 (top) to 63, y1 < y2. col: 0 white, 1 black, 2 inverted.
 * Returns 0, or -1 for another col or corners in another order.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, LCD output. */
int LCDArea(int x1, int y1, int x2, int y2, int col);

/* ---- KEY: the four keys under the LCD ---- */

/* Waits for a key and stores its code, KEY1 to KEY4.
 * Returns 0, or -1 at once if buf is 0.
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

/* Waits for a certain key; others are dropped.
 * excode: KEY1 to KEY4, several OR-ed, or ANYKEY. Returns 0, or -1 at once for another excode.
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

/* Takes a grey image; waits until it is there. Returns 0, or -1 if there is no camera or buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, camera. */
int CAMGetFrame(image *buf);

/* Takes a colour image; waits until it is there.
 * convert: 0 leaves red, green, blue; 1 turns it to 8-bit grey at the start of the same buffer.
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

/* The same as CAMGetFrameColor.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, camera. */
int CAMGetFrameRGB(BYTE *buf);

/* Takes the camera's raw values: 120 rows of 160 bytes behind its colour filter.
 * Returns 0, or -1 if there is no camera or buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, camera. */
int CAMGetFrameBayer(BYTE *buf);

/* Sets the camera.
 * Grey: brightness, offset, contrast. Colour: brightness, hue, saturation. EyeCam: p1 is the frame rate,
 * FPS60 to FPS0_46875. Returns 0, or -1 if there is no camera.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, camera. */
int CAMSet(int p1, int p2, int p3);

/* What CAMSet has set. Returns 0, or -1 if there is no camera or a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, camera. */
int CAMGet(int *p1, int *p2, int *p3);

/* Sets how the brightness is found.
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

/* Turns grey to black and white with a pattern of 2 x 2. Returns 0, or -1 if a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, image processing. */
int IPDither(image *src, image *dest);

/* Absolute difference of two images. Returns 0, or -1 if a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, image processing. */
int IPDiffer(image *current, image *last, image *dest);

/* Turns colour to grey. Returns 0, or -1 if a pointer is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, image processing. */
int IPColor2Grey(colimage *src, image *dest);

/* ---- MT: multi-tasking ---- */

/* Starts multi-tasking; the program becomes the first task, of priority IDLE_PRI.
 * mode: COOP (or DEFAULT): tasks change only where one gives way. PREEMPT: also every 10 ms and when one of
 * higher priority is ready, from OSPermit on. Returns 0, or -1 for another mode or if it was started before.
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

/* The mode of multi-tasking: COOP, PREEMPT, or NOTASK if it was not started.
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

/* Ends a task at once; its destructors run. Ending the first task ends the program.
 * thread: 0 is the current one. Returns 0, or -1 without multi-tasking or if the task has ended.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSKill(struct tcb *thread);

/* Ends the current task; without multi-tasking, and from the first task, the program, as exit(code) does.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSExit(int code);

/* Shows a text and stops the robot for ever. Does not return.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSPanic(const char *message);

/* Lets the other tasks run for a time; without multi-tasking the same as OSWait.
 * n: hundredths of a second. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSSleep(int n);

/* Keeps tasks from changing by themselves, until OSPermit. Returns 0, or -1 without multi-tasking.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSForbid(void);

/* Lets tasks change by themselves, in mode PREEMPT. Returns 0, or -1 without multi-tasking.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSPermit(void);

/* Makes a semaphore; one that is made anew is another one.
 * sem: the program's own. val: how many may pass at first. Returns 0, or -1 if sem is 0 or val below 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSSemInit(struct sem *sem, int val);

/* Passes a semaphore, or waits at it: first come, first served. Also without multi-tasking.
 * Returns 0, or -1 if sem is 0 or was not made.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSSemP(struct sem *sem);

/* Lets the task pass that has waited longest, or one more later.
 * Returns 0, or -1 if sem is 0 or was not made.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, multi-tasking. */
int OSSemV(struct sem *sem);

/* ---- Time: time and timers ---- */

/* Sets the clock of this robot.
 * h: 0 to 23. m, s: 0 to 59. Returns 0, or -1 for another time.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, timer. */
int OSSetTime(int h, int m, int s);

/* The clock of this robot; it starts at 0:00:00.
 * ticks: hundredths of a second. A pointer may be 0. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, timer. */
int OSGetTime(int *h, int *m, int *s, int *ticks);

/* Writes the clock to the LCD, at the cursor. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, timer. */
int OSShowTime(void);

/* Hundredths of a second since the robot's start.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, timer. */
int OSGetCount(void);

/* Waits. n: hundredths of a second. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, timer. */
int OSWait(int n);

/* Calls a function at regular times: every scale/100 seconds.
 * It is called inside of the call that is in progress then, never while it still runs itself; it must be
 * short and must not wait. Returns a handle, or 0 if the list is full, scale is below 1 or f is 0.
 * [any task of the robot]  The function is kept until the program ends.
 * Source: RoBIOS 6 library, timer. */
TimerHandle OSAttachTimer(int scale, TimerFnc f);

/* Stops the calls of OSAttachTimer. Returns 1, or 0 if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, timer. */
int OSDetachTimer(TimerHandle handle);

/* ---- RS232: serial interfaces and download ---- */

/* Sets a serial interface up.
 * baud: SER4800 to SER115200. handshake: NONE or RTSCTS. interface: SERIAL1 to SERIAL3.
 * Returns 0, or not 0 for other values.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSInitRS232(int baud, int handshake, int interface);

/* Sends a byte. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSSendCharRS232(char chr, int interface);

/* Sends text. interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure or if s is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, serial communication. */
int OSSendRS232(const char *s, int interface);

/* Waits for a byte.
 * interface: SERIAL1 to SERIAL3. Returns 0, or not 0 on failure or if buf is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, serial communication. */
int OSRecvRS232(char *buf, int interface);

/* Drops what has been received. Returns 0, or not 0 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSFlushInRS232(int interface);

/* Drops what has not been sent. Returns 0, or not 0 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSFlushOutRS232(int interface);

/* How many bytes have been received and not read; below 0 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSCheckInRS232(int interface);

/* How many bytes have not been sent yet; below 0 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int OSCheckOutRS232(int interface);

/* Loads a user program over a serial interface, which a simulated robot cannot.
 * name: at least 16 bytes for the program's name. bytes: how many were loaded.
 * Returns 0 when done, 99 to be called again, or another number on failure.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, serial communication. */
int OSDownload(char *name, int *bytes, int baud, int handshake, int interface);

/* Starts the user program that was loaded, which a simulated robot has none of. Returns -1.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, serial communication. */
int USRStart(void);

/* Makes the loaded user program stay over a reset.
 * name: what it is called. mode: SET (TRUE) or RESET (FALSE). Returns 0, or -1 if there is none.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, serial communication. */
int USRResident(const char *name, BOOL mode);

/* ---- AU: sound ---- */

/* Plays a sample; does not wait.
 * sample: a WAV file in memory, or the name of one. Returns its rate in Hz, or 0 if it is none.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, audio. */
int AUPlaySample(char *sample);

/* Whether no sample is being played: FALSE while one is.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUCheckSample(void);

/* Plays a tone; does not wait.
 * freq_hz: 65 to 21000. span_ms: milliseconds. Returns 0, or -1 for other values.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUTone(int freq_hz, int span_ms);

/* Whether no tone is being played: FALSE while one is.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUCheckTone(void);

/* Plays a short tone; does not wait. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUBeep(void);

/* Records from the microphone.
 * buf: where the sample goes, written before the return. len: its bytes. freq: wanted rate in Hz.
 * Returns the rate in Hz, or 0 if buf is 0 or len is not positive.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, audio. */
int AURecordSample(BYTE *buf, long len, long freq);

/* Whether nothing is being recorded: FALSE while it is.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUCheckRecord(void);

/* The microphone's value now, 0 to 1023; 512 is silence.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, audio. */
int AUCaptureMic(void);

/* ---- PSD: infrared distance sensors, results in millimetres ---- */

/* Makes a PSD sensor ready for measuring.
 * semantics: PSD_FRONT and so on. Returns a handle (one bit), or 0 if the robot has no such sensor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
PSDHandle PSDInit(DeviceSemantics semantics);

/* Stops measuring and releases all PSD sensors. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
int PSDRelease(void);

/* Starts measuring.
 * bitmask: handles, OR-ed. cycle: TRUE measures on and on, FALSE once.
 * Returns 0, 1 if another measurement is still running, or -1 if bitmask has a bit that is no handle.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
int PSDStart(PSDHandle bitmask, BOOL cycle);

/* Ends measuring after the cycle that is running. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
int PSDStop(void);

/* Whether there is a valid result: TRUE after the first cycle is complete, else FALSE.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
BOOL PSDCheck(void);

/* The distance that the last complete cycle has measured, in millimetres; PSD_OUT_OF_RANGE if nothing is
 * within range.
 * handle: of PSDInit; 0 asks for the time stamp of the measurement, in hundredths of a second.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
int PSDGet(PSDHandle handle);

/* The raw value that the last complete cycle has measured, 0 to 255.
 * handle: of PSDInit; 0 asks for the time stamp of the measurement, in hundredths of a second.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, position sensing devices. */
int PSDGetRaw(PSDHandle handle);

/* ---- SERVO: servos ---- */

/* Makes a servo ready.
 * semantics: SERVO1 and so on. Returns a handle, or 0 if the robot has no such servo.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
ServoHandle SERVOInit(DeviceSemantics semantics);

/* Releases servos.
 * handle: handles, OR-ed. Returns 0; 0x11110000 if none of it is a handle; else the handles not released.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
int SERVORelease(ServoHandle handle);

/* Turns a servo.
 * handle: of SERVOInit. angle: 0 to 255, the middle is 127 or 128. Returns 0, or -1 if handle is not one or
 * angle is another.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
int SERVOSet(ServoHandle handle, int angle);

/* ---- MOTOR: motors ---- */

/* Makes a motor ready.
 * semantics: MOTOR_LEFT and so on. Returns a handle, or 0 if the robot has no such motor or VW has it.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
MotorHandle MOTORInit(DeviceSemantics semantics);

/* Stops and releases motors.
 * handle: handles, OR-ed. Returns 0; 0x11110000 if none of it is a handle; else the handles not released.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
int MOTORRelease(MotorHandle handle);

/* Sets a motor's speed.
 * handle: handles, OR-ed. speed_percent: -100 (full backwards) to 100.
 * Returns 0, or -1 if handle has one that is none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, servos and motors. */
int MOTORDrive(MotorHandle handle, int speed_percent);

/* ---- QUAD: wheel encoders ---- */

/* Makes an encoder ready; its count starts at 0.
 * semantics: QUAD_LEFT and so on. Returns a handle, or 0 if the robot has no such encoder.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
QuadHandle QUADInit(DeviceSemantics semantics);

/* Releases encoders.
 * handle: handles, OR-ed. Returns 0, or -1 if none of it is a handle.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
int QUADRelease(QuadHandle handle);

/* Sets the counts of encoders to 0.
 * handle: handles, OR-ed. Returns 0, or -1 if it has one that is none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
int QUADReset(QuadHandle handle);

/* An encoder's count: ticks since the reset, more when the wheel turns forward; 0 if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
int QUADRead(QuadHandle handle);

/* The motor that belongs to an encoder.
 * semantics: QUAD_LEFT and so on. Returns MOTOR_LEFT and so on, or 0 if the robot has no such encoder.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
DeviceSemantics QUADGetMotor(DeviceSemantics semantics);

/* How far a wheel has rolled since QUADODOReset, in metres; 0 if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
float QUADODORead(QuadHandle handle);

/* Sets how far a wheel has rolled to 0; its count stays.
 * handle: handles, OR-ed. Returns 0, or -1 if it has one that is none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, encoders. */
int QUADODOReset(QuadHandle handle);

/* ---- VW: driving: metres, radians, seconds; x forward, y left, phi counter-clockwise ---- */

/* Makes the driving interface ready and sets position and heading to 0; it takes motors and encoders.
 * semantics: VW_DRIVE. Timescale: control runs at 100 Hz/Timescale, usually 1.
 * Returns a handle, or 0 if the robot cannot drive, it is already in use or Timescale is below 1.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
VWHandle VWInit(DeviceSemantics semantics, int Timescale);

/* Stops the robot and releases the driving interface. Returns 0, or -1 if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWRelease(VWHandle handle);

/* Sets the speed, until the next command.
 * v_mps: m/s, negative = backwards. w_radps: rad/s, positive = counter-clockwise.
 * Returns 0, or -1 if handle is not one. Starts at the end of the call and replaces a drive in progress.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWSetSpeed(VWHandle handle, meterPerSec v_mps, radPerSec w_radps);

/* The speed as the encoders show it. Returns 0, or -1 if handle is not one or vw is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, VW interface. */
int VWGetSpeed(VWHandle handle, SpeedType *vw);

/* Says where the robot is; it does not move.
 * x_m, y_m: metres. phi_rad: radians. Returns 0, or -1 if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWSetPosition(VWHandle handle, meter x_m, meter y_m, radians phi_rad);

/* Where the robot is, as the encoders show it. Returns 0, or -1 if handle is not one or pos is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, VW interface. */
int VWGetPosition(VWHandle handle, PositionType *pos);

/* Starts the PI controllers of speed and rate of turn: output = V * (e + 1/T * integral of e).
 * Vv, Tv: for the speed. Vw, Tw: for the rate of turn. Typical: 7, 0.3, 10, 0.1.
 * Returns 0, or -1 if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWStartControl(VWHandle handle, float Vv, float Tv, float Vw, float Tw);

/* Stops the PI controllers: speeds are open loop again. Returns 0, or -1 if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWStopControl(VWHandle handle);

/* Drives straight ahead.
 * delta_m: distance in metres, negative = backwards. v_mps: speed in m/s, > 0.
 * Returns 0, or -1 if handle is not one. Starts at the end of the call and replaces a drive in progress; does
 * not wait.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWDriveStraight(VWHandle handle, meter delta_m, meterPerSec v_mps);

/* Turns on the spot.
 * delta_rad: angle in radians, positive = counter-clockwise. w_radps: rate in rad/s, > 0.
 * Returns 0, or -1 if handle is not one. Starts at the end of the call and replaces a drive in progress; does
 * not wait.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWDriveTurn(VWHandle handle, radians delta_rad, radPerSec w_radps);

/* Drives along a circular arc.
 * delta_l_m: length of the arc in metres, negative = backwards. delta_phi_rad: change of heading in radians,
 * positive = counter-clockwise. v_mps: speed in m/s, > 0.
 * Returns 0, or -1 if handle is not one. Starts at the end of the call and replaces a drive in progress; does
 * not wait.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWDriveCurve(VWHandle handle, meter delta_l_m, radians delta_phi_rad, meterPerSec v_mps);

/* What remains of the drive in progress, in metres (for a turn radians; for a curve its length): 0 when done
 * or if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
float VWDriveRemain(VWHandle handle);

/* Whether the drive has ended: 1 if it has, 0 if it is in progress, -1 if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWDriveDone(VWHandle handle);

/* Waits until the drive has ended. Returns 0, or -1 at once if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWDriveWait(VWHandle handle);

/* Whether a motor is stalled: 1 if one is, 0 if none is or there is no command, -1 if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, VW interface. */
int VWStalled(VWHandle handle);

/* ---- BUMP: bumpers ---- */

/* Makes a bumper ready.
 * semantics: BUMP_LEFT and so on. Returns a handle, or 0 if the robot has no such bumper.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
BumpHandle BUMPInit(DeviceSemantics semantics);

/* Releases bumpers.
 * handle: handles, OR-ed. Returns 0; 0x11110000 if none of it is a handle; else the handles not released.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
int BUMPRelease(BumpHandle handle);

/* Whether something has bumped since the last check.
 * timestamp: when, the first time, in hundredths of a second; may be 0.
 * Returns 0 if something has, -1 if nothing has or handle is not one.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
int BUMPCheck(BumpHandle handle, int *timestamp);

/* ---- IR: infrared proximity sensors ---- */

/* Makes an infrared sensor ready.
 * semantics: IR_LEFT and so on. Returns a handle, or 0 if the robot has no such sensor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
IRHandle IRInit(DeviceSemantics semantics);

/* Releases infrared sensors.
 * handle: handles, OR-ed. Returns 0; 0x11110000 if none of it is a handle; else the handles not released.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
int IRRelease(IRHandle handle);

/* Whether something is near: 1 if it is, 0 if not, -1 if handle is not one.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, bumper and infrared sensors. */
int IRRead(IRHandle handle);

/* ---- Latch: latches, parallel port, analogue inputs ---- */

/* Reads an input latch. n: which one, 0 to 3. Returns its byte, 0 for another n.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSReadInLatch(int n);

/* Writes an output latch: new = (old & mask) | value.
 * n: which one, 0 to 3. Returns the old byte, 0 for another n.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSWriteOutLatch(int n, BYTE mask, BYTE value);

/* Reads an output latch. n: which one, 0 to 3. Returns its byte, 0 for another n.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSReadOutLatch(int n);

/* Reads the data byte of the parallel port.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSReadParData(void);

/* Writes the data byte of the parallel port.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
void OSWriteParData(BYTE value);

/* Reads the status byte of the parallel port.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSReadParSR(void);

/* Writes the control byte of the parallel port.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
void OSWriteParCTRL(BYTE value);

/* Reads the control byte of the parallel port.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
BYTE OSReadParCTRL(void);

/* An analogue input: 0 to 1023, -1 for another channel. channel: 0 to 15.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
int OSGetAD(int channel);

/* Switches the analogue converter off. mode: 1 idle, 0 off. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, latches, parallel port and A/D. */
int OSOffAD(int mode);

/* ---- COMPASS: the compass ---- */

/* Makes the compass ready. semantics: COMPASS. Returns 0, or not 0 if the robot has none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSInit(DeviceSemantics semantics);

/* Starts measuring. cycle: TRUE measures on and on, FALSE once. Returns 0, or 1 if it is not ready.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSStart(BOOL cycle);

/* Whether a result is there: 1 if it is, else 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSCheck(void);

/* Ends measuring. Returns 0, or 1 if it is not ready.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSStop(void);

/* Releases the compass. Returns 0, or 1 if it is not ready.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSRelease(void);

/* The last result: 0 to 359 degrees, clockwise from north (the world's +y); -1 if there is none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSGet(void);

/* Calibrates. mode: 1 resets the calibration, 0 is called in two opposite headings.
 * Returns 0, or 1 if it is not ready.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, compass. */
int COMPASSCalibrate(int mode);

/* ---- IRTV: TV remote control ---- */

/* Starts receiving with the settings of the table of devices.
 * semantics: IRTV. Returns 0, or not 0 if the robot has no receiver.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
int IRTVInitHDT(DeviceSemantics semantics);

/* Starts receiving.
 * type_code: SPACE_CODE, PULSE_CODE, MANCHESTER_CODE or RAW_CODE. length: bits of a code.
 * tog_mask: bits that toggle. inv_mask: bits that are inverted. mode: DEFAULT_MODE, SLOPPY_MODE or
 * REPCODE_MODE. bufsize: codes that are kept, 1 to 4. delay: hundredths of a second before a key repeats.
 * Returns 0, or not 0 if the robot has no receiver.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
int IRTVInit(int type_code, int length, int tog_mask, int inv_mask, int mode, int bufsize, int delay);

/* Stops receiving.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
void IRTVTerm(void);

/* The code that is being received, without waiting; 0 if there is none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
int IRTVPressed(void);

/* The next code that has been received, without waiting; 0 if there is none.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
int IRTVRead(void);

/* Waits for the next code and returns it; 0 at once if nothing is being received.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
int IRTVGet(void);

/* Drops the codes that have been received.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, infrared remote control. */
void IRTVFlush(void);

/* The settings of IRTVInit; a pointer may be 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, infrared remote control. */
void IRTVGetStatus(int *type_code, int *length, int *tog_mask, int *inv_mask, int *mode, int *bufsize, int *delay);

/* ---- RADIO: radio between robots ---- */

/* Switches the radio on, with the settings of RADIOSetIoctl. Returns 0, -1 if it is on already.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOInit(void);

/* Switches the radio off: messages that wait or are on their way are lost. Returns 0, -1 if it is off.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOTerm(void);

/* Sends a message; does not wait until it is sent, nor learns whether it arrives.
 * id: the receiver, BROADCAST for everybody. byteCount: 0 to MAXMSGLEN.
 * Returns 0, or 1 if the radio is off, the message is too long, buffer is 0, or 1024 bytes wait to be sent already.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOSend(BYTE id, int byteCount, BYTE *buffer);

/* How many messages wait to be received; 0 if the radio is off.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOCheck();

/* Waits for a message, which may be damaged: there is no checksum.
 * id: its sender. bytesReceived: its length. buffer: at least MAXMSGLEN bytes; a longer message is cut to these.
 * Returns 0, or -1 at once if the radio is off or buffer is 0; the other pointers may be 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIORecv(BYTE *id, int *bytesReceived, BYTE *buffer);

/* The settings of the radio. Returns 0, -1 if p is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOGetIoctl(RadioIOParameters *p);

/* Changes the settings of the radio, before RADIOInit: speed and id count, the others are kept.
 * Returns 0, or -1 if p is 0, a setting is not one that it may have, or the radio is on; then nothing changes.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOSetIoctl(RadioIOParameters *p);

/* State of the radio. Returns 0, -1 if it is off or s is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS 6 library, radio communication; fields of RadioStatus: our choice. */
int RADIOGetStatus(RadioStatus *s);

/* ---- RANGE: range sensors beyond RoBIOS ---- */

/* What the distance of the last complete cycle was made of: the signal of a reflectance sensor, in 1/m; the energy
 * of a sonar's echo, of which a perfect reflector 1 m ahead returns 1; of others 1 with an echo, 0 without.
 * handle: of PSDInit. Returns -1 if handle is not one, or nothing has been measured.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
float PSDGetSignal(PSDHandle handle);

/* Scans once with the laser scanner: distances in millimetres from left to right, the middle one (of n, that of
 * index n/2) straight ahead; 9999 for nothing.
 * size: room in distance; as many are written as fit. Returns the number of points of the scan, or -1 if there is
 * no scanner or distance is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int LIDARScan(int distance[], int size);

/* ---- TRUTH: what the camera's last image shows, in simulation only ---- */

/* How far away what each pixel of the last image shows is: along the line of sight, in mm, INFINITY for the sky.
 * mm: 60 rows of 80 numbers, row 0 on top, without errors. Returns 0, -1 if mm is 0 or no image has been taken.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int CAMGetDepth(float *mm);

/* What each pixel of the last image shows: CAM_SKY, CAM_FLOOR, CAM_WALL, or CAM_BODY + n for robot or object n, as
 * SIMGetRobot and SIMGetObject number them: robots from 1, objects on from the last robot.
 * labels: 60 rows of 80 numbers, row 0 on top. Returns 0, -1 if labels is 0 or no image has been taken.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int CAMGetLabels(int *labels);

/* ---- LEG: legs ---- */

/* Number of legs; 0 if the robot has none. Legs, joints, links and gaits are numbered from 1, as the robi has them.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGCount(void);

/* Walks in another gait from now on: each leg when it is lifted next.
 * gait: from 1. Returns 0, -1 if there are no legs or no such gait.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGSetGait(int gait);

/* Walks with this speed until further notice, sideways too; 0, 0, 0 stops.
 * vx_mmps: forward, vy_mmps: to the left, mm/s. omega_degps: counter-clockwise, degrees/s. A twist beyond what the
 * legs can do is slowed down as a whole. Returns 0, -1 if there are no legs.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGSetSpeed(int vx_mmps, int vy_mmps, int omega_degps);

/* Sets how high feet are lifted, each from its next step on.
 * height_mm: 0 or more. Returns 0, -1 if there are no legs or the height is negative or more than they can do.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGSetStep(int height_mm);

/* The angle of a joint, now: as its encoder tells it, without errors.
 * joint: from 1 at the body. degrees: the sign is that of the robi: yaw to the left, roll, thigh forward, knee
 * bent, toes up. Returns 0, -1 if there is no such leg or joint or degrees is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int LEGGetJoint(int leg, int joint, float *degrees);

/* Where a link of a leg is, now, in the frame of the body, by the joints' angles.
 * link: from 1, the thigh. pose: 6 numbers: x forward, y left, z up, in mm; roll, pitch, yaw in degrees.
 * Returns 0, -1 if there is no such leg or link or pose is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int LEGGetLink(int leg, int link, float pose[6]);

/* How high the body's frame is above the world's floor, now, as the legs tell it: 0 upright on the floor.
 * mm: up. Returns 0, -1 if there are no legs or mm is 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int LEGGetHeight(float *mm);

/* Whether a foot is on the ground, now: 1, 0 in the air, -1 if there is no such leg.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGGetFoot(int leg);

/* Moves where a leg treads: from the next instant at which its foot is in the air on, until it is called again.
 * dx_mm: forward, dy_mm: to the left of the foothold of the gait. dz_mm: how much higher the foot is lifted.
 * Returns 0, -1 if there is no such leg or it cannot reach so far.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
int LEGCorrect(int leg, int dx_mm, int dy_mm, int dz_mm);

#ifdef __cplusplus
}
#endif

#include "variants.h"

#endif
