//! `sortie schema`: JSON Schemas of the spec and of every document.

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};

use super::args::SchemaName;
use super::convert;
use super::terrain::TerrainDocument;
use crate::flight::FlightDocument;
use crate::report::{
    CertificateDocument, CheckDocument, PlanDocument, ReviewDocument, TimingDocument,
    TrajectoriesDocument, UploadDocument,
};
use crate::spec;
use crate::study::Speed;

/// The JSON Schema (draft 2020-12) of the spec or a document.
pub(super) fn of(name: SchemaName) -> String {
    let schema = match name {
        SchemaName::Spec => return spec::json_schema(),
        SchemaName::Plan => written::<PlanDocument<'_>>(),
        SchemaName::Review => written::<ReviewDocument>(),
        SchemaName::Trajectories => written::<TrajectoriesDocument>(),
        SchemaName::Timing => written::<TimingDocument>(),
        SchemaName::Upload => written::<UploadDocument>(),
        SchemaName::Flight => written::<FlightDocument>(),
        SchemaName::Certificate => written::<CertificateDocument>(),
        SchemaName::Check => written::<CheckDocument>(),
        SchemaName::Convert => written::<convert::Report>(),
        SchemaName::Terrain => written::<TerrainDocument>(),
        SchemaName::Speed => written::<Speed>(),
    };
    format!("{:#}\n", schema.as_value())
}

/// The schema of a document as it is written: a key that may be absent is not required.
fn written<D: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    settings.into_generator().into_root_schema_for::<D>()
}
