/* Layers of the window; part of shim.c. */
#include "eyesim.h"

enum {
    MAX_LAYER_CELLS = 1 << 20,
    MAX_LAYER_POINTS = 1 << 16
};

/* Bytes of `rows` rows of `columns` items, up to `most` items; none if the sizes are wrong, which the host reports. */
static struct eyesim_bytes items_of(const void *data, int columns, int rows, int most, size_t item)
{
    if (columns <= 0 || rows <= 0 || columns > most / rows)
        return bytes_of(NULL, 0);
    return bytes_of(data, (size_t)columns * (size_t)rows * item);
}

WEAK int eyesim_show_grid(const char *name, int frame, double x_m, double y_m, double cell_m, int columns, int rows,
                          const unsigned char *cells)
{
    int32_t result = 0;
    SUPPORT(show_grid, text_of(name), frame, x_m, y_m, cell_m, columns, rows,
            items_of(cells, columns, rows, MAX_LAYER_CELLS, 1), &result);
    return result;
}

WEAK int eyesim_show_points(const char *name, int frame, int dimensions, int count, const double *coordinates_m)
{
    int32_t result = 0;
    SUPPORT(show_points, text_of(name), frame, dimensions, count,
            items_of(coordinates_m, dimensions, count, 3 * MAX_LAYER_POINTS, sizeof *coordinates_m), &result);
    return result;
}

WEAK int eyesim_show_line(const char *name, int frame, int dimensions, int count, const double *coordinates_m)
{
    int32_t result = 0;
    SUPPORT(show_line, text_of(name), frame, dimensions, count,
            items_of(coordinates_m, dimensions, count, 3 * MAX_LAYER_POINTS, sizeof *coordinates_m), &result);
    return result;
}
