//! Takes nothing; gives the JSON Schema of the files in and of every answer.
//!
//! Not promised: that a file which fits the schema is free of faults; bounds that depend on other keys are not in it.

use super::atlas::AtlasAnswer;
use super::draw::DrawAnswer;
use super::exported::ExportAnswer;
use super::run::{ReportAnswer, RunAnswer};
use super::told::{News, Told, Trouble};
use crate::chirality::answer::Hands;
use crate::report::answer::fab::{FabAnswer, ProcessesAnswer};
use crate::report::answer::{
    BlockingAnswer, CheckAnswer, FlexAnswer, PlanAnswer, PlayAnswer, ReleaseAnswer, RepeatsAnswer,
    WeaveAnswer,
};
use crate::report::content::{Chapter, Tone};
use crate::spec::shape::SpecFile;
use crate::verify::Verified;
use schemars::{Schema, schema_for};
use std::collections::BTreeMap;

pub fn schema() -> Result<Told, Trouble> {
    let all: BTreeMap<&str, Schema> = BTreeMap::from([
        ("spec", schema_for!(SpecFile)),
        ("check", schema_for!(CheckAnswer)),
        ("plan", schema_for!(PlanAnswer)),
        ("play", schema_for!(PlayAnswer)),
        ("release", schema_for!(ReleaseAnswer)),
        ("new", schema_for!(super::new::NewAnswer)),
        ("blocking", schema_for!(BlockingAnswer)),
        ("flex", schema_for!(FlexAnswer)),
        ("repeats", schema_for!(RepeatsAnswer)),
        ("weave", schema_for!(WeaveAnswer)),
        ("chirality", schema_for!(Hands)),
        ("atlas", schema_for!(AtlasAnswer)),
        ("verify", schema_for!(Verified)),
        ("draw", schema_for!(DrawAnswer)),
        ("export", schema_for!(ExportAnswer)),
        ("report", schema_for!(ReportAnswer)),
        ("run", schema_for!(RunAnswer)),
        ("fab", schema_for!(FabAnswer)),
        ("processes", schema_for!(ProcessesAnswer)),
    ]);
    let pretty = serde_json::to_string_pretty(&all).unwrap_or_default();
    let figure = pretty.lines().map(str::to_string).collect();
    let headline = "One schema for the files in (spec), one for each answer.".to_string();
    let chapter = Chapter { tone: Tone::Good, headline, figure, ..Chapter::default() };
    Ok(Told::new(News::Good, &all, "JSON Schema", "Schemas", chapter))
}
