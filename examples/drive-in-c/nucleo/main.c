/* The drive on a NUCLEO-F446RE, with registers alone: the ST-Link's serial port is USART2 on PA2 and PA3, the clock is TIM2.
 * Numbers of sections are those of ST's reference manual RM0390. */

#include <stddef.h>
#include <stdint.h>

#include "drive.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))

/* Flash interface, section 3.8. */
#define FLASH_ACR REGISTER(0x40023C00)
/* Clocks, section 6.3. */
#define RCC_CR REGISTER(0x40023800)
#define RCC_PLLCFGR REGISTER(0x40023804)
#define RCC_CFGR REGISTER(0x40023808)
#define RCC_AHB1ENR REGISTER(0x40023830)
#define RCC_APB1ENR REGISTER(0x40023840)
/* Port A, section 7.4. */
#define GPIOA_MODER REGISTER(0x40020000)
#define GPIOA_PUPDR REGISTER(0x4002000C)
#define GPIOA_AFRL REGISTER(0x40020020)
/* Timer, section 17.4. */
#define TIM2_CR1 REGISTER(0x40000000)
#define TIM2_EGR REGISTER(0x40000014)
#define TIM2_CNT REGISTER(0x40000024)
#define TIM2_PSC REGISTER(0x40000028)
#define TIM2_ARR REGISTER(0x4000002C)
/* Serial port, section 25.6. */
#define USART2_SR REGISTER(0x40004400)
#define USART2_DR REGISTER(0x40004404)
#define USART2_BRR REGISTER(0x40004408)
#define USART2_CR1 REGISTER(0x4000440C)
/* Interrupts 32 to 63 of the core; USART2 is number 38. */
#define NVIC_ISER1 REGISTER(0xE000E104)

#define PERIPHERAL_HZ 24000000u /* APB1 */
#define TIMER_HZ 48000000u      /* twice APB1, because APB1 is divided */
#define BAUD 921600u            /* what the bench takes without --baud */

enum { OVERRUN = 1 << 3 };                                      /* of SR */
enum { RXNE = 1 << 5, TXE = 1 << 7 };                           /* of SR, and as interrupts of CR1 */
enum { RECEIVE = 1 << 2, TRANSMIT = 1 << 3, ENABLE = 1 << 13 }; /* of CR1 */

/* 96 MHz from the 8 MHz that the ST-Link feeds into the crystal's input. The timer of the clock must not drift from the
 * bench's, and the internal oscillator is off by up to 1 %. */
static void start_clocks(void)
{
    RCC_CR |= 1u << 16 | 1u << 18; /* external, bypassed */
    while (!(RCC_CR & 1u << 17))
        ;
    RCC_PLLCFGR = 8u | 192u << 6 | 0u << 16 | 1u << 22 | 4u << 24 | 2u << 28; /* 8 MHz / 8 * 192 / 2; R unused, 2 at least */
    RCC_CR |= 1u << 24;
    while (!(RCC_CR & 1u << 25))
        ;
    FLASH_ACR = 3u | 1u << 8 | 1u << 9 | 1u << 10; /* 3 wait states, for up to 120 MHz; prefetch and caches */
    RCC_CFGR = 2u | 5u << 10 | 4u << 13;           /* PLL; APB1 a fourth, APB2 a half */
    while ((RCC_CFGR >> 2 & 3u) != 2u)
        ;
    RCC_AHB1ENR |= 1u << 0;             /* port A */
    RCC_APB1ENR |= 1u << 0 | 1u << 17;  /* TIM2, USART2 */
    (void)RCC_APB1ENR;                  /* a clock takes two cycles to start, section 6.2.14 */
}

static void start_timer(void)
{
    TIM2_PSC = TIMER_HZ / 1000000u - 1; /* microseconds */
    TIM2_ARR = 0xFFFFFFFFu;
    TIM2_EGR = 1; /* takes the prescaler */
    TIM2_CR1 = 1;
}

static void start_line(void)
{
    GPIOA_MODER = (GPIOA_MODER & ~(0xFu << 4)) | 0xAu << 4;   /* PA2, PA3: alternate function */
    GPIOA_AFRL = (GPIOA_AFRL & ~(0xFFu << 8)) | 0x77u << 8;   /* number 7 */
    GPIOA_PUPDR = (GPIOA_PUPDR & ~(3u << 6)) | 1u << 6;       /* PA3 pulled up: a cable that is pulled out is idle */
    USART2_BRR = (PERIPHERAL_HZ + BAUD / 2) / BAUD;
    USART2_CR1 = ENABLE | RECEIVE | TRANSMIT | RXNE;
    NVIC_ISER1 = 1u << (38 - 32);
}

/* Bytes between the interrupt and the main loop: one side writes `head`, the other `tail`, each after its access to the bytes. */
#define ORDERED() __asm__ volatile("" ::: "memory")
#define RING_LEN 1024u /* a power of two; in Idle a drive takes 17 requests or 320 bytes in one write */

struct ring {
    uint8_t bytes[RING_LEN];
    volatile uint32_t head, tail; /* only ever rise */
};

static struct ring received, to_send;

static int push(struct ring *ring, uint8_t byte)
{
    if (ring->head - ring->tail == RING_LEN)
        return 0;
    ring->bytes[ring->head % RING_LEN] = byte;
    ORDERED();
    ring->head = ring->head + 1;
    return 1;
}

static int pop(struct ring *ring, uint8_t *byte)
{
    if (ring->head == ring->tail)
        return 0;
    *byte = ring->bytes[ring->tail % RING_LEN];
    ORDERED();
    ring->tail = ring->tail + 1;
    return 1;
}

void usart2_interrupt(void)
{
    uint8_t byte;
    uint32_t status = USART2_SR;
    if (status & (RXNE | OVERRUN)) { /* either interrupts until this read */
        byte = (uint8_t)USART2_DR;
        if (status & RXNE)
            (void)push(&received, byte); /* a byte that is lost damages a frame, which its CRC shows */
    }
    if (USART2_CR1 & TXE && status & TXE) {
        if (pop(&to_send, &byte))
            USART2_DR = byte;
        else
            USART2_CR1 &= ~(uint32_t)TXE;
    }
}

static void send_frame(const uint8_t *bytes, size_t len)
{
    for (size_t i = 0; i < len; i++)
        while (!push(&to_send, bytes[i]))
            ; /* the interrupt makes room */
    /* The interrupt changes CR1 too. */
    __asm__ volatile("cpsid i" ::: "memory");
    USART2_CR1 |= TXE;
    __asm__ volatile("cpsie i" ::: "memory");
}

/* The timer has 32 bits, 72 minutes. The main loop calls this far more often. */
static uint64_t now_ns(void)
{
    static uint32_t last, turns;
    uint32_t now = TIM2_CNT;
    if (now < last)
        turns++;
    last = now;
    return ((uint64_t)turns << 32 | now) * 1000u;
}

static void set_torque(float torque_nm)
{
    (void)torque_nm; /* here goes the power stage; 0 means off */
}

void power_stage_off(void)
{
    set_torque(0);
}

int main(void)
{
    static const struct board BOARD = { now_ns, send_frame, set_torque };
    static struct drive drive;
    uint8_t byte;
    start_clocks();
    start_timer();
    start_line();
    drive_init(&drive, &BOARD);
    for (;;) {
        if (pop(&received, &byte))
            drive_receive(&drive, byte);
        drive_tick(&drive); /* after each byte: a host that never pauses must not keep the watchdog waiting */
    }
}
