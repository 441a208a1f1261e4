//! The geometry room from outside: fast against slow, rays that leave
//! surfaces, cracks, stated errors, scale and place.

mod along;
mod composed;
mod curved;
mod equivalence;
mod exact;
mod field;
mod kinds;
mod known;
mod leaks;
mod leaving;
mod place;
mod precision;
mod quick;
mod scenes;
mod solids;
mod truth;
mod turning;
mod watertight;
