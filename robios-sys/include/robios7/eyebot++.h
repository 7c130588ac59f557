/* The name that programs in C++ include it by. */
#include "eyebot.h"
