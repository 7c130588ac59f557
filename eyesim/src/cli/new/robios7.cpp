// Drives to each of four walls and turns left before it.
#include "eyebot.h"

#include <vector>

constexpr int near_mm = 300;

// Drives until a wall is near; returns the distance to it in mm.
int drive_to_wall()
{
  VWSetSpeed(300, 0); // mm/s, degrees/s
  while (PSDGet(PSD_FRONT) > near_mm)
    OSWait(50);
  VWSetSpeed(0, 0);
  return PSDGet(PSD_FRONT);
}

int main()
{
  LCDSetColor(GREEN, BLACK);
  LCDPrintf("@NAME@\n");

  std::vector<int> walls;
  while (walls.size() < 4) {
    walls.push_back(drive_to_wall());
    LCDPrintf("wall %d: %d mm\n", static_cast<int>(walls.size()), walls.back());
    VWTurn(90, 60);
    VWWait();
  }

  int x, y, phi;
  VWGetPosition(&x, &y, &phi);
  LCDPrintf("x %d y %d mm\n", x, y);
}
