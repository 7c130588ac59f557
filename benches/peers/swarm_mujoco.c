/* The swarm in MuJoCo: swarm_mujoco BODY RAYS ROBOTS SECONDS LIMIT_S

   Runs the scene of benches/src/swarm.rs with the controller of benches/swarm/swarm.c on one thread, for SECONDS of virtual time or
   until LIMIT_S of wall-clock time have passed, and prints the result as JSON.

   BODY is `planar` or `wheels`:
   - `planar`: a body that slides along x and y and turns about z. Its velocity is set in each slot, so its motors are ideal.
   - `wheels`: a free body on a floor with two driven wheels and a castor.
   RAYS is `library` or `grid`: rays by mj_ray, which tests every body of the model, or rays of mju_rayGeom at the robots of the cells
   around, which a grid in this file finds.

   The fastest settings of those tried, by the speed of the physics alone with 100 and 1,000 robots (MuJoCo 4.0):
   - Bodies are spheres whose centres are level. They touch and stop rays as the cylinders of the scene do, and take 2 % less time.
     The walls are boxes on bodies of their own, which the broad phase (sweep and prune, which has no alternative) sorts with the
     others: 10 % less than planes. Limits of the sliding joints instead of walls would save 3 to 8 % more.
   - Timestep: one step of 50 ms per slot. Steps of 25, 10 and 5 ms take 2.3, 5 and 10 times as long. The largest overlap of bodies was
     4 mm with 50 ms, 3 mm with 5 ms. `wheels` needs the weak motors below for 50 ms; with motors three times as strong, robots hop
     and overlap by more than 4 cm, and 25 ms would be necessary.
   - Integrator: Euler for `planar`, equal to implicitfast and discrete within 15 %; implicitfast for `wheels`, where implicit takes 1.6
     and discrete 1.9 times as long.
   - Solver: Newton without warm start and without islands, 1.3 times as fast for `wheels` as with both. CG takes 1.3 to 1.7 times and
     PGS 2 times as long. Fewer iterations make the simulation unstable. For `planar` there is no difference.
   - Cone: pyramidal; elliptic takes 1.1 times as long. The sparse Jacobian, the default for crowds, is 2.5 times as fast as the dense
     one. Sleep does not apply, since all robots drive.
   - Disable flags of features that the model does not use (sensors, springs, gravity for `planar`) change nothing.
   - Rays of the library: mj_ray. mj_multiRay takes 1.05 to 3 times as long, and a rangefinder calls mj_ray. */
#include <malloc.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <mujoco/mujoco.h>

#define SLOT_S       0.05
#define WARM_UP      5     /* slots */
#define WARM_UP_S    2.0
#define GOLDEN_ANGLE 137.5 /* degrees, between the headings of neighbours in the list */
#define RADIUS       0.09
#define RAY_Z        0.06
#define WHEEL_RADIUS 0.027
#define HALF_AXLE    0.05
#define WALLS        4

#define SENSORS 8
#define FAR_MM  2000
#define NEAR_MM 300
#define SPEED   0.3 /* m/s */
#define RATE    1.5 /* rad/s */
#define REACH   (FAR_MM / 1000.0 + 0.081) /* of a ray from the robot's centre */

/* Collision bits, and the group of geoms that rays do not see. */
#define IS_ROBOT  "contype='1' conaffinity='1'"
#define IS_WALL   "contype='1' conaffinity='0'"
#define IS_FLOOR  "contype='2' conaffinity='0' group='1'"
#define ON_FLOOR  "contype='0' conaffinity='2' group='1'"

static const mjtByte seen_groups[mjNGROUP] = { 1 };

/* The PSDs of swarm.robi in the order of swarm.c. A ray starts at the robot's centre, since each sensor's axis passes the centre within
   3 mm; the sensor's distance from the centre is subtracted. */
static const struct { double x, y, angle_deg; } places[SENSORS] = {
  { 0, 80, 90 }, { 57, 57, 45 }, { 75, 30, 20 }, { 80, 0, 0 }, { 75, -30, -20 }, { 57, -57, -45 }, { 0, -80, -90 }, { -80, 0, 180 }
};

/* One robot's program. */
typedef struct {
  int distance_mm[SENSORS];
  double turn;           /* rate of the turn in progress, 0 for none */
  double speed, rate;    /* the command */
  double path;           /* m */
} Robot;

typedef struct {
  mjModel *model;
  mjData *data;
  Robot *robots;
  int count, columns, rows;
  int has_wheels, has_grid;
  int first_body, bodies_per_robot;
  int *first_in_cell, *next_in_cell; /* of the grid; -1 ends a list */
} Swarm;

/* --- controller: the functions of swarm.c --- */

static int ahead_mm(const Robot *robot)
{
  int i, least = FAR_MM;

  for (i = 1; i <= 5; i++)
    if (robot->distance_mm[i] < least)
      least = robot->distance_mm[i];
  return least;
}

static double away(const Robot *robot)
{
  const int *distance_mm = robot->distance_mm;
  int left = distance_mm[0] + distance_mm[1] + distance_mm[2];
  int right = distance_mm[4] + distance_mm[5] + distance_mm[6];

  return left > right ? RATE : -RATE;
}

static void control(Robot *robot)
{
  if (ahead_mm(robot) > 2 * NEAR_MM)
    robot->turn = 0;
  else if (robot->turn == 0 && ahead_mm(robot) < NEAR_MM)
    robot->turn = away(robot);
  robot->speed = robot->turn == 0 ? SPEED * ahead_mm(robot) / FAR_MM : 0;
  robot->rate = robot->turn == 0 ? 0.2 * away(robot) : robot->turn;
}

/* --- model --- */

static char *xml, *xml_end;

static void append(const char *format, ...)
{
  va_list arguments;

  va_start(arguments, format);
  xml_end += vsprintf(xml_end, format, arguments);
  va_end(arguments);
}

static double heading(int robot)
{
  return fmod(robot * GOLDEN_ANGLE, 360) * mjPI / 180;
}

static void append_wall(double x, double y, double half_x, double half_y)
{
  append("<body><geom type='box' pos='%g %g 0' size='%g %g 0.5' " IS_WALL "/></body>", x, y, half_x, half_y);
}

static void append_robot(const Swarm *swarm, int robot)
{
  double x = robot % swarm->columns + 0.5, y = robot / swarm->columns + 0.5;
  int side;

  append("<body pos='%g %g 0' euler='0 0 %.9g'>", x, y, swarm->has_wheels ? heading(robot) : 0);
  append("<geom type='sphere' size='%g' pos='0 0 %g' mass='0.5' " IS_ROBOT "/>", RADIUS, RAY_Z);
  if (!swarm->has_wheels) {
    append("<joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/><joint axis='0 0 1'/></body>");
    return;
  }
  /* The centre of mass is low and behind the axle, so that the castor stays on the floor. */
  append("<freejoint/><inertial pos='-0.02 0 0.02' mass='0.5' diaginertia='0.001 0.001 0.002'/>");
  append("<geom type='sphere' size='0.01' pos='-0.06 0 0.01' " ON_FLOOR "/>");
  for (side = 1; side >= -1; side -= 2) {
    append("<body pos='0 %g %g'><joint name='%c%d' axis='0 1 0' armature='2e-5'/>", side * HALF_AXLE, WHEEL_RADIUS, side > 0 ? 'l' : 'r', robot);
    append("<geom type='sphere' size='%g' mass='0.03' condim='3' " ON_FLOOR "/></body>", WHEEL_RADIUS);
  }
  append("</body>");
}

/* Actuators that hold the speed of a wheel, with a time constant of about 80 ms. */
static void append_motors(int robot)
{
  append("<velocity joint='l%d' kv='0.003'/><velocity joint='r%d' kv='0.003'/>", robot, robot);
}

static void make_model(Swarm *swarm)
{
  double width = swarm->columns, height = swarm->rows, bodies = swarm->count * swarm->bodies_per_robot + WALLS + 1;
  char error[1000] = "";
  mjSpec *spec;
  int i;

  xml = xml_end = malloc(4096 + (size_t)swarm->count * 1500);
  append("<mujoco><compiler angle='radian'/>");
  /* The broad phase reserves two lists of all pairs of bodies. Their pages are touched only as far as they are filled. */
  append("<size memory='%.0f'/>", 4.2 * bodies * bodies + 2e4 * swarm->count + 1.6e7);
  append("<option timestep='%g' integrator='%s'>", SLOT_S, swarm->has_wheels ? "implicitfast" : "Euler");
  append("<flag warmstart='disable' island='disable' eulerdamp='disable'/></option><default><geom condim='1'/></default><worldbody>");
  append_wall(-0.5, height / 2, 0.5, height / 2 + 1);
  append_wall(width + 0.5, height / 2, 0.5, height / 2 + 1);
  append_wall(width / 2, -0.5, width / 2 + 1, 0.5);
  append_wall(width / 2, height + 0.5, width / 2 + 1, 0.5);
  if (swarm->has_wheels)
    append("<geom type='plane' size='0 0 1' " IS_FLOOR "/>");
  for (i = 0; i < swarm->count; i++)
    append_robot(swarm, i);
  append("</worldbody><actuator>");
  for (i = 0; swarm->has_wheels && i < swarm->count; i++)
    append_motors(i);
  append("</actuator></mujoco>");

  spec = mj_parseXMLString(xml, NULL, error, sizeof error);
  swarm->model = spec ? mj_compile(spec, NULL) : NULL;
  if (!swarm->model) {
    fprintf(stderr, "%s\n", spec ? mjs_getError(spec) : error);
    exit(1);
  }
  mj_deleteSpec(spec);
  free(xml);
  swarm->data = mj_makeData(swarm->model);
  swarm->first_body = WALLS + 1;
  for (i = 0; !swarm->has_wheels && i < swarm->count; i++)
    swarm->data->qpos[3 * i + 2] = heading(i);
  mj_forward(swarm->model, swarm->data);
  malloc_trim(0);
}

/* --- sensors --- */

static int body_of(const Swarm *swarm, int robot)
{
  return swarm->first_body + robot * swarm->bodies_per_robot;
}

static int clamp(int cell, int cells)
{
  return cell < 0 ? 0 : cell >= cells ? cells - 1 : cell;
}

/* Sorts the robots into the cells of the grid. */
static void fill_grid(Swarm *swarm)
{
  int i;

  for (i = 0; i < swarm->columns * swarm->rows; i++)
    swarm->first_in_cell[i] = -1;
  for (i = 0; i < swarm->count; i++) {
    const mjtNum *at = swarm->data->xpos + 3 * body_of(swarm, i);
    int cell = clamp((int)at[1], swarm->rows) * swarm->columns + clamp((int)at[0], swarm->columns);
    swarm->next_in_cell[i] = swarm->first_in_cell[cell];
    swarm->first_in_cell[cell] = i;
  }
}

/* Shortens the rays that hit a geom. */
static void cast_at_geom(const Swarm *swarm, int geom, const mjtNum from[3], mjtNum rays[SENSORS][3], mjtNum distances[SENSORS])
{
  const mjModel *m = swarm->model;
  const mjData *d = swarm->data;
  int k;

  for (k = 0; k < SENSORS; k++) {
    if (m->geom_type[geom] == mjGEOM_SPHERE) {
      const mjtNum *at = d->geom_xpos + 3 * geom;
      double dx = at[0] - from[0], dy = at[1] - from[1];
      if (dx * rays[k][0] + dy * rays[k][1] < 0 || fabs(dy * rays[k][0] - dx * rays[k][1]) > RADIUS)
        continue;
    }
    mjtNum distance = mju_rayGeom(d->geom_xpos + 3 * geom, d->geom_xmat + 9 * geom, m->geom_size + 3 * geom, from, rays[k], m->geom_type[geom], NULL);
    if (distance >= 0 && distance < distances[k])
      distances[k] = distance;
  }
}

/* Casts rays at the robots of the cells within reach and at the walls within reach. */
static void cast_in_grid(const Swarm *swarm, int robot, const mjtNum from[3], mjtNum rays[SENSORS][3], mjtNum distances[SENSORS])
{
  double reach = REACH + RADIUS;
  double to_wall[WALLS] = { from[0], swarm->columns - from[0], from[1], swarm->rows - from[1] };
  int left = clamp((int)(from[0] - reach), swarm->columns), right = clamp((int)(from[0] + reach), swarm->columns);
  int bottom = clamp((int)(from[1] - reach), swarm->rows), top = clamp((int)(from[1] + reach), swarm->rows);
  int x, y, other, i;

  for (i = 0; i < SENSORS; i++)
    distances[i] = REACH;
  for (i = 0; i < WALLS; i++)
    if (to_wall[i] < REACH)
      cast_at_geom(swarm, swarm->model->body_geomadr[1 + i], from, rays, distances);
  for (y = bottom; y <= top; y++)
    for (x = left; x <= right; x++)
      for (other = swarm->first_in_cell[y * swarm->columns + x]; other >= 0; other = swarm->next_in_cell[other]) {
        int geom = swarm->model->body_geomadr[body_of(swarm, other)];
        const mjtNum *at = swarm->data->geom_xpos + 3 * geom;
        double dx = at[0] - from[0], dy = at[1] - from[1];
        if (other != robot && dx * dx + dy * dy < reach * reach)
          cast_at_geom(swarm, geom, from, rays, distances);
      }
}

static void read_sensors(const Swarm *swarm, int robot, double directions[SENSORS][3])
{
  int body = body_of(swarm, robot), k;
  const mjtNum *at = swarm->data->xpos + 3 * body, *axes = swarm->data->xmat + 9 * body;
  mjtNum from[3] = { at[0], at[1], RAY_Z }, rays[SENSORS][3], distances[SENSORS];
  double length = hypot(axes[0], axes[3]), forward_x = axes[0] / length, forward_y = axes[3] / length;

  for (k = 0; k < SENSORS; k++) {
    rays[k][0] = forward_x * directions[k][0] - forward_y * directions[k][1];
    rays[k][1] = forward_y * directions[k][0] + forward_x * directions[k][1];
    rays[k][2] = 0;
  }
  if (swarm->has_grid)
    cast_in_grid(swarm, robot, from, rays, distances);
  else
    for (k = 0; k < SENSORS; k++)
      distances[k] = mj_ray(swarm->model, swarm->data, from, rays[k], swarm->has_wheels ? seen_groups : NULL, 1, body, NULL, NULL);
  for (k = 0; k < SENSORS; k++) {
    double mm = rint(1000 * (distances[k] - directions[k][2]));
    swarm->robots[robot].distance_mm[k] = distances[k] < 0 || mm > FAR_MM ? FAR_MM : mm < 0 ? 0 : (int)mm;
  }
}

/* --- slots --- */

static void drive(Swarm *swarm, int robot)
{
  const Robot *command = &swarm->robots[robot];

  if (swarm->has_wheels) {
    swarm->data->ctrl[2 * robot] = (command->speed - command->rate * HALF_AXLE) / WHEEL_RADIUS;
    swarm->data->ctrl[2 * robot + 1] = (command->speed + command->rate * HALF_AXLE) / WHEEL_RADIUS;
  } else {
    /* The chord of the arc that the robot drives. */
    double angle = swarm->data->qpos[3 * robot + 2] + 0.5 * command->rate * SLOT_S;
    swarm->data->qvel[3 * robot] = command->speed * cos(angle);
    swarm->data->qvel[3 * robot + 1] = command->speed * sin(angle);
    swarm->data->qvel[3 * robot + 2] = command->rate;
  }
}

/* Simulates a slot of all robots; returns the largest overlap of two robots, or of a robot and a wall, at its start. */
static double run_slot(Swarm *swarm, double directions[SENSORS][3])
{
  mjData *d = swarm->data;
  int dofs = swarm->has_wheels ? 8 : 3, i;
  double overlap = 0;

  if (swarm->has_grid)
    fill_grid(swarm);
  for (i = 0; i < swarm->count; i++) {
    read_sensors(swarm, i, directions);
    control(&swarm->robots[i]);
    drive(swarm, i);
  }
  mj_step(swarm->model, d);
  for (i = 0; i < d->ncon; i++)
    if (swarm->model->geom_group[d->contact[i].geom[1]] == 0)
      overlap = fmax(overlap, -d->contact[i].dist);
  for (i = 0; i < swarm->count; i++)
    swarm->robots[i].path += SLOT_S * hypot(d->qvel[dofs * i], d->qvel[dofs * i + 1]);
  return overlap;
}

static double now_s(void)
{
  struct timespec time;

  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec + 1e-9 * time.tv_nsec;
}

static long resident_kib(void)
{
  char line[256];
  long kib = 0;
  FILE *status = fopen("/proc/self/status", "r");

  while (status && fgets(line, sizeof line, status))
    sscanf(line, "VmRSS: %ld", &kib);
  if (status)
    fclose(status);
  return kib;
}

int main(int argc, char **argv)
{
  Swarm swarm = { 0 };
  double directions[SENSORS][3]; /* x, y, distance of the sensor from the centre */
  double overlap = 0, path = 0, start, limit, real = 0;
  long slot, slots;
  int i;

  if (argc != 6) {
    fprintf(stderr, "usage: swarm_mujoco planar|wheels library|grid ROBOTS SECONDS LIMIT_S\n");
    return 1;
  }
  swarm.has_wheels = strcmp(argv[1], "wheels") == 0;
  swarm.has_grid = strcmp(argv[2], "grid") == 0;
  swarm.count = atoi(argv[3]);
  slots = lround(atof(argv[4]) / SLOT_S);
  limit = atof(argv[5]);
  swarm.columns = (int)sqrt(swarm.count);
  swarm.rows = (swarm.count + swarm.columns - 1) / swarm.columns;
  swarm.bodies_per_robot = swarm.has_wheels ? 3 : 1;
  swarm.robots = calloc(swarm.count, sizeof *swarm.robots);
  swarm.first_in_cell = malloc(swarm.columns * swarm.rows * sizeof *swarm.first_in_cell);
  swarm.next_in_cell = malloc(swarm.count * sizeof *swarm.next_in_cell);
  for (i = 0; i < SENSORS; i++) {
    double angle = places[i].angle_deg * mjPI / 180;
    directions[i][0] = cos(angle);
    directions[i][1] = sin(angle);
    directions[i][2] = (places[i].x * cos(angle) + places[i].y * sin(angle)) / 1000;
  }
  make_model(&swarm);

  start = now_s();
  for (slot = 0; slot < WARM_UP && now_s() - start < WARM_UP_S; slot++)
    run_slot(&swarm, directions);
  for (i = 0; i < swarm.count; i++)
    swarm.robots[i].path = 0;
  start = now_s();
  for (slot = 0; slot < slots && real < limit; slot++) {
    overlap = fmax(overlap, run_slot(&swarm, directions));
    real = now_s() - start;
  }
  for (i = 0; i < swarm.count; i++)
    path += swarm.robots[i].path;
  printf("{\"sim_time_s\": %.2f, \"real_time_s\": %.6f, \"resident_kib\": %ld, \"speed_m_per_s\": %.4f, \"overlap_mm\": %.2f}\n",
         slot * SLOT_S, real, resident_kib(), path / swarm.count / (slot * SLOT_S), 1000 * overlap);
  return 0;
}
