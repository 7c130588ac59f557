/* RoBIOS 6: which device of its kind.
 * Written from the lists of functions and constants of eyesim. */
#ifndef EYESIM_HDT_SEM_H
#define EYESIM_HDT_SEM_H

#define MOTOR_LEFT        (-100) /* Motor of the left wheel. */
#define MOTOR_RIGHT       (-101) /* Motor of the right wheel. */
#define MOTOR_FL          (-102) /* Motor of the front left wheel. */
#define MOTOR_FR          (-103) /* Motor of the front right wheel. */
#define MOTOR_BL          (-104) /* Motor of the back left wheel. */
#define MOTOR_BR          (-105) /* Motor of the back right wheel. */
#define MOTOR_DRIVE       (-106) /* The motor that drives an Ackermann robot. */
#define PSD_FRONT         (-200) /* PSD sensor to the front. */
#define PSD_FRONTLEFT     (-201) /* PSD sensor to the front, left of the middle. */
#define PSD_FRONTRIGHT    (-202) /* PSD sensor to the front, right of the middle. */
#define PSD_LEFTDIAG      (-203) /* PSD sensor diagonally to the left. */
#define PSD_RIGHTDIAG     (-204) /* PSD sensor diagonally to the right. */
#define PSD_LEFT          (-205) /* PSD sensor to the left. */
#define PSD_LEFTFRONT     (-206) /* PSD sensor to the left, at the front. */
#define PSD_LEFTBACK      (-207) /* PSD sensor to the left, at the back. */
#define PSD_RIGHTFRONT    (-208) /* PSD sensor to the right, at the front. */
#define PSD_RIGHTBACK     (-209) /* PSD sensor to the right, at the back. */
#define PSD_RIGHT         (-210) /* PSD sensor to the right. */
#define PSD_FRONT2        (-211) /* Second PSD sensor to the front. */
#define PSD_BACK          (-212) /* PSD sensor to the back. */
#define PSD_BACKLEFT      (-213) /* PSD sensor to the back, left of the middle. */
#define PSD_BACKRIGHT     (-214) /* PSD sensor to the back, right of the middle. */
#define QUAD_LEFT         (-300) /* Encoder of the left wheel. */
#define QUAD_RIGHT        (-301) /* Encoder of the right wheel. */
#define QUAD_FL           (-302) /* Encoder of the front left wheel. */
#define QUAD_FR           (-303) /* Encoder of the front right wheel. */
#define QUAD_BL           (-304) /* Encoder of the back left wheel. */
#define QUAD_BR           (-305) /* Encoder of the back right wheel. */
#define QUAD_DRIVE        (-306) /* Encoder of the wheels that drive an Ackermann robot. */
#define SERVO1            (-401) /* Servo 1. */
#define SERVO2            (-402) /* Servo 2. */
#define SERVO3            (-403) /* Servo 3. */
#define SERVO4            (-404) /* Servo 4. */
#define SERVO5            (-405) /* Servo 5. */
#define SERVO6            (-406) /* Servo 6. */
#define SERVO7            (-407) /* Servo 7. */
#define SERVO8            (-408) /* Servo 8. */
#define SERVO9            (-409) /* Servo 9. */
#define SERVO10           (-410) /* Servo 10. */
#define SERVO11           (-411) /* Servo 11. */
#define SERVO12           (-412) /* Servo 12. */
#define SERVO13           (-413) /* Servo 13. */
#define SERVO14           (-414) /* Servo 14. */
#define SERVO15           (-415) /* Servo 15. */
#define SERVO16           (-416) /* Servo 16. */
#define SERVO_STEER       (-420) /* The servo that steers an Ackermann robot. */
#define SERVO_CAMERA      (-421) /* The servo that turns the camera. */
#define BUMP_RIGHT        (-500) /* Bumper to the right. */
#define BUMP_LEFT         (-501) /* Bumper to the left. */
#define BUMP_FRONT        (-502) /* Bumper to the front. */
#define BUMP_BACK         (-503) /* Bumper to the back. */
#define BUMP_FRONTLEFT    (-504) /* Bumper to the front, left of the middle. */
#define BUMP_FRONTRIGHT   (-505) /* Bumper to the front, right of the middle. */
#define BUMP_BACKLEFT     (-506) /* Bumper to the back, left of the middle. */
#define BUMP_BACKRIGHT    (-507) /* Bumper to the back, right of the middle. */
#define IR_FRONT          (-600) /* Infrared proximity sensor to the front. */
#define IR_LEFT           (-601) /* Infrared proximity sensor to the left. */
#define IR_RIGHT          (-602) /* Infrared proximity sensor to the right. */
#define IR_BACK           (-603) /* Infrared proximity sensor to the back. */
#define IR_LEFTDIAG       (-604) /* Infrared proximity sensor diagonally to the left. */
#define IR_RIGHTDIAG      (-605) /* Infrared proximity sensor diagonally to the right. */
#define IR_FRONTLEFT      (-606) /* Infrared proximity sensor to the front, left of the middle. */
#define IR_FRONTRIGHT     (-607) /* Infrared proximity sensor to the front, right of the middle. */
#define IR_BACKLEFT       (-608) /* Infrared proximity sensor to the back, left of the middle. */
#define IR_BACKRIGHT      (-609) /* Infrared proximity sensor to the back, right of the middle. */
#define VW_DRIVE          (-700) /* The driving interface over motors and encoders. */
#define VW                (-700) /* The older name of VW_DRIVE. */
#define COMPASS           (-800) /* The compass. */
#define IRTV              (-900) /* The receiver of a TV remote control. */

#endif
