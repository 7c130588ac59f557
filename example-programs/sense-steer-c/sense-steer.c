/* A sensing task beside a control task: the first measures periodically; the second waits on a semaphore for each measurement and
   steers by it. The robot drives about for a minute and avoids all obstacles. */
#include <stdio.h>
#include "eyebot.h"

#define SENSORS  5
#define SECONDS  60
#define PERIOD   6      /* 1/100 s: a cycle of the sensors */
#define SPEED    0.3    /* m/s */
#define RATE     2.0    /* rad/s */
#define NEAR_MM  220    /* nearer than this it turns on the spot */
#define FAR_MM   600

static struct sem measured;  /* signalled once for each measurement */
static struct sem access;    /* guards the measurements */
static int distance[SENSORS];
static int measurements, commands;

static PSDHandle psd[SENSORS];
static VWHandle vw;

static void sense(void)
{
  int i, mm[SENSORS];

  for (;;) {
    for (i = 0; i < SENSORS; i++)
      mm[i] = PSDGet(psd[i]);
    OSSemP(&access);
    for (i = 0; i < SENSORS; i++)
      distance[i] = mm[i] < FAR_MM ? mm[i] : FAR_MM;
    measurements++;
    OSSemV(&access);
    OSSemV(&measured);
    OSSleep(PERIOD);
  }
}

static int min(int a, int b) { return a < b ? a : b; }

static void steer(void)
{
  int ahead, left, right, side = 1;

  for (;;) {
    OSSemP(&measured);
    OSSemP(&access);
    left = min(distance[0], distance[1]);
    right = min(distance[3], distance[4]);
    ahead = min(distance[2], min(distance[1], distance[3]));
    OSSemV(&access);
    if (ahead < NEAR_MM) {
      VWSetSpeed(vw, 0, side * RATE);
    } else {
      side = left < right ? -1 : 1;  /* the side with more room, kept until the way is free */
      VWSetSpeed(vw, SPEED * min(ahead, left + right) / FAR_MM, RATE * (left - right) / FAR_MM);
    }
    commands++;
  }
}

int main(void)
{
  static const DeviceSemantics places[SENSORS] = {  /* from left to right */
    PSD_LEFTDIAG, PSD_FRONTLEFT, PSD_FRONT, PSD_FRONTRIGHT, PSD_RIGHTDIAG
  };
  struct tcb *sensing, *control;
  PSDHandle all = 0;
  int i;

  vw = VWInit(VW_DRIVE, 1);
  for (i = 0; i < SENSORS; i++)
    all |= psd[i] = PSDInit(places[i]);
  PSDStart(all, TRUE);
  OSWait(PERIOD + 1);  /* the first values */

  OSMTInit(PREEMPT);
  OSSemInit(&measured, 0);
  OSSemInit(&access, 1);
  sensing = OSSpawn("sense", sense, SMALL_STACKSIZE, 4, 1);
  control = OSSpawn("steer", steer, SMALL_STACKSIZE, 5, 2);
  OSReady(sensing);
  OSReady(control);
  OSPermit();

  OSSleep(SECONDS * 100);
  OSForbid();
  OSKill(sensing);
  OSKill(control);
  VWSetSpeed(vw, 0, 0);
  printf("%d measurements, %d commands\n", measurements, commands);
  return 0;
}
