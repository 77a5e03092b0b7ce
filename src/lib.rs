//! Decides whether an assembly of solid parts locks, proves it, plans how it goes together, makes its parts.
//!
//! The flow, one way:
//!
//! ```text
//! weave -> profile -> sites -> tile -> assembly -> contact -> { blocking, locking, cores, sequence, sampling, repeats, flex, chirality } -> fab -> report
//! ```

pub mod assembly;
pub mod atlas;
pub mod blocking;
pub mod chirality;
pub mod cli;
pub mod contact;
pub mod cores;
pub mod fabricate;
pub mod fault;
pub mod flex;
pub mod input;
pub mod interlock;
pub mod locking;
pub mod made;
pub mod play;
pub mod profile;
pub mod release;
pub mod repeats;
pub mod report;
pub mod sampling;
pub mod sequence;
pub mod sites;
pub mod solid;
pub mod spec;
pub mod tile;
pub mod verify;
pub mod watch;
pub mod weave;
