/* The library of RoBIOS under the name of its folder, as some programs include it. */
#include "eyebot.h"
