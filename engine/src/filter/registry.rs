//! Which filters there are, by name.

use crate::diagnostic::nearest_name;
use filter_api::Plugin;

/// The filters that are linked in, by name.
const BUILT_IN: &[Plugin] =
    &[blur::PLUGIN, colour::PLUGIN, floor::PLUGIN, horizon::PLUGIN, scharr::PLUGIN, sobel::PLUGIN, threshold::PLUGIN];

/// Every filter that is linked in.
#[must_use]
pub fn built_in() -> &'static [Plugin] {
    BUILT_IN
}

/// The filter called `name`.
///
/// # Errors
/// If there is none: what to write instead.
pub fn find(name: &str) -> Result<&'static Plugin, String> {
    if let Some(plugin) = BUILT_IN.iter().find(|plugin| plugin.descriptor.name == name) {
        return Ok(plugin);
    }
    let names = BUILT_IN.iter().map(|plugin| plugin.descriptor.name);
    Err(match nearest_name(name, names.clone()) {
        Some(near) => format!("did you mean \"{near}\"?"),
        None => format!("there are: {}", names.collect::<Vec<_>>().join(", ")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_sorted_and_unique_and_every_default_is_in_range() {
        for (index, plugin) in BUILT_IN.iter().enumerate() {
            let descriptor = plugin.descriptor;
            assert!(BUILT_IN[index + 1..].iter().all(|other| other.descriptor.name > descriptor.name));
            for parameter in descriptor.parameters {
                assert!((parameter.min..=parameter.max).contains(&parameter.default), "{}", parameter.name);
            }
        }
    }

    #[test]
    fn a_misspelt_name_is_answered_with_the_nearest() {
        assert_eq!(find("sobol").unwrap_err(), "did you mean \"sobel\"?");
        assert_eq!(find("x").unwrap_err(), "there are: blur, colour, floor, horizon, scharr, sobel, threshold");
    }
}
