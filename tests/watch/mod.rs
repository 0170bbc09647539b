/// What hostile requests get.
mod hostile;
/// A running `engine watch` and raw requests to it.
pub(crate) mod served;
/// What the page is told on saves.
mod told;
