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

    /// Where a point is seen; `None` behind the camera.
    pub fn sight(&self, p: DVec3) -> Option<Sight> {
        let to = p - self.eye;
        let along = to.dot(self.forward);
        if along <= 0.0 {
            return None;
        }
        let pixel = 2.0 * self.half_height / self.size.y;
        let plane = DVec2::new(to.dot(self.right), -to.dot(self.up));
        let (plane, eye, per_area) = match self.projection {
            Projection::Perspective => {
                // A pixel at unit distance is seen under the solid angle
                // pixel^2 cos^3.
                let cos = along / to.length();
                let area = pixel * pixel * cos * cos * cos * to.length_squared();
                (plane / along, self.eye, 1.0 / area)
            }
            Projection::Orthographic => (plane, p - self.forward * along, 1.0 / (pixel * pixel)),
        };
        Some(Sight {
            film: plane / pixel + self.size * 0.5,
            eye,
            per_area,
        })
    }

    /// How film positions become rays.
    pub fn projection(&self) -> Projection {
        self.projection
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

    /// Unit view direction.
    pub fn forward(&self) -> DVec3 {
        self.forward
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

/// How a point is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Its place on the film, in pixels; it may lie outside the picture.
    pub film: DVec2,
    /// Where the ray through that place starts.
    pub eye: DVec3,
    /// Square pixels per square metre at the point, across the ray.
    pub per_area: f64,
}

/// The width of a pixel's beam along its ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Width in metres.
    pub width: f64,
    /// Growth in metres per metre.
    pub spread: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Step of the differences, in pixels.
    const H: f64 = 1e-3;

    /// A point on a ray is seen where the ray came from, and the density is
    /// that of neighbouring rays: their cross product, by central differences
    /// (error about the square of the step, 1e-6).
    #[test]
    fn sight_inverts_rays() {
        let (eye, at, up) = (
            DVec3::new(1.0, -4.0, 2.0),
            DVec3::new(0.2, 0.0, 0.4),
            DVec3::Z,
        );
        for camera in [
            Camera::perspective(eye, at, up, 70.0, [40, 30]),
            Camera::orthographic(eye, at, up, 3.0, [40, 30]),
        ] {
            for film in [[20.0, 15.0], [3.2, 28.5], [-1.0, 31.0]] {
                let film = DVec2::from_array(film);
                let ray = camera.ray(film);
                let seen = camera.sight(ray.at(3.7)).expect("in front");
                assert!((seen.film - film).length() < 1e-12 * 40.0, "{seen:?}");
                assert!((seen.eye - ray.origin).length() < 1e-14 * 10.0);
                let at = |dx: f64, dy: f64| {
                    let other = camera.ray(film + DVec2::new(dx, dy));
                    // Where it crosses the plane across the first ray.
                    let reach = (ray.at(3.7) - other.origin).dot(ray.dir);
                    other.at(reach / other.dir.dot(ray.dir))
                };
                let dx = (at(H, 0.0) - at(-H, 0.0)) / (2.0 * H);
                let dy = (at(0.0, H) - at(0.0, -H)) / (2.0 * H);
                let area = dx.cross(dy).length();
                assert!((seen.per_area * area - 1.0).abs() < 1e-6, "{seen:?} {area}");
                assert!(camera.sight(eye - camera.forward()).is_none());
            }
        }
    }
}
