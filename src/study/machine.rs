//! The machine that a study runs on.

use std::{fs, thread};

use super::record::Machine;

impl Machine {
    /// This machine, as far as the system tells.
    pub fn this() -> Self {
        Self {
            processor: processor(),
            cores: thread::available_parallelism().map_or(1, |n| n.get() as u32),
            threads: rayon::current_num_threads() as u32,
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        }
    }
}

/// Name of the processor: Linux has it in a file, Windows in the environment.
fn processor() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    model_name(&text)
        .or_else(|| std::env::var("PROCESSOR_IDENTIFIER").ok())
        .unwrap_or_else(|| "unknown".to_owned())
}

fn model_name(text: &str) -> Option<String> {
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    let (_, name) = line.split_once(':')?;
    Some(name.trim().to_owned()).filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_is_found() {
        let text = "processor\t: 0\nmodel name\t: Model 7 @ 2 GHz\ncpu MHz : 1\nmodel name: x\n";
        assert_eq!(model_name(text).as_deref(), Some("Model 7 @ 2 GHz"));
        assert_eq!(model_name("model name :\n"), None);
        assert_eq!(model_name("no such line"), None);
        assert!(Machine::this().cores >= 1);
    }
}
