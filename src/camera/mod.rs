//! Cameras: from a position on the film to a ray.
//!
//! Film coordinates are continuous pixels: `(0, 0)` is the top left corner of
//! the image, x runs right, y runs down; pixel `(i, j)` covers
//! `[i, i + 1) x [j, j + 1)`.

mod filter;

pub use filter::Filter;

use glam::{DVec2, DVec3};

use crate::{geometry::Ray, numeric::trig};

/// A camera, validated: its axes are orthonormal.
#[derive(Clone, Debug)]
pub struct Camera {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Half the film's height: at unit distance for a perspective camera, in
    /// metres for an orthographic one.
    half_height: f64,
    size: DVec2,
    projection: Projection,
}

/// How film positions become rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// All rays start at the eye.
    Perspective,
    /// All rays are parallel.
    Orthographic,
}

impl Camera {
    /// A pinhole camera. `fov` is the vertical field of view in degrees,
    /// between 0 and 180; `up` must not be parallel to the view direction.
    pub fn perspective(
        eye: DVec3,
        look_at: DVec3,
        up: DVec3,
        fov: f64,
        resolution: [u32; 2],
    ) -> Self {
        let half = trig::tan(0.5 * fov.to_radians());
        Self::new(eye, look_at, up, half, resolution, Projection::Perspective)
    }

    /// A camera of parallel rays whose film is `height` metres tall and
    /// stands at the eye.
    pub fn orthographic(
        eye: DVec3,
        look_at: DVec3,
        up: DVec3,
        height: f64,
        resolution: [u32; 2],
    ) -> Self {
        Self::new(
            eye,
            look_at,
            up,
            0.5 * height,
            resolution,
            Projection::Orthographic,
        )
    }

    fn new(
        eye: DVec3,
        look_at: DVec3,
        up: DVec3,
        half_height: f64,
        resolution: [u32; 2],
        projection: Projection,
    ) -> Self {
        let forward = (look_at - eye).normalize();
        let right = forward.cross(up).normalize();
        let size = DVec2::new(f64::from(resolution[0]), f64::from(resolution[1]));
        Self {
            eye,
            right,
            up: right.cross(forward),
            forward,
            half_height,
            size,
            projection,
        }
    }

    /// The same view on a film of another resolution; the vertical field
    /// stays.
    #[must_use]
    pub fn with_resolution(&self, resolution: [u32; 2]) -> Self {
        Self {
            size: DVec2::new(f64::from(resolution[0]), f64::from(resolution[1])),
            ..self.clone()
        }
    }

    /// The ray through a film position.
    pub fn ray(&self, film: DVec2) -> Ray {
        let scale = 2.0 * self.half_height / self.size.y;
        let x = (film.x - 0.5 * self.size.x) * scale;
        let y = (0.5 * self.size.y - film.y) * scale;
        match self.projection {
            Projection::Perspective => Ray::new(
                self.eye,
                (self.forward + self.right * x + self.up * y).normalize(),
            ),
            Projection::Orthographic => {
                Ray::new(self.eye + self.right * x + self.up * y, self.forward)
            }
        }
    }

    /// The point from which perspective rays start, or the middle of the film.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The normal of the film on which parallel rays start; `None` where all
    /// start at the eye.
    pub fn film_normal(&self) -> Option<DVec3> {
        match self.projection {
            Projection::Perspective => None,
            Projection::Orthographic => Some(self.forward),
        }
    }

    /// Footprint of a pixel: its width at distance `d` along a ray is
    /// `width + spread * d`, in metres.
    pub fn pixel_footprint(&self) -> Footprint {
        let pixel = 2.0 * self.half_height / self.size.y;
        match self.projection {
            Projection::Perspective => Footprint {
                width: 0.0,
                spread: pixel,
            },
            Projection::Orthographic => Footprint {
                width: pixel,
                spread: 0.0,
            },
        }
    }
}

/// The width of a pixel's beam along its ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Width in metres.
    pub width: f64,
    /// Growth in metres per metre.
    pub spread: f64,
}
