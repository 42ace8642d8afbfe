//! True tables of every kind have no violations; tables with one pair hidden that is seen have.

mod changes;
mod common;
mod damage;
mod doors;
mod flips;
mod impostors;
mod sampled;
mod structure;
