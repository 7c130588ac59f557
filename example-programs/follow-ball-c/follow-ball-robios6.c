/* Finds a ball by its colour, drives to it and stops in front of it, like follow-ball.c, for RoBIOS 6 and its images of 80 x 60
   pixels within a border of one. There is no function for hue and saturation, so they are computed here. */
#include <math.h>
#include <stdlib.h>
#include "eyebot.h"

#define HUE        27     /* degrees; orange */
#define HUE_ERROR  14
#define SATURATION 0.8    /* the least */
#define BRIGHTNESS 25     /* the least, of 255: nearly black pixels have any hue */

#define RADIUS     0.05   /* radius of the ball, m */
#define STOP       0.14   /* distance from the camera to the ball's middle at which the robot stops, m */
#define SPEED      0.2    /* m/s */
#define TURN       1.0    /* rad/s */
#define LENS       69.3   /* focal length in pixels: 40 / tan(30 degrees) */

static colimage img;
static BYTE mask[imagerows][imagecolumns];

static double limited(double value, double limit)
{
  return value > limit ? limit : value < -limit ? -limit : value;
}

static int is_ball(BYTE r, BYTE g, BYTE b)
{
  int max = r > g ? (r > b ? r : b) : (g > b ? g : b);
  int min = r < g ? (r < b ? r : b) : (g < b ? g : b);
  double hue;

  if (max < BRIGHTNESS || max - min < SATURATION * max)
    return 0;
  hue = max == r ? 60.0 * (g - b) / (max - min) : max == g ? 120 + 60.0 * (b - r) / (max - min) : 240 + 60.0 * (r - g) / (max - min);
  return fabs(remainder(hue - HUE, 360)) <= HUE_ERROR;
}

/* Takes an image and finds the ball: the run of columns with the most pixels of the ball. Returns their number. */
static int look(int *left, int *right)
{
  int row, column, best = 0, pixels = 0, start = 0;

  CAMGetColFrame(&img, 0);
  for (column = 1; column < imagecolumns - 1; column++) {
    int count = 0;
    for (row = 1; row < imagerows - 1; row++) {
      mask[row][column] = is_ball(img[row][column][0], img[row][column][1], img[row][column][2]);
      count += mask[row][column];
    }
    if (count == 0) {
      pixels = 0;
      continue;
    }
    if (pixels == 0)
      start = column;
    pixels += count;
    if (pixels > best) {
      best = pixels;
      *left = start;
      *right = column;
    }
  }
  return best >= 2 ? best : 0;
}

/* Shows the image without its border, in black and white, with the pixels of the ball inverted. */
static void show(void)
{
  int row, column;

  LCDPutColorGraphic(&img);
  for (row = 0; row < 54; row++)
    for (column = 0; column < imagecolumns - 2; column++)
      if (mask[row + 1][column + 1])
        LCDInvertPixel(row, column);
}

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PSDHandle front = PSDInit(PSD_FRONT);
  int left = 0, right = 0, side = 1, last_seen = 0, version = CAMInit(NORMAL);

  if (!vw || !front || version < COLCAM || version >= INITERROR)
    return OSError("device missing", 1, TRUE);
  PSDStart(front, TRUE);
  last_seen = OSGetCount();
  for (;;) {
    int pixels = look(&left, &right);

    show();
    if (VWStalled(vw) || (!pixels && OSGetCount() - last_seen > 700)) { /* blocked or once around: try another place */
      double room = (PSDGet(front) - 200) / 1000.0;
      if (VWStalled(vw)) {
        VWDriveStraight(vw, -0.15, SPEED);
        VWDriveWait(vw);
        VWDriveTurn(vw, side * 1.0, TURN);
        VWDriveWait(vw);
      }
      VWDriveStraight(vw, limited(room, 0.6), SPEED);
      while (!VWDriveDone(vw) && !VWStalled(vw))
        OSWait(5);
      last_seen = OSGetCount();
    } else if (!pixels) {
      VWSetSpeed(vw, 0, side * TURN);
    } else {
      double distance = RADIUS / sin(atan((right - left + 1) / 2.0 / LENS));
      double direction = atan((imagecolumns - 1 - left - right) / 2.0 / LENS);
      LCDSetPrintf(0, 11, "%4dmm", (int)(1000 * distance));
      if (distance <= STOP)
        break;
      last_seen = OSGetCount();
      side = direction < 0 ? -1 : 1;
      VWSetSpeed(vw, limited(distance - STOP + 0.04, SPEED), limited(2 * direction, TURN));
    }
  }
  VWSetSpeed(vw, 0, 0);
  CAMRelease();
  PSDRelease();
  VWRelease(vw);
  LCDSetPrintf(2, 11, "there");
  return 0;
}
