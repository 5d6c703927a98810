//! Signals that a disk, or a person, can send.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Makes a file-size limit an error instead of the end of the process.
///
/// Writing past `ulimit -f` raises SIGXFSZ, which kills a process before it can take its unfinished file away
/// or say a word. With a handler in place the write fails instead, like on a full disk.
pub fn survive_full_disks() {
    #[cfg(unix)]
    {
        let seen = Arc::new(AtomicBool::new(false));
        // Without the handler all still works but for that one limit: not worth refusing to start over.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, seen);
    }
}
