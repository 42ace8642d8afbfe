//! Reasons of the system in words that are safe for editors.

/// A reason without the system's number for it: ` (os error 2)`. Editors take the word in it for a failure, and warnings are none.
pub(crate) fn plain(reason: &str) -> String {
    let mut text = reason.to_owned();
    while let Some(start) = text.find(" (os error ") {
        let Some(len) = text[start..].find(')') else { break };
        text.replace_range(start..=start + len, "");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_system_are_left_out() {
        assert_eq!(plain("a: No such file (os error 2); going on"), "a: No such file; going on");
        assert_eq!(plain("x (os error 2), y (os error 13)"), "x, y");
        assert_eq!([plain("nothing"), plain("cut (os error 2")], ["nothing", "cut (os error 2"]);
        let real = std::fs::read("/nowhere/at/all").unwrap_err().to_string();
        assert!(real.contains("error") && !plain(&real).contains("error"), "{real}");
    }
}
