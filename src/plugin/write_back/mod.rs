//! The last stage of a tick: tells the game what happened.
//!
//! In: contacts, faults, and quantities to be compared with limits. Out: messages, log lines, faults of lost cloths, and
//! colliders on bones that have appeared.

mod bone_colliders;
mod faults;
mod limits;
mod tearing;
mod touch;

pub(crate) use bone_colliders::{make_bone_colliders, remove_bone_colliders};
pub(crate) use faults::{log_faults, report_lost};
pub use limits::ClothLimitExceeded;
pub(crate) use limits::report_limits;
pub use tearing::ClothTorn;
pub(crate) use tearing::{report_tears, tear_cloths};
pub(crate) use touch::{send_stopped_messages, send_touch_messages};
