//! Takes what the table is to hold and a folder; gives a row for every genus-1 weave up to it that hangs together.
//!
//! Promised: the files at the end are the same with any number of threads, stops and shards. Not promised: what the
//! stages that are asked do not promise (`repeats`, `flex`, `chirality`).

mod export;
mod journal;
mod merge;
mod picture;
mod release;
mod row;
mod run;
mod table;
mod weaves;

pub use export::{Files, Final, told};
pub use journal::Head;
pub use merge::merge;
pub use picture::sheet;
pub use row::{AtPhase, Flexible, Release, Repeated, Row, Status, row};
pub use run::{Progress, Written, write};
pub use table::{Ask, FLEX_UP_TO, MOST, Phases, RELEASE_UP_TO, Settings, Shard, cost, share};
pub use weaves::{Abc, By, Equivalent, Which, equivalents, weaves};
