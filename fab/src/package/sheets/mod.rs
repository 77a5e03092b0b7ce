//! Takes a package's answer; gives its sheets in Markdown, in the order of the work.
//!
//! Every number on them stands in the package's JSON too. Not promised: prose for every material; the schedule is that of
//! the process file, line by line.

mod cast;
mod checked;
mod ledger;
mod molds;
mod print;
mod start;
mod table;

use super::{Attachment, PackageReport, folder::Folder};
use crate::files::FileError;

/// Writes all sheets.
pub fn write(package: &PackageReport, folder: &Folder) -> Result<(), FileError> {
    let sheets = [
        ("README.md", Some(start::sheet(package))),
        ("1-coupon.md", Some(ledger::coupon(package))),
        ("2-print.md", print::sheet(package)),
        ("3-molds.md", molds::sheet(package)),
        ("4-cast.md", cast::sheet(package)),
        ("5-pour.md", cast::pour(package)),
        ("bill-of-materials.md", Some(start::bill(package))),
        ("ledger.md", Some(ledger::sheet(package))),
        ("checked.md", Some(checked::sheet(package))),
    ];
    for (name, text) in sheets {
        if let Some(text) = text {
            let file = Attachment { name: name.to_string(), bytes: text.into_bytes() };
            folder.write(&file.name, &file.bytes)?;
        }
    }
    Ok(())
}
