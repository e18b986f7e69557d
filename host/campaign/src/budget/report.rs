//! The budget as text, with advice.

use std::fmt;
use std::time::Duration;

use super::wire_time::{Budget, Cycle, SAMPLE, TELEMETRY, TORQUE, USUAL_BAUD};

fn us(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

impl fmt::Display for Budget {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Budget { baud, period, telemetry_every, signals } = *self;
        let hz = 1.0 / period.as_secs_f64();
        write!(out, "{baud} Bd, period {} us ({hz:.0} Hz), ", us(period))?;
        match self.telemetry_len() {
            0 => writeln!(out, "no telemetry")?,
            _ => writeln!(out, "telemetry of {signals} signals after one torque in {telemetry_every}")?,
        }
        self.frames(out)?;
        self.answers(out)?;
        self.speeds(out)?;
        self.advice(out)
    }
}

impl Budget {
    fn frames(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "\n{:<28}{:>8}{:>12}{:>12}", "on the wire", "bytes", "us", "of period")?;
        let mut line = |name: String, bytes: f64| {
            let time_us = bytes * 1e7 / f64::from(self.baud);
            let share = 100.0 * time_us / us(self.period);
            writeln!(out, "{name:<28}{bytes:>8.1}{time_us:>12.1}{share:>10.1} %")
        };
        line(format!("out   {}", SAMPLE.name), SAMPLE.frame_len() as f64)?;
        line(format!("back  {}", TORQUE.name), TORQUE.frame_len() as f64)?;
        let telemetry = self.telemetry_len();
        if telemetry > 0 {
            line(format!("back  {}", TELEMETRY.name), telemetry as f64)?;
            line("      of it, each signal".to_owned(), TELEMETRY.element_len.unwrap_or(0) as f64)?;
            line("back  a cycle, mean".to_owned(), self.bytes_back(Cycle::Mean))?;
            line("back  a cycle, worst".to_owned(), self.bytes_back(Cycle::Worst))?;
        }
        let sample = SAMPLE.frame_len() as f64;
        line("both  a cycle, mean".to_owned(), sample + self.bytes_back(Cycle::Mean))?;
        line("both  a cycle, worst".to_owned(), sample + self.bytes_back(Cycle::Worst))
    }

    fn answers(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "\n{:<28}{:>8}{:>12}{:>12}", "sample to torque", "us", "of period", "left, us")?;
        for (name, cycle) in [("mean", Cycle::Mean), ("worst, behind telemetry", Cycle::Worst)] {
            let answer = self.answer(cycle);
            let share = 100.0 * answer.as_secs_f64() / self.period.as_secs_f64();
            let left = us(self.deadline()) - us(answer);
            writeln!(out, "{name:<28}{:>8.1}{share:>10.1} %{left:>12.1}", us(answer))?;
        }
        let deadline = us(self.deadline());
        writeln!(
            out,
            "What is left of {deadline} us is for adapters, drivers, the drive and the bench; the last {} us of a",
            us(self.period) - deadline
        )?;
        writeln!(out, "period belong to the loop. Directions do not wait for each other.")
    }

    fn speeds(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut speeds: Vec<_> = USUAL_BAUD.into_iter().chain([self.baud]).collect();
        speeds.sort_unstable();
        speeds.dedup();
        writeln!(
            out,
            "\n{:>10}{:>14}{:>14}{:>14}{:>14}  period",
            "Bd", "mean, us", "worst, us", "mean, Hz", "worst, Hz"
        )?;
        for baud in speeds {
            let budget = Budget { baud, ..*self };
            let [mean_us, worst_us] = [Cycle::Mean, Cycle::Worst].map(|cycle| us(budget.answer(cycle)));
            let [mean_hz, worst_hz] = [Cycle::Mean, Cycle::Worst].map(|cycle| budget.highest_rate_hz(cycle));
            let holds = if budget.holds(Cycle::Worst) { "holds" } else { "too short" };
            writeln!(
                out,
                "{baud:>10}{mean_us:>14.1}{worst_us:>14.1}{mean_hz:>14.0}{worst_hz:>14.0}  {holds}"
            )?;
        }
        Ok(())
    }

    fn advice(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let worst = self.answer(Cycle::Worst);
        let share = |part: Duration| 100.0 * part.as_secs_f64() / worst.as_secs_f64();
        let (sample, torque) = (self.frame(SAMPLE), self.frame(TORQUE));
        let (sample, torque, wait) = (share(sample), share(torque), share(worst - sample - torque));
        writeln!(
            out,
            "\nOf the worst answer {sample:.0} % goes to the sample, {torque:.0} % to the torque, {wait:.0} % to waiting for telemetry."
        )?;
        if self.holds(Cycle::Worst) {
            return write!(out, "The period holds the worst cycle.");
        }
        write!(out, "The period does NOT hold the worst cycle. What would, each by itself:")?;
        let faster = USUAL_BAUD.into_iter().find(|&baud| Budget { baud, ..*self }.holds(Cycle::Worst));
        match faster {
            Some(baud) => write!(out, "\n  a line of {baud} Bd")?,
            None => write!(out, "\n  no usual speed of a line")?,
        }
        let period_us = self.shortest_period(Cycle::Worst).as_micros();
        write!(out, "\n  a period of {period_us} us (run.control_period_us)")?;
        if (Budget { telemetry_every: 0, ..*self }).holds(Cycle::Worst) {
            write!(out, "\n  no telemetry (telemetry.every_steps = 0)")?;
        }
        let fewer = (1..self.signals).rev().find(|&signals| Budget { signals, ..*self }.holds(Cycle::Worst));
        if let Some(signals) = fewer {
            write!(out, "\n  at most {signals} signals (telemetry.signals)")?;
        }
        Ok(())
    }
}
