//! What a chain of filters begins with: the camera's colours, or its depth.

use filter_api::{Descriptor, Format};

use super::catalogue::Catalogue;
use super::condition;
use super::entry::Entry;
use crate::settings::FilterSettings;

/// What a chain begins with: depth if that is what its first filter reads, else colour.
pub(super) fn first_reads(settings: &[FilterSettings], catalogue: &Catalogue) -> Format {
    let first = settings.first().and_then(|filter| Some(descriptor_of(&*catalogue.find(&filter.name).ok()?, filter)));
    match first {
        Some(descriptor) if descriptor.reads.first() == Some(&Format::Depth) => Format::Depth,
        _ => Format::Rgb,
    }
}

/// What a filter says of itself, as it is set.
pub(super) fn descriptor_of(entry: &Entry, filter: &FilterSettings) -> &'static Descriptor {
    match &filter.condition {
        Some(text) if entry.by_condition && condition::looks_at_depth(text) => &condition::OF_DEPTH,
        _ => entry.descriptor,
    }
}
