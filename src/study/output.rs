//! The files that are made of a whole study.

use std::fs;
use std::path::Path;

use super::account::results_md;
use super::figures::figures;
use super::page::page;
use super::setting::Setting;
use super::store::{StoreError, write_whole};
use super::tables::Results;

/// Writes tables, account, figures and page into a folder, the same bytes for the same runs.
///
/// # Errors
/// Files that cannot be written.
pub fn write_results(
    folder: &Path,
    results: &Results<'_>,
    settings: &[Setting],
) -> Result<(), StoreError> {
    fs::create_dir_all(folder).map_err(super::store::io_at(folder))?;
    write_whole(&folder.join("table2.csv"), &results.table_2())?;
    write_whole(&folder.join("table3.csv"), &results.table_3())?;
    let account = results_md(results);
    write_whole(&folder.join("RESULTS.md"), &account)?;
    let figures = figures(results, settings);
    for (name, _, svg) in &figures {
        write_whole(&folder.join(name), svg)?;
    }
    write_whole(&folder.join("study.html"), &page(&account, &figures))?;
    Ok(())
}
