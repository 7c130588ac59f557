use std::hint::black_box;
use std::time::Instant;

/// Wall-clock time per item, in nanoseconds, in the fastest of `repeats` calls of `work`: other load on the machine
/// only adds time. One call processes `count` items.
pub fn nanoseconds<R>(repeats: usize, count: usize, mut work: impl FnMut() -> R) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..repeats.max(1) {
        let start = Instant::now();
        black_box(work());
        best = best.min(start.elapsed().as_secs_f64());
    }
    best * 1e9 / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_called_once_per_repeat() {
        let mut calls = 0;
        let time = nanoseconds(3, 10, || calls += 1);
        assert_eq!(calls, 3);
        assert!(time.is_finite() && time >= 0.0);
    }
}
