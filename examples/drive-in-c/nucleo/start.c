/* From reset to main, and the table of vectors. */

#include <stdint.h>

extern uint32_t data_start[], data_end[], data_stored[], zero_start[], zero_end[], stack_top[];

int main(void);
void usart2_interrupt(void);
void power_stage_off(void);

/* Coprocessor access, ARMv7-M manual, section B3.2.20. */
#define CPACR (*(volatile uint32_t *)0xE000ED88)

void reset(void);

void reset(void)
{
    CPACR |= 0xFu << 20; /* the floating-point unit, before the first function that uses it */
    __asm__ volatile("dsb\n\tisb" ::: "memory");
    for (uint32_t *to = data_start, *from = data_stored; to < data_end;)
        *to++ = *from++;
    for (uint32_t *to = zero_start; to < zero_end;)
        *to++ = 0;
    main();
}

/* Any fault, and any interrupt that nobody asked for. */
static void halt(void)
{
    power_stage_off();
    for (;;)
        ;
}

typedef void (*handler)(void);

/* 16 of the core, then those of the chip up to USART2, number 38. */
__attribute__((section(".vectors"), used)) static const handler VECTORS[16 + 39] = {
    (handler)(uintptr_t)stack_top,
    reset,
    [2 ... 16 + 37] = halt,
    [16 + 38] = usart2_interrupt,
};
