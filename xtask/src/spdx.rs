//! Expressions of licences, such as `MIT OR (Apache-2.0 AND Unicode-3.0)`.

use std::collections::BTreeSet;

/// Whether an expression can be fulfilled with licences from `allowed`.
///
/// The old form with a slash counts as `OR`. `None` if it is no expression.
pub(crate) fn is_allowed(expression: &str, allowed: &BTreeSet<String>) -> Option<bool> {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let mut rest = words.as_slice();
    let answer = any(&mut rest, allowed)?;
    rest.is_empty().then_some(answer)
}

fn any(words: &mut &[&str], allowed: &BTreeSet<String>) -> Option<bool> {
    let mut answer = every(words, allowed)?;
    while take(words, "OR") {
        // Not with `||`, which would leave the rest unread.
        answer |= every(words, allowed)?;
    }
    Some(answer)
}

fn every(words: &mut &[&str], allowed: &BTreeSet<String>) -> Option<bool> {
    let mut answer = one(words, allowed)?;
    while take(words, "AND") {
        answer &= one(words, allowed)?;
    }
    Some(answer)
}

fn one(words: &mut &[&str], allowed: &BTreeSet<String>) -> Option<bool> {
    if take(words, "(") {
        let answer = any(words, allowed)?;
        return take(words, ")").then_some(answer);
    }
    let (first, rest) = words.split_first()?;
    if ["AND", "OR", "WITH", "(", ")"].contains(first) {
        return None;
    }
    *words = rest;
    if !take(words, "WITH") {
        return Some(allowed.contains(*first));
    }
    let (exception, rest) = words.split_first()?;
    *words = rest;
    Some(allowed.contains(&format!("{first} WITH {exception}")))
}

fn take(words: &mut &[&str], word: &str) -> bool {
    match words.split_first() {
        Some((first, rest)) if *first == word => {
            *words = rest;
            true
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_are_evaluated() {
        let allowed = ["MIT", "Zlib", "Apache-2.0 WITH LLVM-exception"].map(str::to_owned).into();
        let yes =
            ["MIT", "GPL-3.0 OR MIT", "GPL-3.0/MIT", "GPL-3.0 / MIT", "MIT AND Zlib", "(MIT AND Zlib) OR GPL-3.0"];
        let yes = yes.into_iter().chain(["Apache-2.0 WITH LLVM-exception OR GPL-3.0"]);
        for expression in yes {
            assert_eq!(is_allowed(expression, &allowed), Some(true), "{expression}");
        }
        for expression in
            ["GPL-3.0", "MIT AND GPL-3.0", "(MIT OR Zlib) AND GPL-3.0", "Apache-2.0", "MIT WITH LLVM-exception"]
        {
            assert_eq!(is_allowed(expression, &allowed), Some(false), "{expression}");
        }
        for expression in ["", "MIT OR", "(MIT", "MIT)", "MIT Zlib", "OR MIT", "MIT WITH"] {
            assert_eq!(is_allowed(expression, &allowed), None, "{expression}");
        }
    }
}
