/* Old programs include it; everything is in eyebot.h. */
#include "eyebot.h"
