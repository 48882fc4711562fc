/* Sends the capacitors of the branch gains to the board when the frequency changes. Made from {{file}}.
 *
 *   cc -o gain_host gain_host.c -lm
 *   gain_host /dev/ttyUSB0                  frequencies in Hz on standard input, one a line
 *   gain_host /dev/ttyUSB0 --samples 10000  samples of the reference on standard input, one a line, so many a second:
 *                                           the frequency is measured from one rise through the middle to the next
 *   gain_host - ...                         sends nothing, shows which set it would take
 *
 * The line is 57600 baud, 8 bits, no parity. After each packet the board is asked for its status; a packet that is not
 * answered is sent again. Exit status 0: everything was sent; 1: the board did not answer; 2: wrong usage or input. */
#define _DEFAULT_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#define SETS {{set_count}}
#define CHIPS {{chip_count}}
#define TRIES 4
#define ANSWER_MS 1000

/* Serves up to to_hz; once taken it is kept from keep_from_hz to keep_to_hz, so that it does not toggle. */
struct gain_set
{
   double frequency_hz, to_hz, keep_from_hz, keep_to_hz;
   const char* update[CHIPS]; /* hexadecimal text of each chip's update stream */
};

static const struct gain_set sets[SETS] =
{
{{#sets}}
   /*{{#gains}} {{branch}} {{over}}/{{under}} = {{gain}}{{/gains}} */
   { {{frequency}}, {{to}}, {{keep_from}}, {{keep_to}},
     { {{#packets}}"{{hex}}",
       {{/packets}} } },
{{/sets}}
};

/* --- The serial line ------------------------------------------------------------------------------------------- */

static int open_line(const char* device)
{
   struct termios line;
   int file = open(device, O_RDWR | O_NOCTTY);
   if (file < 0 || tcgetattr(file, &line) != 0)
   {
      fprintf(stderr, "gain_host: %s: cannot be opened as a serial port: %s\n", device, strerror(errno));
      return -1;
   }
   cfmakeraw(&line);
   line.c_cflag |= CLOCAL | CREAD;
   line.c_cflag &= ~(tcflag_t)(CSTOPB | PARENB);
   cfsetispeed(&line, B57600);
   cfsetospeed(&line, B57600);
   if (tcsetattr(file, TCSANOW, &line) != 0) return -1;
   tcflush(file, TCIOFLUSH);
   return file;
}

static int put(int file, const char* bytes, size_t count)
{
   while (count > 0)
   {
      ssize_t done = write(file, bytes, count);
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) return 0;
      bytes += done;
      count -= (size_t)done;
   }
   return 1;
}

/* A byte, or -1 when none comes in time. */
static int get(int file, int wait_ms)
{
   unsigned char byte;
   struct pollfd wait;
   wait.fd = file;
   wait.events = POLLIN;
   if (poll(&wait, 1, wait_ms) <= 0 || read(file, &byte, 1) != 1) return -1;
   return byte;
}

/* An answer ends with a 0 byte. */
static int good_answer(int file)
{
   char answer[256];
   size_t count = 0;
   while (count + 1 < sizeof answer)
   {
      int byte = get(file, ANSWER_MS);
      if (byte < 0) return 0;
      if (byte == 0x11 || byte == 0x13 || (byte == 0 && count == 0)) continue;
      answer[count++] = (char)byte;
      if (byte == 0) return strstr(answer, "ERR") == NULL && strstr(answer, "FAIL") == NULL;
      if (byte > 0x7E) return 0;
   }
   return 0;
}

/* STX, '1' for an update, four digits with the number of hexadecimal characters, the text, ETX; then '?'. */
static int send_update(int file, const char* hex)
{
   char head[8];
   int attempt;
   snprintf(head, sizeof head, "\x02" "1%04X", (unsigned)(strlen(hex) & 0xFFFF));
   for (attempt = 0; attempt < TRIES; ++attempt)
   {
      int good;
      while (get(file, 10) >= 0) /* what is left of a late answer */
      {
      }
      if (!put(file, head, 6) || !put(file, hex, strlen(hex)) || !put(file, "\x03", 1)) return 0;
      if (!put(file, "\x02" "?", 2)) return 0;
      good = good_answer(file);
      if (!put(file, "\x03", 1)) return 0;
      if (good) return 1;
   }
   return 0;
}

/* --- The table ------------------------------------------------------------------------------------------------- */

static int set_for(double frequency_hz)
{
   int i = 0;
   while (i + 1 < SETS && frequency_hz >= sets[i].to_hz) ++i;
   return i;
}

static int current = -1;

/* 1: as it should be, 0: the board does not answer. */
static int follow(int file, double frequency_hz)
{
   int chip, wanted;
   if (current >= 0 && frequency_hz >= sets[current].keep_from_hz && frequency_hz <= sets[current].keep_to_hz) return 1;
   wanted = set_for(frequency_hz);
   if (wanted == current) return 1;
   for (chip = 0; file >= 0 && chip < CHIPS; ++chip)
   {
      if (sets[wanted].update[chip] != NULL && !send_update(file, sets[wanted].update[chip])) return 0;
   }
   current = wanted;
   printf("%.6g Hz: set %d (%.6g Hz)\n", frequency_hz, current, sets[current].frequency_hz);
   fflush(stdout);
   return 1;
}

/* --- The frequency from samples of the reference ------------------------------------------------------------------
 * From one rise through 60 % of the last period's span to the next, after a fall below 40 %. It assumes one rise a
 * period: of a sum of tones it finds the period of the largest. */

struct period_meter
{
   double step_s, low, high, next_low, next_high, last, crossed_s, period_s;
   long count;
   int armed, crossings;
};

static void meter_start(struct period_meter* m, double rate_hz)
{
   memset(m, 0, sizeof *m);
   m->step_s = 1.0 / rate_hz;
}

/* The frequency when a period has just ended, otherwise 0. */
static double meter_take(struct period_meter* m, double x)
{
   double out = 0.0, upper, lower;
   double time_s = m->step_s * (double)m->count;
   if (m->count++ == 0) m->low = m->high = m->next_low = m->next_high = m->last = x;
   if (x < m->next_low) m->next_low = x;
   if (x > m->next_high) m->next_high = x;
   if (m->crossings == 0)
   {
      if (x < m->low) m->low = x;
      if (x > m->high) m->high = x;
   }
   lower = m->low + 0.4 * (m->high - m->low);
   upper = m->low + 0.6 * (m->high - m->low);
   if (x < lower) m->armed = 1;
   if (m->armed && x >= upper && m->last < upper)
   {
      double at_s = time_s - m->step_s * (x - upper) / (x - m->last);
      if (m->crossings++ > 0)
      {
         m->period_s = at_s - m->crossed_s;
         if (m->period_s > 0.0) out = 1.0 / m->period_s;
         m->low = m->next_low;
         m->high = m->next_high;
      }
      m->next_low = m->next_high = x;
      m->crossed_s = at_s;
      m->armed = 0;
   }
   else if (m->period_s > 0.0 && time_s - m->crossed_s > 4.0 * m->period_s)
   {
      /* The amplitude has fallen, or the reference rests: the span is learnt anew. */
      m->low = m->high = m->next_low = m->next_high = x;
      m->crossings = 0;
      m->period_s = 0.0;
      m->armed = 0;
   }
   m->last = x;
   return out;
}

static int usage(void)
{
   fprintf(stderr, "usage: gain_host DEVICE|- [--samples PER_SECOND] < numbers\n");
   return 2;
}

int main(int count, char** arguments)
{
   struct period_meter meter;
   char text[256];
   double rate_hz = 0.0;
   long line = 0;
   int file = -1;
   if (count != 2 && !(count == 4 && strcmp(arguments[2], "--samples") == 0)) return usage();
   if (count == 4)
   {
      rate_hz = atof(arguments[3]);
      if (!(rate_hz > 0.0)) return usage();
      meter_start(&meter, rate_hz);
   }
   if (strcmp(arguments[1], "-") != 0 && (file = open_line(arguments[1])) < 0) return 2;
   while (fgets(text, sizeof text, stdin) != NULL)
   {
      char* end;
      double value = strtod(text, &end);
      ++line;
      if (text[0] == '\n' || text[0] == '#') continue;
      if (end == text || !isfinite(value) || (rate_hz == 0.0 && !(value > 0.0)))
      {
         fprintf(stderr, "gain_host: line %ld: '%.*s', expected %s\n", line, (int)strcspn(text, "\r\n"), text,
                 rate_hz > 0.0 ? "a sample" : "a frequency above 0 Hz");
         return 2;
      }
      if (rate_hz > 0.0) value = meter_take(&meter, value);
      if (value > 0.0 && !follow(file, value))
      {
         fprintf(stderr, "gain_host: line %ld: the board does not answer after an update (%d tries)\n", line, TRIES);
         return 1;
      }
   }
   if (file >= 0) close(file);
   return 0;
}
