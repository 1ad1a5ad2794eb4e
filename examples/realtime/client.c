/* A client of `hydrapod serve` in C99 with POSIX sockets alone.
 *
 *     cc -std=c99 -O2 client.c -lm -o client
 *     hydrapod serve machine.toml --once &
 *     ./client 127.0.0.1 4747
 *
 * Moves the platform up and down by 2 mm for two seconds and prints every tenth sample: time [s],
 * demanded and actual displacement in z [mm], length of leg 1 [mm]. The layout of the packets is
 * printed by `hydrapod serve machine.toml --print-layout`.
 */
#define _POSIX_C_SOURCE 200809L
#include <arpa/inet.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

enum { HELLO = 0, POSE = 1, VALVES = 2, LEAVE = 3 };
enum { COMMAND_SIZE = 276, LEAST_SENSORS_SIZE = 540 };

static uint32_t crc32_of(const unsigned char *bytes, size_t size) {
  uint32_t crc = 0xffffffffu;
  for (size_t i = 0; i < size; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1u)));
  }
  return ~crc;
}

static void put(unsigned char *at, uint64_t bits, int size) {
  for (int i = 0; i < size; ++i) at[i] = (unsigned char)(bits >> (8 * i));
}
static uint64_t get(const unsigned char *at, int size) {
  uint64_t bits = 0;
  for (int i = 0; i < size; ++i) bits |= (uint64_t)at[i] << (8 * i);
  return bits;
}
static void put_double(unsigned char *at, double value) {
  uint64_t bits;
  memcpy(&bits, &value, 8);
  put(at, bits, 8);
}
static double get_double(const unsigned char *at) {
  const uint64_t bits = get(at, 8);
  double value;
  memcpy(&value, &bits, 8);
  return value;
}

struct client {
  int socket;
  uint64_t session, sequence;
};
struct sensors {
  int state;
  uint64_t session, sequence, answered;
  double time, length[6], platform[6];
};

static int send_command(struct client *c, int mode, double z, double rate_z) {
  unsigned char packet[COMMAND_SIZE] = {0};
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  put(packet, 0x43445948u, 4); /* "HYDC" */
  put(packet + 4, 1, 2);       /* version */
  packet[6] = (unsigned char)mode;
  put(packet + 8, c->session, 8);
  put(packet + 16, mode == HELLO ? 0 : ++c->sequence, 8);
  put(packet + 24, (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec, 8);
  put_double(packet + 32 + 2 * 8, z);      /* displacement.z */
  put_double(packet + 80 + 2 * 8, rate_z); /* rate.z */
  put(packet + 272, crc32_of(packet, 272), 4);
  return send(c->socket, packet, sizeof packet, 0) == (ssize_t)sizeof packet;
}

/* The next sound packet; 0 where none comes. */
static int receive(struct client *c, struct sensors *s) {
  unsigned char packet[2048];
  for (;;) {
    const ssize_t size = recv(c->socket, packet, sizeof packet, 0);
    if (size < 0) return 0;
    if (size < LEAST_SENSORS_SIZE || get(packet, 4) != 0x53445948u || get(packet + 4, 2) != 1)
      continue;
    if (get(packet + size - 4, 4) != crc32_of(packet, (size_t)size - 4)) continue;
    s->state = packet[6];
    s->session = get(packet + 8, 8);
    s->sequence = get(packet + 16, 8);
    s->time = 1e-9 * (double)get(packet + 24, 8);
    s->answered = get(packet + 32, 8);
    for (int i = 0; i < 6; ++i) {
      s->length[i] = get_double(packet + 96 + 8 * i);
      s->platform[i] = get_double(packet + 384 + 8 * i);
    }
    return 1;
  }
}

static int connect_to(struct client *c, const char *host, int port) {
  struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
  const struct timeval patience = {0, 200000};
  const struct timespec pause = {0, 200000000};
  struct sensors hello;
  memset(c, 0, sizeof *c);
  c->socket = socket(AF_INET, SOCK_DGRAM, 0);
  if (c->socket < 0 || inet_pton(AF_INET, host, &address.sin_addr) != 1) return 0;
  setsockopt(c->socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  if (connect(c->socket, (const struct sockaddr *)&address, sizeof address) != 0) return 0;
  for (int attempt = 0; attempt < 25; ++attempt) { /* the server may still be starting */
    if (send_command(c, HELLO, 0.0, 0.0) && receive(c, &hello)) {
      c->session = hello.session;
      c->sequence = hello.answered;
      return 1;
    }
    nanosleep(&pause, NULL);
  }
  return 0;
}

int main(int argc, char **argv) {
  const double omega = 3.14159265358979323846, size = 0.001;
  struct client c;
  struct sensors s;
  double start = -1.0;
  if (argc != 3) {
    fprintf(stderr, "usage: %s ADDRESS PORT\n", argv[0]);
    return 2;
  }
  if (!connect_to(&c, argv[1], atoi(argv[2]))) {
    fprintf(stderr, "no answer\n");
    return 1;
  }
  send_command(&c, POSE, 0.0, 0.0);
  puts("time,demand_mm,platform_mm,leg1_mm");
  while (receive(&c, &s)) {
    if (start < 0.0) start = s.time;
    const double t = s.time - start, z = size * (1.0 - cos(omega * t));
    if (s.sequence % 10 == 0)
      printf("%.3f,%.4f,%.4f,%.4f\n", t, 1e3 * z, 1e3 * s.platform[2], 1e3 * s.length[0]);
    if (t >= 2.0) {
      send_command(&c, LEAVE, 0.0, 0.0);
      close(c.socket);
      return 0;
    }
    send_command(&c, POSE, z, size * omega * sin(omega * t));
  }
  fprintf(stderr, "the server is silent\n");
  return 1;
}
