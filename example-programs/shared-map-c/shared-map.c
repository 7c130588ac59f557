/* Three robots map a maze of three lanes together, over a radio that loses and garbles messages: shared-map in C, which interoperates
   with the one in Rust. Each robot sends its findings to every other robot until they are acknowledged (stop-and-wait). A garbled
   message is recognised by its checksum and counts as lost. */
#include <stdio.h>
#include <string.h>
#include "eyebot.h"

#define LANES    3
#define COLUMNS  8
#define CELL     0.36f  /* m */
#define SPEED    0.2f   /* m/s */
#define NEAR     140    /* mm: a wall at the side is nearer */
#define TIMEOUT  20     /* 1/100 s without an acknowledgement until a report is sent again */
#define LINGER   300    /* 1/100 s of silence before the end: until then it answers repeats, since an acknowledgement may be lost */
#define UNKNOWN  4

enum kind { FOUND, ACK };

struct report { BYTE kind, lane, column, walls; };  /* walls: 1 at the left, 2 at the right */

/* Reports that one other robot has not acknowledged yet. */
struct queue { struct report reports[COLUMNS]; int first, count, is_sent, sent; };

static int me;
static struct queue queues[LANES + 1];
static BYTE map[LANES][COLUMNS];
static int repeats, garbled;

/* CRC-16 of CCITT, which finds every error of up to three bits. */
static unsigned checksum(struct report report)
{
  BYTE bytes[4] = { report.kind, report.lane, report.column, report.walls };
  unsigned crc = 0xFFFF;
  int i, bit;

  for (i = 0; i < 4; i++)
    for (crc ^= bytes[i] << 8, bit = 0; bit < 8; bit++)
      crc = (crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1) & 0xFFFF;
  return crc;
}

/* Sends a report: a byte each for kind, lane, column and both walls, then the checksum, seven bits a byte, the lowest first. */
static void send(int to, struct report report)
{
  BYTE message[8] = { report.kind, report.lane, report.column, report.walls & 1, report.walls >> 1 };
  unsigned rest = checksum(report);
  int length = 5;

  for (; rest > 0x7F; rest >>= 7)
    message[length++] = rest | 0x80;
  message[length++] = rest;
  while (RADIOSend(to, length, message) != 0)
    OSWait(1);  /* the buffer is full */
}

/* Decodes a message. Returns FALSE if it is garbled. */
static int decode(const BYTE *message, int length, struct report *report)
{
  unsigned sum = 0;
  int i;

  if (length < 6 || length > 8 || message[0] > ACK || message[3] > 1 || message[4] > 1)
    return FALSE;
  *report = (struct report){ message[0], message[1], message[2], message[3] | message[4] << 1 };
  for (i = 5; i < length; i++) {
    sum |= (message[i] & 0x7Fu) << 7 * (i - 5);
    if ((message[i] > 0x7F) != (i + 1 < length))
      return FALSE;
  }
  return sum == checksum(*report);
}

static void tell_all(struct report report)
{
  int other;

  for (other = 1; other <= LANES; other++)
    if (other != me)
      queues[other].reports[queues[other].count++] = report;
}

/* Returns TRUE while an acknowledgement or a part of the map is missing. */
static int is_open(void)
{
  int other;

  for (other = 1; other <= LANES; other++)
    if (queues[other].first < queues[other].count)
      return TRUE;
  return memchr(map, UNKNOWN, sizeof map) != NULL;
}

/* Sends the first report of each queue, if it is new or its acknowledgement is overdue. */
static void send_due(void)
{
  int other;

  for (other = 1; other <= LANES; other++) {
    struct queue *queue = &queues[other];
    if (queue->first == queue->count || (queue->is_sent && OSGetCount() < queue->sent + TIMEOUT))
      continue;
    repeats += queue->is_sent;
    queue->is_sent = TRUE;
    queue->sent = OSGetCount();
    send(other, queue->reports[queue->first]);
  }
}

static void hear(void)
{
  BYTE sender, message[MAXMSGLEN];
  struct report report;
  struct queue *queue;
  int length = 0;

  if (RADIORecv(&sender, &length, message) != 0)
    return;
  if (!decode(message, length, &report)) {
    garbled++;  /* the sender will repeat it */
    return;
  }
  if (report.kind == FOUND) {
    if (report.lane < LANES && report.column < COLUMNS)
      map[report.lane][report.column] = report.walls;
    report.kind = ACK;
    send(sender, report);
    return;
  }
  queue = &queues[sender <= LANES ? sender : 0];
  report.kind = FOUND;
  if (queue->first < queue->count && memcmp(&report, &queue->reports[queue->first], sizeof report) == 0) {
    queue->first++;
    queue->is_sent = FALSE;
  }
}

/* Sends and receives until the time `end`. Returns TRUE if a message was received. */
static int serve(int end)
{
  int is_heard = FALSE;

  for (send_due(); OSGetCount() < end; send_due()) {
    if (RADIOCheck()) {
      hear();
      is_heard = TRUE;
    }
    else
      OSWait(1);
  }
  return is_heard;
}

int main()
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PSDHandle left = PSDInit(PSD_LEFT), right = PSDInit(PSD_RIGHT);
  int lane, column;

  if (!vw || !left || !right || RADIOInit() != 0)
    return 1;
  PSDStart(left | right, TRUE);
  memset(map, UNKNOWN, sizeof map);
  me = OSMachineID();
  lane = me - 1;
  for (column = 0; column < COLUMNS; column++) {
    serve(OSGetCount() + 10);  /* the sensors measure every 60 ms */
    map[lane][column] = (PSDGet(left) < NEAR) | (PSDGet(right) < NEAR) << 1;
    tell_all((struct report){ FOUND, lane, column, map[lane][column] });
    if (column + 1 < COLUMNS) {
      VWDriveStraight(vw, CELL, SPEED);
      while (!VWDriveDone(vw))
        serve(OSGetCount() + 5);
    }
  }
  while (is_open())
    serve(OSGetCount() + 5);
  for (lane = 0; lane < LANES; lane++) {
    printf("lane %d ", lane);
    for (column = 0; column < COLUMNS; column++)
      putchar("-'.=?"[map[lane][column]]);
    printf("\n");
  }
  while (serve(OSGetCount() + LINGER))
    ;
  printf("%d repeats, %d garbled\n", repeats, garbled);
  VWRelease(vw);
  return 0;
}
