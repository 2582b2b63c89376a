//! Emissions by name: those of the scene and those of the library.

use crate::keys::Key;
use crate::library;
use crate::lower::context::Context;
use crate::spec::source::{EMISSION_TABLES, EMISSION_WORDS, EmissionRef, EmissionSpec};

impl Context<'_> {
    /// Notes emissions that no source could refer to.
    pub(super) fn check_names_of_emissions(&mut self) {
        for name in
            self.spec.emissions.keys().filter(|name| EMISSION_WORDS.contains(&name.as_str()))
        {
            let message = format!("the name `{name}` is taken by a kind of emission");
            let key = Key::of(&["emissions", name]);
            self.problems.certain_error(&key, message).hint("give it another name");
        }
    }

    /// The emission of a reference.
    pub(super) fn emission_spec(
        &mut self,
        reference: &EmissionRef,
        key: &Key,
    ) -> Option<EmissionSpec> {
        let name = match reference {
            EmissionRef::Inline(emission) => return Some(*emission),
            EmissionRef::Name(name) => name.as_str(),
        };
        if let Some(own) = self.spec.emissions.get(name) {
            return Some(*own);
        }
        let known = library::emissions().get(name);
        if let Some(known) = known.filter(|_| !self.names("emissions").contains(name)) {
            self.meshes.add(known.keys.as_bytes());
            return Some(known.spec);
        }
        if EMISSION_TABLES.contains(&name) {
            let hint = format!("write it as a table: {{ {name} = ... }}");
            return self.refuse(key, format!("unknown emission `{name}`"), hint);
        }
        let listed = library::emissions().keys().map(String::as_str);
        let known: Vec<&str> = EMISSION_WORDS.into_iter().chain(listed).collect();
        self.require_known(["emission", "emissions"], name, &known, key);
        None
    }
}
