//! Processor time and memory of this process, on Linux.

use std::fs;

/// Ticks of a second in `/proc`, on every architecture of Linux.
const TICKS: f64 = 100.0;

/// Processor time of all threads, seconds.
pub(super) fn cpu_s() -> Option<f64> {
    cpu_of(&fs::read_to_string("/proc/self/stat").ok()?)
}

/// User and system time of a line of `/proc/PID/stat`: fields 14 and 15. Field 2 is the
/// name of the program in brackets, which may hold any character.
fn cpu_of(stat: &str) -> Option<f64> {
    let (_, rest) = stat.rsplit_once(')')?;
    let mut fields = rest.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / TICKS)
}

/// Peak memory, MiB.
pub(super) fn peak_memory_mib() -> Option<f64> {
    memory_of(&fs::read_to_string("/proc/self/status").ok()?)
}

fn memory_of(status: &str) -> Option<f64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::{cpu_of, memory_of};

    #[test]
    fn times_and_memory_are_read_from_what_linux_writes() {
        let stat = "7 (a) b) R 1 7 7 0 -1 4 90 0 0 0 1234 66 0 0 20 0 3 0 100 0 0";
        assert_eq!(cpu_of(stat), Some(13.0));
        assert_eq!(cpu_of("7 (a"), None);
        let status = "Name:\tsortie\nVmPeak:\t  9000 kB\nVmHWM:\t    2048 kB\n";
        assert_eq!(memory_of(status), Some(2.0));
        assert_eq!(memory_of("VmHWM: much"), None);
    }
}
