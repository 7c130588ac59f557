/* Truth values of older RoBIOS, for programs that use them without a declaration. */
#ifndef EYESIM_TRUTH_H
#define EYESIM_TRUTH_H

#define TRUE 1
#define FALSE 0
typedef int BOOL;

#endif
