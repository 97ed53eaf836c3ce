//! Independent jobs on all threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Takes the result of a job and its wall time in seconds; returns false to stop.
pub(super) type Done<'a, R> = &'a (dyn Fn(R, f64) -> bool + Sync);

/// Runs jobs, each on one thread, on as many threads as rayon would use. Jobs start in the
/// order given and end in any order; no job starts after `done` has returned false.
pub(super) fn run_all<J: Sync, R: Send>(
    jobs: &[J],
    make: &(dyn Fn(&J) -> R + Sync),
    done: Done<'_, R>,
) {
    let next = AtomicUsize::new(0);
    let work = || {
        // The evaluations of one run stay on its thread.
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else {
            return;
        };
        while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
            #[expect(
                clippy::disallowed_methods,
                reason = "wall times are recorded, they decide nothing"
            )]
            let started = Instant::now();
            let made = pool.install(|| make(job));
            if !done(made, started.elapsed().as_secs_f64()) {
                next.store(jobs.len(), Ordering::Relaxed);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..rayon::current_num_threads() {
            scope.spawn(work);
        }
    });
}
