/* For old programs that include this name; everything is in eyebot.h. */
#include "eyebot.h"
