//! A short busy wait in front of a blocking one.
//!
//! A thread that sleeps until bytes arrive is woken on an idle core, which takes longer than most answers do. A busy wait that
//! was in vain makes the next ones rarer: with a slow far end, or without a free core, they cost next to nothing.

use std::thread;

/// Attempts in a busy wait. Each is a system call or two, so all together take some 50 us.
const ATTEMPTS: u32 = 100;
fn env(name: &str, default: u32) -> u32 {
    std::env::var(name).ok().and_then(|t| t.parse().ok()).unwrap_or(default)
}
static N: std::sync::LazyLock<u32> = std::sync::LazyLock::new(|| env("SPIN", ATTEMPTS));
static Y: std::sync::LazyLock<u32> = std::sync::LazyLock::new(|| env("YIELD", 1));
static NT: std::sync::LazyLock<u32> = std::sync::LazyLock::new(|| env("SPIN_TWIN", 0));
/// x
pub fn twin() -> bool {
    *NT > 0
}
/// Most waits without a busy one after one that was in vain.
const LONGEST_PAUSE: u32 = 1023;

/// Decides which waits begin with a busy one.
#[derive(Debug, Default)]
pub struct Spin {
    /// Waits without a busy one after the last that was in vain.
    pause: u32,
    /// How many of them are to come.
    left: u32,
}

impl Spin {
    /// The first result of `attempt`, which is repeated for a short time; `None` if the wait is to block.
    pub fn until<T>(&mut self, mut attempt: impl FnMut() -> Option<T>) -> Option<T> {
        if self.left > 0 {
            self.left -= 1;
            return None;
        }
        for _ in 0..*N {
            if let Some(found) = attempt() {
                self.pause = 0;
                return Some(found);
            }
            // The far end may need this core.
            if *Y > 0 {
                thread::yield_now();
            }
        }
        self.pause = (2 * self.pause + 1).min(LONGEST_PAUSE);
        self.left = self.pause;
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Attempts of each of `waits` waits, if nothing ever arrives.
    fn attempts_in_vain(spin: &mut Spin, waits: usize) -> Vec<u32> {
        let mut attempts = vec![0; waits];
        for count in &mut attempts {
            assert_eq!(
                spin.until(|| -> Option<()> {
                    *count += 1;
                    None
                }),
                None
            );
        }
        attempts
    }

    #[test]
    fn busy_waits_in_vain_become_rare() {
        let attempts = attempts_in_vain(&mut Spin::default(), 8);
        assert_eq!(attempts, [ATTEMPTS, 0, ATTEMPTS, 0, 0, 0, ATTEMPTS, 0]);
        let many = attempts_in_vain(&mut Spin::default(), 100_000);
        assert!(many.iter().filter(|count| **count > 0).count() < 110);
    }

    #[test]
    fn a_busy_wait_that_finds_something_ends_and_is_followed_by_others() {
        let mut spin = Spin::default();
        attempts_in_vain(&mut spin, 4);
        attempts_in_vain(&mut spin, 2);
        let mut answers = [None, None, Some(7), Some(8)].into_iter();
        assert_eq!(spin.until(|| answers.next()?), Some(7));
        assert_eq!(spin.until(|| answers.next()?), Some(8));
    }
}
