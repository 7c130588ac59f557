/* Names of X that programs without a window use; EyeSim's types.h includes it. */
#ifndef EYESIM_XLIB_H
#define EYESIM_XLIB_H

#ifndef True
#define True  1
#define False 0
#endif
#ifndef Bool
#define Bool int
#endif

typedef struct _XDisplay Display; /* never created */

#ifdef __cplusplus
extern "C" {
#endif

int XInitThreads(void); /* 1: done */

#ifdef __cplusplus
}
#endif

#endif
