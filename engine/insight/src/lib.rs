//! What a run leaves, and what can be seen in it.
//!
//! | module | what |
//! |---|---|
//! | [`store`] | `run.toml`, `policy.toml` and `log.bin`, written and read |
//! | [`lint`] | mistakes in a behaviour, and ways to cheat its reward, found before it is learned |
//! | [`disk`] | files and folders that are whole or absent, their locks, their reader |
//! | [`report`] | pictures, CSV |
//! | [`page`] | a run as one document of data, and the HTML that shows it |
//! | [`folder`] | a run's folder, written |
//! | [`compare`] | runs beside one another |
//! | [`shell`] | pages that are whole in one file and run no script |
//! | [`shelf`] | the runs that stand under a folder |
//! | [`record`] | a run as an MCAP file for Foxglove and Rerun |
//! | [`words`] | numbers as people read them |

pub mod compare;
pub mod disk;
pub mod folder;
pub mod lint;
mod markup;
pub mod page;
pub mod record;
pub mod report;
pub mod shelf;
pub mod shell;
pub mod store;
pub mod verdict_words;
pub mod words;
