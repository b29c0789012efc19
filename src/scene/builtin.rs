//! The scenes that come with the program.

/// Name and text of each.
pub const SCENES: [(&str, &str); 13] = [
    ("table-1", include_str!("builtin/table-1.toml")),
    ("still", include_str!("builtin/still.toml")),
    ("coning", include_str!("builtin/coning.toml")),
    ("manoeuvre", include_str!("builtin/manoeuvre.toml")),
    ("mpu-9250", include_str!("builtin/mpu-9250.toml")),
    ("full-mpu9250", include_str!("builtin/full-mpu9250.toml")),
    ("level-then-turn", include_str!("builtin/level-then-turn.toml")),
    ("coning-mems", include_str!("builtin/coning-mems.toml")),
    ("pirouette", include_str!("builtin/pirouette.toml")),
    ("pitch-through-90", include_str!("builtin/pitch-through-90.toml")),
    ("vibration", include_str!("builtin/vibration.toml")),
    ("magnetic-disturbance", include_str!("builtin/magnetic-disturbance.toml")),
    ("long-still", include_str!("builtin/long-still.toml")),
];

/// The text of the built-in scene of that name.
pub fn text(name: &str) -> Option<&'static str> {
    SCENES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// What the first line of its text, a comment, says of it.
pub fn about(text: &str) -> &str {
    text.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Plan;

    #[test]
    fn a_scene_made_for_flight_controllers_warns_of_nothing() {
        let made_for_them: Vec<_> =
            SCENES.iter().filter(|(_, text)| about(text).starts_with("Tests ")).collect();
        assert_eq!(made_for_them.len(), 7);
        for (name, _) in made_for_them {
            let plan = Plan::load(name, &[]).unwrap_or_else(|error| panic!("{error}"));
            assert!(plan.warnings.is_empty(), "{name}: {:?}", plan.warnings);
        }
    }
}
