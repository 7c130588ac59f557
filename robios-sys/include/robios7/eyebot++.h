/* Header name for programs in C++. */
#include "eyebot.h"
