/* The board under the firmware: two UARTs and a clock. board_mps2.c has them of a Cortex-M4, board_host.c of a host. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* UART0 to the sensors, UART1 to whoever reads the attitude. */
enum board_port { BOARD_LINK, BOARD_TELEMETRY };

/* Takes both UARTs into use. On a host the first argument is the path of the link, the second, if there is one, that of
 * the telemetry; on a Cortex-M there are none. */
void board_start(int argc, char **argv);

/* The board's own clock since its start, us. */
uint64_t board_now_us(void);

/* Sleeps until the clock is there. */
void board_wait_until(uint64_t t_us);

/* Waits for bytes from the link, at most this long; returns how many it took. 0 with `timeout_us` 0 is none there. */
size_t board_read(uint8_t *bytes, size_t most, uint32_t timeout_us);

/* Sends all bytes. What nobody takes for a second is lost. */
void board_write(enum board_port port, const uint8_t *bytes, size_t n);

/* Goes on at another speed on the link, once all is sent. */
void board_baud(uint32_t baud);

/* 1 once the other side of the link is gone, where that can be known. */
int board_closed(void);

/* Ends the firmware where something started it that waits for its end: a host, an emulator. Does not return. */
void board_exit(int code);

#endif
