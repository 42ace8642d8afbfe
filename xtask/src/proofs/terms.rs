//! Sums of products as they are computed: which roundings each of their terms passes, and what a bound has to be for them.
//!
//! An expression is multiplied out. Every operation puts a factor `1 + d` on all terms that pass it, where `|d|` is at most the unit of
//! rounding (the standard model; that doubles obey it for the products and sums of coordinates, those that underflow included, is
//! the script `model.gappa`). So the computed value is the sum of `t p`, where `t` are the terms of the exact one and `p` products
//! of such factors. The computed bound is at least the sum of `C |t| q`. By the triangle inequality the value is within the bound if
//! `|p - 1| <= C q` for every term. That is what the script says that is written here, and Gappa proves.
//!
//! The lines of an expression:
//!
//! * `name = expression`, of names, powers of two, `+ - * /`, `abs(…)`, `again(…)` for what is
//!   rounded once more, and `C`, the constant. Names that are not defined are numbers that are given.
//! * `name := expression`, one operation on what is given: its exact result is taken as a number of its own, rounded once.
//! * `rounded name …`: numbers that are given with an error of half a unit already.
//! * `share name …`: magnitudes of at most 1, which the bound need not have.
//! * `positive name …`: numbers that are given and not negative.
//!
//! `value` and `bound` are the last two.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// A factor `1 + d`, or one divided by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Factor {
    id: usize,
    is_half: bool,
    is_inverse: bool,
}

/// A product of numbers, with the factors of its roundings.
#[derive(Debug, Clone)]
struct Term {
    times: f64,
    /// What is multiplied, sorted; what divides has a slash before it.
    of: Vec<String>,
    factors: Vec<Factor>,
    is_positive: bool,
}

type Sum = Vec<Term>;

/// What an expression means.
#[derive(Debug, Default)]
struct Scope {
    names: BTreeMap<String, Sum>,
    rounded: BTreeMap<String, Factor>,
    shares: BTreeSet<String>,
    positive: BTreeSet<String>,
    n_factors: usize,
}

/// A goal of a script: that the error of a term, or of several like it, is at most the constant times what the bound has for it.
pub(crate) struct Goals {
    /// Quotients of error and bound.
    pub(crate) quotients: BTreeSet<Goal>,
    /// How many terms they are about.
    pub(crate) n_terms: usize,
}

/// Multiplies out.
///
/// * `by_sign`: only the sign of the value matters, which its last rounding does not change
///
/// # Errors
/// What is wrong with the text, in words.
pub(crate) fn goals(text: &str, by_sign: bool) -> Result<Goals, String> {
    let mut scope = Scope::default();
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
        scope.read(line, by_sign)?;
    }
    let named = |name: &str| scope.names.get(name).cloned().ok_or_else(|| format!("there is no {name}"));
    let (value, mut bound) = (named("value")?, named("bound")?);
    if let Some(term) = bound.iter().find(|term| !term.is_positive) {
        return Err(format!("the bound has {:?} without abs", term.of));
    }
    // Parts of the bound without the constant are additions to it.
    bound.retain(|term| term.of.iter().any(|name| name == "C"));
    if by_sign {
        let last = scope.factor();
        bound.iter_mut().for_each(|term| term.factors.push(Factor { is_inverse: true, ..last }));
    }
    let key = |term: &Term| -> Vec<String> {
        let wanted = |name: &&String| *name != "C" && !scope.shares.contains(*name);
        term.of.iter().filter(wanted).cloned().collect()
    };
    let mut groups: BTreeMap<Vec<String>, [Sum; 2]> = BTreeMap::new();
    for (which, terms) in [value, bound].into_iter().enumerate() {
        terms.into_iter().for_each(|term| groups.entry(key(&term)).or_default()[which].push(term));
    }
    let mut goals = Goals { quotients: BTreeSet::new(), n_terms: 0 };
    for (key, [value, bound]) in groups {
        if value.is_empty() {
            continue;
        }
        if bound.is_empty() {
            return Err(format!("the bound has nothing for {}", key.join(" * ")));
        }
        goals.n_terms += value.len();
        goals.quotients.extend(quotients(&value, &bound));
    }
    Ok(goals)
}

impl Scope {
    fn factor(&mut self) -> Factor {
        self.n_factors += 1;
        Factor { id: self.n_factors, is_half: false, is_inverse: false }
    }

    fn read(&mut self, line: &str, by_sign: bool) -> Result<(), String> {
        let mut words = line.split_whitespace();
        let first = words.next().unwrap_or_default();
        if matches!(first, "rounded" | "share" | "positive") {
            for name in words.map(str::to_owned) {
                match first {
                    "rounded" => {
                        let factor = Factor { is_half: true, ..self.factor() };
                        self.rounded.insert(name, factor);
                    }
                    "share" => _ = self.shares.insert(name),
                    _ => _ = self.positive.insert(name),
                }
            }
            return Ok(());
        }
        let (name, expression) = line.split_once('=').ok_or_else(|| format!("{line:?} is no definition"))?;
        let (name, is_exact) = match name.trim().strip_suffix(':') {
            Some(name) => (name.trim(), true),
            None => (name.trim(), false),
        };
        let mut parser =
            Parser { text: expression.chars().filter(|c| !c.is_whitespace()).collect(), at: 0, scope: self };
        let mut sum = parser.sum()?;
        if parser.at != parser.text.len() {
            return Err(format!("{line:?} ends at {}", parser.at));
        }
        if is_exact {
            let factor = self.factor();
            sum = vec![Term { times: 1.0, of: vec![name.to_owned()], factors: vec![factor], is_positive: false }];
        }
        if name == "value" && by_sign {
            let last = sum.iter().flat_map(|term| &term.factors).map(|factor| factor.id).max().unwrap_or(0);
            sum.iter_mut().for_each(|term| term.factors.retain(|factor| factor.id != last));
        }
        match self.names.insert(name.to_owned(), sum) {
            None => Ok(()),
            Some(_) => Err(format!("{name} is defined twice")),
        }
    }
}

struct Parser<'a> {
    text: Vec<char>,
    at: usize,
    scope: &'a mut Scope,
}

impl Parser<'_> {
    fn takes(&mut self, c: char) -> bool {
        let is_next = self.text.get(self.at) == Some(&c);
        self.at += usize::from(is_next);
        is_next
    }

    fn sum(&mut self) -> Result<Sum, String> {
        let mut left = self.product()?;
        loop {
            let minus = self.takes('-');
            if !minus && !self.takes('+') {
                return Ok(left);
            }
            let right = self.product()?;
            let factor = self.scope.factor();
            left.extend(right.into_iter().map(|term| Term { is_positive: term.is_positive && !minus, ..term }));
            left.iter_mut().for_each(|term| term.factors.push(factor));
        }
    }

    fn product(&mut self) -> Result<Sum, String> {
        let mut left = self.part()?;
        loop {
            let over = self.takes('/');
            if !over && !self.takes('*') {
                return Ok(left);
            }
            let mut right = self.part()?;
            if over {
                let [term] = right.as_mut_slice() else { return Err("a sum divides".to_owned()) };
                term.times = term.times.recip();
                term.factors.iter_mut().for_each(|factor| factor.is_inverse = !factor.is_inverse);
                term.of.iter_mut().for_each(|name| *name = format!("/{name}"));
            }
            left = self.multiplied(&left, &right);
        }
    }

    fn multiplied(&mut self, left: &Sum, right: &Sum) -> Sum {
        let is_power = |sum: &Sum| matches!(&sum[..], [term] if term.of.is_empty() && term.times.log2().fract() == 0.0);
        let factor = (!is_power(left) && !is_power(right)).then(|| self.scope.factor());
        let both = left.iter().flat_map(|a| right.iter().map(move |b| (a, b)));
        let product = |(a, b): (&Term, &Term)| {
            let mut of = [&a.of[..], &b.of[..]].concat();
            of.sort();
            let factors = [&a.factors[..], &b.factors[..], factor.as_slice()].concat();
            Term { times: a.times * b.times, of, factors, is_positive: a.is_positive && b.is_positive }
        };
        both.map(product).collect()
    }

    fn part(&mut self) -> Result<Sum, String> {
        if self.takes('-') {
            return self.part();
        }
        if self.takes('(') {
            let sum = self.sum()?;
            return if self.takes(')') { Ok(sum) } else { Err("a parenthesis is open".to_owned()) };
        }
        let from = self.at;
        while self.text.get(self.at).is_some_and(|c| c.is_alphanumeric() || matches!(c, '.' | '_' | '[' | ']')) {
            self.at += 1;
        }
        let name: String = self.text[from..self.at].iter().collect();
        if name == "again" && self.takes('(') {
            let mut sum = self.sum()?;
            let factor = self.scope.factor();
            sum.iter_mut().for_each(|term| term.factors.push(factor));
            return if self.takes(')') { Ok(sum) } else { Err("a parenthesis is open".to_owned()) };
        }
        if name == "abs" && self.takes('(') {
            let mut sum = self.sum()?;
            if !self.takes(')') {
                return Err("a parenthesis is open".to_owned());
            }
            let [term] = sum.as_mut_slice() else {
                return Err("the magnitude of a sum is less than that of its terms".to_owned());
            };
            term.is_positive = true;
            return Ok(sum);
        }
        if let Some(sum) = self.scope.names.get(&name) {
            return Ok(sum.clone());
        }
        if let Ok(times) = name.parse::<f64>() {
            return Ok(vec![Term { times, of: Vec::new(), factors: Vec::new(), is_positive: true }]);
        }
        if name.is_empty() {
            return Err(format!("nothing is at {from} of {}", self.text.iter().collect::<String>()));
        }
        let factors = self.scope.rounded.get(&name).copied().into_iter().collect();
        let is_positive = name == "C" || self.scope.positive.contains(&name);
        Ok(vec![Term { times: 1.0, of: vec![name], factors, is_positive }])
    }
}

/// Errors of terms divided by their bound, `p - 1` by `q`; of those with the same roundings one.
fn quotients(value: &[Term], bound: &[Term]) -> BTreeSet<Goal> {
    if let ([v], [b]) = (value, bound) {
        return BTreeSet::from([quotient(v, b)]);
    }
    // Where one product of numbers occurs several times: the largest error of any, so many times, and the smallest bound.
    let all = |terms: &[Term]| terms.iter().map(|term| term.times.abs()).sum::<f64>();
    let alone = |terms: &[Term], times: f64| {
        let all: BTreeSet<Kinds> = terms.iter().map(|term| counts(&term.factors)).collect();
        let worst = all.iter().filter(|a| !all.iter().any(|b| b != *a && (0..4).all(|k| a[k] <= b[k])));
        let found = worst.filter_map(|kinds| terms.iter().find(|term| counts(&term.factors) == *kinds));
        // They are of different terms, so they share no rounding.
        let apart = |factors: &[Factor]| factors.iter().map(|f| Factor { id: usize::MAX, ..*f }).collect();
        found.map(|term| Term { times, of: Vec::new(), factors: apart(&term.factors), ..*term }).collect::<Vec<_>>()
    };
    let (value, mut bound) = (alone(value, all(value)), alone(bound, all(bound)));
    bound.iter_mut().flat_map(|term| &mut term.factors).for_each(|factor| factor.id -= 1);
    value.iter().flat_map(|v| bound.iter().map(|b| quotient(v, b))).collect()
}

/// How many factors of each kind there are.
fn counts(factors: &[Factor]) -> Kinds {
    let mut counts = [0; 4];
    factors.iter().for_each(|f| counts[usize::from(f.is_half) + 2 * usize::from(f.is_inverse)] += 1);
    counts
}

/// The error of a term divided by its bound.
fn quotient(v: &Term, b: &Term) -> Goal {
    // Roundings that both have: `(p g - 1) / (q g)` is `(p - 1 / g) / q`.
    let (mut own, mut shared, mut others) = (v.factors.clone(), Vec::new(), Vec::new());
    for factor in &b.factors {
        match own.iter().position(|f| f == factor) {
            Some(at) => shared.push(Factor { is_inverse: !factor.is_inverse, ..own.swap_remove(at) }),
            None => others.push(*factor),
        }
    }
    let products = [own, shared, others].map(|factors| counts(&factors));
    Goal { times: (v.times / b.times).abs().to_string(), products }
}

/// `times (p - 1 / g) / q`, of three products of factors: how many there are of each kind.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Goal {
    times: String,
    products: [Kinds; 3],
}

/// Numbers of factors: of a whole unit, of a half, and such that divide.
type Kinds = [usize; 4];

/// Numbers from which on and up to which a product of factors is, less 1, as Gappa reads them; rounded outwards. What Gappa proves first.
fn range(kinds: &Kinds, unit: i32) -> String {
    const ONE: i128 = 1 << 114;
    let (mut low, mut high) = (ONE, ONE);
    let down = |x: i128, by: i32| x >> by.min(120);
    let up = |x: i128, by: i32| down(x, by) + 1;
    for (kind, &n) in kinds.iter().enumerate() {
        let by = -unit + (kind % 2) as i32;
        for _ in 0..n {
            high += up(high, by);
            low -= up(low, by);
            if kind >= 2 {
                // 1 / (1 - u) is (1 + u) (1 + u^2) (1 + u^4) and so on.
                high += up(high, 2 * by);
                high += up(high, 4 * by) + 1;
                low += down(low, 2 * by) - 1;
            }
        }
    }
    format!("[{}b-114,{}b-114]", low - ONE, high - ONE)
}

/// The script that says in what range the products of factors are.
pub(crate) fn lemmas(goals: &Goals, unit: i32) -> String {
    let all: BTreeSet<&Kinds> = goals.quotients.iter().flat_map(|goal| &goal.products).collect();
    let most = all.iter().map(|kinds| kinds.iter().sum::<usize>()).max().unwrap_or(0).max(1);
    let known: Vec<String> = (0..most)
        .flat_map(|k| [format!("d{k} in [-1b{unit},1b{unit}]"), format!("h{k} in [-1b{0},1b{0}]", unit - 1)])
        .collect();
    let product = |kinds: &Kinds| {
        let (mut text, mut id) = (String::from("1"), 0);
        for (kind, &n) in kinds.iter().enumerate() {
            for _ in 0..n {
                let (sign, letter) = (if kind >= 2 { '/' } else { '*' }, if kind % 2 == 1 { 'h' } else { 'd' });
                write!(text, " {sign} (1 + {letter}{id})").expect("texts grow");
                id += 1;
            }
        }
        text
    };
    let wanted: Vec<String> =
        all.iter().map(|kinds| format!("{} - 1 in {}", product(kinds), range(kinds, unit))).collect();
    format!("{{ {} ->\n  {} }}\n", known.join(" /\\ "), wanted.join(" /\\\n  "))
}

/// The script that says all of the goals for a constant, by the ranges of the products.
///
/// * `unit`: of rounding, as a power of two
pub(crate) fn script(goals: &Goals, unit: i32, constant: &str) -> String {
    let (mut known, mut wanted) = (BTreeSet::new(), Vec::new());
    for goal in &goals.quotients {
        let [p, g, q] = [0, 1, 2].map(|k| {
            let [a, b, c, d] = goal.products[k];
            let name = format!("{}{a}_{b}_{c}_{d}", ['p', 'g', 'q'][k]);
            known.insert(format!("{name} in {}", range(&goal.products[k], unit)));
            name
        });
        wanted.push(format!("|{} * ({p} - {g}) / (1 + {q})| <= {constant}", goal.times));
    }
    let known: Vec<String> = known.into_iter().collect();
    format!("{{ {} ->\n  {} }}\n", known.join(" /\\\n  "), wanted.join(" /\\\n  "))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DETERMINANT: &str = "
        u := a.x - c.x
        v := b.y - c.y
        r := a.y - c.y
        s := b.x - c.x
        left = u * v
        right = r * s
        value = left - right
        bound = C * (abs(left) + abs(right))";

    #[test]
    fn roundings_of_a_determinant_are_counted() {
        let found = goals(DETERMINANT, false).expect("it is sound");
        // Two differences, a product and the last difference; the bound shares three and has a sum and a product of its own.
        let of = |products| BTreeSet::from([Goal { times: "1".to_owned(), products }]);
        assert_eq!((found.n_terms, found.quotients), (2, of([[1, 0, 0, 0], [0, 0, 3, 0], [2, 0, 0, 0]])));
        let by_sign = goals(DETERMINANT, true).expect("it is sound").quotients;
        assert_eq!(by_sign, of([[0, 0, 0, 0], [0, 0, 3, 0], [2, 0, 1, 0]]));
    }

    #[test]
    fn what_a_bound_lacks_is_found() {
        for (text, word) in [
            ("value = a * b - c * d\nbound = C * abs(a * b)", "nothing for"),
            ("value = a - b\nbound = C * abs(a - b)", "magnitude of a sum"),
            ("value = a - b\nbound = C * (abs(a) - abs(b))", "without abs"),
            ("value = a\nbound = C * a", "without abs"),
            ("value = a / (b + c)\nbound = C * abs(a)", "divides"),
            ("value = (a\nbound = C", "open"),
            ("value = a", "no bound"),
            ("value", "no definition"),
        ] {
            let found = goals(text, false).err().unwrap_or_default();
            assert!(found.contains(word), "{text}: {found:?}");
        }
    }

    #[test]
    fn a_script_has_a_range_for_every_rounding() {
        let text = "rounded a\nshare t\nvalue = t * a\nbound = C * abs(a)";
        let goals = goals(text, false).expect("it is sound");
        // The rounding of `a` is in both.
        let lemmas = lemmas(&goals, -23);
        assert!(lemmas.contains("d0 in [-1b-23,1b-23]") && lemmas.contains("1 / (1 + h0) - 1 in ["), "{lemmas}");
        let script = script(&goals, -23, "3b-20");
        assert!(script.ends_with("|1 * (p1_0_0_0 - g0_0_0_1) / (1 + q1_0_0_0)| <= 3b-20 }\n"), "{script}");
        assert_eq!(range(&[0; 4], -53), "[0b-114,0b-114]");
    }
}
