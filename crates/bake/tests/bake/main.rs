//! Tables of plans, maps and scenes, against oracles and full rebuilds.

mod any_input;
mod backends;
mod bakeable;
mod doubled;
mod explain;
mod far;
mod floor;
mod fronts;
mod joints;
mod limit;
mod line_space;
mod live;
mod mirrors;
mod places;
mod plan;
mod quake;
mod reject;
mod reject_engines;
mod reject_text;
mod reject_units;
mod reject_wads;
mod space;
mod stab;
mod surroundings;
mod tile;
mod units;
