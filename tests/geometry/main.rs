//! The geometry room from outside: fast against slow, rays that leave
//! surfaces, cracks, stated errors, scale and place.

mod curved;
mod equivalence;
mod exact;
mod hunt;
mod known;
mod leaks;
mod leaving;
mod place;
mod precision;
mod scenes;
mod solids;
mod turning;
mod watertight;
