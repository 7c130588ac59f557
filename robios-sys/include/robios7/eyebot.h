/* RoBIOS-7 for robot programs.
 *
 * Every call takes effect, and takes its readings, at its end. Calls that wait say so; all others return immediately.
 * [any task of the robot] marks who may call a function: all may be called from timer functions too, where those
 * that wait are errors. No call keeps a pointer. Null pointers and wrong handles give the documented failure.
 *
 * Written from the lists of functions and constants of eyesim. */
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
#define ANYKEY              (-1) /* KEYWait: any key. */
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
#define LCD_AUTOREFRESH        8 /* LCDSetMode: each call is shown immediately. */
#define LCD_NOAUTOREFRESH  32768 /* LCDSetMode: drawings are shown by LCDRefresh. */
#define LCD_SCROLLING         16 /* LCDSetMode: text that leaves the last line moves all lines up. */
#define LCD_NOSCROLLING   0x010000 /* LCDSetMode: text that leaves the last line starts again in the first. */
#define LCD_LINEFEED          32 /* LCDSetMode: the end of a line continues in the next. */
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

/* Prints as printf does, at the cursor. format: as of printf, with the values after it. Returns 0, 1 if format is
 * NULL.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDPrintf(const char *format, ...) EYESIM_PRINTF(1, 2);

/* Prints as printf does, at a position; the cursor stays after it. row, column: cells of a character of the
 * current size, from 0. format: as of printf, with the values after it. Returns 0, 1 if format is NULL.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetPrintf(int row, int column, const char *format, ...) EYESIM_PRINTF(3, 4);

/* Makes the display black; the cursor goes to row 0, column 0; the menu stays. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDClear(void);

/* Moves the cursor. row, column: in characters of the current size, from 0. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetPos(int row, int column);

/* Reads the position of the cursor. row, column: set to its position in characters of the current size, from
 * 0. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDGetPos(int *row, int *column);

/* Sets the colours of text from now on. fg: of the characters. bg: of the background. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetColor(COLOR fg, COLOR bg);

/* Sets the font of text from now on. font: HELVETICA, TIMES or COURIER. variation: NORMAL, BOLD or ITALICS.
 * Returns 0, 1 for other values.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetFont(int font, int variation);

/* Sets the size of text from now on. fontsize: 8, 12, 14, 18 or 24. Returns 0, 1 for other values.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetFontSize(int fontsize);

/* Sets modes of the display. mode: LCD_SCROLLING and the like, or-ed; other modes stay unchanged. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDSetMode(int mode);

/* Sets the labels of the four keys under the display. st1, st2, st3, st4: the labels; an empty text clears a label,
 * NULL leaves it. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDMenu(const char *st1, const char *st2, const char *st3, const char *st4);

/* Sets the label of one key with its colours. pos: key 1 to 4. string: the label. fg: colour of the text. bg: background
 * colour. Returns 0, 1 if there is no such key.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDMenuI(int pos, const char *string, COLOR fg, COLOR bg);

/* Sets a line of a list menu and shows the list; a touch of the line is a key. Used by LCDList, not part of RoBIOS.
 * line: from 0. key: the key of the line, such as KEY_LIST1. text: the line; NULL ends the list before it. fg: colour
 * of the text. bg: background colour. Returns the number of lines that fit, 0 if there is no such line.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDListLine(int line, int key, const char *text, COLOR fg, COLOR bg);

/* Reads the size of the display. x, y: set to columns and rows of pixels. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDGetSize(int *x, int *y);

/* Draws one pixel; all drawing functions clip at the edges of the display. x: pixels to the right of the left edge. y:
 * pixels below the upper edge. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDPixel(int x, int y, COLOR col);

/* Reads the colour of one pixel. x: pixels to the right of the left edge. y: pixels below the upper edge. Returns the
 * colour; 0 outside of the display.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
COLOR LCDGetPixel(int x, int y);

/* Draws a line with both ends. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper edge.
 * Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDLine(int x1, int y1, int x2, int y2, COLOR col);

/* Draws a rectangle between two corners. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper
 * edge. fill: if not 0, filled; otherwise only its edge. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDArea(int x1, int y1, int x2, int y2, COLOR col, int fill);

/* Draws a circle. x1, y1: its centre, pixels to the right of the left edge and below the upper edge. size: its radius
 * in pixels. fill: if not 0, filled; otherwise only its edge. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDCircle(int x1, int y1, int size, COLOR col, int fill);

/* Inverts one pixel. x: pixels to the right of the left edge. y: pixels below the upper edge. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDPixelInvert(int x, int y);

/* Inverts the pixels of a line. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper edge.
 * Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDLineInvert(int x1, int y1, int x2, int y2);

/* Inverts a filled rectangle. x1, x2: pixels to the right of the left edge. y1, y2: pixels below the upper edge.
 * Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDAreaInvert(int x1, int y1, int x2, int y2);

/* Inverts a filled circle. x1, y1: its centre, pixels to the right of the left edge and below the upper edge. size:
 * its radius in pixels. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDCircleInvert(int x1, int y1, int size);

/* Sets the size of the images that LCDImage and the like show. t: a resolution such as QVGA; CUSTOM: CAMWIDTH x
 * CAMHEIGHT. Returns 0, 1 for another number.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDImageSize(int t);

/* Sets position and size of the images that LCDImage and the like show. x, y: upper left corner in pixels. xs,
 * ys: columns and rows in pixels. Returns 0, 1 for a size below 1 or of more pixels than CAM5MP.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDImageStart(int x, int y, int xs, int ys);

/* Shows a colour image of the size that LCDImageStart or LCDImageSize has set. img: 3 bytes per pixel: red, green, blue.
 * Returns 0, 1 if img is NULL.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDImage(BYTE *img);

/* Shows a grey image. g: 1 byte per pixel, 0 is black. Returns 0, 1 if g is NULL.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDImageGray(BYTE *g);

/* Shows a binary image. b: 1 byte per pixel: 0 is white, everything else black. Returns 0, 1 if b is NULL.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LCD output. */
int LCDImageBinary(BYTE *b);

/* Shows the drawings made while LCD_NOAUTOREFRESH is set. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LCD output. */
int LCDRefresh(void);

/* ---- KEY: the four keys, and touches of the display ---- */

/* Waits for a key. Returns KEY1, KEY2, KEY3 or KEY4.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, keys. */
int KEYGet(void);

/* The key that was pressed, without waiting. Returns KEY1, KEY2, KEY3 or KEY4; NOKEY if none was.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, keys. */
int KEYRead(void);

/* Waits for one of the given keys and discards other keys. key: keys, or-ed, or ANYKEY. Returns the key,
 * KEY_INVALID if there is no such key.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, keys. */
int KEYWait(int key);

/* Waits for a touch of the display. x, y: set to its position in pixels from the upper left corner; may be
 * NULL. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, keys. */
int KEYGetXY(int *x, int *y);

/* The position of a touch of the display, without waiting. x, y: set to its position in pixels from the upper
 * left corner; may be NULL. Returns 0 if there was one, otherwise 1.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, keys. */
int KEYReadXY(int *x, int *y);

/* ---- CAM: the camera ---- */

/* Switches the camera on. resolution: QQVGA to CAM5MP, or CUSTOM for CAMWIDTH x CAMHEIGHT. Returns 0, 1 if there is no
 * camera or no such size.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, camera. */
int CAMInit(int resolution);

/* Switches the camera off. Returns 0, 1 if there is no camera.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, camera. */
int CAMRelease(void);

/* Takes a colour image, row 0 at the top. buf: CAMSIZE bytes, 3 per pixel: red, green, blue. Returns 0, 1 if there
 * is no camera.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, camera. */
int CAMGet(BYTE *buf);

/* Takes a grey image, row 0 at the top. buf: CAMPIXELS bytes. Returns 0, 1 if there is no camera.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, camera. */
int CAMGetGray(BYTE *buf);

/* ---- IP: image processing ---- */

/* Sets the size of the images of all IP functions. resolution: QQVGA to CAM5MP; CUSTOM: what the program has written
 * to IP_WIDTH and IP_HEIGHT. Returns 0, 1 for another number.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, image processing. */
int IPSetSize(int resolution);

/* Reads a PNM file, P1 to P6, cropped or padded with black to the size of the images. Grey files become grey images,
 * colour files colour images. filename: relative to the working folder, or to the scene. img: set to the image,
 * IP_SIZE bytes at most. Returns the digit of P1 to P6, -1 if it cannot be read.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
int IPReadFile(const char *filename, BYTE *img);

/* Writes a colour image as PPM. filename: relative to the working folder. img: IP_SIZE bytes. Returns 0, 1 if it
 * cannot be written.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
int IPWriteFile(const char *filename, BYTE *img);

/* Writes a grey image as PGM. filename: relative to the working folder. gray: IP_PIXELS bytes. Returns 0, 1 if it
 * cannot be written.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
int IPWriteFileGray(const char *filename, BYTE *gray);

/* Laplace edges of a grey image. grayIn: IP_PIXELS bytes. grayOut: set to IP_PIXELS bytes; may be the same buffer.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPLaplace(BYTE *grayIn, BYTE *grayOut);

/* Sobel edges of a grey image. grayIn: IP_PIXELS bytes. grayOut: set to IP_PIXELS bytes; may be the same buffer.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPSobel(BYTE *grayIn, BYTE *grayOut);

/* Converts a colour image to grey. imgIn: IP_SIZE bytes. grayOut: set to IP_PIXELS bytes.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPCol2Gray(BYTE *imgIn, BYTE *grayOut);

/* Converts a grey image to a colour image. imgIn: IP_PIXELS bytes. colOut: set to IP_SIZE bytes.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPGray2Col(BYTE *imgIn, BYTE *colOut);

/* Joins three channels to a colour image. r, g, b: IP_PIXELS bytes each. imgOut: set to IP_SIZE bytes.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPRGB2Col(BYTE *r, BYTE *g, BYTE *b, BYTE *imgOut);

/* Splits a colour image into hue, saturation and intensity. img: IP_SIZE bytes. h, s, i: set to IP_PIXELS bytes each,
 * 0 to 255.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPCol2HSI(BYTE *img, BYTE *h, BYTE *s, BYTE *i);

/* Lays the second colour image over the first where the second is not black. c1, c2: IP_SIZE bytes each. cOut: set to
 * IP_SIZE bytes.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPOverlay(BYTE *c1, BYTE *c2, BYTE *cOut);

/* Lays the second grey image over the first, in a colour, where the second is not 0. g1, g2: IP_PIXELS bytes each.
 * cOut: set to IP_SIZE bytes.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPOverlayGray(BYTE *g1, BYTE *g2, COLOR col, BYTE *cOut);

/* The colour of red, green and blue. r, g, b: 0 to 255. Returns the colour, 0xRRGGBB.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, image processing. */
COLOR IPPRGB2Col(BYTE r, BYTE g, BYTE b);

/* Splits a colour into red, green and blue. r, g, b: set to 0 to 255.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPPCol2RGB(COLOR col, BYTE *r, BYTE *g, BYTE *b);

/* Hue, saturation and intensity of a colour. h, s, i: set to 0 to 255.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPPCol2HSI(COLOR c, BYTE *h, BYTE *s, BYTE *i);

/* Hue of red, green and blue. r, g, b: 0 to 255. Returns 0 to 255; 0 for grey.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, image processing. */
BYTE IPPRGB2Hue(BYTE r, BYTE g, BYTE b);

/* Hue, saturation and intensity of red, green and blue. r, g, b: 0 to 255. h, s, i: set to 0 to 255.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, image processing. */
void IPPRGB2HSI(BYTE r, BYTE g, BYTE b, BYTE *h, BYTE *s, BYTE *i);

/* ---- OS: the machine, time and timers ---- */

/* Runs a shell command on the computer that runs the simulator, if allowed. command: the command. out: at least 4096
 * bytes, set to its output as text. Returns 0, 1 if it is not allowed or has failed.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSExecute(const char *command, char *out);

/* The version of RoBIOS as text. buf: at least 32 bytes, set to the text. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSVersion(char *buf);

/* The version of the input and output board as text. buf: at least 32 bytes, set to the text. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSVersionIO(char *buf);

/* The clock rate of the processor. Returns the rate in Hz.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSMachineSpeed(void);

/* The kind of machine. Returns VEHICLE, PLATFORM or WALKER.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSMachineType(void);

/* The name of the robot as text. buf: at least 32 bytes, set to the text. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSMachineName(char *buf);

/* The robot's number, unique in the scene; also its address on the radio. Returns the number, from 1.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSMachineID(void);

/* Shows an error, text and number, on the display and in the trace of the run. message: the text. number: the number
 * shown after it. dead: if not 0, the robot stops here forever; otherwise the program waits for a key and continues.
 * Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSError(const char *message, int number, int dead);

/* Waits. n: milliseconds. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSWait(int n);

/* Calls a function periodically, inside the call in progress at that time. scale: period in milliseconds, at least 1.
 * fct: the function; it must not wait. Returns the timer, 0 if there are too many timers.
 * [any task of the robot]  The function is kept until the program ends.
 * Source: RoBIOS-7 library, system functions and timer. */
TIMER OSAttachTimer(int scale, TimerFnc fct);

/* Stops a timer. Returns 0, 1 if there is no timer with this number.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSDetachTimer(TIMER t);

/* Sets the robot's clock. hrs: 0 to 23. mins, secs: 0 to 59. Returns 0, 1 for an invalid time.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSSetTime(int hrs, int mins, int secs);

/* Reads the robot's clock; it starts at 0:00:00. hrs, mins, secs: set to hours, minutes and seconds. ticks: set to
 * milliseconds. Returns 0.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSGetTime(int *hrs, int *mins, int *secs, int *ticks);

/* Shows the robot's clock on the display. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSShowTime(void);

/* Time since the robot's start. Returns milliseconds.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, system functions and timer. */
int OSGetCount(void);

/* ---- SER: serial interfaces ---- */

/* Opens an interface. interface: 1 to 16. baud: bits per second, 1 to 4000000. handshake: 0 none, 1 RTS/CTS.
 * Returns 0, 1 for other values.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
int SERInit(int interface, int baud, int handshake);

/* Sends a character. interface: 1 to 16. ch: the character. Returns 0, 1 if the interface is not open.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
int SERSendChar(int interface, char ch);

/* Sends bytes. interface: 1 to 16. buf: the bytes. size: their number. Returns 0, 1 if the interface is not open.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, serial communication. */
int SERSend(int interface, const char *buf, uint32_t size);

/* Waits for a character. interface: 1 to 16. Returns it, 0 if the interface is not open.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
char SERReceiveChar(int interface);

/* Reads the received bytes, without waiting. interface: 1 to 16. buf: at least 256 bytes, set to at most 255 bytes and
 * a final 0. Returns their number, 0 if the interface is not open.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, serial communication. */
int SERReceive(int interface, unsigned char *buf);

/* Checks whether bytes have been received. interface: 1 to 16. Returns 1 if they have, otherwise 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
bool SERCheck(int interface);

/* Discards received bytes. interface: 1 to 16. Returns 0, 1 if the interface is not open.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
int SERFlush(int interface);

/* Closes an interface. interface: 1 to 16. Returns 0, 1 if it is not open.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, serial communication. */
int SERClose(int interface);

/* ---- AU: sound ---- */

/* Beeps. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUBeep(void);

/* Plays a sound; does not wait. sample: name of a WAV file, or a WAV file in memory. Returns 0, 1 if it is not a
 * sound.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, audio. */
int AUPlay(const void *sample);

/* Checks whether the sound is over. Returns 1 if it is, otherwise 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUDone(void);

/* The current value of the microphone. Returns 0 to 255; 128 is silence.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUMicrophone(void);

/* Plays a tone; does not wait. freq_hz: frequency in Hz, 65 to 21000. time_ms: duration in milliseconds. Returns 0, 1
 * for a frequency that cannot be played.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUTone(int freq_hz, int time_ms);

/* Checks whether the tone is over. Returns 1 if it is, otherwise 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUCheckTone(void);

/* Checks whether the sound is over. Returns 1 if it is, otherwise 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUCheckPlay(void);

/* Records the microphone into memory; does not wait. buf: set to time * freq / 1000 bytes, 0 to 255 each.
 * time: duration in milliseconds. freq: values per second, at most 44100 Hz. Returns 0, 1 if buf is too small
 * or freq is invalid.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, audio. */
int AURecord(BYTE *buf, int time, long freq);

/* Checks whether the recording is over. Returns 1 if it is, otherwise 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, audio. */
int AUCheckRecord(void);

/* ---- PSD: distance sensors ---- */

/* Measures the current distance of a sensor. psd: number of the sensor, such as PSD_FRONT. Returns millimetres; 9999
 * if out of range, 0 if there is no such sensor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, distance sensors. */
int PSDGet(int psd);

/* Measures the current raw value of a sensor. psd: number of the sensor, such as PSD_FRONT. Returns 0 to 255; 0 if
 * nothing is in range or there is no such sensor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, distance sensors. */
int PSDGetRaw(int psd);

/* ---- LIDAR: the laser scanner ---- */

/* Scans once with the laser scanner, from left to right; the middle point (of n, that of index n/2) is straight
 * ahead. distance: set to as many distances in millimetres as LIDARSet has set, initially as many as the
 * robi states; 9999 if out of range.
 * Returns 0, 1 if there is no scanner.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, LIDAR. */
int LIDARGet(int distance[]);

/* Sets up the laser scanner. range: angle of the scan in degrees, 1 to 360. tilt: tilt of the scanner in degrees, -90
 * to 90. points: number of points, 1 to 65536.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, LIDAR. */
void LIDARSet(int range, int tilt, int points);

/* ---- SERVO: servos ---- */

/* Turns a servo. servo: 1 to 14. angle: position, 0 to 255. Returns 0, 1 if there is no such servo or position.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int SERVOSet(int servo, int angle);

/* Sets the raw position of a servo, ignoring its range. servo: 1 to 14. angle: raw position, 0 to 255. Returns 0, 1 if
 * there is no such servo or position.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int SERVOSetRaw(int servo, int angle);

/* Sets the raw positions of a servo for 0 and 255. servo: 1 to 14. low, high: raw positions, 0 to 255. Returns 0, 1 if
 * there is no such servo or position.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int SERVORange(int servo, int low, int high);

/* ---- MOTOR: motors ---- */

/* Drives a motor. motor: 1 to 4. speed: -100 to 100 percent. Returns 0, 1 if there is no such motor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int MOTORDrive(int motor, int speed);

/* Drives a motor with a raw value. motor: 1 to 4. speed: -127 to 127. Returns 0, 1 if there is no such motor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int MOTORDriveRaw(int motor, int speed);

/* Sets the controller of a motor. motor: 1 to 4. p, i, d: gains, 0 to 255 each. Returns 0, 1 if there is no such
 * motor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int MOTORPID(int motor, int p, int i, int d);

/* Stops a motor's controller. motor: 1 to 4. Returns 0, 1 if there is no such motor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int MOTORPIDOff(int motor);

/* Drives a motor with the speed of its encoder. motor: 1 to 4. ticks: encoder counts per second. Returns 0, 1
 * if there is no such motor.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int MOTORSpeed(int motor, int ticks);

/* ---- ENCODER: encoders ---- */

/* Reads an encoder. quad: 1 to 4. Returns counts since its reset; 0 if there is no such encoder.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int ENCODERRead(int quad);

/* Sets an encoder to 0. quad: 1 to 4. Returns 0, 1 if there is no such encoder.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, servos and motors. */
int ENCODERReset(int quad);

/* ---- VW: driving ---- */

/* Drives with a speed and a turning speed, until the next command. linSpeed: mm/s. angSpeed: degrees/s, positive = to
 * the left. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWSetSpeed(int linSpeed, int angSpeed);

/* Reads the speeds by odometry. linSpeed: set to mm/s. angSpeed: set to degrees/s, positive = to the left. Returns 0,
 * 1 on failure.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWGetSpeed(int *linSpeed, int *angSpeed);

/* Sets the position by odometry; the robot does not move. x, y: mm. phi: degrees, counter-clockwise. Returns 0, 1 on
 * failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWSetPosition(int x, int y, int phi);

/* Reads the position by odometry. x, y: set to mm. phi: set to degrees from -180 to 180, counter-clockwise. Returns 0,
 * 1 on failure.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWGetPosition(int *x, int *y, int *phi);

/* Starts to drive straight; does not wait. dist: mm, negative = backwards. lin_speed: mm/s; its sign is ignored.
 * Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWStraight(int dist, int lin_speed);

/* Starts to turn on the spot; does not wait. angle: degrees, positive = to the left. ang_speed: degrees/s; its sign
 * is ignored. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWTurn(int angle, int ang_speed);

/* Starts to drive in an arc; does not wait. dist: length of the arc in mm, negative = backwards. angle: change of
 * heading in degrees, positive = to the left. lin_speed: mm/s; its sign is ignored. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWCurve(int dist, int angle, int lin_speed);

/* Starts to drive in an arc to a point; does not wait. dx: mm ahead. dy: mm to the left. lin_speed: mm/s; its sign
 * is ignored. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWDrive(int dx, int dy, int lin_speed);

/* Remainder of the drive. Returns mm, for a turn degrees; 0 when it is done.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWRemain(void);

/* Checks whether the drive is done. Returns 1 when it is done or there was none, 0 while it is in progress, -1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWDone(void);

/* Waits for the drive's end. Returns 0, -1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWWait(void);

/* Determines which wheels are stalled. Returns 0 for none, 1 for the left, 2 for the right, 3 for both.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWStalled(void);

/* Starts the controllers of speed and turning speed; typical: 70, 30, 70, 10. Vv: gain for the speed, in tenths. Tv:
 * time for the speed, in hundredths of a second. Vw: gain for the turning speed, in tenths. Tw: time for the turning
 * speed, in hundredths of a second. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWControl(int Vv, int Tv, int Vw, int Tw);

/* Stops the controllers. Returns 0, 1 on failure.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, V-Omega driving. */
int VWControlOff(void);

/* ---- DIGITAL: digital inputs and outputs ---- */

/* Sets the direction of a line. io: 1 to 16. direction: 'i' in, 'o' out, 'I' in with pull-up, 'J' in with
 * pull-down. Returns 0, 1 for other values.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int DIGITALSetup(int io, char direction);

/* Reads a line. io: 1 to 16. Returns 0 or 1; -1 if there is no such line.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int DIGITALRead(int io);

/* Reads all lines. Returns their states, line 1 in the lowest bit.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int DIGITALReadAll(void);

/* Sets an output. io: 1 to 16. state: 0 or 1. Returns 0, 1 if there is no such line or it is not an output.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int DIGITALWrite(int io, int state);

/* ---- ANALOG: analog inputs ---- */

/* Reads an analog input. channel: 0 to 8. Returns 0 to 1023; -1 if there is no such channel.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int ANALOGRead(int channel);

/* The voltage of the battery. Returns hundredths of a volt.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int ANALOGVoltage(void);

/* Starts to record a channel at 1 kHz; does not wait. channel: 0 to 8. iterations: number of values, 1 to 1048576.
 * Returns 0, 1 if there is no such channel or a recording is in progress.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int ANALOGRecord(int channel, int iterations);

/* Moves the whole recording to a buffer. buffer: one byte per value, the upper 8 bits. Returns the number of bytes, 0
 * while the recording is in progress.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, digital and analog I/O. */
int ANALOGTransfer(BYTE *buffer);

/* ---- IRTV: the remote control ---- */

/* Waits for a key of the remote control. Returns its code.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, IR remote control. */
int IRTVGet(void);

/* A key of the remote control that was pressed, without waiting. Returns its code, 0 if none was.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, IR remote control. */
int IRTVRead(void);

/* Discards the keys that were pressed. Returns 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, IR remote control. */
int IRTVFlush(void);

/* Checks whether there is a receiver. Returns 1 if there is one, otherwise 0.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, IR remote control. */
int IRTVGetStatus(void);

/* ---- RADIO: messages between robots ---- */

/* Switches the radio on. Returns 0, 1 if it is on already.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOInit(void);

/* The robot's address. Returns its number.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOGetID(void);

/* Sends text, without waiting for the transmission and without acknowledgement. id: the receiver, 0 for all robots.
 * buf: text of up to 1023 bytes. Returns 0, or 1 if the radio is off, buf is NULL or too long, id is negative, or 1024
 * bytes wait to be sent already.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOSend(int id, const char *buf);

/* Waits for a message, which may be damaged: there is no checksum. id: set to the address of its sender; may be NULL.
 * buf: set to the text up to its first 0, cut to fit, and a final 0. size: capacity of buf. Returns 0, or 1 immediately if
 * the radio is off, buf is NULL or has no room.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOReceive(int *id, char *buf, int size);

/* Counts the messages that wait. Returns their number; 0 if the radio is off.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOCheck(EYESIM_ANY);

/* Lists the robots whose radios are on, including this one. IDlist: room for 256 numbers, set to their addresses in
 * order of the robots. In the slot of RADIOInit it waits for the end of the slot; in a timer's function it does not
 * wait, and may list only this robot. Returns their number, 0 if the radio of this robot is off or IDlist is NULL.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: RoBIOS-7 library, radio communication. */
int RADIOStatus(int IDlist[]);

/* Switches the radio off: messages that wait or are in transit are lost. Returns 0, 1 if it is off.
 * [any task of the robot]  No pointers.
 * Source: RoBIOS-7 library, radio communication. */
int RADIORelease(void);

/* ---- SIM: ground truth, in simulation only ---- */

/* True pose of a robot. id: the robot's number; 0 is this one. x, y, z: set to mm. phi: set to degrees,
 * counter-clockwise.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: EyeSim VR, simulation functions. */
void SIMGetRobot(int id, int *x, int *y, int *z, int *phi);

/* Moves a robot to a pose. id: the robot's number; 0 is this one. x, y, z: mm. phi: degrees, counter-clockwise.
 * [any task of the robot]  No pointers.
 * Source: EyeSim VR, simulation functions. */
void SIMSetRobot(int id, int x, int y, int z, int phi);

/* True pose of an object. id: objects are numbered after the robots. x, y, z: set to mm. phi: set to degrees,
 * counter-clockwise.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: EyeSim VR, simulation functions. */
void SIMGetObject(int id, int *x, int *y, int *z, int *phi);

/* Moves an object to a pose. id: objects are numbered after the robots. x, y, z: mm. phi: degrees, counter-clockwise.
 * [any task of the robot]  No pointers.
 * Source: EyeSim VR, simulation functions. */
void SIMSetObject(int id, int x, int y, int z, int phi);

/* Counts the robots. Returns their number.
 * [any task of the robot]  No pointers.
 * Source: EyeSim VR, simulation functions. */
int SIMGetRobotCount(void);

/* Counts the objects. Returns their number.
 * [any task of the robot]  No pointers.
 * Source: EyeSim VR, simulation functions. */
int SIMGetObjectCount(void);

/* ---- RANGE: range sensors beyond RoBIOS ---- */

/* Signal underlying the distance of a sensor: that of a reflectance sensor, in 1/m; the echo energy of a sonar, 1 for
 * a perfect reflector 1 m ahead; for other sensors 1 with an echo, 0 without. psd: number of the sensor. Returns the
 * signal, -1 if there is no such sensor.
 * [any task of the robot]  No pointers.
 * Source: our choice: RoBIOS has none. */
float PSDGetSignal(int psd);

/* ---- TRUTH: what the camera's last image shows, in simulation only ---- */

/* Depth of each pixel of the last image: distance along the line of sight, in mm, without noise; INFINITY for the sky.
 * mm: CAMPIXELS numbers, row 0 at the top. Returns 0, 1 if mm is 0 or no image has been taken.
 * [any task of the robot]  Pointers belong to the program and are not kept.
 * Source: our choice: RoBIOS has none. */
int CAMGetDepth(float *mm);

/* Label of each pixel of the last image: CAM_SKY, CAM_FLOOR, CAM_WALL, or CAM_BODY + n for robot or object n, numbered as in
 * SIMGetRobot and SIMGetObject: robots from 1, then the objects.
 * labels: CAMPIXELS numbers, row 0 at the top. Returns 0, 1 if labels is 0 or no image has been taken.
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

/* ---- OLDER: functions of older libraries ---- */

/* Last position set for a servo. servo: 1 to 14. Returns 0 to 255, initially the middle; -1 if there is no such servo.
 * [any task of the robot]  No pointers.
 * Source: eye.py of EyeSim X. */
int SERVOGet(int servo);

#ifdef __cplusplus
}
#endif

#include "variants.h"

#endif
