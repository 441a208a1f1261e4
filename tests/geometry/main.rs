//! The geometry room from outside: fast against slow, rays that leave
//! surfaces, cracks, stated errors, scale and place.

mod equivalence;
mod exact;
mod leaving;
mod place;
mod precision;
mod scenes;
mod turning;
mod watertight;
