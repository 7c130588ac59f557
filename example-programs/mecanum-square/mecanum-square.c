/* Drives a square without turning, by the motors of four Mecanum wheels: ahead, left, back, right.
 *
 * All four wheels at one speed drive ahead. Wheels on one diagonal forwards and those on the other backwards drive to the
 * side, since their rollers turn freely. */
#include <math.h>
#include <stdlib.h>
#include "eyebot.h"

#define SIDE  0.5   /* m */
#define POWER 40    /* percent */

static MotorHandle fl, fr, bl, br;
static QuadHandle  qfl, qfr, qbl, qbr;
static double x, y;   /* by the encoders, in m */

/* Drives one side of the square in one of four directions: `ahead` and `left` are -1, 0 or 1, and one of them is 0. */
static void drive(int ahead, int left)
{
  double a, b, c, d;

  QUADODOReset(qfl | qfr | qbl | qbr);
  MOTORDrive(fl | br, POWER * (ahead - left));
  MOTORDrive(fr | bl, POWER * (ahead + left));
  while (fabs(QUADODORead(qfl)) < SIDE)
    ;  /* each call costs virtual time */
  MOTORDrive(fl | fr | bl | br, 0);
  OSWait(10);

  a = QUADODORead(qfl);
  b = QUADODORead(qfr);
  c = QUADODORead(qbl);
  d = QUADODORead(qbr);
  x += (a + b + c + d) / 4;
  y += (-a + b + c - d) / 4;
  LCDPrintf("%7.4f %7.4f\n", x, y);
}

int main(void)
{
  fl = MOTORInit(MOTOR_FL);
  fr = MOTORInit(MOTOR_FR);
  bl = MOTORInit(MOTOR_BL);
  br = MOTORInit(MOTOR_BR);
  qfl = QUADInit(QUAD_FL);
  qfr = QUADInit(QUAD_FR);
  qbl = QUADInit(QUAD_BL);
  qbr = QUADInit(QUAD_BR);
  if (!fl || !fr || !bl || !br || !qfl || !qfr || !qbl || !qbr)
    return OSError("device missing", 1, TRUE);

  drive(1, 0);
  drive(0, 1);
  drive(-1, 0);
  drive(0, -1);
  MOTORRelease(fl | fr | bl | br);
  QUADRelease(qfl | qfr | qbl | qbr);
  return 0;
}
