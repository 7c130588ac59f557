/* Names of older RoBIOS and of the other generation, for programs that use them without a declaration. */
#ifndef EYESIM_OLD_NAMES_H
#define EYESIM_OLD_NAMES_H

#define NONE 0   /* OSInitRS232, SERInit: no handshake */
#define RTSCTS 1 /* OSInitRS232, SERInit: handshake by RTS and CTS */

#define NL '\n'
#define CAMWAIT 10 /* OSWait after a failure of CAMInit; the number is our choice */

typedef int TimerHandle;
typedef int TIMER;
typedef int keycode_t;

#endif
