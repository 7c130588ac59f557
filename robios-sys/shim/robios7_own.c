/* RoBIOS-7 functions whose signature in C differs from that of the call, and functions of older headers; part of shim.c. */
#undef OSExecute
#undef RADIOSend
#undef SERSend
#undef SIMGetObject
#undef SIMSetObject

enum {
    MAX_NAME = 32,
    MAX_SERIAL = 256,
    MAX_RADIO_IDS = 256,
    MAX_LIDAR_POINTS = 65536,
    MAX_RECORDING = 1 << 20
};

/* ---- sizes of images ---- */

WEAK int CAMWIDTH = QVGA_X, CAMHEIGHT = QVGA_Y, CAMPIXELS = QVGA_PIXELS, CAMSIZE = QVGA_SIZE, CAMMODE = QVGA;
WEAK int IP_WIDTH = QVGA_X, IP_HEIGHT = QVGA_Y, IP_PIXELS = QVGA_PIXELS, IP_SIZE = QVGA_SIZE;
static int shown_width = QVGA_X, shown_height = QVGA_Y; /* of the images for the display */

/* Looks up the size of a resolution; returns 0 if there is none or the size of CUSTOM is invalid. CUSTOM leaves the
 * size unchanged. */
static int size_of(int resolution, int *width, int *height)
{
    static const struct {
        int resolution, width, height;
    } sizes[] = {{QQVGA, QQVGA_X, QQVGA_Y},    {QVGA, QVGA_X, QVGA_Y},    {VGA, VGA_X, VGA_Y},
                 {CAM1MP, CAM1MP_X, CAM1MP_Y}, {CAMHD, CAMHD_X, CAMHD_Y}, {CAM5MP, CAM5MP_X, CAM5MP_Y}};
    size_t i;
    if (resolution == CUSTOM)
        return *width > 0 && *height > 0 && (int64_t)*width * *height <= CAM5MP_PIXELS;
    for (i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        if (sizes[i].resolution == resolution) {
            *width = sizes[i].width;
            *height = sizes[i].height;
            return 1;
        }
    }
    return 0;
}

static void set_ip_size(int width, int height)
{
    IP_WIDTH = width;
    IP_HEIGHT = height;
    IP_PIXELS = width * height;
    IP_SIZE = 3 * IP_PIXELS;
}

static struct eyesim_bytes grey_of(const BYTE *image) { return bytes_of(image, (size_t)IP_PIXELS); }
static struct eyesim_bytes colours_of(const BYTE *image) { return bytes_of(image, (size_t)IP_SIZE); }

/* Reports an image of `len` bytes that the function that returns to `site` should write. */
static _Noreturn void fail_image(const void *site, size_t len, int width, int height)
{
    char text[160];
    snprintf(text, sizeof text, "an image of %d x %d pixels has %zu bytes, more than the local array that it should be written to",
             width, height, len);
    fail_at(site, FAILED_IMAGE, text);
}

/* Buffer for an image of `items` items. A buffer that extends beyond the program's part of the stack is refused, since behind
   it lies memory that the simulator needs to report errors. */
PART struct eyesim_room image_room(void *image, int items, size_t item, int width, int height)
{
    const char *start = image, *end = (const char *)this_task()->base;
    size_t len = items > 0 ? (size_t)items : 0;
    if (start > (const char *)__builtin_frame_address(0) && start < end && len > (size_t)(end - start) / item)
        fail_image(__builtin_return_address(0), len * item, width, height);
    return room_of(image, len);
}

PART struct eyesim_room grey_room(BYTE *image) { return image_room(image, IP_PIXELS, 1, IP_WIDTH, IP_HEIGHT); }
PART struct eyesim_room colour_room(BYTE *image) { return image_room(image, IP_SIZE, 1, IP_WIDTH, IP_HEIGHT); }

/* ---- LCD ---- */

WEAK int LCDInit(void) { return 0; }
WEAK int XInitThreads(void) { return 1; }

WEAK int LCDImageSize(int t)
{
    int32_t result = 0;
    int width = CAMWIDTH, height = CAMHEIGHT;
    ROBIOS(LCDImageSize, t, &result);
    if (!size_of(t, &width, &height))
        return 1;
    shown_width = width;
    shown_height = height;
    return result;
}

WEAK int LCDImageStart(int x, int y, int xs, int ys)
{
    int32_t result = 0;
    ROBIOS(LCDImageStart, x, y, xs, ys, &result);
    if (result == 0) {
        shown_width = xs;
        shown_height = ys;
    }
    return result;
}

static size_t shown_pixels(void) { return (size_t)shown_width * (size_t)shown_height; }

WEAK int LCDImage(BYTE *img)
{
    int32_t result = 0;
    ROBIOS(LCDImage, shown_width, shown_height, bytes_of(img, 3 * shown_pixels()), &result);
    return result;
}

WEAK int LCDImageGray(BYTE *g)
{
    int32_t result = 0;
    ROBIOS(LCDImageGray, shown_width, shown_height, bytes_of(g, shown_pixels()), &result);
    return result;
}

WEAK int LCDImageBinary(BYTE *b)
{
    int32_t result = 0;
    ROBIOS(LCDImageBinary, shown_width, shown_height, bytes_of(b, shown_pixels()), &result);
    return result;
}

/* ---- list menus ---- */

static listmenu_t *shown_list;

static int32_t list_line(int32_t line, int32_t key, const char *text, COLOR fg, COLOR bg)
{
    int32_t result = 0;
    ROBIOS(LCDListLine, line, key, text_of(text), fg, bg, &result);
    return result;
}

WEAK int LCDSetList(listmenu_t *menulist)
{
    int32_t line = 0, room, most, items, i, result = 0;
    shown_list = menulist;
    if (!menulist) {
        ROBIOS(LCDSetMode, LCD_CLASSICMENU, &result);
        return 0;
    }
    room = list_line(line++, KEY_LISTTL, menulist->title, menulist->fgcol, menulist->bgcol);
    most = room - 1 < 8 ? room - 1 : 8; /* the items' lines that have a key */
    menulist->scroll = menulist->size > most;
    items = !menulist->scroll ? menulist->size : room - 3 < 8 ? room - 3 : 8;
    if (menulist->scroll)
        list_line(line++, KEY_LISTUP, "SCROLL UP", WHITE, RED);
    for (i = 0; i < items; i++) {
        int64_t item = (int64_t)menulist->start + i;
        int32_t key = KEY_LIST1 << i;
        char label[2 + sizeof menulist->pitems->label + 1];
        if (item < 0 || item >= menulist->size || !menulist->pitems) {
            list_line(line++, NOKEY, "", menulist->fgcol, menulist->bgcol);
            continue;
        }
        snprintf(label, sizeof label, "%s%.*s", i == menulist->index ? "> " : "  ",
                 (int)sizeof menulist->pitems->label, menulist->pitems[item].label);
        list_line(line++, key, label, menulist->pitems[item].fgcol, menulist->pitems[item].bgcol);
    }
    if (menulist->scroll)
        list_line(line++, KEY_LISTDN, "SCROLL DOWN", WHITE, RED);
    if (line < room)
        list_line(line, NOKEY, NULL, 0, 0);
    return 0;
}

WEAK int LCDList(listmenu_t *menulist) { return LCDSetList(menulist); }
WEAK listmenu_t *LCDGetList(void) { return shown_list; }

WEAK menuitem_t *LCDListActiveItem(void)
{
    int64_t item = shown_list ? (int64_t)shown_list->start + shown_list->index : -1;
    return item >= 0 && shown_list->index >= 0 && item < shown_list->size && shown_list->pitems
               ? &shown_list->pitems[item]
               : NULL;
}

/* ---- CAM and IP ---- */

WEAK int CAMInit(int resolution)
{
    int32_t result = 0;
    int width = CAMWIDTH, height = CAMHEIGHT;
    if (size_of(resolution, &width, &height)) {
        CAMMODE = resolution;
        CAMWIDTH = width;
        CAMHEIGHT = height;
        CAMPIXELS = width * height;
        CAMSIZE = 3 * CAMPIXELS;
        set_ip_size(width, height);
        shown_width = width;
        shown_height = height;
    }
    ROBIOS(CAMInit, resolution, CAMWIDTH, CAMHEIGHT, &result);
    return result;
}

WEAK int CAMGet(BYTE *buf)
{
    int32_t result = 0;
    ROBIOS(CAMGet, image_room(buf, CAMSIZE, 1, CAMWIDTH, CAMHEIGHT), &result);
    return result;
}

WEAK int CAMGetGray(BYTE *buf)
{
    int32_t result = 0;
    ROBIOS(CAMGetGray, image_room(buf, CAMPIXELS, 1, CAMWIDTH, CAMHEIGHT), &result);
    return result;
}

WEAK int CAMGetDepth(float *mm)
{
    int32_t result = 0;
    ROBIOS(CAMGetDepth, image_room(mm, CAMPIXELS, sizeof *mm, CAMWIDTH, CAMHEIGHT), &result);
    return result;
}

WEAK int CAMGetLabels(int *labels)
{
    int32_t result = 0;
    ROBIOS(CAMGetLabels, image_room(labels, CAMPIXELS, sizeof *labels, CAMWIDTH, CAMHEIGHT), &result);
    return result;
}

WEAK int IPSetSize(int resolution)
{
    int32_t result = 0;
    int width = IP_WIDTH, height = IP_HEIGHT;
    ROBIOS(IPSetSize, resolution, &result);
    if (!size_of(resolution, &width, &height))
        return 1;
    set_ip_size(width, height);
    return result;
}

WEAK int IPReadFile(const char *filename, BYTE *img)
{
    int32_t result = 0;
    ROBIOS(IPReadFile, text_of(filename), IP_WIDTH, IP_HEIGHT, room_of(img, (size_t)IP_SIZE), &result);
    return result;
}

WEAK int IPWriteFile(const char *filename, BYTE *img)
{
    int32_t result = 0;
    ROBIOS(IPWriteFile, text_of(filename), IP_WIDTH, IP_HEIGHT, colours_of(img), &result);
    return result;
}

WEAK int IPWriteFileGray(const char *filename, BYTE *gray)
{
    int32_t result = 0;
    ROBIOS(IPWriteFileGray, text_of(filename), IP_WIDTH, IP_HEIGHT, grey_of(gray), &result);
    return result;
}

WEAK void IPLaplace(BYTE *grayIn, BYTE *grayOut)
{
    ROBIOS(IPLaplace, IP_WIDTH, IP_HEIGHT, grey_of(grayIn), grey_room(grayOut), NULL);
}

WEAK void IPSobel(BYTE *grayIn, BYTE *grayOut)
{
    ROBIOS(IPSobel, IP_WIDTH, IP_HEIGHT, grey_of(grayIn), grey_room(grayOut), NULL);
}

WEAK void IPCol2Gray(BYTE *imgIn, BYTE *grayOut) { ROBIOS(IPCol2Gray, colours_of(imgIn), grey_room(grayOut), NULL); }

WEAK void IPGray2Col(BYTE *imgIn, BYTE *colOut) { ROBIOS(IPGray2Col, grey_of(imgIn), colour_room(colOut), NULL); }

WEAK void IPRGB2Col(BYTE *r, BYTE *g, BYTE *b, BYTE *imgOut)
{
    ROBIOS(IPRGB2Col, grey_of(r), grey_of(g), grey_of(b), colour_room(imgOut), NULL);
}

WEAK void IPCol2HSI(BYTE *img, BYTE *h, BYTE *s, BYTE *i)
{
    ROBIOS(IPCol2HSI, colours_of(img), grey_room(h), grey_room(s), grey_room(i), NULL);
}

WEAK void IPOverlay(BYTE *c1, BYTE *c2, BYTE *cOut)
{
    ROBIOS(IPOverlay, colours_of(c1), colours_of(c2), colour_room(cOut), NULL);
}

WEAK void IPOverlayGray(BYTE *g1, BYTE *g2, COLOR col, BYTE *cOut)
{
    ROBIOS(IPOverlayGray, grey_of(g1), grey_of(g2), col, colour_room(cOut), NULL);
}

/* ---- OS ---- */

WEAK int OSExecute(const char *command, char *out)
{
    int32_t result = 0;
    ROBIOS(OSExecute, text_of(command), room_of(out, MAX_OUTPUT), &result);
    return result;
}

WEAK char *eyesim_OSExecute(const char *command)
{
    struct results *own = own_results();
    if (own == NULL)
        return NULL;
    memset(own->output, 0, sizeof own->output);
    OSExecute(command, own->output);
    return own->output;
}

WEAK int OSVersion(char *buf)
{
    int32_t result = 0;
    ROBIOS(OSVersion, room_of(buf, MAX_NAME), &result);
    return result;
}

WEAK int OSVersionIO(char *buf)
{
    int32_t result = 0;
    ROBIOS(OSVersionIO, room_of(buf, MAX_NAME), &result);
    return result;
}

WEAK int OSMachineName(char *buf)
{
    int32_t result = 0;
    ROBIOS(OSMachineName, room_of(buf, MAX_NAME), &result);
    return result;
}

/* ---- tasks of the header of 2016 ---- */

WEAK int MTInit(void) { return 0; }

WEAK int MTSleep(int n)
{
    int32_t result = 0;
    ROBIOS(OSWait, n > INT32_MAX / 10 ? INT32_MAX : n > 0 ? 10 * n : 0, &result);
    return result;
}

struct task_start {
    void *(*function)(void *);
    int identifier;
};

static void *start_task(void *data)
{
    struct task_start start = *(struct task_start *)data;
    free(data);
    this_task()->identifier = start.identifier;
    return start.function(&this_task()->identifier);
}

WEAK TASK MTSpawn(void *(*fct)(void *), int id)
{
    TASK task;
    struct task_start *start = malloc(sizeof *start);
    memset(&task, 0, sizeof task);
    task.identifier = id;
    if (start != NULL) {
        start->function = fct;
        start->identifier = id;
        if (pthread_create(&task.thread, NULL, start_task, start) != 0)
            free(start);
    }
    return task;
}

WEAK int MTGetUID(TASK t) { return t.identifier; }
WEAK int MTKill(TASK t) { return pthread_cancel(t.thread) == 0 ? 0 : 1; }
WEAK int MTExit(void) { pthread_exit(NULL); }
WEAK int SEMAInit(SEMA *sem, int val) { return sem && val >= 0 && sem_init(sem, 0, (unsigned)val) == 0 ? 0 : 1; }
WEAK int SEMALock(SEMA *sem) { return sem && sem_wait(sem) == 0 ? 0 : 1; }
WEAK int SEMAUnlock(SEMA *sem) { return sem && sem_post(sem) == 0 ? 0 : 1; }

/* ---- SER, AU ---- */

WEAK int SERSend(int interface, const char *buf, uint32_t size)
{
    int32_t result = 0;
    ROBIOS(SERSend, interface, bytes_of(buf, size), &result);
    return result;
}

WEAK int eyesim_SERSend(int interface, const char *text)
{
    int32_t result = 0;
    ROBIOS(SERSend, interface, text_of(text), &result);
    return result;
}

WEAK int SERReceive(int interface, unsigned char *buf)
{
    int32_t result = 0;
    ROBIOS(SERReceive, interface, room_of(buf, MAX_SERIAL), &result);
    return result;
}

WEAK int AUPlay(const void *sample)
{
    int32_t result = 0;
    ROBIOS(AUPlay, sample_of(sample), &result);
    return result;
}

WEAK int AURecord(BYTE *buf, int time, long freq)
{
    int32_t result = 0;
    int64_t len = time > 0 && freq > 0 && freq <= 1000000 ? (int64_t)time * freq / 1000 : 0;
    ROBIOS(AURecord, room_of(len > 0 ? buf : NULL, (size_t)len), freq, &result);
    return result;
}

/* ---- LIDAR, ANALOG, VW ---- */

WEAK int LIDARGet(int distance[])
{
    int32_t result = 0;
    ROBIOS(LIDARGet, room_of(distance, MAX_LIDAR_POINTS), &result);
    return result;
}

WEAK int LIDAR_RESOLUTION = 0; /* until the program runs */

/* Sets LIDAR_RESOLUTION to the number of points of the robot's scanner; without a scanner it is 360, or as before. */
static void set_lidar_resolution(void)
{
    int32_t points = 0;
    SUPPORT(lidar_points, &points);
    LIDAR_RESOLUTION = points > 0 ? points : LIDAR_RESOLUTION > 0 ? LIDAR_RESOLUTION : 360;
}

WEAK void LIDARSet(int range, int tilt, int points)
{
    ROBIOS(LIDARSet, range, tilt, points, NULL);
    set_lidar_resolution();
}

WEAK int SIMLaserScan(int *dists) { return LIDARGet(dists); }

WEAK int ANALOGTransfer(BYTE *buffer)
{
    int32_t result = 0;
    ROBIOS(ANALOGTransfer, room_of(buffer, MAX_RECORDING), &result);
    return result;
}

WEAK int MOTORPIDoff(int motor)
{
    int32_t result = 0;
    ROBIOS(MOTORPIDOff, motor, &result);
    return result;
}

WEAK int VWDriveRemain(void)
{
    int32_t result = 0;
    ROBIOS(VWRemain, &result);
    return result;
}

WEAK int VWDriveDone(void)
{
    int32_t result = 0;
    ROBIOS(VWDone, &result);
    return result;
}

WEAK int VWDriveWait(void)
{
    int32_t result = 0;
    ROBIOS(VWWait, &result);
    return result;
}

WEAK int VWDriveReady(void)
{
    int32_t result = 0;
    ROBIOS(VWDone, &result);
    return result;
}

/* ---- SERVO ---- */

static int has_servo(int servo)
{
    int32_t position = 0;
    ROBIOS(SERVOGet, servo, &position);
    return position >= 0;
}

WEAK int SERVODone(int servo) { return has_servo(servo); }
WEAK int SERVOWait(int servo) { return !has_servo(servo); }

/* ---- RADIO ---- */

WEAK int eyesim_RADIOSend(int id, const void *buf, int size)
{
    int32_t result = 0;
    ROBIOS(RADIOSend, id, bytes_of(size < 0 ? NULL : buf, size < 0 ? 0 : (size_t)size), &result);
    return result;
}

WEAK int RADIOCheck()
{
    int32_t result = 0;
    ROBIOS(RADIOCheck, &result);
    return result;
}

WEAK int RADIOReceive(int *id, char *buf, int size)
{
    int32_t result = 0;
    ROBIOS(RADIOReceive, id, room_of(size > 0 ? buf : NULL, size > 0 ? (size_t)size : 0), &result);
    return result;
}

WEAK int RADIOStatus(int IDlist[])
{
    int32_t result = 0;
    ROBIOS(RADIOStatus, room_of(IDlist, MAX_RADIO_IDS), &result);
    return result;
}

/* ---- LEG ---- */

WEAK int LEGGetLink(int leg, int link, float pose[6])
{
    int32_t result = 0;
    ROBIOS(LEGGetLink, leg, link, room_of(pose, 6), &result);
    return result;
}

/* ---- SIM of the header of 2017 ---- */

WEAK void SIMGetPose(int *x, int *y, int *phi) { ROBIOS(SIMGetRobot, 0, x, y, NULL, phi, NULL); }
WEAK void SIMSetPose(int x, int y, int phi) { ROBIOS(SIMSetRobot, 0, x, y, 0, phi, NULL); }
WEAK void eyesim_SIMGetObject(int id, int *x, int *y, int *phi) { ROBIOS(SIMGetObject, id, x, y, NULL, phi, NULL); }
WEAK void eyesim_SIMSetObject(int id, int x, int y, int phi) { ROBIOS(SIMSetObject, id, x, y, 0, phi, NULL); }
