//! `--effects`: what is said about effects.

use nephroid::scene::{Choice, Choices, Effect, Settings, Switch};

/// What is said about effects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EffectChoice {
    /// Everything is to be worked out.
    All,
    /// Something about one.
    One(Effect, Choice),
}

impl EffectChoice {
    /// Lays what was typed over the settings of a scene.
    pub(crate) fn apply(all: &[Self], settings: &mut Settings) {
        for choice in all {
            match *choice {
                Self::All => {
                    settings.indirect = true;
                    settings.effects = Choices::all_on();
                }
                Self::One(effect, choice) => {
                    settings.indirect |= effect == Effect::Indirect;
                    settings.effects.set(effect, choice);
                }
            }
        }
    }
}

/// `all`, or an effect and what is said about it: `caustics=off`.
pub(crate) fn effect(text: &str) -> Result<EffectChoice, String> {
    if text == "all" {
        return Ok(EffectChoice::All);
    }
    let (name, choice) = text
        .split_once('=')
        .ok_or("write `all`, or an effect such as caustics=off")?;
    let effect = Effect::named(name).ok_or_else(|| {
        let meant = Effect::nearest(name).map_or_else(String::new, |n| format!("; `{n}`?"));
        let known = Effect::names().join(", ");
        format!("no effect is called `{name}`{meant} There are {known}")
    })?;
    let choice = match choice.to_ascii_lowercase().as_str() {
        "auto" => Choice::Auto,
        "off" => Choice::Off,
        "on" => Choice::On,
        _ => return Err(format!("{name} is `auto`, `off` or `on`")),
    };
    if choice.suits(effect) {
        return Ok(EffectChoice::One(effect, choice));
    }
    Err(match effect.switch() {
        Switch::Never => format!(
            "{name} belongs to a material or a light and cannot be switched; change the scene"
        ),
        Switch::On | Switch::OffOrOn => {
            format!("without {name} the scene would be another one; it is `auto` or `on`")
        }
    })
}
