// Follows the wall at the left with the laser scanner, once around, and stops where it started.
#include "eyebot.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace {

constexpr int keep_mm = 250;     // distance from the wall to the scanner
constexpr int speed_mm_s = 250;

struct Reading {
  int direction;  // degrees, positive to the left
  int distance;   // mm
};

// One scan all around, a point a degree.
class Scan {
public:
  Scan() : distances(360)
  {
    LIDARGet(distances.data());
  }

  // The nearest point between two directions.
  Reading nearest(int right, int left) const
  {
    Reading best{right, distance(right)};
    for (int direction = right; direction <= left; direction++)
      if (distance(direction) < best.distance)
        best = {direction, distance(direction)};
    return best;
  }

private:
  int distance(int direction) const
  {
    return distances[((180 - direction) % 360 + 360) % 360];
  }

  std::vector<int> distances;  // from left to right
};

struct Position {
  int x, y, phi;

  static Position now()
  {
    Position at;
    VWGetPosition(&at.x, &at.y, &at.phi);
    return at;
  }
};

// Steers so that the nearest point of the wall stays at 90 degrees, at the distance keep_mm.
void steer(const Scan &scan)
{
  const Reading wall = scan.nearest(-45, 150);
  const double off = wall.direction - 90;
  const double turn = 2.5 * off + 0.4 * (wall.distance - keep_mm);
  const double slow = std::max(0.0, 1 - std::abs(off) / 45);
  VWSetSpeed(static_cast<int>(speed_mm_s * slow), static_cast<int>(std::clamp(turn, -90.0, 90.0)));
}

}  // namespace

int main()
{
  LIDARSet(360, 0, 360);
  // Approach the wall first.
  while (Scan().nearest(-45, 150).distance > keep_mm + 20) {
    steer(Scan());
    OSWait(20);
  }
  const Position start = Position::now();
  double way_mm = 0;
  for (Position last = start;;) {
    steer(Scan());
    OSWait(20);
    const Position at = Position::now();
    way_mm += std::hypot(at.x - last.x, at.y - last.y);
    last = at;
    if (way_mm > 1000 && std::hypot(at.x - start.x, at.y - start.y) < 50)
      break;
  }
  VWSetSpeed(0, 0);
  LCDPrintf("around: %.1f m\n", way_mm / 1000);
}
