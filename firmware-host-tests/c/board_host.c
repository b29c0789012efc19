/* The board on a host: UARTs are paths of ptys, serial ports or files. */
#define _DEFAULT_SOURCE
#include "board.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

static int ports[2] = {-1, -1};
static int closed;

static uint64_t monotonic_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

/* Opens a path; a terminal becomes raw and keeps what waits in it. */
static int open_port(const char *path, int create) {
    struct termios raw;
    int fd = open(path, O_RDWR | create | O_NOCTTY | O_NONBLOCK | O_CLOEXEC, 0666);
    if (fd < 0) {
        perror(path);
        exit(2);
    }
    if (tcgetattr(fd, &raw) == 0) {
        cfmakeraw(&raw);
        tcsetattr(fd, TCSANOW, &raw);
    }
    return fd;
}

static uint64_t started_us;

void board_start(int argc, char **argv) {
    if (argc < 2 || argc > 3) {
        fprintf(stderr, "usage: %s LINK [TELEMETRY]\n", argc > 0 ? argv[0] : "firmware");
        exit(2);
    }
    started_us = monotonic_us();
    ports[BOARD_LINK] = open_port(argv[1], 0);
    if (argc == 3) ports[BOARD_TELEMETRY] = open_port(argv[2], O_CREAT);
}

uint64_t board_now_us(void) { return monotonic_us() - started_us; }

void board_wait_until(uint64_t t_us) {
    for (;;) {
        uint64_t now = board_now_us();
        struct timespec left;
        if (now >= t_us) return;
        left.tv_sec = (time_t)((t_us - now) / 1000000u);
        left.tv_nsec = (long)((t_us - now) % 1000000u) * 1000;
        nanosleep(&left, NULL);
    }
}

/* Waits until a port can be read or written; returns what it can do. */
static short wait_for(int fd, short events, uint64_t timeout_us) {
    struct pollfd one;
    one.fd = fd;
    one.events = events;
    one.revents = 0;
    return poll(&one, 1, (int)((timeout_us + 999) / 1000)) > 0 ? one.revents : 0;
}

size_t board_read(uint8_t *bytes, size_t most, uint32_t timeout_us) {
    ssize_t n;
    if (closed || !wait_for(ports[BOARD_LINK], POLLIN, timeout_us)) return 0;
    n = read(ports[BOARD_LINK], bytes, most);
    if (n > 0) return (size_t)n;
    closed = n == 0 || (errno != EAGAIN && errno != EINTR);
    return 0;
}

void board_write(enum board_port port, const uint8_t *bytes, size_t n) {
    while (n > 0 && ports[port] >= 0) {
        ssize_t sent = write(ports[port], bytes, n);
        if (sent > 0) {
            bytes += sent;
            n -= (size_t)sent;
        } else if (errno != EINTR && (errno != EAGAIN || !(wait_for(ports[port], POLLOUT, 1000000u) & POLLOUT))) {
            return;
        }
    }
}

void board_baud(uint32_t baud) {
    struct termios settings;
    speed_t speed = baud == 9600 ? B9600 : baud == 115200 ? B115200 : B921600;
    if (tcgetattr(ports[BOARD_LINK], &settings) != 0) return;
    cfsetspeed(&settings, speed);
    tcsetattr(ports[BOARD_LINK], TCSADRAIN, &settings);
}

int board_closed(void) { return closed; }

void board_exit(int code) { exit(code); }
