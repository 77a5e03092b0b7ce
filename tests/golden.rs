//! The same bytes out for the same input, with any number of threads.

use crate::support::{joined, plan_answer, source, tiles, window};
use weavelock::locking::check;
use weavelock::report::answer;

fn written(text: &str) -> String {
    let joined = joined(text);
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let checked = answer::check(&joined, &check(asm, patches, None), source("test.toml", text));
    let planned = plan_answer(&joined, source("test.toml", text));
    let json = |e: serde_json::Result<String>| e.expect("JSON");
    json(serde_json::to_string(&checked)) + &json(serde_json::to_string(&planned))
}

fn with_threads(count: usize, text: &str) -> String {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
    pool.install(|| written(text))
}

#[test]
fn one_thread_and_many_write_the_same() {
    let texts = [window([1, 1, 1], 6, 2, 2), tiles([1, 1, 1], 6, 2, 1, 0), tiles([2, 2, 1], 6, 4, 1, 1)];
    for text in texts {
        let one = with_threads(1, &text);
        for count in [2, 5] {
            assert!(one == with_threads(count, &text), "{count} threads write something else for\n{text}");
        }
        assert!(one == with_threads(1, &text), "a second run writes something else for\n{text}");
    }
}
