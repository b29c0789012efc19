/* The board of Arm's MPS2 with the Cortex-M4 image AN386, as QEMU has it (`-M mps2-an386`): CMSDK UARTs and timer.
 *
 * Registers: Cortex-M System Design Kit, Technical Reference Manual (DDI 0479), APB timer and APB UART; addresses and
 * interrupts: Application Note AN386. */
#include "board.h"

struct uart {
    volatile uint32_t data, state, ctrl, intclear, bauddiv;
};
struct timer {
    volatile uint32_t ctrl, value, reload, intclear;
};

#define TIMER0 ((struct timer *)0x40000000u)
#define UART0 ((struct uart *)0x40004000u)
#define UART1 ((struct uart *)0x40005000u)
#define SYSTICK ((volatile uint32_t *)0xE000E010u)
#define NVIC_ENABLE (*(volatile uint32_t *)0xE000E100u)

enum { STATE_TX_FULL = 1, STATE_RX_FULL = 2 };
enum { CTRL_TX = 1, CTRL_RX = 2, CTRL_RX_INTERRUPT = 8 };
enum { INT_RX = 2 };
enum { UART0_RX_IRQ = 0, TICKS_PER_US = 25 };

/* What has come from the link and was not read. */
static uint8_t ring[4096];
static volatile uint32_t head, tail;

static uint32_t counter;
static uint64_t ticks;

static void disable_interrupts(void) { __asm volatile("cpsid i" ::: "memory"); }
static void enable_interrupts(void) { __asm volatile("cpsie i" ::: "memory"); }

/* Takes what the UART holds. With a full ring it leaves it there: an emulated link then waits, a real one overruns. */
static void receive(void) {
    while (UART0->state & STATE_RX_FULL) {
        if (head - tail == sizeof ring) {
            UART0->ctrl = CTRL_TX | CTRL_RX;
            return;
        }
        UART0->intclear = INT_RX;
        ring[head++ % sizeof ring] = (uint8_t)UART0->data;
    }
}

void uart0_rx_handler(void) {
    UART0->intclear = INT_RX;
    receive();
}

/* Only wakes whoever waits. */
void systick_handler(void) {}

void board_start(int argc, char **argv) {
    (void)argc;
    (void)argv;
    TIMER0->reload = 0xFFFFFFFFu;
    TIMER0->value = 0xFFFFFFFFu;
    TIMER0->ctrl = 1;
    counter = TIMER0->value;
    SYSTICK[1] = TICKS_PER_US * 1000 - 1;
    SYSTICK[2] = 0;
    SYSTICK[0] = 7; /* the processor's clock, interrupt, on */
    UART0->bauddiv = 25000000u / 921600u;
    UART1->bauddiv = 25000000u / 921600u;
    UART1->ctrl = CTRL_TX;
    UART0->ctrl = CTRL_TX | CTRL_RX | CTRL_RX_INTERRUPT;
    NVIC_ENABLE = 1u << UART0_RX_IRQ;
}

/* The timer counts down from 2^32, 171 s at 25 MHz: called more often than that, nothing of it is missed. */
uint64_t board_now_us(void) {
    uint32_t now = TIMER0->value;
    ticks += counter - now;
    counter = now;
    return ticks / TICKS_PER_US;
}

/* The SysTick or the link ends a sleep, so that this is up to 1 ms late. A processor that waited awake would, emulated,
 * take the time of the emulator that has to bring it the bytes of a UART. */
void board_wait_until(uint64_t t_us) {
    while (board_now_us() < t_us) __asm volatile("wfi");
}

/* Sleeps until the next interrupt, at most a ms, unless bytes are there. An interrupt between the look and the sleep
 * ends the sleep: it is pending. */
static void sleep_if_empty(void) {
    disable_interrupts();
    if (head == tail) __asm volatile("wfi");
    enable_interrupts();
}

size_t board_read(uint8_t *bytes, size_t most, uint32_t timeout_us) {
    uint64_t until = board_now_us() + timeout_us;
    size_t n = 0;
    while (head == tail && board_now_us() < until) sleep_if_empty();
    while (n < most && tail != head) bytes[n++] = ring[tail++ % sizeof ring];
    if (n > 0) {
        disable_interrupts();
        UART0->ctrl = CTRL_TX | CTRL_RX | CTRL_RX_INTERRUPT;
        receive();
        enable_interrupts();
    }
    return n;
}

/* Nobody takes anything from this port: what follows is lost at once. */
static uint8_t is_stuck[2];

void board_write(enum board_port port, const uint8_t *bytes, size_t n) {
    struct uart *uart = port == BOARD_LINK ? UART0 : UART1;
    uint64_t until = board_now_us() + 1000000u;
    while (n--) {
        while (uart->state & STATE_TX_FULL) {
            if (is_stuck[port] || board_now_us() > until) {
                is_stuck[port] = 1;
                return;
            }
        }
        is_stuck[port] = 0;
        uart->data = *bytes++;
    }
}

void board_baud(uint32_t baud) {
    while (UART0->state & STATE_TX_FULL && !is_stuck[BOARD_LINK]) {}
    UART0->bauddiv = 25000000u / baud;
}

int board_closed(void) { return 0; }

/* Semihosting, SYS_EXIT_EXTENDED with ADP_Stopped_ApplicationExit: QEMU ends with this code. */
void board_exit(int code) {
    uint32_t block[2];
    block[0] = 0x20026u;
    block[1] = (uint32_t)code;
    register uint32_t operation __asm("r0") = 0x20u;
    register uint32_t *parameters __asm("r1") = block;
    __asm volatile("bkpt 0xAB" : : "r"(operation), "r"(parameters) : "memory");
    for (;;) {}
}
