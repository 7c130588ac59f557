/* RoBIOS 6: the types of eyebot.h. */
#ifndef EYESIM_TYPES_H
#define EYESIM_TYPES_H

/* RoBIOS generation of this header. */
#define EYESIM_ROBIOS 6

/* Checks the arguments of a function that formats as printf does. */
#if defined(__GNUC__)
#define EYESIM_PRINTF(text, first) __attribute__((__format__(__printf__, text, first)))
#else
#define EYESIM_PRINTF(text, first)
#endif

typedef unsigned char BYTE;
typedef int BOOL;

/* Images: 80 x 60 pixels and a border of one pixel, which is undefined; row 0 is at the top. */
#define imagecolumns 82
#define imagerows    62
typedef BYTE image[imagerows][imagecolumns];       /* grey, 0 to 255 */
typedef BYTE colimage[imagerows][imagecolumns][3]; /* red, green, blue */

typedef int DeviceSemantics; /* a number of hdt_sem.h */
typedef int TypeID;          /* a number of hdt.h */
typedef int MotorHandle;
typedef int QuadHandle;
typedef int ServoHandle;
typedef int PSDHandle;
typedef int VWHandle;
typedef int BumpHandle;
typedef int IRHandle;
typedef int TimerHandle;
typedef void (*TimerFnc)(void);

typedef float meterPerSec;
typedef float radPerSec;
typedef float meter;
typedef float radians;

/* x forward and y left of the origin set by VWInit or VWSetPosition; phi counter-clockwise. */
typedef struct {
    meter x;
    meter y;
    radians phi;
} PositionType;

typedef struct {
    meterPerSec v;
    radPerSec w;
} SpeedType;

typedef struct {
    int interface;     /* SERIAL1 to SERIAL3 */
    int speed;         /* SER9600 to SER115200 */
    int id;            /* of the machine, 1 to 255 */
    int remoteOn;      /* 1: the remote control is active */
    int imageTransfer; /* 0 off, 1 full, 2 reduced */
    int debug;         /* 0 off to 100 everything */
} RadioIOParameters;

typedef struct {
    int id;       /* of the machine */
    int sent;     /* messages */
    int received; /* messages */
    int waiting;  /* messages that can be received now */
} RadioStatus;

/* A device of the robot. */
typedef struct {
    TypeID type_id;
    DeviceSemantics semantics;
    char device_name[16]; /* ends in 0 */
} HDT_entry_type;

/* A task; its members are for reading. */
struct tcb {
    struct tcb *next; /* the task created before */
    int id;
    int uid;
    int pri;
    int stksiz;
    char name[16];
};

/* A semaphore; OSSemInit fills it in. */
struct sem {
    int id;
    int count; /* as OSSemInit has set it */
};

#endif
