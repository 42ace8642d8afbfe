//! Constants as the sources write them, evaluated as Rust does, and as Gappa writes them.

/// The value of an expression such as `(3.0 + 8.0 * f64::EPSILON) * (0.5 * f64::EPSILON)`, each operation rounded to a double; `None` if it is
/// made of something else than numbers, powers of two and the four operations.
pub(crate) fn value(text: &str) -> Option<f64> {
    let mut text = text.replace('_', "").replace("2f64.powi(", "2^(").replace("f64::MINPOSITIVE", "2^(-1022)");
    if let Some(bits) = text.strip_prefix("f64::from_bits(".replace('_', "").as_str()) {
        text = format!("2^({})", bits.replace(" << 52)", " - 1023"));
    }
    for (name, number) in [
        ("f64::EPSILON", "2^(-52)"),
        ("as f64", ""),
        ("u128 <<", "*2^"),
        ("u64 <<", "*2^"),
        ("u32 <<", "*2^"),
        ("f64", ""),
    ] {
        text = text.replace(name, number);
    }
    let text: Vec<char> = text.replace("0x1p", "2^").chars().filter(|c| !c.is_whitespace()).collect();
    let mut parser = Parser { text, at: 0 };
    let value = parser.sum()?;
    (parser.at == parser.text.len() && value.is_finite()).then_some(value)
}

struct Parser {
    text: Vec<char>,
    at: usize,
}

impl Parser {
    fn takes(&mut self, c: char) -> bool {
        let is_next = self.text.get(self.at) == Some(&c);
        self.at += usize::from(is_next);
        is_next
    }

    fn sum(&mut self) -> Option<f64> {
        let mut value = self.product()?;
        loop {
            if self.takes('+') {
                value += self.product()?;
            } else if self.takes('-') {
                value -= self.product()?;
            } else {
                return Some(value);
            }
        }
    }

    fn product(&mut self) -> Option<f64> {
        let mut value = self.factor()?;
        loop {
            if self.takes('*') {
                value *= self.factor()?;
            } else if self.takes('/') {
                value /= self.factor()?;
            } else {
                return Some(value);
            }
        }
    }

    fn factor(&mut self) -> Option<f64> {
        if self.takes('-') {
            return Some(-self.factor()?);
        }
        let value = self.number()?;
        if self.takes('^') {
            return Some(value.powf(self.factor()?));
        }
        Some(value)
    }

    fn number(&mut self) -> Option<f64> {
        if self.takes('(') {
            let value = self.sum()?;
            return self.takes(')').then_some(value);
        }
        let from = self.at;
        while let Some(c) = self.text.get(self.at) {
            let is_exponent = matches!(c, '+' | '-') && self.at > from && self.text[self.at - 1] == 'e';
            if !(c.is_ascii_digit() || matches!(c, '.' | 'e') || is_exponent) {
                break;
            }
            self.at += 1;
        }
        self.text[from..self.at].iter().collect::<String>().parse().ok()
    }
}

/// A double as Gappa reads it, exactly: an integer times a power of two.
pub(crate) fn dyadic(x: f64) -> String {
    let bits = x.to_bits();
    let (field, fraction) = ((bits >> 52 & 0x7ff) as i64, bits & ((1 << 52) - 1));
    let (whole, exponent) = if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field - 1075) };
    let zeros = if whole == 0 { 0 } else { whole.trailing_zeros() };
    format!("{}{}b{}", if x < 0.0 { "-" } else { "" }, whole >> zeros, exponent + i64::from(zeros))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_are_evaluated_as_rust_does() {
        for (text, expected) in [
            ("(3.0 + 8.0 * f64::EPSILON) * (0.5 * f64::EPSILON)", (3.0 + 8.0 * f64::EPSILON) * (0.5 * f64::EPSILON)),
            ("1.0 / (1u64 << 43) as f64", 2f64.powi(-43)),
            ("1.0 / (1u128 << 98) as f64", 2f64.powi(-98)),
            ("2f64.powi(-44)", 2f64.powi(-44)),
            ("0x1p-19", 2f64.powi(-19)),
            ("1e-9", 1e-9),
            ("f64::from_bits((1023 - 140) << 52)", 2f64.powi(-140)),
            ("1.0 - 64.0 * f64::EPSILON", 1.0 - 64.0 * f64::EPSILON),
            ("-1.5 * f64::MIN_POSITIVE", -1.5 * f64::MIN_POSITIVE),
        ] {
            assert_eq!(value(text), Some(expected), "{text}");
        }
        for wrong in ["", "1.0 +", "x", "1.0 2.0", "(1.0", "1.0 / 0.0"] {
            assert_eq!(value(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn doubles_are_written_exactly() {
        assert_eq!(
            [1.0, -0.75, 0.0, 5e-324, 3.0 * f64::EPSILON].map(dyadic),
            ["1b0", "-3b-2", "0b-1074", "1b-1074", "3b-52"]
        );
    }
}
