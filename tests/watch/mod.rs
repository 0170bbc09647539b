/// What the page is told of the check, of combined policies and of filters.
mod checked;
/// What hostile requests get.
mod hostile;
/// What a reward that is swapped while the robots learn leaves.
mod keep;
/// A running `engine watch` and raw requests to it.
pub(crate) mod served;
/// What the page is told on saves.
mod told;
