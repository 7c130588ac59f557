// Drives to a goal 10 m ahead through a field of obstacles: turns towards the free direction nearest to the goal.
#include "eyebot.h"
#include <math.h>
#include <stdlib.h>

#define GOAL_X 10000   // mm, in the frame of the start
#define GOAL_Y 0
#define NEAR 200       // mm, close enough to the goal
#define AHEAD 700      // mm that have to be free in the direction of travel
#define HALF_WIDTH 150 // mm, half of the robot and a margin
#define DEGREES 57.29577951

static int scan[360]; // from left to right, one a degree; scan[180] is ahead

// Distance that the robot can drive in a direction (degrees, positive to the left) before it touches a point of the scan.
static int room(int direction)
{
    int room = AHEAD;
    for (int i = 0; i < 360; i++) {
        double angle = (180 - i - direction) / DEGREES;
        double along = scan[i] * cos(angle), lateral = fabs(scan[i] * sin(angle));
        if (along > 0 && lateral < HALF_WIDTH && along < room) room = (int)along;
    }
    return room;
}

int main(void)
{
    LIDARSet(360, 0, 360);
    for (;;) {
        int x, y, phi;
        VWGetPosition(&x, &y, &phi);
        double dx = GOAL_X - x, dy = GOAL_Y - y;
        if (hypot(dx, dy) < NEAR) break;
        LIDARGet(scan);
        int wanted = (int)lround(atan2(dy, dx) * DEGREES) - phi;
        int best = 0;
        double min_cost = 1e9;
        for (int direction = -120; direction <= 120; direction += 3) {
            int off = abs((direction - wanted + 540) % 360 - 180);
            double cost = off + 0.3 * abs(direction) + 2.0 * (AHEAD - room(direction));
            if (cost < min_cost) min_cost = cost, best = direction;
        }
        int speed = 400 - 5 * abs(best);
        VWSetSpeed(speed < 0 ? 0 : speed, 2 * best);
        OSWait(40);
    }
    VWSetSpeed(0, 0);
    return 0;
}
