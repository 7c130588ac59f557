/* Other names of functions; part of eyebot.h. */
#ifndef EYESIM_VARIANTS_H
#define EYESIM_VARIANTS_H

#include "types.h"

#ifdef __cplusplus
extern "C" {
#endif

int VWDriveReady(VWHandle handle); /* VWDriveDone */

#ifdef __cplusplus
}
#endif

#endif
