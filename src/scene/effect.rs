//! The effects that the renderer knows, and what a user says about them.
//!
//! An effect joins as one entry in [`Effect`]'s list here; the compiler then
//! asks `plan` for its proof, and nothing else has to know of it.

use std::fmt;

use serde::{
    Deserialize, Deserializer,
    de::{Error, MapAccess, Visitor},
};

use super::suggest::nearest;

/// Lists the effects: variant, name in files, words for people, and whether a
/// user may switch it off.
macro_rules! effects {
    ($($(#[$doc:meta])* $variant:ident, $name:literal, $title:literal, $switch:ident;)*) => {
        /// Something that light does, and that a scene may or may not call for.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Effect {
            $($(#[$doc])* $variant,)*
        }

        impl Effect {
            /// All effects, in the order in which they are told.
            pub const ALL: [Self; NAMES.len()] = [$(Self::$variant,)*];

            /// How people call it.
            pub fn title(self) -> &'static str {
                match self { $(Self::$variant => $title,)* }
            }

            /// What a user may say about it.
            pub fn switch(self) -> Switch {
                match self { $(Self::$variant => Switch::$switch,)* }
            }
        }

        /// The names in scene files and on the command line.
        const NAMES: &[&str] = &[$($name,)*];
    };
}

effects! {
    /// Surfaces that shine, and suns with a disc, seen by the camera.
    Sources, "sources", "lights in view", Never;
    /// Direct light of lights without extent.
    HardShadows, "hard_shadows", "hard shadows", Never;
    /// Direct light of lights with extent.
    SoftShadows, "soft_shadows", "soft shadows", Never;
    /// Light that was reflected or bent before it fell on a diffuse surface.
    Caustics, "caustics", "caustics", OffOrOn;
    /// Light that goes from one diffuse surface to another.
    Indirect, "indirect", "indirect light", OffOrOn;
    /// Reflection by mirrors.
    Mirrors, "mirrors", "mirror reflection", Never;
    /// Reflection and refraction at glass and water.
    Refraction, "refraction", "refraction", Never;
    /// Reflection in glass beyond the critical angle.
    TotalReflection, "total_reflection", "total reflection", Never;
    /// Surfaces that let light through in a straight line.
    Panes, "panes", "panes", On;
    /// Bodies of clear media that overlap.
    Nesting, "nesting", "nested media", On;
    /// Normals that are interpolated over a mesh.
    ShadingNormals, "shading_normals", "smooth normals", Never;
    /// Rays of their own for small images of sources.
    Glints, "glints", "glints", OffOrOn;
}

/// What a user may say about an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Switch {
    /// It belongs to a material or a light: nothing runs where there is none,
    /// and to leave it out the scene has to change.
    Never,
    /// It can be worked out where nobody needs it; without it the scene
    /// would be another one.
    On,
    /// It can be left out, too.
    OffOrOn,
}

impl Effect {
    /// Its name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        NAMES[self as usize]
    }

    /// The names of all effects.
    pub fn names() -> &'static [&'static str] {
        NAMES
    }

    /// The name of an effect that someone probably meant to write.
    pub fn nearest(name: &str) -> Option<&'static str> {
        nearest(name, NAMES.iter().copied())
    }

    /// The effect of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|e| e.name() == name)
    }
}

/// What a user has said about an effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename = "choice")]
pub enum Choice {
    /// The scene decides.
    #[default]
    Auto,
    /// Leave it out.
    Off,
    /// Work it out even where the plan can prove that nothing comes of it.
    On,
}

impl Choice {
    /// Whether it may be said of an effect.
    pub fn suits(self, effect: Effect) -> bool {
        match (self, effect.switch()) {
            (Self::Auto, _) | (_, Switch::OffOrOn) | (Self::On, Switch::On) => true,
            (Self::Off, Switch::On) | (_, Switch::Never) => false,
        }
    }
}

/// What a user has said about all effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Choices([Choice; Effect::ALL.len()]);

impl Choices {
    /// What was said about one.
    pub fn of(&self, effect: Effect) -> Choice {
        self.0[effect as usize]
    }

    /// Says something about one. It must [suit](Choice::suits).
    pub fn set(&mut self, effect: Effect, choice: Choice) {
        debug_assert!(choice.suits(effect), "{effect:?} cannot be {choice:?}");
        self.0[effect as usize] = choice;
    }

    /// Everything on that can be forced.
    pub fn all_on() -> Self {
        Self(Effect::ALL.map(|e| {
            if Choice::On.suits(e) {
                Choice::On
            } else {
                Choice::Auto
            }
        }))
    }
}

impl fmt::Display for Choices {
    /// As it is typed: `caustics=off,panes=on`; `auto` if nothing was said.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let said = Effect::ALL.into_iter().filter_map(|e| {
            let word = match self.of(e) {
                Choice::Auto => return None,
                Choice::Off => "off",
                Choice::On => "on",
            };
            Some(format!("{}={word}", e.name()))
        });
        let said: Vec<String> = said.collect();
        f.write_str(if said.is_empty() { "auto" } else { "" })?;
        f.write_str(&said.join(","))
    }
}

/// `effects: (caustics: Off)` as written: any effect, any choice.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EffectsDescription(pub Vec<(Effect, Choice)>);

impl<'de> Deserialize<'de> for EffectsDescription {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Fields;
        impl<'de> Visitor<'de> for Fields {
            type Value = EffectsDescription;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("effects by name")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut found: Vec<(Effect, Choice)> = Vec::new();
                while let Some(Key(effect)) = map.next_key()? {
                    if found.iter().any(|(e, _)| *e == effect) {
                        return Err(A::Error::duplicate_field(effect.name()));
                    }
                    found.push((effect, map.next_value()?));
                }
                Ok(EffectsDescription(found))
            }
        }
        from.deserialize_struct("Effects", NAMES, Fields)
    }
}

/// The name of an effect where a field is expected.
struct Key(Effect);

impl<'de> Deserialize<'de> for Key {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Name;
        impl Visitor<'_> for Name {
            type Value = Key;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of an effect")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<Key, E> {
                Effect::named(name)
                    .map(Key)
                    .ok_or_else(|| E::unknown_field(name, NAMES))
            }
        }
        from.deserialize_identifier(Name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_lead_back() {
        for (i, effect) in Effect::ALL.into_iter().enumerate() {
            assert_eq!(effect as usize, i);
            assert_eq!(Effect::named(effect.name()), Some(effect));
        }
        assert_eq!(Effect::named("fog"), None);
    }

    #[test]
    fn what_may_be_said() {
        let all = Choices::all_on();
        for effect in Effect::ALL {
            assert!(Choice::Auto.suits(effect) && all.of(effect).suits(effect));
            let forced = all.of(effect) == Choice::On;
            assert_eq!(forced, effect.switch() != Switch::Never, "{effect:?}");
        }
        assert!(Choice::Off.suits(Effect::Caustics) && !Choice::Off.suits(Effect::Panes));
        assert!(!Choice::On.suits(Effect::Mirrors));
    }
}
