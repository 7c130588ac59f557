/* Functions of the simulator, which real robots lack, for programs of both generations of RoBIOS.
 *
 * Layers show in the window, below the robots, what a program has computed, such as a map. Each robot has up to 16 layers with names
 * of up to 32 bytes; a call replaces the layer of that name. Nothing else is affected, and no time passes. All functions return 0;
 * 1, with a hint, if an argument is beyond a limit or not a number. Lengths are in metres. */
#ifndef EYESIM_EYESIM_H
#define EYESIM_EYESIM_H

#ifdef __cplusplus
extern "C" {
#endif

#define EYESIM_WORLD 0      /* The frame of the world. */
#define EYESIM_ODOMETRY 1   /* The frame of odometry, fixed in the world when the program last set the odometry, or at the robot's start. */
#define EYESIM_OCCUPIED 100 /* A cell that is certainly occupied; 0 is certainly free. */
#define EYESIM_UNKNOWN 255  /* An unknown cell. */

/* Shows a grid of square cells of cell_m, up to 1048576 of them. Its corner with the smallest coordinates is at x_m, y_m. cells: one byte
 * each, row by row from the smallest y, each row from the smallest x; 0 to 100, or EYESIM_UNKNOWN. */
int eyesim_show_grid(const char *name, int frame, double x_m, double y_m, double cell_m, int columns, int rows,
                     const unsigned char *cells);

/* Shows points, up to 65536. dimensions: 2 for x and y of each point, 3 for x, y and z. count: the number of points, 0 for an empty
 * layer. */
int eyesim_show_points(const char *name, int frame, int dimensions, int count, const double *coordinates_m);

/* Like eyesim_show_points, for a line through the points, such as a path or a profile of the ground. */
int eyesim_show_line(const char *name, int frame, int dimensions, int count, const double *coordinates_m);

#ifdef __cplusplus
}
#endif

#endif
