/* Finds a ball by its colour, drives to it and stops in front of it.
 *
 * A pixel belongs to the ball if it has the ball's hue and is saturated: brown has the hue of orange, but a lower saturation. Pixels
 * are counted by column, so that single pixels coloured by noise do not matter: the ball is the run of columns with the most
 * ball pixels. Its width gives the distance of the ball.
 *
 * Optional argument: the hue, 0 to 255: follow-ball 65 */
#include <math.h>
#include <stdlib.h>

#include "eyebot.h"

#define HUE 65         /* of orange */
#define HUE_ERROR 10
#define SATURATION 175 /* the least, of 255 */
#define BRIGHTNESS 25  /* the least: nearly black pixels have any hue */

#define RADIUS 50      /* radius of the ball, mm */
#define STOP 130       /* distance from the camera to the ball's middle at which the robot stops, mm */
#define SPEED 250      /* mm/s */
#define TURN 60        /* degrees/s while it looks around */

typedef struct { int left, right, pixels; } Ball; /* columns of the image that the ball fills; no pixels: not in sight */

static BYTE colours[QQVGA_SIZE], hue[QQVGA_PIXELS], saturation[QQVGA_PIXELS], intensity[QQVGA_PIXELS], mask[QQVGA_PIXELS];

/* Takes an image and finds the ball in it. */
static Ball look(int wanted)
{
  int counts[QQVGA_X] = {0}, x, i;
  Ball run = {0, 0, 0}, best = {0, 0, 0};

  CAMGet(colours);
  IPCol2HSI(colours, hue, saturation, intensity);
  for (i = 0; i < QQVGA_PIXELS; i++) {
    mask[i] = abs(hue[i] - wanted) <= HUE_ERROR && saturation[i] >= SATURATION && intensity[i] >= BRIGHTNESS;
    counts[i % QQVGA_X] += mask[i];
  }
  for (x = 0; x < QQVGA_X; x++) {
    if (counts[x] < 2) {
      run.pixels = 0;
      continue;
    }
    if (run.pixels == 0)
      run.left = x;
    run.right = x;
    run.pixels += counts[x];
    if (run.pixels > best.pixels)
      best = run;
  }
  return best;
}

/* Focal length in pixels, of a camera with a field of view of 60 degrees. */
static double focal_length(void)
{
  return QQVGA_X / 2 / tan(30 * M_PI / 180);
}

/* Distance of the ball's middle from the camera, mm. */
static int distance_of(Ball ball)
{
  double half_angle = atan((ball.right - ball.left + 1) / 2.0 / focal_length());
  return (int)(RADIUS / sin(half_angle));
}

/* Direction of the ball, in degrees to the left. */
static double direction_of(Ball ball)
{
  double off = (QQVGA_X - 1 - ball.left - ball.right) / 2.0;
  return atan(off / focal_length()) * 180 / M_PI;
}

/* Shows the camera image at the left and the pixels of the ball at the right. */
static void show(Ball ball)
{
  LCDImageStart(0, 0, QQVGA_X, QQVGA_Y);
  LCDImage(colours);
  LCDImageStart(QQVGA_X, 0, QQVGA_X, QQVGA_Y);
  LCDImageBinary(mask);
  if (ball.pixels > 0) {
    LCDLine(ball.left, 0, ball.left, QQVGA_Y - 1, GREEN);
    LCDLine(ball.right, 0, ball.right, QQVGA_Y - 1, GREEN);
    LCDSetPrintf(10, 0, "ball at %4d mm, %3d degrees  ", distance_of(ball), (int)direction_of(ball));
  } else {
    LCDSetPrintf(10, 0, "looking around                ");
  }
}

static int limited(double value, int limit)
{
  return (int)(value > limit ? limit : value < -limit ? -limit : value);
}

/* Drives up to 0.7 m ahead but leaves 0.3 m free in front; backs up 0.1 m if there is less. */
static void move_on(void)
{
  int room = PSDGet(PSD_FRONT) - 300;
  VWStraight(room < 0 ? -100 : limited(room, 700), SPEED);
  while (VWDone() == 0 && !VWStalled())
    OSWait(50);
}

int main(int argc, char *argv[])
{
  int wanted = argc > 1 ? atoi(argv[1]) : HUE, last_seen = 0, side = 1;

  if (CAMInit(QQVGA) != 0)
    return 1;
  last_seen = OSGetCount();
  for (;;) {
    Ball ball = look(wanted);
    show(ball);
    if (VWStalled()) {
      VWStraight(-150, SPEED);
      VWWait();
      VWTurn(side * 60, TURN);
      VWWait();
      move_on();
    } else if (ball.pixels == 0) {
      if (OSGetCount() - last_seen > 1000 * 400 / TURN) { /* once around */
        move_on();
        last_seen = OSGetCount();
      }
      VWSetSpeed(0, side * TURN);
    } else {
      int distance = distance_of(ball);
      double direction = direction_of(ball);
      if (distance <= STOP)
        break;
      last_seen = OSGetCount();
      side = direction < 0 ? -1 : 1;
      VWSetSpeed(limited(distance - STOP + 40, SPEED), limited(2 * direction, TURN));
    }
  }
  VWSetSpeed(0, 0);
  CAMRelease();
  LCDSetPrintf(12, 0, "there");
  return 0;
}
