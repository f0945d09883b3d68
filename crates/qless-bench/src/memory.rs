//! Peak memory of this process, as Linux counts it: resident pages, so that it is right to some 100 KiB.

/// Bytes that are resident, once the count of the peak has been set back to them; none where the system does not do that.
pub fn start() -> Option<u64> {
    // 5 sets VmHWM back to VmRSS: see proc_pid_clear_refs(5).
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    status("VmRSS:")
}

/// Bytes at the peak beyond those at the start.
pub fn peak_since(start: Option<u64>) -> Option<u64> {
    Some(status("VmHWM:")?.saturating_sub(start?))
}

fn status(name: &str) -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let kib = text.lines().find_map(|line| line.strip_prefix(name)?.trim().strip_suffix(" kB")?.trim().parse().ok());
    kib.map(|kib: u64| kib << 10)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    #[test]
    fn the_peak_is_what_was_allocated_though_it_is_gone() {
        let Some(start) = super::start() else {
            println!("this system does not set the peak back: nothing was tested");
            return;
        };
        let block = std::hint::black_box(vec![1_u8; 64 << 20]);
        drop(block);
        let peak = super::peak_since(Some(start)).expect("Linux tells it");
        // Tests beside this one allocate too.
        assert!((60 << 20..2 << 30).contains(&peak), "{peak}");
    }
}
