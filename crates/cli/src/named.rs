//! Arguments that are one of a list of values that the libraries name.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use sightlines::multifocal::Measure;

/// Parses one of `all`, each by its name; the long help lists them with what each does.
pub(crate) fn one_of<T: Copy + Send + Sync + 'static>(
    all: &[T],
    name: fn(T) -> &'static str,
    about: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let all = all.to_vec();
    let value = |&t: &T| {
        let value = PossibleValue::new(name(t));
        if about(t).is_empty() { value } else { value.help(about(t)) }
    };
    let values: Vec<PossibleValue> = all.iter().map(value).collect();
    let read = move |text: String| *all.iter().find(|&&t| name(t) == text).expect("the value is one of the list");
    PossibleValuesParser::new(values).map(read)
}

/// Parses what multifocal buffers compare.
pub(crate) fn measure() -> impl TypedValueParser<Value = Measure> {
    one_of(&Measure::ALL, Measure::name, |_| "")
}
