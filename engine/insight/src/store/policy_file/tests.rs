use super::*;
use engine::state::Grid;

fn map(settings: &Settings) -> GridMap {
    GridMap::new(&settings.view.grid, Grid::new(&settings.view.grid, 160, 120).unwrap())
}

fn written(settings: &Settings) -> Result<String> {
    text_of("wall", (settings, Vec::new()), &Catalogue::linked_in(), (&map(settings), &policy()), None)
}

fn read(source: &SourceText, settings: &Settings) -> Result<Policy> {
    fitting(source, settings, &map(settings)).map(|stored| stored.policy)
}

fn policy() -> Policy {
    let values: Vec<f64> = (0..14).map(|action| -0.1 - f64::from(action) / 3.0).collect();
    let mut rows = vec![None; 64];
    rows[5] = Some(PolicyRow { visits: 17, values });
    Policy::new(14, rows)
}

#[test]
fn a_policy_is_read_back_bit_for_bit() {
    let settings = Settings::default();
    let text = written(&settings).unwrap();
    let read = read(&SourceText::new("policy.toml", text), &settings).unwrap();
    assert_eq!(read, policy());
}

#[test]
fn what_filters_kept_is_read_back_and_damage_of_it_is_an_error() {
    let settings = Settings::default();
    let policy = policy().keeping((0..=255).collect());
    let parts = (&settings, Vec::new());
    let text = text_of("wall", parts, &Catalogue::linked_in(), (&map(&settings), &policy), None).unwrap();
    assert_eq!(read(&SourceText::new("policy.toml", text.clone()), &settings).unwrap(), policy);
    let error = read(&SourceText::new("policy.toml", text.replace("AAEC", "A!EC")), &settings).unwrap_err();
    assert_eq!(error.message, "'policy.toml' has damaged bytes of its filters in 'kept'");
}

#[test]
fn filters_are_read_back_with_their_parameters() {
    let mut settings = Settings::default();
    let parameters = vec![("saturation".to_owned(), 0.4), ("hue_deg".to_owned(), 120.0)];
    settings.view.filters = vec![FilterSettings { parameters, ..FilterSettings::new("colour") }];
    let source = SourceText::new("policy.toml", written(&settings).unwrap());
    let mut read = StoredPolicy::parse(&source).unwrap().filters;
    read[0].parameters.sort_by_key(|(name, _)| std::cmp::Reverse(name.clone()));
    assert_eq!(read, settings.view.filters);
}

#[test]
fn the_first_format_is_named_and_not_guessed_at() {
    let old = "format = 1\nbehaviour = \"wall\"\nfilters = [\"sobel(threshold: 60)\"]\n";
    let error = StoredPolicy::parse(&SourceText::new("policy.toml", old)).unwrap_err();
    assert_eq!(error.message, "'policy.toml' has format 1, this engine reads formats 2 to 5");
}

#[test]
fn another_grid_or_other_actions_are_refused() {
    let mut settings = Settings::default();
    let source = SourceText::new("policy.toml", written(&settings).unwrap());
    settings.view.grid.rows = 4;
    assert!(read(&source, &settings).unwrap_err().message.contains("a grid of 3x3"));
    settings.view.grid.rows = 3;
    settings.actions.pop();
    let error = read(&source, &settings).unwrap_err();
    assert!(error.message.contains("with 14 actions, this run has 13 actions"), "{}", error.message);
}

#[test]
fn damage_is_an_error_and_not_a_guess() {
    let settings = Settings::default();
    let text = written(&settings).unwrap();
    for damaged in [text.replace("index = 5", "index = 64"), text.replace("-0.1,", "nan,"), text[..200].to_owned()] {
        assert!(read(&SourceText::new("policy.toml", damaged), &settings).is_err());
    }
}
