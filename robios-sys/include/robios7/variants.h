/* Names of the RoBIOS-7 headers of 2016 and 2017; part of eyebot.h. */
#ifndef EYESIM_VARIANTS_H
#define EYESIM_VARIANTS_H

#include "types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- 2016: tasks and semaphores; newer programs use pthreads ---- */

int MTInit(void);                               /* 0 */
int MTSleep(int n);                             /* waits n hundredths of a second */
TASK MTSpawn(void *(*fct)(void *), int id);     /* fct gets a pointer to the identifier */
int MTGetUID(TASK t);                           /* its identifier */
int MTKill(TASK t);                             /* 0, 1 on failure */
int MTExit(void);                               /* ends the task that calls it */
int SEMAInit(SEMA *sem, int val);               /* 0, 1 on failure */
int SEMALock(SEMA *sem);                        /* 0, 1 on failure */
int SEMAUnlock(SEMA *sem);                      /* 0, 1 on failure */

/* ---- 2016: other names ---- */

int VWDriveRemain(void); /* VWRemain */
int VWDriveDone(void);   /* VWDone */
int VWDriveWait(void);   /* VWWait */
int VWDriveReady(void);  /* VWDone */

int LCDInit(void); /* 0: the display is always there */

/* ---- EyeSim X, in Python only ---- */

int SERVODone(int servo); /* 1: a servo turns at once; 0 if there is no such servo */
int SERVOWait(int servo); /* 0, 1 if there is no such servo */

/* Number of points of LIDARGet, as set by LIDARSet; initially that of the robot's scanner, 360 without one. */
#ifndef LIDAR_RESOLUTION
extern int LIDAR_RESOLUTION;
#endif

/* ---- 2017: other names ---- */

void SIMGetPose(int *x, int *y, int *phi); /* of this robot: mm, mm, degrees */
void SIMSetPose(int x, int y, int phi);
int SIMLaserScan(int *dists);              /* LIDARGet: LIDAR_RESOLUTION distances in mm */
int MOTORPIDoff(int motor);                /* MOTORPIDOff */

/* ---- 2017: list menus, in no header; the order of the fields is ours ---- */

typedef struct {
    char label[32];
    COLOR fgcol, bgcol;
    void *plink; /* for the program */
} menuitem_t;

typedef struct {
    char title[64];
    COLOR fgcol, bgcol;
    int size;   /* number of items */
    int start;  /* the first item that is shown */
    int index;  /* the active one of those that are shown, from 0; -1 for none */
    int scroll; /* set by LCDList: 1 where not all items have room */
    menuitem_t *pitems;
} listmenu_t;

int LCDList(listmenu_t *menulist);    /* shows a list above the menu; its lines are KEY_LIST1 to KEY_LIST8 */
int LCDSetList(listmenu_t *menulist); /* the same; null shows none */
listmenu_t *LCDGetList(void);         /* the list that is shown, or null */
menuitem_t *LCDListActiveItem(void);  /* its active item, or null */

/* ---- the same name with fewer arguments ---- */

char *eyesim_OSExecute(const char *command);                             /* 2016: the output stays valid until the next call */
int eyesim_SERSend(int interface, const char *text);                     /* 2016: a text that ends in 0 */
int eyesim_RADIOSend(int id, const void *buf, int size);                 /* 2016: `size` bytes */
void eyesim_SIMGetObject(int id, int *x, int *y, int *phi);              /* 2017: without z */
void eyesim_SIMSetObject(int id, int x, int y, int phi);                 /* 2017: without z */

#define EYESIM_NTH(_1, _2, _3, _4, _5, name, ...) name
#define OSExecute(...) \
    EYESIM_NTH(__VA_ARGS__, OSExecute, OSExecute, OSExecute, OSExecute, eyesim_OSExecute, 0)(__VA_ARGS__)
#define RADIOSend(...) \
    EYESIM_NTH(__VA_ARGS__, RADIOSend, RADIOSend, eyesim_RADIOSend, RADIOSend, RADIOSend, 0)(__VA_ARGS__)
#define SERSend(...) EYESIM_NTH(__VA_ARGS__, SERSend, SERSend, SERSend, eyesim_SERSend, SERSend, 0)(__VA_ARGS__)
#define SIMGetObject(...) \
    EYESIM_NTH(__VA_ARGS__, SIMGetObject, eyesim_SIMGetObject, SIMGetObject, SIMGetObject, SIMGetObject, 0)(__VA_ARGS__)
#define SIMSetObject(...) \
    EYESIM_NTH(__VA_ARGS__, SIMSetObject, eyesim_SIMSetObject, SIMSetObject, SIMSetObject, SIMSetObject, 0)(__VA_ARGS__)

#ifdef __cplusplus
}
#endif

#endif
