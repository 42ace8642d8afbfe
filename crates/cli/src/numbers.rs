//! Numbers as arguments.

/// Number of threads of a command; 0 stands for one for each core.
pub(crate) fn threads(text: &str) -> Result<usize, String> {
    const MOST: usize = 1024;
    match text.parse::<usize>() {
        Ok(n) if n <= MOST => Ok(n),
        _ => Err(format!("not a whole number from 0 to {MOST}")),
    }
}

/// A share of a whole.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.0..=1.0).contains(&x) => Ok(x),
        _ => Err("not a number from 0 to 1".to_owned()),
    }
}
