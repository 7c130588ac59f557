/* RoBIOS-7 for robot programs.
 *
 * Every call takes effect, and reads what it reads, at its end. Those that wait say so; the others return at once.
 * [any task of the robot] marks who may call a function: all may be called from timer functions too, where those
 * that wait are errors. No call keeps a pointer. Null pointers and wrong handles give the documented failure.
 *
 * Generated from the lists in robios-sys/src; change them, then: cargo run -p robios-sys --bin generate */
#ifndef EYESIM_EYEBOT_H
#define EYESIM_EYEBOT_H

#include "types.h"

#define QQVGA                  0 /* 160 x 120 pixels. */
#define QVGA                   1 /* 320 x 240 pixels. */
#define VGA                    2 /* 640 x 480 pixels. */
#define CAM1MP                 3 /* 1296 x 730 pixels. */
#define CAMHD                  4 /* 1920 x 1080 pixels. */
#define CAM5MP                 5 /* 2592 x 1944 pixels. */
#define CUSTOM                10 /* The size that the program has written to CAMWIDTH and CAMHEIGHT, or to IP_WIDTH and IP_HEIGHT. */
#define CAM_SKY                0 /* CAMGetLabels: nothing. */
#define CAM_FLOOR              1 /* CAMGetLabels: the floor, with what is painted on it, or a terrain. */
#define CAM_WALL               2 /* CAMGetLabels: a wall. */
#define CAM_BODY              10 /* CAMGetLabels: robot or object n is this + n. */
#define RED               0xFF0000 /* Colour of 255, 0, 0. */
#define GREEN              65280 /* Colour of 0, 255, 0. */
#define BLUE                 255 /* Colour of 0, 0, 255. */
#define WHITE             0xFFFFFF /* Colour of 255, 255, 255. */
#define GRAY              0x808080 /* Colour of 128, 128, 128. */
#define BLACK                  0 /* Colour of 0, 0, 0. */
#define SILVER            0xC0C0C0 /* Colour of 192, 192, 192. */
#define LIGHTGRAY         0xD3D3D3 /* Colour of 211, 211, 211. */
#define DARKGRAY          0xA9A9A9 /* Colour of 169, 169, 169. */
#define NAVY                 128 /* Colour of 0, 0, 128. */
#define CYAN               61166 /* Colour of 0, 238, 238. */
#define TEAL               32896 /* Colour of 0, 128, 128. */
#define MAGENTA           0xFF00FF /* Colour of 255, 0, 255. */
#define PURPLE            0x800080 /* Colour of 128, 0, 128. */
#define MAROON            0x800000 /* Colour of 128, 0, 0. */
#define YELLOW            0xFFFF00 /* Colour of 255, 255, 0. */
#define OLIVE             0x9ACD32 /* Colour of 154, 205, 50. */
#define ORANGE            0xFFA500 /* Colour of 255, 165, 0. */
#define NOKEY                  0 /* No key is pressed. */
#define KEY1                   1 /* The left key under the LCD. */
#define KEY2                   2 /* The second key from the left. */
#define KEY3                   4 /* The third key from the left. */
#define KEY4                   8 /* The right key. */
#define ANYKEY              (-1) /* KEYWait: whichever key. */
#define KEY_INVALID         (-1) /* No such key. */
#define KEY_LIST1             16 /* First line of a list menu. */
#define KEY_LIST2             32 /* Second line of a list menu. */
#define KEY_LIST3             64 /* Third line of a list menu. */
#define KEY_LIST4            128 /* Fourth line of a list menu. */
#define KEY_LIST5            256 /* Fifth line of a list menu. */
#define KEY_LIST6            512 /* Sixth line of a list menu. */
#define KEY_LIST7           1024 /* Seventh line of a list menu. */
#define KEY_LIST8           2048 /* Eighth line of a list menu. */
#define KEY_LISTDN        0x10000000 /* A list menu's way down. */
#define KEY_LISTUP        0x20000000 /* A list menu's way up. */
#define KEY_LISTTL        0x40000000 /* A list menu's title. */
#define KEY_ESCAPE        (-2147483648) /* Escape. */
#define KEYTM_UNKNOWN          0 /* Touch map: not known. */
#define KEYTM_CLASSIC          1 /* Touch map: four keys. */
#define KEYTM_STANDARD         2 /* Touch map: standard. */
#define KEYTM_REGIONS          3 /* Touch map: regions that the program sets. */
#define KEYTM_LISTMENU         4 /* Touch map: a list menu. */
#define HELVETICA              0 /* LCDSetFont: without serifs. */
#define TIMES                  1 /* LCDSetFont: with serifs. */
#define COURIER                2 /* LCDSetFont: all characters of one width. */
#define NORMAL                 0 /* LCDSetFont: upright, of normal weight. */
#define BOLD                   1 /* LCDSetFont: bold. */
#define ITALICS                2 /* LCDSetFont: slanted. */
#define LCD_BGCOL_TRANSPARENT      1 /* LCDSetMode: text is drawn over what is there. */
#define LCD_BGCOL_NOTRANSPARENT   4096 /* LCDSetMode: text has a background. */
#define LCD_BGCOL_INVERSE      2 /* LCDSetMode: the background colour is inverted. */
#define LCD_BGCOL_NOINVERSE   8192 /* LCDSetMode: the background colour is as set. */
#define LCD_FGCOL_INVERSE      4 /* LCDSetMode: the text's colour is inverted. */
#define LCD_FGCOL_NOINVERSE  16384 /* LCDSetMode: the text's colour is as set. */
#define LCD_AUTOREFRESH        8 /* LCDSetMode: each call is shown at once. */
#define LCD_NOAUTOREFRESH  32768 /* LCDSetMode: what was drawn is shown by LCDRefresh. */
#define LCD_SCROLLING         16 /* LCDSetMode: text that leaves the last line moves all lines up. */
#define LCD_NOSCROLLING   0x010000 /* LCDSetMode: text that leaves the last line starts again in the first. */
#define LCD_LINEFEED          32 /* LCDSetMode: the end of a line goes on in the next. */
#define LCD_NOLINEFEED    0x020000 /* LCDSetMode: the end of a line stays in it. */
#define LCD_SHOWMENU          64 /* LCDSetMode: the menu is shown. */
#define LCD_HIDEMENU      0x040000 /* LCDSetMode: the menu is not shown. */
#define LCD_LISTMENU         128 /* LCDSetMode: the menu is a list. */
#define LCD_CLASSICMENU   0x080000 /* LCDSetMode: the menu has four keys. */
#define LCD_FB_ROTATE        256 /* LCDSetMode: the display is turned. */
#define LCD_FB_NOROTATION 0x100000 /* LCDSetMode: the display is not turned. */
#define VEHICLE                1 /* OSMachineType: drives. */
#define PLATFORM               2 /* OSMachineType: stands on a platform. */
#define WALKER                 3 /* OSMachineType: walks. */
#define PSD_FRONT              1 /* PSDGet: the sensor in front. */
#define PSD_LEFT               2 /* PSDGet: the left sensor. */
#define PSD_RIGHT              3 /* PSDGet: the right sensor. */
#define PSD_BACK               4 /* PSDGet: the sensor at the back. */
#define IRTV_0                48 /* IRTVGet: the digit 0; the others follow. */
#define IRTV_1                49 /* IRTVGet: the digit 1. */
#define IRTV_2                50 /* IRTVGet: the digit 2. */
#define IRTV_3                51 /* IRTVGet: the digit 3. */
#define IRTV_4                52 /* IRTVGet: the digit 4. */
#define IRTV_5                53 /* IRTVGet: the digit 5. */
#define IRTV_6                54 /* IRTVGet: the digit 6. */
#define IRTV_7                55 /* IRTVGet: the digit 7. */
#define IRTV_8                56 /* IRTVGet: the digit 8. */
#define IRTV_9                57 /* IRTVGet: the digit 9. */
#define IRTV_RED              82 /* IRTVGet: the red key. */
#define IRTV_GREEN            71 /* IRTVGet: the green key. */
#define IRTV_YELLOW           89 /* IRTVGet: the yellow key. */
#define IRTV_BLUE             66 /* IRTVGet: the blue key. */
#define IRTV_LEFT             76 /* IRTVGet: left. */
#define IRTV_RIGHT            62 /* IRTVGet: right. */
#define IRTV_UP               85 /* IRTVGet: up. */
#define IRTV_DOWN             68 /* IRTVGet: down. */
#define IRTV_OK               79 /* IRTVGet: OK. */
#define IRTV_POWER            80 /* IRTVGet: power. */

#ifdef __cplusplus
extern "C" {
#endif

/* ---- LCD: the colour display ---- */

/* Prints as printf does, at the cursor. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDPrintf(const char *format, ...) EYESIM_PRINTF(1, 2);

/* Prints as printf does, at a row and a column of characters, both from 0. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetPrintf(int row, int column, const char *format, ...) EYESIM_PRINTF(3, 4);

/* Makes the display black; the cursor goes to row 0, column 0; the menu stays. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDClear(void);

/* Moves the cursor. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetPos(int row, int column);

/* Where the cursor is. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDGetPos(int *row, int *column);

/* Colours of text from now on. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetColor(COLOR fg, COLOR bg);

/* Font of text from now on: HELVETICA, TIMES or COURIER; NORMAL, BOLD or ITALICS. Returns 0, 1 for others.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetFont(int font, int variation);

/* Size of text from now on: 8, 12, 14, 18 or 24. Returns 0, 1 for others.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetFontSize(int fontsize);

/* Modes, LCD_SCROLLING and the like, or-ed. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetMode(int mode);

/* Names the four keys under the display; an empty text clears a name. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDMenu(const char *st1, const char *st2, const char *st3, const char *st4);

/* Names one key, 1 to 4, with colours of its own. Returns 0, 1 if there is no such key.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDMenuI(int pos, const char *string, COLOR fg, COLOR bg);

/* Sets a line of a list menu, from 0, which is a key, such as KEY_LIST1, when touched, and shows the list; null ends the
 * list before that line. LCDList stands on it; not of RoBIOS. Returns how many lines there is room for, 0 if there is
 * no such line.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDListLine(int line, int key, const char *text, COLOR fg, COLOR bg);

/* Size of the display in pixels. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDGetSize(int *x, int *y);

/* Draws one pixel; x to the right, y down, from the upper left corner. Returns 0, here and in all that draw: what lies
 * outside of the display is left out.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDPixel(int x, int y, COLOR col);

/* Colour of one pixel; 0 outside of the display.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
COLOR LCDGetPixel(int x, int y);

/* Draws a line with both ends. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDLine(int x1, int y1, int x2, int y2, COLOR col);

/* Draws a rectangle between two corners; fill: if not 0, filled. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDArea(int x1, int y1, int x2, int y2, COLOR col, int fill);

/* Draws a circle; size: its radius in pixels. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDCircle(int x1, int y1, int size, COLOR col, int fill);

/* Inverts one pixel. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDPixelInvert(int x, int y);

/* Inverts the pixels of a line. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDLineInvert(int x1, int y1, int x2, int y2);

/* Inverts a filled rectangle. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDAreaInvert(int x1, int y1, int x2, int y2);

/* Inverts a filled circle. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDCircleInvert(int x1, int y1, int size);

/* Size of the images that LCDImage and the like show, a resolution such as QVGA; CUSTOM: CAMWIDTH x CAMHEIGHT. Returns 0, 1 for another number.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDImageSize(int t);

/* Place and size in pixels of the images that LCDImage and the like show. Returns 0, 1 for a size below 1 or of more
 * pixels than CAM5MP.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDImageStart(int x, int y, int xs, int ys);

/* Shows a colour image, 3 bytes a pixel, of the size that LCDImageStart or LCDImageSize has set. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDImage(BYTE *img);

/* Shows a grey image, 1 byte a pixel. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDImageGray(BYTE *g);

/* Shows a binary image, 1 byte a pixel: 0 is white, everything else black. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDImageBinary(BYTE *b);

/* Shows what has been drawn, where LCD_NOAUTOREFRESH is set. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDRefresh(void);

/* ---- KEY: the four keys, and touches of the display ---- */

/* Waits for a key. Returns KEY1, KEY2, KEY3 or KEY4.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, keys. */
int KEYGet(void);

/* The key that was pressed; NOKEY if none was. Does not wait.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, keys. */
int KEYRead(void);

/* Waits for one key, or with ANYKEY for whichever. Returns the key, KEY_INVALID if there is no such key.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, keys. */
int KEYWait(int key);

/* Waits for a touch of the display, and tells its place in pixels. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, keys. */
int KEYGetXY(int *x, int *y);

/* The place of a touch of the display. Does not wait. Returns 0 if there was one, else 1.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, keys. */
int KEYReadXY(int *x, int *y);

/* ---- CAM: the camera ---- */

/* Switches the camera on, with a resolution such as QVGA. Returns 0, 1 if there is no camera.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, camera. */
int CAMInit(int resolution);

/* Switches the camera off. Returns 0, 1 if there is no camera.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, camera. */
int CAMRelease(void);

/* Takes a colour image, 3 bytes a pixel, CAMSIZE in all, row 0 on top. Returns 0, 1 if there is no camera.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, camera. */
int CAMGet(BYTE *buf);

/* Takes a grey image, CAMPIXELS bytes. Returns 0, 1 if there is no camera.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, camera. */
int CAMGetGray(BYTE *buf);

/* ---- IP: image processing ---- */

/* Sets the size of the images of all IP functions; CUSTOM: what the program has written to IP_WIDTH and IP_HEIGHT.
 * Returns 0, 1 for another number.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, image processing. */
int IPSetSize(int resolution);

/* Reads a PNM file: P1 to P6; a size other than the images' is cut, or filled up with black. Grey files become grey
 * images, colour files colour images. Returns the digit of P1 to P6, -1 if it cannot be read.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
int IPReadFile(const char *filename, BYTE *img);

/* Writes a colour image as PPM. Returns 0, 1 if it cannot be written.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
int IPWriteFile(const char *filename, BYTE *img);

/* Writes a grey image as PGM. Returns 0, 1 if it cannot be written.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
int IPWriteFileGray(const char *filename, BYTE *gray);

/* Laplace edges of a grey image.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPLaplace(BYTE *grayIn, BYTE *grayOut);

/* Sobel edges of a grey image.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPSobel(BYTE *grayIn, BYTE *grayOut);

/* Grey of a colour image.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPCol2Gray(BYTE *imgIn, BYTE *grayOut);

/* A colour image that looks like a grey one.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPGray2Col(BYTE *imgIn, BYTE *colOut);

/* A colour image of its three channels.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPRGB2Col(BYTE *r, BYTE *g, BYTE *b, BYTE *imgOut);

/* Hue, saturation and intensity of a colour image, a channel each.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPCol2HSI(BYTE *img, BYTE *h, BYTE *s, BYTE *i);

/* The second colour image over the first, where it is not black.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPOverlay(BYTE *c1, BYTE *c2, BYTE *cOut);

/* The second grey image over the first, in a colour, where it is not 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPOverlayGray(BYTE *g1, BYTE *g2, COLOR col, BYTE *cOut);

/* The colour of red, green and blue.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, image processing. */
COLOR IPPRGB2Col(BYTE r, BYTE g, BYTE b);

/* Red, green and blue of a colour.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPPCol2RGB(COLOR col, BYTE *r, BYTE *g, BYTE *b);

/* Hue, saturation and intensity of a colour.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPPCol2HSI(COLOR c, BYTE *h, BYTE *s, BYTE *i);

/* Hue of red, green and blue; 0 for grey.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, image processing. */
BYTE IPPRGB2Hue(BYTE r, BYTE g, BYTE b);

/* Hue, saturation and intensity of red, green and blue.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPPRGB2HSI(BYTE r, BYTE g, BYTE b, BYTE *h, BYTE *s, BYTE *i);

/* ---- OS: the machine, time and timers ---- */

/* Runs a command of the machine that simulates, where that is allowed; its output goes to out, at most 4095 bytes.
 * Returns 0, 1 if it is not allowed or has failed.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSExecute(const char *command, char *out);

/* Version of RoBIOS as text, at most 31 characters. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSVersion(char *buf);

/* Version of the input and output board as text, at most 31 characters. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSVersionIO(char *buf);

/* Clock rate of the processor in Hz.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSMachineSpeed(void);

/* The kind of machine: VEHICLE, PLATFORM or WALKER.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSMachineType(void);

/* Name of the robot as text, at most 31 characters. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSMachineName(char *buf);

/* The robot's number, unique in the scene; also its address on the radio.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSMachineID(void);

/* Shows an error: text and number, on the display and in the record of the run.
 * dead: if not 0, the robot stops here for ever; else the program waits for a key and goes on. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSError(const char *message, int number, int dead);

/* Waits n milliseconds. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSWait(int n);

/* Calls a function every `scale` milliseconds. It may not wait. Returns the timer, 0 if there is no room for it.
 * [any task of the robot]  The function is kept until the program ends.
 * Source: RoBIOS-7 library, system functions and timer. */
TIMER OSAttachTimer(int scale, TimerFnc fct);

/* Ends a timer. Returns 0, 1 if there is none of that number.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSDetachTimer(TIMER t);

/* Sets the robot's clock. Returns 0, 1 for no time of a day.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSSetTime(int hrs, int mins, int secs);

/* Reads the robot's clock; ticks: milliseconds. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSGetTime(int *hrs, int *mins, int *secs, int *ticks);

/* Shows the robot's clock on the display. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSShowTime(void);

/* Milliseconds since the robot's start.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSGetCount(void);

/* ---- SER: serial interfaces ---- */

/* Opens an interface, 1 to 16. handshake: 0 none, 1 RTS/CTS. Returns 0, 1 if there is no such interface.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
int SERInit(int interface, int baud, int handshake);

/* Sends a character. Returns 0, 1 if the interface is not open.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
int SERSendChar(int interface, char ch);

/* Sends bytes. Returns 0, 1 if the interface is not open.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, serial communication. */
int SERSend(int interface, const char *buf, uint32_t size);

/* Waits for a character. Returns it, 0 if the interface is not open.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
char SERReceiveChar(int interface);

/* What has come in, at most 255 bytes and a final 0. Does not wait. Returns how many, 0 if the interface is not open.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, serial communication. */
int SERReceive(int interface, unsigned char *buf);

/* Whether something has come in.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
bool SERCheck(int interface);

/* Forgets what has come in. Returns 0, 1 if the interface is not open.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
int SERFlush(int interface);

/* Closes an interface. Returns 0, 1 if it is not open.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
int SERClose(int interface);

/* ---- AU: sound ---- */

/* Beeps. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUBeep(void);

/* Plays a sound file of this name, or the WAV file that is in memory there. Does not wait. Returns 0, 1 if it is none.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, audio. */
int AUPlay(const void *sample);

/* Whether the sound is over: 1, else 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUDone(void);

/* A value of the microphone, 0 to 255.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUMicrophone(void);

/* Plays a tone. Does not wait. Returns 0, 1 for a frequency that cannot be played.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUTone(int freq_hz, int time_ms);

/* Whether the tone is over: 1, else 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUCheckTone(void);

/* Whether the sound is over: 1, else 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUCheckPlay(void);

/* Records the microphone into memory. Does not wait. Returns 0, 1 for no room or no rate.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, audio. */
int AURecord(BYTE *buf, int time, long freq);

/* Whether the recording is over: 1, else 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUCheckRecord(void);

/* ---- PSD: distance sensors ---- */

/* Distance of sensor 1 to 6 in millimetres, now; 9999 if there is nothing near, 0 if there is no such sensor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, distance sensors. */
int PSDGet(int psd);

/* The same as the sensor's own number; 0 if there is no such sensor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, distance sensors. */
int PSDGetRaw(int psd);

/* ---- LIDAR: the laser scanner ---- */

/* Distances in millimetres from left to right, the middle one (of n, that of index n/2) straight ahead; 9999 for nothing.
 * Room for as many as LIDARSet has set, at first 360. Returns 0, 1 if there is no scanner.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LIDAR. */
int LIDARGet(int distance[]);

/* Sets angle in degrees, 1 to 360, the scanner's tilt in degrees, and the number of points.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LIDAR. */
void LIDARSet(int range, int tilt, int points);

/* ---- SERVO: servos ---- */

/* Turns servo 1 to 14 to a position of 0 to 255. Returns 0, 1 if there is no such servo or position.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int SERVOSet(int servo, int angle);

/* The same as the servo's own number, past its range. Returns 0, 1 if there is no such servo.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int SERVOSetRaw(int servo, int angle);

/* Sets what positions 0 and 255 mean, in the servo's own numbers. Returns 0, 1 if there is no such servo.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int SERVORange(int servo, int low, int high);

/* ---- MOTOR: motors ---- */

/* Drives motor 1 to 4 with -100 to 100 percent. Returns 0, 1 if there is no such motor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int MOTORDrive(int motor, int speed);

/* The same as the motor's own number, -127 to 127. Returns 0, 1 if there is no such motor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int MOTORDriveRaw(int motor, int speed);

/* Sets the controller of a motor, each 1 to 255. Returns 0, 1 if there is no such motor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int MOTORPID(int motor, int p, int i, int d);

/* Takes a motor's controller away. Returns 0, 1 if there is no such motor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int MOTORPIDOff(int motor);

/* Drives a motor with a speed in encoder ticks a second. Returns 0, 1 if there is no such motor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int MOTORSpeed(int motor, int ticks);

/* ---- ENCODER: encoders ---- */

/* Ticks of encoder 1 to 4 since its reset; 0 if there is no such encoder.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int ENCODERRead(int quad);

/* Sets an encoder to 0. Returns 0, 1 if there is no such encoder.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int ENCODERReset(int quad);

/* ---- VW: driving ---- */

/* Drives with a speed in mm/s and a turning speed in degrees/s, until the next command. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWSetSpeed(int linSpeed, int angSpeed);

/* Speeds in mm/s and degrees/s. Returns 0, 1 on failure.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWGetSpeed(int *linSpeed, int *angSpeed);

/* Sets the position by odometry: mm, mm, degrees. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWSetPosition(int x, int y, int phi);

/* Position by odometry: mm, mm, and degrees from -180 to 180. Returns 0, 1 on failure.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWGetPosition(int *x, int *y, int *phi);

/* Starts to drive straight for dist mm; the sign is that of dist. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWStraight(int dist, int lin_speed);

/* Starts to turn by angle degrees, to the left for positive ones. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWTurn(int angle, int ang_speed);

/* Starts to drive dist mm while turning by angle degrees. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWCurve(int dist, int angle, int lin_speed);

/* Starts to drive in an arc to the place dx mm ahead and dy mm to the left. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWDrive(int dx, int dy, int lin_speed);

/* What is left of the drive: mm, of a turn degrees; 0 when it is done.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWRemain(void);

/* 1 when the drive is done or there was none, 0 while it goes on, -1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWDone(void);

/* Waits for the drive's end. Returns 0, -1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWWait(void);

/* Which wheel stalls: 0 none, 1 the left, 2 the right, 3 both.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWStalled(void);

/* Starts the controllers of speed and turning speed, with parameters in tenths and hundredths as 70 30 70 10.
 * Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWControl(int Vv, int Tv, int Vw, int Tw);

/* Stops the controllers. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWControlOff(void);

/* ---- DIGITAL: digital inputs and outputs ---- */

/* Direction of line 1 to 16: 'i' in, 'o' out, 'I' in with pull-up, 'J' in with pull-down. Returns 0, 1 for others.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int DIGITALSetup(int io, char direction);

/* State of a line: 0 or 1; -1 if there is no such line.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int DIGITALRead(int io);

/* States of all lines, line 1 in the lowest bit.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int DIGITALReadAll(void);

/* Sets an output. Returns 0, 1 if there is no such line or it is no output.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int DIGITALWrite(int io, int state);

/* ---- ANALOG: analog inputs ---- */

/* Value of channel 0 to 8; -1 if there is no such channel.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int ANALOGRead(int channel);

/* Voltage of the battery in hundredths of a volt.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int ANALOGVoltage(void);

/* Starts to record a channel at 1 kHz. Does not wait. Returns 0, 1 if there is no such channel or it records.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int ANALOGRecord(int channel, int iterations);

/* Moves the recording to a buffer, as long as it is. Returns how many bytes, 0 while it goes on.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int ANALOGTransfer(BYTE *buffer);

/* ---- IRTV: the remote control ---- */

/* Waits for a key of the remote control. Returns its code.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, IR remote control. */
int IRTVGet(void);

/* A key of the remote control that was pressed, 0 if none was. Does not wait.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, IR remote control. */
int IRTVRead(void);

/* Forgets the keys that were pressed. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, IR remote control. */
int IRTVFlush(void);

/* Whether there is a receiver: 1, else 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, IR remote control. */
int IRTVGetStatus(void);

/* ---- RADIO: messages between robots ---- */

/* Switches the radio on. Returns 0, 1 if it is on already.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOInit(void);

/* The robot's address: its number.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOGetID(void);

/* Sends text of up to 1023 bytes; does not wait until it is sent, nor learns whether it arrives.
 * id: the receiver, 0 for everybody.
 * Returns 0, or 1 if the radio is off, buf is NULL or too long, id is negative, or 1024 bytes wait to be sent already.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOSend(int id, const char *buf);

/* Waits for a message, which may be damaged: there is no checksum.
 * id: its sender; may be NULL. size: room in buf for the text up to its first 0, cut to what fits, and a final 0.
 * Returns 0, or 1 at once if the radio is off, buf is NULL or has no room.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOReceive(int *id, char *buf, int size);

/* Number of messages that wait; 0 if the radio is off.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOCheck(EYESIM_ANY);

/* Addresses of the robots whose radios are on, the own one included, in order of the robots; room for 256.
 * Returns their number, 0 if the own radio is off or IDlist is NULL.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOStatus(int IDlist[]);

/* Switches the radio off: messages that wait or are on their way are lost. Returns 0, 1 if it is off.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, radio communication. */
int RADIORelease(void);

/* ---- SIM: ground truth, in simulation only ---- */

/* True pose of a robot, 0 for the own one: mm, mm, mm, degrees.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: EyeSim VR, simulation functions. */
void SIMGetRobot(int id, int *x, int *y, int *z, int *phi);

/* Puts a robot, 0 for the own one, at a pose.
 * [any task of the robot]  No pointers.
 * Source: EyeSim VR, simulation functions. */
void SIMSetRobot(int id, int x, int y, int z, int phi);

/* True pose of an object; objects are numbered on from the robots.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: EyeSim VR, simulation functions. */
void SIMGetObject(int id, int *x, int *y, int *z, int *phi);

/* Puts an object at a pose.
 * [any task of the robot]  No pointers.
 * Source: EyeSim VR, simulation functions. */
void SIMSetObject(int id, int x, int y, int z, int phi);

/* Number of robots.
 * [any task of the robot]  No pointers.
 * Source: EyeSim VR, simulation functions. */
int SIMGetRobotCount(void);

/* Number of objects.
 * [any task of the robot]  No pointers.
 * Source: EyeSim VR, simulation functions. */
int SIMGetObjectCount(void);

/* ---- RANGE: range sensors beyond RoBIOS ---- */

/* What the distance of a PSD sensor is made of: the signal of a reflectance sensor, in 1/m; the energy of a sonar's
 * echo, of which a perfect reflector 1 m ahead returns 1; of others 1 with an echo, 0 without.
 * Returns -1 if there is no such sensor.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
float PSDGetSignal(int psd);

/* ---- TRUTH: what the camera's last image shows, in simulation only ---- */

/* How far away what each pixel of the last image shows is: along the line of sight, in mm, INFINITY for the sky.
 * mm: CAMPIXELS numbers, row 0 on top, without errors. Returns 0, 1 if mm is 0 or no image has been taken.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int CAMGetDepth(float *mm);

/* What each pixel of the last image shows: CAM_SKY, CAM_FLOOR, CAM_WALL, or CAM_BODY + n for robot or object n, as
 * SIMGetRobot and SIMGetObject number them: robots from 1, objects on from the last robot.
 * labels: CAMPIXELS numbers, row 0 on top. Returns 0, 1 if labels is 0 or no image has been taken.
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

/* ---- OLDER: functions of older libraries ---- */

/* Position of a servo, 0 to 255, as it was set last; the middle where nothing was. Returns -1 if there is no such servo.
 * [any task of the robot]  No pointers.
 * Source: eye.py of EyeSim X. */
int SERVOGet(int servo);

#ifdef __cplusplus
}
#endif

#include "variants.h"

#endif
