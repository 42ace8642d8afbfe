//! What all commands have in common: they get their arguments and a verbosity, and return what is printed at their end.

use crate::error::Result;
use crate::output;
use serde::Serialize;
use std::fmt;

/// How much a command says.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Verbosity {
    /// Whether progress goes to standard error.
    pub(crate) show_progress: bool,
    /// Whether people get all facts in place of a few lines.
    pub(crate) verbose: bool,
}

/// What a command found, as the program's exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Answer {
    /// Done; exit code 0.
    Yes,
    /// Done, and the answer is no, such as for a point outside every cell; exit code 1.
    No,
    /// A job is not complete: some of its shards are to be done; exit code 3.
    Incomplete,
}

/// Whether the result is for programs.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(crate) struct JsonArg {
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

impl From<JsonArg> for bool {
    fn from(JsonArg { json }: JsonArg) -> Self {
        json
    }
}

/// A command that came to its end: its answer, and what is to be printed.
pub(crate) struct Done {
    answer: Answer,
    print: Box<dyn FnOnce() -> Result<()>>,
}

impl Done {
    /// With a result, which is printed as JSON if `json`, otherwise as it is displayed; the answer is yes.
    pub(crate) fn new(json: impl Into<bool>, result: impl Serialize + fmt::Display + 'static) -> Self {
        let json = json.into();
        Self { answer: Answer::Yes, print: Box::new(move || output::print(json, &result, &result)) }
    }

    /// The same where people and programs get different forms of it, of which one is made.
    pub(crate) fn in_two_forms<T: Serialize + 'static>(
        json: impl Into<bool>,
        fields: impl FnOnce() -> T,
        text: impl FnOnce() -> String,
    ) -> Self {
        let form = if json.into() { Ok(fields()) } else { Err(text()) };
        let print = move || match form {
            Ok(fields) => output::print(true, &fields, &""),
            Err(text) => output::print(false, &(), &text),
        };
        Self { answer: Answer::Yes, print: Box::new(print) }
    }

    /// With nothing to print.
    pub(crate) fn silently() -> Self {
        Self { answer: Answer::Yes, print: Box::new(|| Ok(())) }
    }

    /// The same with another answer.
    #[must_use]
    pub(crate) fn answering(self, answer: Answer) -> Self {
        Self { answer, ..self }
    }

    /// Answers yes or no.
    #[must_use]
    pub(crate) fn answering_whether(self, is_so: bool) -> Self {
        self.answering(if is_so { Answer::Yes } else { Answer::No })
    }

    /// The same with something to do once the result is printed.
    #[must_use]
    pub(crate) fn then(self, last: impl FnOnce() -> Result<()> + 'static) -> Self {
        let Self { answer, print } = self;
        Self { answer, print: Box::new(move || print().and_then(|()| last())) }
    }

    pub(crate) fn print(self) -> Result<Answer> {
        (self.print)()?;
        Ok(self.answer)
    }
}

/// Makes the enum of some commands, and what runs one.
macro_rules! commands {
    (enum $enum:ident: $($(#[$about:meta])* $name:ident($args:ty) => $run:path,)*) => {
        /// What to do.
        #[derive(Debug, clap::Subcommand)]
        pub(crate) enum $enum {
            $($(#[$about])* $name($args),)*
        }

        impl $enum {
            pub(crate) fn run(&self, verbosity: crate::command::Verbosity) -> crate::error::Result<crate::command::Done> {
                match self {
                    $(Self::$name(args) => $run(args, verbosity),)*
                }
            }
        }
    };
}
pub(crate) use commands;
