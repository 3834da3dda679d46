//! Runs that are ended from outside.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How often a waiting run looks whether it has to end.
const TICK: Duration = Duration::from_millis(50);

/// Runs in a thread of its own, so that a panic is a failed run, and ends it after `cap` seconds or when `interrupted`
/// is raised; says whether the cap ended it.
pub fn watched<T: Send>(
    run: impl FnOnce(&AtomicBool) -> Result<T, String> + Send,
    cap: f64,
    interrupted: &AtomicBool,
) -> (Result<T, String>, bool) {
    let (stop, begin) = (AtomicBool::new(false), Instant::now());
    let (done, waiting) = channel::<()>();
    let mut capped = false;
    let result = std::thread::scope(|scope| {
        let stop = &stop;
        let worker = scope.spawn(move || {
            let _ended = done;
            run(stop)
        });
        while waiting.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
            capped = begin.elapsed().as_secs_f64() > cap;
            if capped || interrupted.load(Ordering::Relaxed) {
                stop.store(true, Ordering::Relaxed);
                break;
            }
        }
        worker.join().unwrap_or_else(|_| Err("the fluid panicked".to_string()))
    });
    (result, capped)
}
