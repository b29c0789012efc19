/* From reset to main(): the vector table, the FPU, and what C expects of its memory. */
#include <stdint.h>

extern uint32_t stack_top[], data_load[], data_start[], data_end[], bss_start[], bss_end[];
int main(int argc, char **argv);
void board_exit(int code);
void uart0_rx_handler(void);
void systick_handler(void);

void reset_handler(void);
void fault_handler(void);

void reset_handler(void) {
    volatile uint32_t *access = (volatile uint32_t *)0xE000ED88u; /* CPACR */
    uint32_t *to = data_start;
    const uint32_t *from = data_load;
    *access |= 0xFu << 20; /* CP10 and CP11: the FPU */
    __asm volatile("dsb\n isb");
    while (to < data_end) *to++ = *from++;
    for (to = bss_start; to < bss_end;) *to++ = 0;
    board_exit(main(0, 0));
}

void fault_handler(void) {
    for (;;) {}
}

typedef void (*handler)(void);

struct vectors {
    uint32_t *stack;
    handler system[15];
    handler interrupt[1];
};

__attribute__((section(".vectors"), used)) static const struct vectors vectors = {
    stack_top,
    {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, 0, 0, 0, 0, fault_handler,
     fault_handler, 0, fault_handler, systick_handler},
    {uart0_rx_handler},
};
