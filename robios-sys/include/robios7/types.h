/* RoBIOS-7: the types of eyebot.h. */
#ifndef EYESIM_TYPES_H
#define EYESIM_TYPES_H

#include <pthread.h>
#include <semaphore.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Additional names of EyeSim's types.h, X included; with EYESIM_LEAN these names are left to the program. */
#ifndef EYESIM_LEAN
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
#include "X11/Xlib.h"
#endif

/* RoBIOS generation of this header. */
#define EYESIM_ROBIOS 7

/* Checks the arguments of a function that formats as printf does. */
#if defined(__GNUC__)
#define EYESIM_PRINTF(text, first) __attribute__((__format__(__printf__, text, first)))
#else
#define EYESIM_PRINTF(text, first)
#endif

typedef unsigned char BYTE;
typedef int COLOR; /* 0xRRGGBB */
typedef int TIMER; /* of OSAttachTimer, 0 is none */
typedef char *DeviceSemantics;
typedef void (*TimerFnc)(void);

/* Any arguments, since the original headers differ. */
#ifdef __cplusplus
#define EYESIM_ANY ...
#else
#define EYESIM_ANY
#endif

/* Types of the header of 2016. */
typedef sem_t SEMA;
typedef struct {
    pthread_t thread;
    int identifier;
} TASK;

/* Sizes of images: columns, rows, pixels, and bytes in colour. */
#define QQVGA_X       160
#define QQVGA_Y       120
#define QQVGA_PIXELS  (QQVGA_X * QQVGA_Y)
#define QQVGA_SIZE    (QQVGA_PIXELS * 3)
#define QVGA_X        320
#define QVGA_Y        240
#define QVGA_PIXELS   (QVGA_X * QVGA_Y)
#define QVGA_SIZE     (QVGA_PIXELS * 3)
#define VGA_X         640
#define VGA_Y         480
#define VGA_PIXELS    (VGA_X * VGA_Y)
#define VGA_SIZE      (VGA_PIXELS * 3)
#define CAM1MP_X      1296
#define CAM1MP_Y      730
#define CAM1MP_PIXELS (CAM1MP_X * CAM1MP_Y)
#define CAM1MP_SIZE   (CAM1MP_PIXELS * 3)
#define CAMHD_X       1920
#define CAMHD_Y       1080
#define CAMHD_PIXELS  (CAMHD_X * CAMHD_Y)
#define CAMHD_SIZE    (CAMHD_PIXELS * 3)
#define CAM5MP_X      2592
#define CAM5MP_Y      1944
#define CAM5MP_PIXELS (CAM5MP_X * CAM5MP_Y)
#define CAM5MP_SIZE   (CAM5MP_PIXELS * 3)

typedef BYTE QQVGAcol[QQVGA_SIZE];
typedef BYTE QQVGAgray[QQVGA_PIXELS];
typedef BYTE QVGAcol[QVGA_SIZE];
typedef BYTE QVGAgray[QVGA_PIXELS];
typedef BYTE VGAcol[VGA_SIZE];
typedef BYTE VGAgray[VGA_PIXELS];
typedef BYTE CAM1MPcol[CAM1MP_SIZE];
typedef BYTE CAM1MPgray[CAM1MP_PIXELS];
typedef BYTE CAMHDcol[CAMHD_SIZE];
typedef BYTE CAMHDgray[CAMHD_PIXELS];
typedef BYTE CAM5MPcol[CAM5MP_SIZE];
typedef BYTE CAM5MPgray[CAM5MP_PIXELS];

/* Sizes set by CAMInit and IPSetSize; initially QVGA. */
#ifdef __cplusplus
extern "C" {
#endif
extern int CAMWIDTH, CAMHEIGHT, CAMPIXELS, CAMSIZE, CAMMODE;
extern int IP_WIDTH, IP_HEIGHT, IP_PIXELS, IP_SIZE;
#ifdef __cplusplus
}
#endif

#define CAM_SUCCESS 0 /* CAMInit, CAMGet */
#define CAM_FAILURE 1

/* The properties of a machine that the library assumes by default. */
#define MACHINE_SPEED   700000000
#define MACHINE_TYPE    VEHICLE
#define MACHINE_NAME    "EyeBot"
#define MACHINE_ID      1
#define MACHINE_VERSION "1.0"
#ifndef EYESIM_LEAN
#ifndef VERSION
#define VERSION MACHINE_VERSION
#endif
#endif

#endif
