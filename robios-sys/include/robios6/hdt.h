/* RoBIOS 6: kinds of devices.
 * Written from the lists of functions and constants of eyesim. */
#ifndef EYESIM_HDT_H
#define EYESIM_HDT_H

#define HDT_MOTOR              1 /* Motors. */
#define HDT_QUAD               2 /* Encoders. */
#define HDT_SERVO              3 /* Servos. */
#define HDT_PSD                4 /* PSD distance sensors. */
#define HDT_BUMP               5 /* Bumpers. */
#define HDT_IR                 6 /* Infrared proximity sensors. */
#define HDT_VW                 7 /* Driving interfaces. */
#define HDT_COMPASS            8 /* Compasses. */
#define HDT_IRTV               9 /* Receivers of TV remote controls. */

#endif
