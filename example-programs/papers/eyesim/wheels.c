/* Section 2: drives the wheels at fixed fractions of their maximum rates, and prints the fractions once all wheels have reached them.
   The argument `4` is for four Mecanum wheels. */
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"

static const int two[][2] = { { 40, 40 }, { 20, 60 }, { -50, 50 }, { 60, -10 }, { -30, -45 }, { 0, 70 }, { 100, 15 } };
static const int four[][4] = { { 40, 40, 40, 40 }, { -40, 40, 40, -40 }, { -40, 40, -40, 40 }, { 10, 60, 40, 30 }, { 70, -20, 35, 5 }, { -60, -15, -35, 20 } };

int main(int argc, char *argv[])
{
  static const DeviceSemantics names[2][4] = { { MOTOR_LEFT, MOTOR_RIGHT }, { MOTOR_FL, MOTOR_FR, MOTOR_BL, MOTOR_BR } };
  int is_four = argc > 1 && atoi(argv[1]) == 4, wheels = is_four ? 4 : 2, cases = is_four ? 6 : 7, i, k;
  MotorHandle motor[4];

  for (k = 0; k < wheels; k++)
    motor[k] = MOTORInit(names[is_four][k]);
  for (i = 0; i < cases; i++) {
    const int *percent = is_four ? four[i] : two[i];
    for (k = 0; k < wheels; k++)
      MOTORDrive(motor[k], percent[k]);
    for (k = 0; k < wheels; k++)
      printf("%d ", percent[k]);
    printf("\n");
    OSWait(100);
  }
  return 0;
}
